#include "mcu/nvic.h"

#include <stddef.h>
#include <string.h>

#define PRIORITY_BITS 0xF0U

static void set_bit(uint32_t *bits, unsigned exception, bool value) {
    const uint32_t bit = UINT32_C(1) << (exception % 32U);
    bits[exception / 32U] = value ? bits[exception / 32U] | bit : bits[exception / 32U] & ~bit;
}

int nvic_priority_of(const struct nvic *nvic, unsigned exception) {
    if (exception <= NVIC_HARD_FAULT) {
        return (int)exception - 4;
    }
    return nvic->priority[exception];
}

/// The part of a priority that decides whether it preempts.
static int group_of(const struct nvic *nvic, int priority) {
    return priority < 0 ? priority : (int)((unsigned)priority & nvic->group_mask);
}

/// After any change: who goes next, and does it matter?
static void update(struct nvic *nvic) {
    unsigned best = 0;
    int best_priority = NVIC_PRIORITY_THREAD;
    nvic->active_group = NVIC_PRIORITY_THREAD;
    for (unsigned word = 0; word < NVIC_WORDS; word++) {
        for (uint32_t left = nvic->active[word]; left != 0U; left &= left - 1U) {
            const unsigned exception = 32U * word + (unsigned)__builtin_ctz(left);
            const int group = group_of(nvic, nvic_priority_of(nvic, exception));
            nvic->active_group = group < nvic->active_group ? group : nvic->active_group;
        }
        for (uint32_t left = nvic->pending[word] & nvic->enabled[word]; left != 0U;
             left &= left - 1U) {
            const unsigned exception = 32U * word + (unsigned)__builtin_ctz(left);
            const int priority = nvic_priority_of(nvic, exception);
            if (priority < best_priority) {
                best = exception;
                best_priority = priority;
            }
        }
    }
    nvic->candidate = best;
    nvic->candidate_group = best != 0U ? group_of(nvic, best_priority) : NVIC_PRIORITY_THREAD;
    nvic->attention = nvic->candidate_group < nvic->active_group;
    if (nvic->attention && nvic->attend_cycle != NULL) {
        *nvic->attend_cycle = 0;
    }
}

void nvic_reset(struct nvic *nvic, uint64_t *attend_cycle) {
    uint32_t held[NVIC_WORDS];
    memcpy(held, nvic->held, sizeof held);
    memset(nvic, 0, sizeof *nvic);
    memcpy(nvic->held, held, sizeof held);
    memcpy(nvic->line, held, sizeof held);
    memcpy(nvic->pending, held, sizeof held);
    nvic->attend_cycle = attend_cycle;
    // System exceptions can't be disabled, but for the three faults, which SHCSR enables.
    nvic->enabled[0] = UINT32_C(1) << NVIC_NMI | UINT32_C(1) << NVIC_HARD_FAULT |
                       UINT32_C(1) << NVIC_SVCALL | UINT32_C(1) << NVIC_PENDSV |
                       UINT32_C(1) << NVIC_SYSTICK;
    nvic_set_grouping(nvic, 0);
}

static void make_pending(struct nvic *nvic, unsigned exception) {
    if (!nvic_test(nvic->pending, exception)) {
        set_bit(nvic->pending, exception, true);
        nvic->event = nvic->event || nvic->set_event_on_pending;
    }
}

void nvic_set_line(struct nvic *nvic, unsigned irq, bool high) {
    const unsigned exception = NVIC_IRQ0 + irq;
    high = high || nvic_test(nvic->held, exception);
    if (nvic_test(nvic->line, exception) == high) {
        return;
    }
    set_bit(nvic->line, exception, high);
    if (high) {
        make_pending(nvic, exception);
        update(nvic);
    }
}

void nvic_hold_line(struct nvic *nvic, unsigned irq, bool held) {
    set_bit(nvic->held, NVIC_IRQ0 + irq, held);
    nvic_set_line(nvic, irq, held); // a part that is still high says so with its next change
}

void nvic_set_pending(struct nvic *nvic, unsigned exception, bool pending) {
    if (pending) {
        make_pending(nvic, exception);
    } else if (!nvic_test(nvic->line, exception) || nvic_test(nvic->active, exception)) {
        set_bit(nvic->pending, exception, false); // a line that is high keeps it pending
    }
    update(nvic);
}

void nvic_enable(struct nvic *nvic, unsigned exception, bool enabled) {
    set_bit(nvic->enabled, exception, enabled);
    update(nvic);
}

void nvic_set_priority(struct nvic *nvic, unsigned exception, uint8_t priority) {
    nvic->priority[exception] = priority & PRIORITY_BITS;
    update(nvic);
}

void nvic_set_grouping(struct nvic *nvic, unsigned prigroup) {
    // PRIGROUP n: bits 7 to n+1 are the group.
    nvic->group_mask = (uint8_t)(0xFFU << (prigroup + 1U));
    update(nvic);
}

