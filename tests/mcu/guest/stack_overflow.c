/// A stack that runs out of memory: no frame can be stored any more.
#include "guest.h"

void guest_main(void) {
    print("started\n");
    __asm volatile("ldr sp, =0x20000010\n\tsvc 0");
}
