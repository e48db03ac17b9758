/// The image of the Raspberry Pi Pico: sets up the chip, then runs the loop that all boards share.
#include "devices.h"

#include "app/board_loop.h"
#include "compiled_rig.h"
#include "console.h"
#include "cortexm/cortexm.h"
#include "cortexm/cortexm_crash.h"
#include "cortexm/cortexm_start.h"
#include "link/text.h"
#include "pins.h"
#include "rp2040/rp2040_clocks.h"
#include "rp2040/rp2040_gpio.h"
#include "rp2040/rp2040_pwm.h"
#include "rp2040/rp2040_watchdog.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define TICK_US      1000U

struct board_devices_here devices;

static struct rp2040_gpio gpio;
static struct rp2040_pwm pwm;
static struct rp2040_watchdog watchdog;
static struct console console;
static struct board_loop loop;

static const struct board_stop_line stop_lines[] = {
    {LINE_EMERGENCY_STOP, "emergency stop"},
    {LINE_KEY_SWITCH, "key switch off"},
    {LINE_PAN_LIMIT, "pan limit switch"},
    {LINE_TILT_LIMIT, "tilt limit switch"},
};

// ---------------------------------------------------------------- what the greeting tells

static char clock_note[64], crash_note[80];
static const char *notes[] = {"board: pico", clock_note, NULL, NULL};

static void finish(struct text *text) {
    text->buffer[text->size_bytes] = '\0';
}

static void note_clock(const struct rp2040_clocks *clocks) {
    struct text text;
    text_begin(&text, clock_note, sizeof clock_note - 1U);
    text_string(&text, "clock: ");
    text_unsigned(&text, clocks->core_hz / 1000000U, 0);
    text_string(&text, " MHz, ");
    text_string(&text, rp2040_clocks_state_name(clocks->state));
    if (!clocks->usb) {
        text_string(&text, ", no USB");
    }
    finish(&text);
}

static void note_crash(void) {
    struct cortexm_crash crash;
    if (!cortexm_crash_take(&crash)) {
        return;
    }
    struct text text;
    text_begin(&text, crash_note, sizeof crash_note - 1U);
    text_string(&text, "last run: ");
    text_string(&text, cortexm_crash_name(crash.exception));
    text_string(&text, " ");
    text_unsigned(&text, crash.exception, 0);
    text_string(&text, " at ");
    text_hex(&text, crash.pc);
    text_string(&text, " from ");
    text_hex(&text, crash.lr);
    finish(&text);
    notes[2] = crash_note;
}

// ---------------------------------------------------------------- set-up

/// Returns why the board must not arm, or NULL.
static const char *set_up(void) {
    rp2040_watchdog_init(&watchdog);
    const struct rp2040_clocks clocks = rp2040_clocks_start();
    note_clock(&clocks);
    note_crash();
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
                                         .notes = notes};
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
