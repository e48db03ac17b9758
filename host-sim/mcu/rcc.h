/// Clocks and resets.
///
/// Source: RM0090 (STM32F405/415, 407/417, 427/437, 429/439), chapter 7; times and limits from the
/// STM32F405xx data sheet, 5.3. Oscillators and PLL become ready some time after they are switched
/// on, or never (soc_options.stuck). The system clock changes over when the one asked for is ready.
/// What runs the system can't be switched off. A PLL, bus clock or flash out of its limits is a
/// complaint. The clock security system switches to the internal oscillator and raises NMI
/// (rcc_fail_hse). Left out: clock outputs, RTC, spread spectrum, low-power modes, the PLL for
/// audio (ready bit only). Shown: tests/mcu/rcc.c.
#ifndef MCU_RCC_H
#define MCU_RCC_H

#include <stdbool.h>
#include <stdint.h>

struct soc;
enum soc_reset;

enum rcc_bus { RCC_AHB1, RCC_AHB2, RCC_AHB3, RCC_APB1, RCC_APB2, RCC_BUS_COUNT, RCC_UNGATED };

enum rcc_oscillator { RCC_LSI, RCC_LSE, RCC_HSI, RCC_HSE, RCC_PLL, RCC_PLLI2S, RCC_OSCILLATORS };

struct rcc {
    struct soc *soc;
    uint32_t cr, pllcfgr, cfgr, cir, bdcr, csr, plli2scfgr, sscgr;
    uint32_t reset[RCC_BUS_COUNT], enable[RCC_BUS_COUNT], low_power_enable[RCC_BUS_COUNT];
    uint32_t running;                   ///< a bit for each oscillator that is ready
    uint64_t ready_ns[RCC_OSCILLATORS]; ///< when one that was switched on becomes ready
    uint32_t switched;                  ///< SWS
    bool hse_failed;
};

void rcc_reset(struct rcc *rcc, struct soc *soc, enum soc_reset cause);
void rcc_due(struct rcc *rcc);

uint32_t rcc_read(void *model, uint32_t offset);
void rcc_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// May the registers of a part be used: clocked, and not held in reset?
bool rcc_is_clocked(const struct rcc *rcc, enum rcc_bus bus, unsigned bit);

/// Clock of the APB1 or APB2 bus.
uint32_t rcc_pclk_hz(const struct rcc *rcc, enum rcc_bus bus);

/// HCLK cycles for each clock of the timers on APB1 or APB2: the bus clock, or twice that if the
/// bus is divided.
uint32_t rcc_timer_divider(const struct rcc *rcc, enum rcc_bus bus);

/// The watchdog needs the low-speed internal oscillator: it is switched on.
void rcc_force_lsi(struct rcc *rcc);
bool rcc_lsi_runs(const struct rcc *rcc);

/// The crystal stops.
void rcc_fail_hse(struct rcc *rcc);

/// Checks the flash latency and the voltage scale against the clock; called when any of them
/// changes.
void rcc_check_limits(struct rcc *rcc);

#endif
