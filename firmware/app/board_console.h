/// A board's serial line: a console for a person and a link for a program, both at once.
///
/// It begins by telling who it is and why it started, then a line of telemetry a second; from the
/// first key on it is a console with a prompt (link/line_editor.h) and is silent unless asked.
/// Lines that begin with `$` are a program's (app/program_link.h). While a program has the board, a
/// person may look and stop, no more. Shown: tests/unit/test_board_console.c (golden transcripts,
/// fuzzing), tests/unit/test_board_loop.c.
#ifndef APP_BOARD_CONSOLE_H
#define APP_BOARD_CONSOLE_H

#include "app/board_commands.h"
#include "app/board_status.h"
#include "app/program_link.h"
#include "hal/serial.h"
#include "link/line_editor.h"
#include "link/line_splitter.h"

/// At most so much is read in a tick: ten times what comes at 115,200 baud.
#define BOARD_CONSOLE_BYTES_A_TICK 128U
#define BOARD_CONSOLE_IN_BYTES     32U
#define BOARD_CONSOLE_OUT_BYTES    512U ///< a power of two, at least two lines
#define BOARD_CONSOLE_LINE_BYTES   224U

/// What is told in several lines, one a tick at most.
enum board_console_job {
    BOARD_CONSOLE_QUIET,
    BOARD_CONSOLE_GREETING,
    BOARD_CONSOLE_HELP,
    BOARD_CONSOLE_STATUS,
    BOARD_CONSOLE_SETTINGS
};

struct board_console {
    const struct hal_serial *serial;
    const char *const *notes; ///< lines for the greeting, up to a NULL
    struct pump *pump;
    struct board_status *status;
    struct board_settings *settings;
    struct board_commands commands;
    struct program_link link;
    struct line_splitter splitter;
    struct line_editor editor;
    uint64_t now_us; ///< since the start: the board's time for programs
    uint32_t last_us, digest;
    enum board_console_job job;
    uint32_t job_line;
    bool talks;         ///< a person has pressed a key: there is a prompt
    bool traces, asked; ///< telemetry goes out; somebody asked for it
    uint32_t trace_ms;
    uint64_t traced_us;
    uint32_t lost_lines; ///< that did not fit into out
    uint32_t in_count, in_at, out_first, out_count;
    uint8_t in[BOARD_CONSOLE_IN_BYTES];
    uint8_t out[BOARD_CONSOLE_OUT_BYTES];
};

/// All must outlive the console. The pump's clock begins the board's time.
void board_console_init(struct board_console *console, const struct hal_serial *serial,
                        const char *const *notes, struct pump *pump, struct board_status *status,
                        struct board_settings *settings);

/// Call it once a tick, after the pump. Never blocks: writes what the line has room for.
void board_console_poll(struct board_console *console);

#endif
