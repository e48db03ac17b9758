#include "stm32f4/stm32f4_watchdog.h"

#include "cortexm/cortexm.h"
#include "stm32f4/stm32f4_registers.h"

#define SLOWEST_KHZ    17U
#define TIMEOUT_US_MAX (UINT32_MAX / SLOWEST_KHZ)

/// Five cycles of the slowest oscillator are 300 us (21.3.2): 8 ms at 168 MHz.
#define BUSY_READS 130000U

static enum hal_status watchdog_start(void *ctx, uint32_t timeout_us) {
    struct stm32f4_watchdog *watchdog = ctx;
    if (watchdog->started) {
        return HAL_ERROR_ARGUMENT;
    }
    if (timeout_us > TIMEOUT_US_MAX) {
        return HAL_ERROR_UNSUPPORTED;
    }
    const uint32_t cycles = timeout_us * SLOWEST_KHZ / 1000U;
    unsigned shift = 2; // the oscillator is divided by 4 at least
    while (shift < STM32F4_IWDG_SHIFT_MAX && cycles >> shift > STM32F4_IWDG_RLR_MAX + 1U) {
        shift++;
    }
    const uint32_t count = cycles >> shift;
    if (count < 2U || count > STM32F4_IWDG_RLR_MAX + 1U) {
        return HAL_ERROR_UNSUPPORTED;
    }
    struct stm32f4_iwdg *iwdg = STM32F4_IWDG;
    iwdg->kr = STM32F4_IWDG_KR_START;
    watchdog->started = true;
    iwdg->kr = STM32F4_IWDG_KR_UNLOCK;
    iwdg->pr = shift - 2U;
    iwdg->rlr = count - 1U;
    const bool taken = cortexm_wait_bits(&iwdg->sr, STM32F4_IWDG_SR_BUSY, 0, BUSY_READS);
    iwdg->kr = STM32F4_IWDG_KR_FEED;
    return taken ? HAL_OK : HAL_ERROR_IO;
}

static enum hal_status watchdog_feed(void *ctx) {
    const struct stm32f4_watchdog *watchdog = ctx;
    if (!watchdog->started) {
        return HAL_ERROR_DOWN;
    }
    STM32F4_IWDG->kr = STM32F4_IWDG_KR_FEED;
    return HAL_OK;
}

static enum hal_status watchdog_reset_cause(void *ctx, enum hal_reset_cause *cause) {
    const struct stm32f4_watchdog *watchdog = ctx;
    *cause = watchdog->cause;
    return HAL_OK;
}

static const struct hal_watchdog_ops stm32f4_watchdog_ops = {watchdog_start, watchdog_feed,
                                                             watchdog_reset_cause};

/// 7.3.21. Every reset from inside also pulls the reset pin, and power-on sets the brown-out flag:
/// the most telling one first.
static enum hal_reset_cause cause_of(uint32_t csr) {
    static const struct {
        uint32_t flag;
        enum hal_reset_cause cause;
    } causes[] = {{STM32F4_RCC_CSR_IWDG | STM32F4_RCC_CSR_WWDG, HAL_RESET_WATCHDOG},
                  {STM32F4_RCC_CSR_SFTRSTF, HAL_RESET_SOFTWARE},
                  {STM32F4_RCC_CSR_PORRSTF, HAL_RESET_POWER_ON},
                  {STM32F4_RCC_CSR_BORRSTF, HAL_RESET_BROWN_OUT},
                  {STM32F4_RCC_CSR_PINRSTF, HAL_RESET_PIN}};
    for (unsigned i = 0; i < sizeof causes / sizeof causes[0]; i++) {
        if ((csr & causes[i].flag) != 0U) {
            return causes[i].cause;
        }
    }
    return HAL_RESET_UNKNOWN;
}

void stm32f4_watchdog_init(struct stm32f4_watchdog *watchdog) {
    (void)!hal_watchdog_bind(&watchdog->hal, &stm32f4_watchdog_ops, watchdog);
    watchdog->started = false;
    watchdog->cause = cause_of(STM32F4_RCC->csr);
    STM32F4_RCC->csr |= STM32F4_RCC_CSR_RMVF;
}
