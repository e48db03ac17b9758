/// The vector table (RP2040 datasheet, 2.3.2): whatever is not handled here is a crash.
#include "devices.h"

#include "cortexm/cortexm_crash.h"
#include "cortexm/cortexm_start.h"

enum { SYSTICK = 15, CORE_VECTORS = 16, CONSOLE = CORE_VECTORS + RP2040_IRQ_UART0 };

static void on_tick(void) {
    cortexm_clock_on_tick(&devices.clock);
}

static void on_console(void) {
    rp2040_uart_on_interrupt(&devices.console);
}

#define CRASH cortexm_crash_handler

extern void (*const vectors[])(void);

__attribute__((section(".vectors"),
               used)) void (*const vectors[CORE_VECTORS + RP2040_IRQ_COUNT])(void) = {
    (void (*)(void))(void *)stack_top,
    reset_handler,
    [2 ... SYSTICK - 1] = CRASH,
    [SYSTICK] = on_tick,
    [CORE_VECTORS... CONSOLE - 1] = CRASH,
    [CONSOLE] = on_console,
    [CONSOLE + 1 ... CORE_VECTORS + RP2040_IRQ_COUNT - 1] = CRASH,
};
