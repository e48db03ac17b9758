/// The vector table (RP2040 datasheet, 2.3.2): whatever is not handled here is a crash.
#include "devices.h"

#include "cortexm/cortexm_crash.h"
#include "cortexm/cortexm_start.h"

enum {
    SYSTICK = 15,
    CORE_VECTORS = 16,
    USB = CORE_VECTORS + RP2040_IRQ_USB,
    UART = CORE_VECTORS + RP2040_IRQ_UART0
};

static void on_tick(void) {
    cortexm_clock_on_tick(&devices.clock);
}

static void on_usb(void) {
    rp2040_usb_on_interrupt(&devices.usb);
}

static void on_uart(void) {
    rp2040_uart_on_interrupt(&devices.uart);
}

#define CRASH cortexm_crash_handler

extern void (*const vectors[])(void);

__attribute__((section(".vectors"),
               used)) void (*const vectors[CORE_VECTORS + RP2040_IRQ_COUNT])(void) = {
    (void (*)(void))(void *)stack_top,
    reset_handler,
    [2 ... SYSTICK - 1] = CRASH,
    [SYSTICK] = on_tick,
    [CORE_VECTORS... USB - 1] = CRASH,
    [USB] = on_usb,
    [USB + 1 ... UART - 1] = CRASH,
    [UART] = on_uart,
    [UART + 1 ... CORE_VECTORS + RP2040_IRQ_COUNT - 1] = CRASH,
};
