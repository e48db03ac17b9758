/// What only a board knows about itself, and how it is told to people.
///
/// Shown: tests/unit/test_board_loop.c, tests/unit/test_board_console.c.
#ifndef APP_BOARD_STATUS_H
#define APP_BOARD_STATUS_H

#include "app/pump.h"
#include "hal/watchdog.h"
#include "link/text.h"

struct board_status {
    const char *refusal; ///< why it never arms, or NULL
    const char *stop;    ///< name of the stop line that is active, or NULL
    enum hal_reset_cause reset_cause;
    struct hal_can_state can; ///< at its worst since the last line of telemetry
    uint32_t busy_us;         ///< of the last tick
    uint32_t busy_us_max;     ///< since the last line of telemetry
    uint32_t ticks_missed;
    const char *scene;  ///< a line about it; NULL: the image has none
    const char *hidden; ///< a line about hidden targets; NULL: nothing hides any
};

/// Why it must not arm now, or NULL.
const char *board_status_held(const struct board_status *status);

/// Line `index` of who it is and how it started. notes: the board's own lines, up to a NULL.
/// False: there is no such line.
bool board_status_greet(const struct board_status *status, const char *const *notes, uint32_t index,
                        struct text *text);

/// A line of telemetry.
void board_status_trace(const struct board_status *status, const struct pump *pump,
                        uint32_t seconds, struct text *text);

/// The next line of telemetry tells the worst from here on.
void board_status_begin_period(struct board_status *status);

/// Line `index` of a longer account, for `status`. False: there is no such line.
bool board_status_tell(const struct board_status *status, const struct pump *pump, uint32_t index,
                       struct text *text);

#endif
