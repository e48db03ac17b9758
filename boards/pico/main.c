/// The image of the Raspberry Pi Pico: sets up the chip, then runs the loop that all boards share.
#include "devices.h"

#include "app/board_loop.h"
#include "compiled_rig.h"
#include "console.h"
#include "cortexm/cortexm.h"
#include "cortexm/cortexm_start.h"
#include "greeting.h"
#include "pins.h"
#include "rp2040/rp2040_clocks.h"
#include "rp2040/rp2040_gpio.h"
#include "rp2040/rp2040_pwm.h"
#include "rp2040/rp2040_watchdog.h"
#include "switches.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define TICK_US      1000U

struct board_devices_here devices;

static struct rp2040_gpio gpio;
static struct rp2040_pwm pwm;
static struct rp2040_watchdog watchdog;
static struct console console;
static struct board_loop loop;
static struct greeting greeting;

// ---------------------------------------------------------------- set-up

/// Returns why the board must not arm, or NULL.
static const char *set_up(void) {
    rp2040_watchdog_init(&watchdog);
    const struct rp2040_clocks clocks = rp2040_clocks_start();
    greeting_init(&greeting, "board: pico");
    greeting_clock(&greeting, clocks.core_hz, rp2040_clocks_state_name(clocks.state),
                   clocks.usb ? "" : ", no USB");
    greeting_crash(&greeting, NULL);
    cortexm_clock_start(&devices.clock, clocks.core_hz, TICK_US);
    rp2040_gpio_init(&gpio, gpio_lines, gpio_pins, COUNT(gpio_lines));
    rp2040_pwm_init(&pwm, pwm_pins, COUNT(pwm_pins), clocks.core_hz);
    rp2040_gpio_set_function(CONSOLE_TX, RP2040_FUNCTION_UART, HAL_GPIO_PULL_NONE);
    rp2040_gpio_set_function(CONSOLE_RX, RP2040_FUNCTION_UART, HAL_GPIO_PULL_UP);
    rp2040_uart_init(&devices.uart, RP2040_UART0, RP2040_IRQ_UART0, clocks.core_hz, CONSOLE_BAUD);
    if (clocks.usb) {
        rp2040_usb_init(&devices.usb);
    }
    console_init(&console, &devices.uart, clocks.usb ? &devices.usb : NULL);
    return clocks.state == RP2040_CLOCKS_FULL ? NULL : rp2040_clocks_state_name(clocks.state);
}

int main(void) {
    static struct board_config config = {.controller = &compiled_rig,
                                         .stop_lines = stop_lines,
                                         .stop_line_count = COUNT(stop_lines),
                                         .enable_line = LINE_ENABLE,
                                         .notes = greeting.notes};
    config.refusal = set_up();
    board_loop_init(&loop, &config,
                    &(struct board_devices){.pump = {.clock = &devices.clock.hal, .pwm = &pwm.hal},
                                            .gpio = &gpio.hal,
                                            .console = &console.hal,
                                            .watchdog = &watchdog.hal});
    uint32_t tick = devices.clock.ticks;
    for (;;) {
        const uint32_t next = cortexm_clock_wait_tick(&devices.clock, tick);
        board_loop_tick(&loop, next - tick - 1U);
        tick = next;
    }
}
