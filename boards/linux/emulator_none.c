#include "emulator.h"

// boresight-mcu has a definition of its own, and the linker then leaves this file out.
const struct emulator *const emulator = NULL;
