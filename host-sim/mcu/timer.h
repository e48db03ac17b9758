/// Timers TIM1 to TIM5, counting up, with pulses from their compare channels.
///
/// Source: RM0090, chapters 17 (TIM1) and 18 (TIM2 to TIM5). The prescaler always, and the reload
/// and compare values where their preload bit is set, take effect at an update: an overflow (every
/// RCR + 1 of them, TIM1) or EGR.UG. TIM2 and TIM5 have 32 bits, the others 16. Left out: counting
/// down and in the middle, input capture, slave mode, DMA, break and dead time (all complain when
/// switched on). The counter is worked out when somebody looks; an update is an event only while it
/// means something. Shown: tests/mcu/timer.c.
#ifndef MCU_TIMER_H
#define MCU_TIMER_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

enum { TIMER_COUNT = 5, TIMER_CHANNELS = 4 };

struct timer {
    struct soc *soc;
    uint8_t index; ///< 0: TIM1
    uint32_t cr1, cr2, smcr, dier, sr, ccmr[2], ccer, psc, arr, rcr, ccr[TIMER_CHANNELS], bdtr, dcr;
    // What counts now.
    uint32_t active_psc, active_arr, active_ccr[TIMER_CHANNELS], repetitions;
    // The counter was `count` at `since`, with the prescaler at its beginning.
    uint32_t count;
    uint64_t since;
    uint32_t divider; ///< HCLK cycles in a clock of the timer
};

void timer_reset(struct timer *timer, struct soc *soc, unsigned index);
void timer_due(struct timer *timer);
uint32_t timer_read(void *model, uint32_t offset);
void timer_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// The bus clocks are about to change, and have changed.
void timer_hold(struct timer *timer);
void timer_clock_changed(struct timer *timer);

/// What comes out of a channel, in HCLK cycles: how long the line is high in each period. 0 of 0:
/// the line does not move.
struct timer_pulse {
    uint64_t high_cycles, period_cycles;
};
struct timer_pulse timer_pulse_of(struct timer *timer, unsigned channel);

#endif
