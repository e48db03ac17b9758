#include "cortexm/cortexm_crash.h"
#include "cortexm/cortexm_start.h"
extern void (*const vectors[])(void);
__attribute__((section(".vectors"), used)) void (*const vectors[98])(void) = {
    (void (*)(void))stack_top, reset_handler, cortexm_crash_handler};
