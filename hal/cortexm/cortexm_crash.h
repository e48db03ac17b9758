/// What to do when the processor meets a fault or an interrupt that nobody asked for: note it in
/// memory that survives the reset, and reset. The next start tells.
/// Shown: tests/mcu/cpu/faults.c.
#ifndef CORTEXM_CORTEXM_CRASH_H
#define CORTEXM_CORTEXM_CRASH_H

#include <stdbool.h>
#include <stdint.h>

struct cortexm_crash {
    uint32_t exception; ///< 2 non-maskable, 3 hard fault, 16 and more: an interrupt
    uint32_t pc, lr;    ///< where it happened; 0 if the stack was broken
};

/// The handler for every vector that has no other.
void cortexm_crash_handler(void);

/// Whether the last run ended in a crash; said once after each.
bool cortexm_crash_take(struct cortexm_crash *crash);

/// "non-maskable interrupt", "hard fault", "unexpected interrupt".
const char *cortexm_crash_name(uint32_t exception);

#endif
