/// A chip without a processor, for the tests of its register models: registers by their addresses
/// in RM0090 (table 1), time by hand. The tests write addresses and bits as the manual has them.
#ifndef TESTS_MCU_CHIP_H
#define TESTS_MCU_CHIP_H

#include "check.h"
#include "mcu/soc.h"

#include <string.h>

#define RCC    0x40023800U
#define FLASH  0x40023C00U
#define PWR    0x40007000U
#define SYSCFG 0x40013800U
#define EXTI   0x40013C00U
#define IWDG   0x40003000U
#define GPIOA  0x40020000U
#define GPIOB  0x40020400U
#define GPIOC  0x40020800U
#define TIM1   0x40010000U
#define TIM2   0x40000000U
#define TIM3   0x40000400U
#define USART1 0x40011000U
#define USART2 0x40004400U
#define CAN1   0x40006400U
#define CAN2   0x40006800U

static struct soc chip;

static inline uint32_t peek(uint32_t address) {
    return soc_read(&chip, address, 4);
}

static inline void poke(uint32_t address, uint32_t value) {
    soc_write(&chip, address, 4, value);
}

static inline void set_bits(uint32_t address, uint32_t bits) {
    poke(address, peek(address) | bits);
}

static inline void pass_ns(uint64_t ns) {
    soc_advance_ns(&chip, ns);
}

static inline void pass_us(uint64_t us) {
    soc_advance_ns(&chip, us * 1000U);
}

/// Lets HCLK cycles pass, as a processor does: one by one for whoever waits.
static inline void pass_cycles(uint64_t cycles) {
    for (uint64_t i = 0; i < cycles; i++) {
        chip.cycle++;
        if (chip.cycle >= chip.attend_cycle) {
            soc_run_due(&chip);
        }
    }
}

/// 8 MHz crystal, 32 kHz low-speed oscillator.
static inline void power_on_with(struct soc_options options) {
    if (options.lsi_hz == 0U) {
        options.lsi_hz = 32000;
    }
    soc_init(&chip, &options);
}

static inline void power_on(void) {
    power_on_with((struct soc_options){.hse_hz = 8000000});
}

static inline bool is_pending(unsigned exception) {
    return nvic_test(chip.nvic.pending, exception);
}

/// An interrupt by its position in RM0090, table 61.
static inline bool irq_is_pending(unsigned irq) {
    return is_pending(16U + irq);
}

/// As after its handler has begun.
static inline void clear_irq(unsigned irq) {
    nvic_set_pending(&chip.nvic, 16U + irq, false);
}

/// All clocks of parts on.
static inline void clock_everything(void) {
    poke(RCC + 0x30U, 0x1FFU);
    poke(RCC + 0x40U, 0xFFFFFFFFU);
    poke(RCC + 0x44U, 0xFFFFFFFFU);
}

/// 8 MHz / 8 * 336 / 2: 168 MHz, APB1 a quarter, APB2 half of it (RM0090, 7.3.2 and 7.3.3).
static inline void run_at_168_mhz(void) {
    set_bits(RCC, UINT32_C(1) << 16); // HSEON
    pass_us(10000);
    poke(FLASH, 5);
    poke(RCC + 4U, 8U | 336U << 6 | 0U << 16 | UINT32_C(1) << 22 | 7U << 24);
    poke(RCC + 8U, 5U << 10 | 4U << 13); // PPRE1: /4, PPRE2: /2
    set_bits(RCC, UINT32_C(1) << 24);    // PLLON
    pass_us(1000);
    set_bits(RCC + 8U, 2U);
}

#endif
