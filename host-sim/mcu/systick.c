#include "mcu/systick.h"

#include "mcu/soc.h"

#define CONTROL_ENABLE  1U
#define CONTROL_TICKINT 2U
#define CONTROL_HCLK    4U
#define CONTROL_COUNTED 0x10000U
#define VALUE_MASK      0xFFFFFFU

static uint32_t cycles_per_count(const struct systick *s) {
    return (s->control & CONTROL_HCLK) != 0U ? 1U : 8U;
}

/// Counts from `start` to the next passage from 1 to 0; 0: never.
static uint64_t counts_to_zero(const struct systick *s) {
    if (s->start != 0U) {
        return s->start;
    }
    return s->load != 0U ? (uint64_t)s->load + 1U : 0U; // one count to load
}

static void schedule(struct systick *s) {
    const uint64_t counts = counts_to_zero(s);
    const bool runs = (s->control & CONTROL_ENABLE) != 0U && counts != 0U;
    soc_schedule(s->soc, SOC_SYSTICK,
                 runs && (s->control & CONTROL_TICKINT) != 0U
                     ? s->start_cycle + counts * cycles_per_count(s)
                     : SOC_NEVER);
}

/// Moves `start` to now.
static void advance(struct systick *s) {
    if ((s->control & CONTROL_ENABLE) == 0U) {
        return;
    }
    const uint32_t step = cycles_per_count(s);
    uint64_t counts = (s->soc->cycle - s->start_cycle) / step;
    s->start_cycle += counts * step;
    const uint64_t to_zero = counts_to_zero(s);
    if (to_zero == 0U || counts < to_zero) {
        if (s->start != 0U) {
            s->start -= (uint32_t)counts;
        } else if (to_zero != 0U && counts != 0U) {
            s->start = s->load - (uint32_t)(counts - 1U);
        }
        return;
    }
    counts -= to_zero;
    s->count_flag = true;
    if ((s->control & CONTROL_TICKINT) != 0U) {
        nvic_set_pending(&s->soc->nvic, NVIC_SYSTICK, true);
    }
    const uint64_t period = (uint64_t)s->load + 1U;
    counts = s->load != 0U ? counts % period : 0U; // since it was 0
    s->start = counts == 0U ? 0U : s->load - (uint32_t)(counts - 1U);
}

void systick_reset(struct systick *s, struct soc *soc) {
    *s = (struct systick){.soc = soc};
    schedule(s);
}

void systick_due(struct systick *s) {
    advance(s);
    schedule(s);
}

uint32_t systick_read(struct systick *s, uint32_t offset) {
    advance(s);
    schedule(s);
    uint32_t value = 0;
    switch (offset) {
    case 0x0:
        value = s->control | (s->count_flag ? CONTROL_COUNTED : 0U);
        s->count_flag = false;
        break;
    case 0x4:
        value = s->load;
        break;
    case 0x8:
        value = s->start;
        break;
    case 0xC:
        value = 18750; // RM0090, 12.1.2: the calibration value of this chip
        break;
    default:
        break;
    }
    return value;
}

void systick_write(struct systick *s, uint32_t offset, uint32_t value) {
    advance(s);
    switch (offset) {
    case 0x0:
        s->control = value & (CONTROL_ENABLE | CONTROL_TICKINT | CONTROL_HCLK);
        s->start_cycle = s->soc->cycle;
        break;
    case 0x4:
        s->load = value & VALUE_MASK;
        break;
    case 0x8:
        s->start = 0;
        s->count_flag = false;
        s->start_cycle = s->soc->cycle;
        break;
    default:
        break;
    }
    schedule(s);
}
