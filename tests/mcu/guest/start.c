#include "guest.h"

extern uint32_t stack_top[], data_begin[], data_end[], data_from[], bss_begin[], bss_end[];

static void stop(void) {
    print("an exception that nobody expected\n");
    for (;;) {
    }
}

#define WEAK __attribute__((weak, alias("stop")))
WEAK handler_fn nmi_handler, hard_fault_handler, bus_fault_handler, usage_fault_handler,
    svc_handler, pend_sv_handler, sys_tick_handler, irq37_handler, irq38_handler, irq39_handler;

struct vectors {
    uint32_t *stack;
    handler_fn *handler[15 + 82];
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    stack_top,
    {[0] = reset_handler,
     [1] = nmi_handler,
     [2] = hard_fault_handler,
     [3] = stop,
     [4] = bus_fault_handler,
     [5] = usage_fault_handler,
     [10] = svc_handler,
     [13] = pend_sv_handler,
     [14] = sys_tick_handler,
     [15 + 37] = irq37_handler,
     [15 + 38] = irq38_handler,
     [15 + 39] = irq39_handler}};

static void open_console(void) {
    REG(0x40023830U) |= 1U;                                 // GPIOA
    REG(0x40023844U) |= 1U << 4;                            // USART1
    REG(0x40020024U) = (REG(0x40020024U) & ~0xF0U) | 0x70U; // PA9: AF7
    REG(0x40020000U) = (REG(0x40020000U) & ~0xC0000U) | 0x80000U;
    REG(0x40011008U) = 139; // 16 MHz / 115200
    REG(0x4001100CU) = 0x2008;
}

void print(const char *text) {
    for (; *text != '\0'; text++) {
        while ((REG(0x40011000U) & 0x80U) == 0U) {
        }
        REG(0x40011004U) = (uint8_t)*text;
    }
}

static void print_hex(uint32_t value) {
    char text[9];
    for (int i = 7; i >= 0; i--, value >>= 4) {
        text[i] = "0123456789abcdef"[value & 15U];
    }
    text[8] = '\0';
    print(text);
}

void check(const char *name, uint32_t value, uint32_t wanted) {
    print(name);
    if (value == wanted) {
        print(" ok\n");
        return;
    }
    print(": ");
    print_hex(value);
    print(", not ");
    print_hex(wanted);
    print("\n");
}

void reset_handler(void) {
    const uint32_t *from = data_from;
    for (uint32_t *to = data_begin; to != data_end; to++) {
        *to = *from++;
    }
    for (volatile uint32_t *to = bss_begin; to != bss_end; to++) {
        *to = 0;
    }
    open_console();
    guest_main();
    print("end\n");
    for (;;) {
        __asm volatile("wfi");
    }
}