int nvic_running_priority(const struct nvic *nvic, const struct nvic_masks *masks) {
    int running = nvic->active_group;
    if (masks->basepri != 0U) {
        const int base = group_of(nvic, masks->basepri);
        running = base < running ? base : running;
    }
    if (masks->primask && running > 0) {
        running = 0;
    }
    if (masks->faultmask && running > -1) {
        running = -1;
    }
    return running;
}

unsigned nvic_preempts(const struct nvic *nvic, const struct nvic_masks *masks) {
    if (!nvic->attention) {
        return 0;
    }
    return nvic->candidate_group < nvic_running_priority(nvic, masks) ? nvic->candidate : 0U;
}

bool nvic_wakes(const struct nvic *nvic, const struct nvic_masks *masks) {
    struct nvic_masks without = *masks;
    without.primask = false;
    return nvic_preempts(nvic, &without) != 0U;
}

bool nvic_can_take(const struct nvic *nvic, unsigned exception, const struct nvic_masks *masks) {
    return nvic_test(nvic->enabled, exception) &&
           group_of(nvic, nvic_priority_of(nvic, exception)) < nvic_running_priority(nvic, masks);
}

void nvic_activate(struct nvic *nvic, unsigned exception) {
    set_bit(nvic->pending, exception, false);
    set_bit(nvic->active, exception, true);
    update(nvic);
}

void nvic_deactivate(struct nvic *nvic, unsigned exception) {
    set_bit(nvic->active, exception, false);
    if (nvic_test(nvic->line, exception)) {
        make_pending(nvic, exception);
    }
    update(nvic);
}

unsigned nvic_active_count(const struct nvic *nvic) {
    unsigned count = 0;
    for (unsigned word = 0; word < NVIC_WORDS; word++) {
        count += (unsigned)__builtin_popcount(nvic->active[word]);
    }
    return count;
}

// ---------------------------------------------------------------- registers

#define ISER           0xE000E100U
#define ICER           0xE000E180U
#define ISPR           0xE000E200U
#define ICPR           0xE000E280U
#define IABR           0xE000E300U
#define IPR            0xE000E400U
#define STIR           0xE000EF00U
#define REGISTER_BYTES 0x80U

/// The 32 interrupts from 32 * word on, out of bits by exception number.
static uint32_t word_of_irqs(const uint32_t *bits, unsigned word) {
    uint32_t value = 0;
    for (unsigned i = 0; i < 32U; i++) {
        const unsigned irq = 32U * word + i;
        if (irq < NVIC_IRQS && nvic_test(bits, NVIC_IRQ0 + irq)) {
            value |= UINT32_C(1) << i;
        }
    }
    return value;
}

uint32_t nvic_read(const struct nvic *nvic, uint32_t address) {
    const unsigned word = (address % REGISTER_BYTES) / 4U;
    switch (address & ~(REGISTER_BYTES - 1U)) {
    case ISER:
    case ICER:
        return word_of_irqs(nvic->enabled, word);
    case ISPR:
    case ICPR:
        return word_of_irqs(nvic->pending, word);
    case IABR:
        return word_of_irqs(nvic->active, word);
    default:
        break;
    }
    uint32_t value = 0;
    for (unsigned i = 0; address >= IPR && address < IPR + NVIC_IRQS && i < 4U; i++) {
        const unsigned irq = address - IPR + i;
        if (irq < NVIC_IRQS) {
            value |= (uint32_t)nvic->priority[NVIC_IRQ0 + irq] << (8U * i);
        }
    }
    return value;
}

/// Calls set for each interrupt whose bit is 1.
static void for_each_irq(struct nvic *nvic, unsigned word, uint32_t value, bool to,
                         void (*set)(struct nvic *, unsigned, bool)) {
    for (; value != 0U; value &= value - 1U) {
        const unsigned irq = 32U * word + (unsigned)__builtin_ctz(value);
        if (irq < NVIC_IRQS) {
            set(nvic, NVIC_IRQ0 + irq, to);
        }
    }
}

void nvic_write(struct nvic *nvic, uint32_t address, uint32_t value, uint32_t lanes) {
    const unsigned word = (address % REGISTER_BYTES) / 4U;
    const uint32_t ones = value & lanes;
    switch (address & ~(REGISTER_BYTES - 1U)) {
    case ISER:
        for_each_irq(nvic, word, ones, true, nvic_enable);
        return;
    case ICER:
        for_each_irq(nvic, word, ones, false, nvic_enable);
        return;
    case ISPR:
        for_each_irq(nvic, word, ones, true, nvic_set_pending);
        return;
    case ICPR:
        for_each_irq(nvic, word, ones, false, nvic_set_pending);
        return;
    default:
        break;
    }
    if (address == STIR && (value & 0x1FFU) < NVIC_IRQS) {
        nvic_set_pending(nvic, NVIC_IRQ0 + (value & 0x1FFU), true);
    }
    for (unsigned i = 0; address >= IPR && address < IPR + NVIC_IRQS && i < 4U; i++) {
        const unsigned irq = address - IPR + i;
        if (irq < NVIC_IRQS && (lanes >> (8U * i) & 0xFFU) != 0U) {
            nvic_set_priority(nvic, NVIC_IRQ0 + irq, (uint8_t)(value >> (8U * i)));
        }
    }
}
