/// From reset to main: the first instructions of every image.
#include "cortexm/cortexm.h"

#include "cortexm/cortexm_start.h"

#include <stddef.h>

/// Places that the linker script names (boards/sections.ld).
extern uint32_t data_start[], data_end[], bss_start[], bss_end[];
extern const uint32_t data_image[];
extern void (*const vectors[])(void);

void reset_handler(void) {
    // A debugger or boot loader may have left the table elsewhere.
    CORTEXM_SCB->vtor = (uint32_t)(uintptr_t)vectors;
    for (size_t i = 0; &data_start[i] != data_end; i++) {
        data_start[i] = data_image[i];
    }
    for (uint32_t *word = bss_start; word != bss_end; word++) {
        *word = 0;
    }
    cortexm_interrupts_enable();
    main();
}
