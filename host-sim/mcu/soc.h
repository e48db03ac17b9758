/// The STM32F405 but for its processor: registers, clocks, time, interrupts.
///
/// Every model here was written from ST's reference manual RM0090, the programming manual PM0214
/// and the ARMv7-M Architecture Reference Manual, never from a driver, so that driver and model
/// can't share a mistake. Each header names the chapter and what is left out; tests/mcu/ has the
/// tests.
///
/// The processor (cpu.h) counts `cycle` up and calls soc_read and soc_write; a test may do the same
/// without one. Time is counted in cycles of the bus clock HCLK, which runs at different speeds
/// (16 MHz after reset), and told in nanoseconds since power-on. Everything that happens by itself
/// (a byte arrives, a counter overflows) is an event: one due time for each part.
///
/// What the manual forbids, and what a real chip would answer with nonsense (a flash too slow for
/// its clock, a register of a part whose clock is off), is a complaint: counted, and told once.
/// Registers that exist but have no model read 0, ignore writes, and complain.
#ifndef MCU_SOC_H
#define MCU_SOC_H

#include "mcu/bxcan.h"
#include "mcu/exti.h"
#include "mcu/flash_interface.h"
#include "mcu/gpio.h"
#include "mcu/iwdg.h"
#include "mcu/nvic.h"
#include "mcu/pwr.h"
#include "mcu/rcc.h"
#include "mcu/scb.h"
#include "mcu/systick.h"
#include "mcu/timer.h"
#include "mcu/usart.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/// Never, as a cycle or a time.
#define SOC_NEVER UINT64_MAX

enum soc_part {
    SOC_RCC,
    SOC_FLASH,
    SOC_PWR,
    SOC_SYSCFG,
    SOC_EXTI,
    SOC_IWDG,
    SOC_GPIOA,
    SOC_GPIO_END = SOC_GPIOA + GPIO_PORTS,
    SOC_TIM1 = SOC_GPIO_END,
    SOC_TIM_END = SOC_TIM1 + TIMER_COUNT,
    SOC_USART1 = SOC_TIM_END,
    SOC_USART_END = SOC_USART1 + USART_COUNT,
    SOC_CAN1 = SOC_USART_END,
    SOC_CAN2,
    SOC_SYSTICK,
    SOC_WORLD, ///< the host's events: the CAN bus, bytes for the serial port
    SOC_END,   ///< of a run, soc_set_end
    SOC_PART_COUNT
};

/// Why the chip starts; the flags of RCC_CSR.
enum soc_reset {
    SOC_RESET_NONE,
    SOC_RESET_POWER,
    SOC_RESET_PIN,
    SOC_RESET_SOFTWARE,
    SOC_RESET_WATCHDOG,
};

/// Ready bits that never come, or-ed.
enum soc_stuck {
    SOC_STUCK_HSE = 1,    ///< the crystal does not start
    SOC_STUCK_PLL = 2,    ///< the PLL does not lock
    SOC_STUCK_SWITCH = 4, ///< the system clock switch does not follow
    SOC_STUCK_CAN = 8,    ///< the CAN controller does not enter its initialisation mode
};

struct soc_options {
    uint32_t hse_hz; ///< crystal; 0: none fitted
    uint32_t lsi_hz; ///< 17,000 to 47,000 by the data sheet; typically 32,000
    uint32_t stuck;  ///< enum soc_stuck
    FILE *log;       ///< complaints, a line each; NULL: only counted
};

#define SOC_COMPLAINTS_KEPT 16U

struct soc {
    struct soc_options options;

    // Time.
    uint64_t cycle; ///< HCLK cycles since power-on
    uint64_t epoch_cycle, epoch_ns;
    uint32_t hclk_hz;
    uint64_t due_cycle[SOC_PART_COUNT];
    uint64_t due_ns[SOC_PART_COUNT]; ///< of events by the clock on the wall, SOC_NEVER for others
    uint64_t next_cycle;             ///< the earliest of due_cycle
    /// When the processor must look up from its program: next_cycle, or at once (0) because of an
    /// interrupt, a reset or a fault.
    uint64_t attend_cycle;

    bool ended; ///< the end of the run has come

    /// Called when the part SOC_WORLD is due.
    void (*world)(void *context);
    void *world_context;

    enum soc_reset reset_wanted; ///< the processor carries it out
    uint64_t slept_cycles;       ///< how many of cycle the processor slept; for CYCCNT

    uint8_t part_of_block[512]; ///< by KiB from 0x40000000 on: 1 + enum soc_part; 0: no model

    uint64_t complaints;
    char complaint[SOC_COMPLAINTS_KEPT][120];
    uint32_t complaint_kinds;

    struct nvic nvic;
    struct scb scb;
    struct systick systick;
    struct rcc rcc;
    struct flash_interface flash;
    struct pwr pwr;
    struct gpio_port gpio[GPIO_PORTS];
    struct exti exti;
    struct iwdg iwdg;
    struct timer timer[TIMER_COUNT];
    struct usart usart[USART_COUNT];
    struct bxcan_filters filters;
    struct bxcan can[2];
};

/// Power-on. options: copied. The struct must not move afterwards.
void soc_init(struct soc *soc, const struct soc_options *options);

/// A system reset: every register but the reset flags and the backup domain. Time goes on.
void soc_reset(struct soc *soc, enum soc_reset cause);

/// The reset bits of a bus in RCC: parts are held in reset.
void soc_reset_parts(struct soc *soc, enum rcc_bus bus, uint32_t bits);

/// An access of 1, 2 or 4 bytes at 0x40000000 to 0x5FFFFFFF or 0xE0000000 to 0xE00FFFFF.
uint32_t soc_read(struct soc *soc, uint32_t address, unsigned size_bytes);
void soc_write(struct soc *soc, uint32_t address, unsigned size_bytes, uint32_t value);

// ---------------------------------------------------------------- time

/// Nanoseconds since power-on, rounded down.
static inline uint64_t soc_now_ns(const struct soc *soc) {
    return soc->epoch_ns + (soc->cycle - soc->epoch_cycle) * UINT64_C(1000000000) / soc->hclk_hz;
}

/// The first cycle at or after a time. More than 100 s ahead: 100 s ahead.
uint64_t soc_cycle_at(const struct soc *soc, uint64_t ns);

/// HCLK runs at another speed from now on.
void soc_set_hclk(struct soc *soc, uint32_t hz);

/// When a part wants to be called; SOC_NEVER: not at all. May be called early (a time more than
/// 100 s ahead, another clock), so it looks at the time itself.
void soc_schedule(struct soc *soc, enum soc_part part, uint64_t cycle);
void soc_schedule_ns(struct soc *soc, enum soc_part part, uint64_t ns);

/// Calls every part whose time has come, in the order of their times, and sets attend_cycle.
void soc_run_due(struct soc *soc);

/// The processor must look up at once.
static inline void soc_alert(struct soc *soc) {
    soc->attend_cycle = 0;
}

/// Resets the chip as soon as the processor looks up.
static inline void soc_want_reset(struct soc *soc, enum soc_reset cause) {
    soc->reset_wanted = cause;
    soc_alert(soc);
}

/// From now on `ended` tells whether a time has come.
void soc_set_end(struct soc *soc, uint64_t ns);

/// Without a processor: lets time pass. For tests.
void soc_advance_ns(struct soc *soc, uint64_t ns);

// ---------------------------------------------------------------- complaints

/// Each text is told once.
void soc_complain(struct soc *soc, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
