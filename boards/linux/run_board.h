/// `boresight run` with `board = serial:DEVICE`: the rig's controller is a flashed board.
/// Shown: tests/cli/board.sh, tests/vm/guest/board.sh.
#ifndef LINUX_RUN_BOARD_H
#define LINUX_RUN_BOARD_H

#include "command.h"
#include "rig.h"
#include "target_source.h"

struct run_board_options {
    struct target_source *source; ///< NULL: no targets
    const char *scene;            ///< whose solids hide targets; NULL: none here
    uint64_t limit_us;            ///< 0: until interrupted
    uint64_t state_us;            ///< a line of state every so often; 0: none
    const char *log;              ///< as for run_log_open
    bool arm, json;
    bool stay; ///< a board that is missing, leaves or stops by itself does not end it
};

/// Drives until the time is over, a signal comes, or the board stops by itself; then prints what
/// came of it. What goes wrong is one line on stderr. SIGUSR1 arms. With `stay` it waits for a
/// board that is missing or has left, and then nothing moves before SIGUSR1.
/// Returns: EXIT_STATUS_OK; EXIT_STATUS_DEVICE: no such device, no answer, another protocol, build
///          or rig; EXIT_STATUS_SAFETY_STOP: a fault, a stop line, somebody else's stop;
///          EXIT_STATUS_USAGE: no such log, no such scene.
/// Shown: tests/cli/board.sh, tests/vm/guest/board.sh.
enum exit_status run_board(const struct command *command, const struct rig *rig,
                           const struct run_board_options *options);

#endif
