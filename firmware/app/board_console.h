/// What a board says on its serial line: who it is and why it started, then a status line a second.
///
/// Read-only for now: what a host or a person types is thrown away. The console of firmware/link/
/// takes its place in board_console_poll, which has all that it needs: the line, the pump for
/// targets and commands, the status to tell.
#ifndef APP_BOARD_CONSOLE_H
#define APP_BOARD_CONSOLE_H

#include "app/pump.h"
#include "hal/serial.h"
#include "hal/watchdog.h"

/// What only the board knows about itself.
struct board_status {
    const char *refusal; ///< why it never arms, or NULL
    const char *stop;    ///< name of the stop line that is active, or NULL
    enum hal_reset_cause reset_cause;
    struct hal_can_state can; ///< at its worst since the last status line
    uint32_t busy_us;         ///< of the last tick
    uint32_t busy_us_max;     ///< since the last status line
    uint32_t ticks_missed;
};

#define BOARD_CONSOLE_LINE_BYTES 224U

struct board_console {
    const struct hal_serial *serial;
    const char *const *notes; ///< lines for the greeting, up to a NULL
    uint32_t notes_told;
    bool greeted, cause_told, refusal_told;
    uint32_t told_us; ///< time of the last status line
    uint32_t seconds; ///< since the start
    uint32_t size_bytes, sent_bytes;
    char line[BOARD_CONSOLE_LINE_BYTES]; ///< on its way out
};

void board_console_init(struct board_console *console, const struct hal_serial *serial,
                        const char *const *notes);

/// Call it once a tick. Never blocks: writes what the line has room for.
void board_console_poll(struct board_console *console, struct pump *pump,
                        struct board_status *status);

#endif
