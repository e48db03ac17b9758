/// Requests to the emulator or debugger that the processor runs under: text and the exit status.
///
/// Only for images that never leave an emulator: without a debugger the instruction behind these
/// calls is a hard fault. Source: Arm, "Semihosting for AArch32 and AArch64", 2.0.
#ifndef BOARDS_MPS2_SEMIHOST_H
#define BOARDS_MPS2_SEMIHOST_H

#include <stddef.h>
#include <stdint.h>

/// Appends to the emulator's standard output. Kept until the line is complete, because each request
/// costs as much as thousands of instructions.
void semihost_write(const char *text, size_t size);

/// Writes out what is kept and ends the emulator with this exit status.
_Noreturn void semihost_exit(uint32_t status);

#endif
