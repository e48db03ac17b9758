#include "mcu/timer.h"

#include "mcu/soc.h"

#define CR1_CEN     (UINT32_C(1) << 0)
#define CR1_UDIS    (UINT32_C(1) << 1)
#define CR1_URS     (UINT32_C(1) << 2)
#define CR1_OPM     (UINT32_C(1) << 3)
#define CR1_DIR     (UINT32_C(1) << 4)
#define CR1_CMS     (UINT32_C(3) << 5)
#define CR1_ARPE    (UINT32_C(1) << 7)
#define CR1_BITS    0x3FFU
#define FLAG_UPDATE 1U
#define DIER_DMA    0x7F00U
#define EGR_UG      1U
#define BDTR_MOE    (UINT32_C(1) << 15)
#define OC_PRELOAD  8U
#define OC_PWM1     6U
#define OC_PWM2     7U

static bool is_wide(const struct timer *t) {
    return t->index == 1U || t->index == 4U; // TIM2, TIM5
}

static bool is_advanced(const struct timer *t) {
    return t->index == 0U;
}

static uint32_t count_mask(const struct timer *t) {
    return is_wide(t) ? UINT32_MAX : 0xFFFFU;
}

/// The mode bits of a channel in CCMR: CCxS, OCxFE, OCxPE, OCxM, OCxCE.
static uint32_t channel_mode(const struct timer *t, unsigned channel) {
    return t->ccmr[channel / 2U] >> (8U * (channel % 2U)) & 0xFFU;
}

static bool is_preloaded(const struct timer *t, unsigned channel) {
    return (channel_mode(t, channel) & OC_PRELOAD) != 0U;
}

static uint64_t cycles_per_count(const struct timer *t) {
    return (uint64_t)t->divider * ((uint64_t)t->active_psc + 1U);
}

// ---------------------------------------------------------------- interrupts

static void update_interrupts(const struct timer *t) {
    static const uint8_t irq_of[TIMER_COUNT] = {25, 28, 29, 30, 50};
    struct nvic *nvic = &t->soc->nvic;
    const uint32_t wanted = t->sr & t->dier & 0xFFU;
    if (!is_advanced(t)) {
        nvic_set_line(nvic, irq_of[t->index], wanted != 0U);
        return;
    }
    nvic_set_line(nvic, 25, (wanted & FLAG_UPDATE) != 0U);
    nvic_set_line(nvic, 27, (wanted & 0x1EU) != 0U); // compare
    nvic_set_line(nvic, 26, (wanted & 0x60U) != 0U); // trigger and commutation
    nvic_set_line(nvic, 24, (wanted & 0x80U) != 0U); // break
}

// ---------------------------------------------------------------- counting

/// Preloaded values take effect.
static void load_shadows(struct timer *t) {
    t->active_psc = t->psc;
    t->active_arr = t->arr;
    t->repetitions = t->rcr;
    for (unsigned i = 0; i < TIMER_CHANNELS; i++) {
        t->active_ccr[i] = t->ccr[i];
    }
}

/// An overflow: every RCR + 1 of them is an update.
static void overflow(struct timer *t) {
    if (is_advanced(t) && t->repetitions != 0U) {
        t->repetitions--;
        return;
    }
    if ((t->cr1 & CR1_UDIS) != 0U) {
        return;
    }
    load_shadows(t);
    t->sr |= FLAG_UPDATE;
    if ((t->cr1 & CR1_OPM) != 0U) {
        t->cr1 &= ~CR1_CEN;
    }
}

/// Compare flags of the counts in (from, to], without an overflow between.
static void flag_matches(struct timer *t, uint64_t from, uint64_t to) {
    for (unsigned i = 0; i < TIMER_CHANNELS; i++) {
        if (t->active_ccr[i] > from && t->active_ccr[i] <= to) {
            t->sr |= 2U << i;
        }
    }
}

/// After an overflow the counter is at 0, which is a match, too.
static void flag_matches_at_zero(struct timer *t) {
    for (unsigned i = 0; i < TIMER_CHANNELS; i++) {
        if (t->active_ccr[i] == 0U) {
            t->sr |= 2U << i;
        }
    }
}

static bool is_counting(const struct timer *t) {
    return (t->cr1 & CR1_CEN) != 0U && t->active_arr != 0U;
}

