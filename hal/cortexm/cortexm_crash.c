#include "cortexm/cortexm_crash.h"

#include "cortexm/cortexm.h"

#define MAGIC 0xC4A54ED0U ///< plus the exception, so that a half-written record doesn't count

extern uint32_t stack_bottom[], stack_top[];

static struct {
    struct cortexm_crash crash;
    uint32_t seal;
} record __attribute__((section(".noinit")));

/// Called by the assembly below only.
__attribute__((noreturn)) void cortexm_crash_save(const uint32_t *frame);

void cortexm_crash_save(const uint32_t *frame) {
    uint32_t exception;
    __asm volatile("mrs %0, ipsr" : "=r"(exception));
    record.crash = (struct cortexm_crash){.exception = exception};
    // The frame has r0 to r3, r12, lr, pc, xpsr (DDI 0403 B1.5.6). It may lie outside the memory.
    if (frame >= stack_bottom && frame + 8 <= stack_top) {
        record.crash.lr = frame[5];
        record.crash.pc = frame[6];
    }
    record.seal = MAGIC + exception;
    cortexm_reset();
}

/// The stack may be what broke, so this starts it anew.
__attribute__((naked)) void cortexm_crash_handler(void) {
    __asm volatile("mrs r0, msp\n"
                   "ldr r1, =stack_top\n"
                   "msr msp, r1\n"
                   "bl cortexm_crash_save");
}

bool cortexm_crash_take(struct cortexm_crash *crash) {
    const bool there = record.seal == MAGIC + record.crash.exception;
    if (there) {
        *crash = record.crash;
    }
    record.seal = 0;
    return there;
}

const char *cortexm_crash_name(uint32_t exception) {
    return exception == 2U   ? "non-maskable interrupt"
           : exception <= 6U ? "hard fault"
                             : "unexpected interrupt";
}
