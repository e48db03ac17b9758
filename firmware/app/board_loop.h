/// What every microcontroller board does in a tick, around the pump: stop lines, enable line,
/// console, watchdog.
///
/// A board's main() sets up its devices, calls board_loop_init, and then board_loop_tick once for
/// each tick of its clock. Shown: tests/unit/test_board_loop.c.
///
/// It never arms while a stop line is active, and not at all if something is wrong that only a
/// repair mends: the board says so (refusal), the settings are unusable, the watchdog does not run.
/// After a reset by the watchdog or by a crash it does not arm by itself, whatever the settings
/// say.
#ifndef APP_BOARD_LOOP_H
#define APP_BOARD_LOOP_H

#include "app/board_console.h"
#include "app/pump.h"
#include "hal/gpio.h"
#include "hal/serial.h"
#include "hal/watchdog.h"

/// The watchdog resets the board at most so long after a hang.
#define BOARD_WATCHDOG_US 33000U

/// An input that stops the gimbal while it is active: emergency stop, limit switches, key switch.
struct board_stop_line {
    uint32_t line; ///< of the gpio device
    const char *name;
};

struct board_config {
    const struct controller_config *controller;
    const struct board_stop_line *stop_lines;
    uint32_t stop_line_count;
    uint32_t enable_line;     ///< an output, active while axes are driven: power for servos
    const char *const *notes; ///< lines for the console's greeting, up to a NULL
    const char *refusal;      ///< why this board must not arm, or NULL
};

struct board_devices {
    struct pump_devices pump;
    const struct hal_gpio *gpio;
    const struct hal_serial *console;
    const struct hal_watchdog *watchdog;
};

/// Who must check in before the watchdog is fed.
enum board_task {
    BOARD_TASK_INPUTS = 1,  ///< the stop lines were looked at
    BOARD_TASK_CONTROL = 2, ///< the controller took a step, at a later time than the one before
    BOARD_TASK_CONSOLE = 4,
    BOARD_TASKS = 7
};

/// About 33 KiB.
struct board_loop {
    const struct board_config *config;
    struct board_devices devices;
    struct board_status status;
    uint32_t checked_in; ///< enum board_task
    uint32_t ticks;
    uint32_t last_now_us;
    bool runs;    ///< the pump has all that it needs
    bool enabled; ///< the enable line, as last written
    struct board_settings settings;
    struct board_console console;
    struct pump pump;
    struct controller controller;
};

/// config must outlive the loop. Starts the watchdog.
void board_loop_init(struct board_loop *loop, const struct board_config *config,
                     const struct board_devices *devices);

/// One tick. missed: how many ticks were skipped before this one.
void board_loop_tick(struct board_loop *loop, uint32_t missed);

#endif