/// Counts from now to the next overflow. A counter beyond its reload value runs through to the end.
static uint64_t counts_to_overflow(const struct timer *t) {
    const uint64_t last = t->count <= t->active_arr ? t->active_arr : count_mask(t);
    return last - t->count + 1U;
}

/// Are all further overflows alike, so that many can be taken in one step?
static bool is_settled(const struct timer *t) {
    bool settled = t->active_psc == t->psc && t->active_arr == t->arr && t->repetitions == 0U &&
                   t->rcr == 0U && (t->cr1 & CR1_OPM) == 0U;
    for (unsigned i = 0; settled && i < TIMER_CHANNELS; i++) {
        settled = t->active_ccr[i] == t->ccr[i];
    }
    return settled;
}

/// Moves the counter to now.
static void advance(struct timer *t) {
    while (is_counting(t)) {
        const uint64_t step = cycles_per_count(t);
        const uint64_t counts = (t->soc->cycle - t->since) / step;
        const uint64_t left = counts_to_overflow(t);
        if (counts < left) {
            flag_matches(t, t->count, t->count + counts);
            t->count += (uint32_t)counts;
            t->since += counts * step;
            return;
        }
        flag_matches(t, t->count, t->count + left - 1U);
        t->count = 0;
        t->since += left * step;
        overflow(t);
        flag_matches_at_zero(t);
        const uint64_t period = (uint64_t)t->active_arr + 1U;
        if (is_settled(t) && counts - left >= 2U * period) {
            // A whole period shows every match; the rest of them change nothing more.
            flag_matches(t, 0, t->active_arr);
            t->since += ((counts - left) / period - 1U) * period * step;
        }
    }
    t->since = t->soc->cycle;
}

/// Cycle of the next count that somebody waits for.
static uint64_t next_event(const struct timer *t) {
    if (!is_counting(t)) {
        return SOC_NEVER;
    }
    const bool update_matters = (t->dier & FLAG_UPDATE) != 0U || (t->cr1 & CR1_OPM) != 0U;
    uint64_t counts = update_matters ? counts_to_overflow(t) : UINT64_MAX;
    for (unsigned i = 0; i < TIMER_CHANNELS; i++) {
        if ((t->dier & (2U << i)) != 0U) {
            const uint64_t ccr = t->active_ccr[i];
            const uint64_t to = ccr > t->count ? ccr - t->count : counts_to_overflow(t) + ccr;
            counts = to < counts ? to : counts;
        }
    }
    return counts == UINT64_MAX ? SOC_NEVER : t->since + counts * cycles_per_count(t);
}

static void settle(struct timer *t) {
    update_interrupts(t);
    soc_schedule(t->soc, (enum soc_part)(SOC_TIM1 + t->index), next_event(t));
}

void timer_due(struct timer *t) {
    advance(t);
    settle(t);
}

void timer_hold(struct timer *t) {
    advance(t);
}

void timer_clock_changed(struct timer *t) {
    t->divider = rcc_timer_divider(&t->soc->rcc, is_advanced(t) ? RCC_APB2 : RCC_APB1);
    settle(t);
}

void timer_reset(struct timer *t, struct soc *soc, unsigned index) {
    *t = (struct timer){.soc = soc, .index = (uint8_t)index, .divider = 1, .since = soc->cycle};
    t->arr = t->active_arr = count_mask(t);
    timer_clock_changed(t);
}

// ---------------------------------------------------------------- pulses

struct timer_pulse timer_pulse_of(struct timer *t, unsigned channel) {
    const struct timer_pulse still = {0, 0};
    advance(t);
    settle(t);
    const bool enabled = (t->ccer >> (4U * channel) & 1U) != 0U;
    const bool inverted = (t->ccer >> (4U * channel) & 2U) != 0U;
    const uint32_t mode = channel_mode(t, channel) >> 4 & 7U;
    if (!is_counting(t) || !enabled || (is_advanced(t) && (t->bdtr & BDTR_MOE) == 0U) ||
        (mode != OC_PWM1 && mode != OC_PWM2)) {
        return still;
    }
    const uint64_t period = (uint64_t)t->active_arr + 1U;
    const uint64_t ccr = t->active_ccr[channel] < period ? t->active_ccr[channel] : period;
    const bool active_first = mode == OC_PWM1;
    const uint64_t high = active_first != inverted ? ccr : period - ccr;
    if (high == 0U || high == period) {
        return still;
    }
    return (struct timer_pulse){high * cycles_per_count(t), period * cycles_per_count(t)};
}

