/// Which exception runs next: the nested vectored interrupt controller.
///
/// Source: ARMv7-M Architecture Reference Manual (DDI 0403E), B1.5 and B3.4; RM0090, table 61
/// (vector table) and PM0214, 4.3: 82 interrupts, 16 priorities in the upper four bits.
/// An exception is pending, active, both or neither. The pending one with the lowest priority
/// number (then the lowest exception number) is taken if its group priority is below the running
/// priority. Interrupt lines of the STM32's parts are levels: a line that is still high when its
/// handler returns makes the interrupt pending again. Left out: unprivileged access (everything is
/// privileged). Shown: tests/mcu/nvic.c; with a processor tests/mcu/cpu/exceptions.c.
#ifndef MCU_NVIC_H
#define MCU_NVIC_H

#include <stdbool.h>
#include <stdint.h>

enum {
    NVIC_RESET = 1,
    NVIC_NMI = 2,
    NVIC_HARD_FAULT = 3,
    NVIC_MEM_MANAGE = 4,
    NVIC_BUS_FAULT = 5,
    NVIC_USAGE_FAULT = 6,
    NVIC_SVCALL = 11,
    NVIC_DEBUG_MONITOR = 12,
    NVIC_PENDSV = 14,
    NVIC_SYSTICK = 15,
    NVIC_IRQ0 = 16,
    NVIC_IRQS = 82,
    NVIC_EXCEPTIONS = NVIC_IRQ0 + NVIC_IRQS,
    NVIC_WORDS = (NVIC_EXCEPTIONS + 31) / 32,
};

/// The running priority of a processor that runs no exception.
#define NVIC_PRIORITY_THREAD 256

/// The processor's special registers that hold exceptions back.
struct nvic_masks {
    bool primask, faultmask;
    uint8_t basepri;
};

struct nvic {
    /// A bit for each exception, by its number.
    uint32_t pending[NVIC_WORDS], enabled[NVIC_WORDS], active[NVIC_WORDS], line[NVIC_WORDS];
    uint32_t held[NVIC_WORDS]; ///< lines that a fault outside keeps high; survives a reset
    uint8_t priority[NVIC_EXCEPTIONS];
    uint8_t group_mask; ///< which bits of a priority decide whether it preempts

    // Kept up to date by every change.
    uint32_t candidate;        ///< pending and enabled, goes first; 0: none
    int candidate_group;       ///< its group priority
    int active_group;          ///< the lowest of the active exceptions, or NVIC_PRIORITY_THREAD
    bool attention;            ///< the candidate would preempt if no mask held it back
    uint64_t *attend_cycle;    ///< of the soc: set to 0 when attention is wanted
    bool set_event_on_pending; ///< SCR.SEVONPEND
    bool event;                ///< something became pending: wakes from WFE with SEVONPEND
};

/// attend_cycle: set to 0 whenever the processor should look; NULL: nobody cares.
void nvic_reset(struct nvic *nvic, uint64_t *attend_cycle);

/// A part's interrupt line.
void nvic_set_line(struct nvic *nvic, unsigned irq, bool high);

/// A fault: the line is high from now on, whatever its part says.
void nvic_hold_line(struct nvic *nvic, unsigned irq, bool held);

/// By software, or an edge.
void nvic_set_pending(struct nvic *nvic, unsigned exception, bool pending);
void nvic_enable(struct nvic *nvic, unsigned exception, bool enabled);
void nvic_set_priority(struct nvic *nvic, unsigned exception, uint8_t priority);
/// AIRCR.PRIGROUP, 0 to 7.
void nvic_set_grouping(struct nvic *nvic, unsigned prigroup);

/// Reset, NMI and hard fault have -3, -2 and -1; others 0 to 255.
int nvic_priority_of(const struct nvic *nvic, unsigned exception);

/// The priority that the processor runs at, masks included.
int nvic_running_priority(const struct nvic *nvic, const struct nvic_masks *masks);

/// The exception to take now; 0: none.
unsigned nvic_preempts(const struct nvic *nvic, const struct nvic_masks *masks);

/// Whether the processor would wake from WFI: as above, but PRIMASK does not count.
bool nvic_wakes(const struct nvic *nvic, const struct nvic_masks *masks);

/// May an exception that an instruction caused be taken now?
bool nvic_can_take(const struct nvic *nvic, unsigned exception, const struct nvic_masks *masks);

void nvic_activate(struct nvic *nvic, unsigned exception);
void nvic_deactivate(struct nvic *nvic, unsigned exception);
unsigned nvic_active_count(const struct nvic *nvic);

static inline bool nvic_test(const uint32_t *bits, unsigned exception) {
    return (bits[exception / 32U] >> (exception % 32U) & 1U) != 0U;
}

/// Registers at 0xE000E100 to 0xE000E4FF and STIR. lanes: which bits the access writes.
uint32_t nvic_read(const struct nvic *nvic, uint32_t address);
void nvic_write(struct nvic *nvic, uint32_t address, uint32_t value, uint32_t lanes);

#endif
