#include "stm32f4/stm32f4_clocks.h"

#include "cortexm/cortexm.h"
#include "stm32f4/stm32f4_registers.h"

#define HSI_HZ 16000000U
#define PLL_HZ 168000000U

/// Reads of a register at 16 MHz: about 100 ms, which is many times what a crystal takes (data
/// sheet: 2 ms), and 1 ms for what takes microseconds.
#define CRYSTAL_READS 160000U
#define SHORT_READS   1600U

/// A core of the first revision (IDCODE 0x1000) must not prefetch (errata ES0182).
#define REVISION_A 0x1000U

/// A boot loader that was left without a reset may have the PLL running.
static void return_to_hsi(void) {
    struct stm32f4_rcc *rcc = STM32F4_RCC;
    rcc->cr |= STM32F4_RCC_CR_HSION;
    (void)cortexm_wait_bits(&rcc->cr, STM32F4_RCC_CR_HSIRDY, STM32F4_RCC_CR_HSIRDY, SHORT_READS);
    rcc->cfgr = STM32F4_RCC_CFGR_SW_HSI;
    (void)cortexm_wait_bits(&rcc->cfgr, STM32F4_RCC_CFGR_SWS, 0, SHORT_READS);
    rcc->cr &= ~(uint32_t)(STM32F4_RCC_CR_PLLON | STM32F4_RCC_CR_HSEON | STM32F4_RCC_CR_CSSON);
    (void)cortexm_wait_bits(&rcc->cr, STM32F4_RCC_CR_PLLRDY, 0, SHORT_READS);
}

static enum stm32f4_clocks_state start_pll(uint32_t crystal_mhz) {
    struct stm32f4_rcc *rcc = STM32F4_RCC;
    rcc->cr |= STM32F4_RCC_CR_HSEON;
    if (!cortexm_wait_bits(&rcc->cr, STM32F4_RCC_CR_HSERDY, STM32F4_RCC_CR_HSERDY, CRYSTAL_READS)) {
        return STM32F4_CLOCKS_NO_CRYSTAL;
    }
    // Crystal / m = 1 MHz, * 336 = 336 MHz, / 2 = 168 MHz; / 7 = 48 MHz for USB.
    rcc->pllcfgr = crystal_mhz | 336U << STM32F4_RCC_PLLCFGR_N_SHIFT | STM32F4_RCC_PLLCFGR_SRC_HSE |
                   7U << STM32F4_RCC_PLLCFGR_Q_SHIFT;
    rcc->cr |= STM32F4_RCC_CR_PLLON;
    if (!cortexm_wait_bits(&rcc->cr, STM32F4_RCC_CR_PLLRDY, STM32F4_RCC_CR_PLLRDY, SHORT_READS)) {
        return STM32F4_CLOCKS_NO_PLL;
    }
    // 3.5.1: five wait states before the clock is fast, at 2.7 V and more; read back, they are in
    // force.
    const uint32_t prefetch =
        *STM32F4_DBGMCU_IDCODE >> 16 > REVISION_A ? STM32F4_FLASH_ACR_PREFETCH : 0;
    STM32F4_FLASH->acr = STM32F4_FLASH_ACR_LATENCY_5 | STM32F4_FLASH_ACR_INSTRUCTION_CACHE |
                         STM32F4_FLASH_ACR_DATA_CACHE | prefetch;
    if (!cortexm_wait_bits(&STM32F4_FLASH->acr, STM32F4_FLASH_ACR_LATENCY,
                           STM32F4_FLASH_ACR_LATENCY_5, SHORT_READS)) {
        return STM32F4_CLOCKS_NO_FLASH;
    }
    // 7.3.3: at most 42 MHz on APB1, 84 MHz on APB2.
    rcc->cfgr = STM32F4_RCC_CFGR_PPRE1_DIV4 | STM32F4_RCC_CFGR_PPRE2_DIV2;
    rcc->cfgr |= STM32F4_RCC_CFGR_SW_PLL;
    if (!cortexm_wait_bits(&rcc->cfgr, STM32F4_RCC_CFGR_SWS,
                           STM32F4_RCC_CFGR_SW_PLL << STM32F4_RCC_CFGR_SWS_SHIFT, SHORT_READS)) {
        return STM32F4_CLOCKS_NO_SWITCH;
    }
    rcc->cr |= STM32F4_RCC_CR_CSSON;
    return STM32F4_CLOCKS_FULL;
}

struct stm32f4_clocks stm32f4_clocks_start(uint32_t crystal_mhz) {
    return_to_hsi();
    struct stm32f4_clocks clocks = {.state = start_pll(crystal_mhz),
                                    .core_hz = PLL_HZ,
                                    .apb1_hz = PLL_HZ / 4U,
                                    .apb2_hz = PLL_HZ / 2U,
                                    .apb1_timer_hz = PLL_HZ / 2U};
    if (clocks.state != STM32F4_CLOCKS_FULL) {
        return_to_hsi();
        clocks.core_hz = clocks.apb1_hz = clocks.apb2_hz = clocks.apb1_timer_hz = HSI_HZ;
    }
    return clocks;
}

const char *stm32f4_clocks_state_name(enum stm32f4_clocks_state state) {
    static const char *const names[] = {
        "crystal and PLL run", "the crystal does not oscillate", "the PLL does not lock",
        "the flash does not take its wait states", "the chip does not switch to the PLL"};
    return names[state];
}

void stm32f4_clocks_enable(const volatile void *block) {
    const uint32_t address = (uint32_t)(uintptr_t)block;
    const uint32_t bit = 1U << (address >> 10 & 31U);
    volatile uint32_t *enable = address >= 0x40020000U   ? &STM32F4_RCC->ahb1enr
                                : address >= 0x40010000U ? &STM32F4_RCC->apb2enr
                                                         : &STM32F4_RCC->apb1enr;
    *enable |= bit;
    (void)*enable; // the clock needs two cycles before the block can be used (7.2.12, ES0182)
}