// ---------------------------------------------------------------- registers

static uint32_t *plain_register(struct timer *t, uint32_t offset) {
    switch (offset) {
    case 0x00:
        return &t->cr1;
    case 0x04:
        return &t->cr2;
    case 0x08:
        return &t->smcr;
    case 0x0C:
        return &t->dier;
    case 0x10:
        return &t->sr;
    case 0x18:
        return &t->ccmr[0];
    case 0x1C:
        return &t->ccmr[1];
    case 0x20:
        return &t->ccer;
    case 0x24:
        return &t->count;
    case 0x28:
        return &t->psc;
    case 0x2C:
        return &t->arr;
    case 0x30:
        return is_advanced(t) ? &t->rcr : NULL;
    case 0x34:
    case 0x38:
    case 0x3C:
    case 0x40:
        return &t->ccr[(offset - 0x34U) / 4U];
    case 0x44:
        return is_advanced(t) ? &t->bdtr : NULL;
    case 0x48:
        return &t->dcr;
    default:
        return NULL;
    }
}

/// Bits of a register that can be written.
static uint32_t writable(const struct timer *t, uint32_t offset) {
    switch (offset) {
    case 0x00:
        return CR1_BITS;
    case 0x04:
        return is_advanced(t) ? 0x7FFDU : 0xF8U;
    case 0x08:
        return 0xFFF7U;
    case 0x0C:
        return is_advanced(t) ? 0x7FFFU : 0x5F5FU;
    case 0x20:
        return is_advanced(t) ? 0x3FFFU : 0xBBBBU;
    case 0x24:
    case 0x2C:
    case 0x34:
    case 0x38:
    case 0x3C:
    case 0x40:
        return count_mask(t);
    case 0x30:
        return 0xFFU;
    case 0x48:
        return 0x1F1FU;
    default:
        return 0xFFFFU;
    }
}

uint32_t timer_read(void *model, uint32_t offset) {
    struct timer *t = model;
    advance(t);
    settle(t);
    const uint32_t *reg = plain_register(t, offset);
    return reg != NULL ? *reg : 0U;
}

static void complain_of_modes(struct timer *t) {
    bool captures = false;
    for (unsigned i = 0; i < TIMER_CHANNELS; i++) {
        captures = captures || (channel_mode(t, i) & 3U) != 0U;
    }
    if ((t->cr1 & (CR1_DIR | CR1_CMS)) != 0U || (t->smcr & 7U) != 0U || captures ||
        (t->dier & DIER_DMA) != 0U || (t->bdtr & 0x1000U) != 0U) {
        soc_complain(t->soc,
                     "TIM%u: counting down, capture, slave mode, DMA and break have no model",
                     t->index + 1U);
    }
}

/// UG: an update by software. The counter and the prescaler start anew even if updates are off.
static void generate(struct timer *t, uint32_t value) {
    t->sr |= value & 0x1EU;
    if ((value & EGR_UG) == 0U) {
        return;
    }
    t->count = 0;
    t->since = t->soc->cycle;
    if ((t->cr1 & CR1_UDIS) == 0U) {
        load_shadows(t);
        t->sr |= (t->cr1 & CR1_URS) == 0U ? FLAG_UPDATE : 0U;
    }
}

/// Values without preload count at once.
static void take_unbuffered(struct timer *t) {
    if ((t->cr1 & CR1_ARPE) == 0U) {
        t->active_arr = t->arr;
    }
    for (unsigned i = 0; i < TIMER_CHANNELS; i++) {
        if (!is_preloaded(t, i)) {
            t->active_ccr[i] = t->ccr[i];
        }
    }
}

void timer_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct timer *t = model;
    (void)lanes;
    advance(t);
    if (offset == 0x10U) {
        t->sr &= value; // a flag is cleared by writing 0
    } else if (offset == 0x14U) {
        generate(t, value);
    } else {
        uint32_t *reg = plain_register(t, offset);
        if (reg != NULL) {
            *reg = value & writable(t, offset);
        }
        take_unbuffered(t);
        complain_of_modes(t);
    }
    settle(t);
}
