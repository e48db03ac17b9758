/// A fault in the handler of a hard fault: the processor locks up, and only the watchdog gets it
/// out.
#include "guest.h"

void hard_fault_handler(void) {
    print("hard fault\n");
    __asm volatile("udf #2");
}

void guest_main(void) {
    if ((RCC_CSR & UINT32_C(1) << 29) != 0U) {
        print("reset by the watchdog\n");
        return;
    }
    print("started\n");
    IWDG_KR = 0xCCCC; // 4 * 4096 / 32 kHz: 512 ms
    __asm volatile("udf #1");
}
