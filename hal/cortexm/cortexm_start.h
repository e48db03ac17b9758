/// What a board's vector table needs besides the handlers of its drivers.
///
/// The table is the board's: `const vectors[]` in section `.vectors`, first word stack_top, second
/// reset_handler, every other one a handler or cortexm_crash_handler.
/// Shown: tests/gate/boot.sh.
#ifndef CORTEXM_CORTEXM_START_H
#define CORTEXM_CORTEXM_START_H

/// End of the stack's memory, from the linker script.
extern char stack_top[];

/// Sets up the memory and calls main.
__attribute__((noreturn)) void reset_handler(void);

/// The board's. Called with interrupts enabled.
__attribute__((noreturn)) int main(void);

#endif
