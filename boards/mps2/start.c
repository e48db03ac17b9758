/// From reset to main() and out again, for test images under QEMU (mps2-an385, -an386, -an500).
///
/// What main() returns is the emulator's exit status. A fault says where it was; then the status is
/// MPS2_FAULT_STATUS.
#include "semihost.h"

#include "cortexm/cortexm.h"

#define MPS2_FAULT_STATUS 3U

/// Places that the linker script names (boards/sections.ld).
extern uint32_t data_start[], data_end[], bss_start[], bss_end[];
extern const uint32_t data_image[];
extern uint32_t stack_bottom[], stack_top[];

int main(void);
void reset_handler(void);
void mps2_fault_handler(void);
void mps2_fault_report(const uint32_t *frame);
extern void (*const vectors[])(void);

/// The emulator ignores writes where there is no memory, so the memory protection unit has to
/// notice a stack that overflows: ARMv7-M reference manual (DDI 0403), B3.5.
struct memory_protection {
    volatile uint32_t type, control, region, base, attributes;
};
#define MEMORY_PROTECTION ((struct memory_protection *)0xE000ED90U)

static void guard_stack(void) {
    MEMORY_PROTECTION->region = 0;
    MEMORY_PROTECTION->base = (uint32_t)(uintptr_t)stack_bottom - (UINT32_C(1) << 16);
    // No access, 2^(15 + 1) bytes, enabled.
    MEMORY_PROTECTION->attributes = UINT32_C(15) << 1 | 1U;
    // On, but for fault handlers; the rest of the memory stays as it is without.
    MEMORY_PROTECTION->control = 1U << 2 | 1U;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
}

void reset_handler(void) {
    guard_stack();
#if __ARM_ARCH == 6
    // The board has a Cortex-M3, which reads words at any address; a Cortex-M0+ does not.
    CORTEXM_SCB->ccr |= UINT32_C(1) << 3;
#endif
    for (size_t i = 0; &data_start[i] != data_end; i++) {
        data_start[i] = data_image[i];
    }
    for (uint32_t *word = bss_start; word != bss_end; word++) {
        *word = 0;
    }
    semihost_exit((uint32_t)main());
}

static void write_text(const char *text) {
    size_t size = 0;
    while (text[size] != '\0') {
        size++;
    }
    semihost_write(text, size);
}

static void write_hex(uint32_t value) {
    char text[8];
    for (unsigned i = 0; i < sizeof text; i++) {
        text[i] = "0123456789abcdef"[value >> (28U - 4U * i) & 15U];
    }
    semihost_write(text, sizeof text);
}

/// frame: r0 to r3, r12, lr, pc, xpsr, as the processor pushed them; if there was room for it.
void mps2_fault_report(const uint32_t *frame) {
    if (frame >= stack_bottom && frame + 8 <= stack_top) {
        write_text("\nthe processor faulted at ");
        write_hex(frame[6]);
        write_text(", called from ");
        write_hex(frame[5]);
        write_text("\n");
    } else {
        write_text("\nthe stack overflowed\n");
    }
    semihost_exit(MPS2_FAULT_STATUS);
}

/// The stack may be what broke, so this starts it anew, below a frame at its top.
__attribute__((naked)) void mps2_fault_handler(void) {
    __asm__ volatile("mov r0, sp\n\t"
                     "ldr r1, =stack_top - 64\n\t"
                     "mov sp, r1\n\t"
                     "bl mps2_fault_report");
}

__attribute__((section(".vectors"), used)) void (*const vectors[16])(void) = {
    (void (*)(void))stack_top, reset_handler,      mps2_fault_handler, mps2_fault_handler,
    mps2_fault_handler,        mps2_fault_handler, mps2_fault_handler, mps2_fault_handler,
    mps2_fault_handler,        mps2_fault_handler, mps2_fault_handler, mps2_fault_handler,
    mps2_fault_handler,        mps2_fault_handler, mps2_fault_handler, mps2_fault_handler};
