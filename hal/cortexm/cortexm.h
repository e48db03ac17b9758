/// The parts of a Cortex-M core that images need: system timer, interrupt controller, reset.
///
/// Facts from the ARMv7-M (DDI 0403) and ARMv6-M (DDI 0419) reference manuals; all of it is the
/// same on both. The interrupt controller's priority registers are used by words, because a
/// Cortex-M0+ has no narrower access.
/// Shown: tests/mcu/hal/suites.c; start and reset: tests/gate/boot.sh.
#ifndef CORTEXM_CORTEXM_H
#define CORTEXM_CORTEXM_H

#include <stdbool.h>
#include <stdint.h>

/// B3.3 SysTick: counts down from reload to 0, again and again.
struct cortexm_systick {
    volatile uint32_t control, reload, value, calibration;
};
#define CORTEXM_SYSTICK ((struct cortexm_systick *)0xE000E010U)
enum {
    CORTEXM_SYSTICK_ENABLE = 1 << 0,
    CORTEXM_SYSTICK_INTERRUPT = 1 << 1,
    CORTEXM_SYSTICK_CORE_CLOCK = 1 << 2
};

/// B3.2.2 System control block.
struct cortexm_scb {
    volatile uint32_t cpuid, icsr, vtor, aircr, scr, ccr, shpr[3];
};
#define CORTEXM_SCB               ((struct cortexm_scb *)0xE000ED00U)
#define CORTEXM_ICSR_PENDSTSET    (1U << 26)
#define CORTEXM_AIRCR_SYSRESETREQ 0x05FA0004U ///< with the key that a write needs

/// B3.4 Interrupt controller.
#define CORTEXM_NVIC_ISER ((volatile uint32_t *)0xE000E100U)
#define CORTEXM_NVIC_ISPR ((volatile uint32_t *)0xE000E200U)
#define CORTEXM_NVIC_IPR  ((volatile uint32_t *)0xE000E400U)

/// Two levels are enough: the tick, which keeps the time, interrupts the devices' handlers, and
/// these interrupt only the program. Both values exist on cores with two priority bits.
enum { CORTEXM_PRIORITY_TICK = 0x00, CORTEXM_PRIORITY_DEVICE = 0x40 };

static inline void cortexm_interrupts_disable(void) {
    __asm volatile("cpsid i" ::: "memory");
}
static inline void cortexm_interrupts_enable(void) {
    __asm volatile("cpsie i" ::: "memory");
}
/// Sleeps until an interrupt is pending, whether or not it is let through.
static inline void cortexm_wait_for_interrupt(void) {
    __asm volatile("wfi" ::: "memory");
}
/// Keeps the compiler from moving memory accesses across: what is needed between the program and
/// the interrupt handlers of one core.
static inline void cortexm_barrier(void) {
    __asm volatile("" ::: "memory");
}

static inline void cortexm_irq_set_priority(unsigned irq, unsigned priority) {
    const unsigned shift = irq % 4U * 8U;
    volatile uint32_t *word = &CORTEXM_NVIC_IPR[irq / 4U];
    *word = (*word & ~(0xFFU << shift)) | (uint32_t)priority << shift;
}
static inline void cortexm_irq_enable(unsigned irq) {
    CORTEXM_NVIC_ISER[irq / 32U] = 1U << irq % 32U;
}
/// Calls an interrupt's handler as soon as priorities allow: how the program has a driver's handler
/// look at its queue. So all work on the hardware is done in one place, and nothing needs a lock.
static inline void cortexm_irq_pend(unsigned irq) {
    cortexm_barrier();
    CORTEXM_NVIC_ISPR[irq / 32U] = 1U << irq % 32U;
    __asm volatile("dsb" ::: "memory");
}

/// Resets core and peripherals. Does not return.
__attribute__((noreturn)) static inline void cortexm_reset(void) {
    __asm volatile("dsb" ::: "memory");
    CORTEXM_SCB->aircr = CORTEXM_AIRCR_SYSRESETREQ;
    for (;;) {
        __asm volatile("dsb" ::: "memory");
    }
}

/// Waits until the bits of mask have the value, for at most so many reads of the register: about
/// ten processor cycles each. No ready bit is waited for without a bound. Returns whether they did.
static inline bool cortexm_wait_bits(const volatile uint32_t *reg, uint32_t mask, uint32_t value,
                                     uint32_t reads) {
    while ((*reg & mask) != value) {
        if (reads-- == 0U) {
            return false;
        }
    }
    return true;
}

#endif
