/// The parts of run_board: run_board.c drives, run_board_report.c tells what came of it. For them
/// only.
#ifndef LINUX_RUN_BOARD_PRIVATE_H
#define LINUX_RUN_BOARD_PRIVATE_H

#include "run_board.h"

#include "board_link.h"
#include "board_targets.h"
#include "event_loop.h"
#include "occlusion_file.h"
#include "run_log.h"

#include "linux/linux_error.h"
#include "linux/linux_serial.h"

struct board_run {
    const struct command *command;
    const struct rig *rig;
    const struct run_board_options *options;
    struct run_log log;
    struct event_loop loop; ///< a tick a millisecond
    struct linux_serial serial;
    struct board_link link;
    struct board_targets targets;
    struct occlusion_rig *hiding; ///< NULL: nothing hides targets, as far as we know
    uint64_t start_us;            ///< when the board was first there; before that, of all
    bool interrupted;
    bool known; ///< a board has been there
    bool is_there;
    bool arm_due; ///< as soon as the axes are homed
    uint32_t returns;
    char refusal[LINUX_ERROR_BYTES]; ///< why the board is not there, as told; empty: it is
    // Since the board is there:
    uint32_t seen_lines; ///< of status
    enum controller_mode told_mode;
    bool told, armed, stopping;
    const char *ended_by; ///< why the board stopped by itself
    int32_t rest_mdeg[2];
    uint32_t rest_lines;
    // What comes of it:
    uint64_t targets_refused;
    bool settled;
    int32_t goal_mdeg[2];
    double error_sum;
    uint64_t error_count;
    uint64_t state_due_us, states_dropped;
};

/// Takes the pointing error of the axes against their goals, by the last status: from when the aim
/// has settled (below 0.1 degrees) until a goal jumps by more than 5.
void run_board_measure(struct board_run *run);

/// Prints a line of state when one is due.
void run_board_state(struct board_run *run, uint64_t now_us);

void run_board_summary(struct board_run *run);

#endif
