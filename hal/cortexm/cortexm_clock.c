#include "cortexm/cortexm_clock.h"

#include "cortexm/cortexm.h"

/// Cycles since the last tick. The counter shows 0 in the very cycle of the tick, then the reload
/// value.
static uint32_t cycles_since_tick(const struct cortexm_clock *clock, uint32_t value) {
    return value == 0U ? 0U : clock->tick_us * clock->cycles_per_us - value;
}

uint32_t cortexm_clock_now_us(const struct cortexm_clock *clock) {
    uint32_t ticks, cycles;
    do {
        ticks = clock->ticks;
        cycles = cycles_since_tick(clock, CORTEXM_SYSTICK->value);
        if ((CORTEXM_SCB->icsr & CORTEXM_ICSR_PENDSTSET) != 0U) {
            // The tick has come, but its handler has not: interrupts are off.
            cycles = cycles_since_tick(clock, CORTEXM_SYSTICK->value) +
                     clock->tick_us * clock->cycles_per_us;
        }
    } while (ticks != clock->ticks);
    return ticks * clock->tick_us + cycles / clock->cycles_per_us;
}

static uint32_t now_us(void *ctx) {
    return cortexm_clock_now_us(ctx);
}

static const struct hal_clock_ops cortexm_clock_ops = {now_us};

void cortexm_clock_start(struct cortexm_clock *clock, uint32_t core_hz, uint32_t tick_us) {
    (void)!hal_clock_bind(&clock->hal, &cortexm_clock_ops, clock);
    clock->ticks = 0;
    clock->tick_us = tick_us;
    clock->cycles_per_us = core_hz / 1000000U;
    CORTEXM_SYSTICK->control = 0;
    CORTEXM_SYSTICK->reload = clock->tick_us * clock->cycles_per_us - 1U;
    CORTEXM_SYSTICK->value = 0;
    CORTEXM_SCB->shpr[2] = (CORTEXM_SCB->shpr[2] & 0x00FFFFFFU) | (uint32_t)CORTEXM_PRIORITY_TICK
                                                                      << 24;
    CORTEXM_SYSTICK->control =
        CORTEXM_SYSTICK_ENABLE | CORTEXM_SYSTICK_INTERRUPT | CORTEXM_SYSTICK_CORE_CLOCK;
}

void cortexm_clock_on_tick(struct cortexm_clock *clock) {
    clock->ticks++;
}

uint32_t cortexm_clock_wait_tick(const struct cortexm_clock *clock, uint32_t tick) {
    for (;;) {
        // With interrupts off, none can slip in between the look and the sleep; it still wakes.
        cortexm_interrupts_disable();
        if (clock->ticks == tick) {
            cortexm_wait_for_interrupt();
        }
        cortexm_interrupts_enable();
        if (clock->ticks != tick) {
            return clock->ticks;
        }
    }
}
