#include "run_board.h"

#include "board_link.h"
#include "board_targets.h"
#include "capacity.h"
#include "facts.h"
#include "occlusion_file.h"
#include "sim.h"

#include "app/program_link.h"
#include "app/settings_digest.h"
#include "linux/linux_serial.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

extern const char build_id[];

#define ANSWER_US  3000000U
#define REST_LINES 4U ///< so many lines of status without motion: it stands still

struct board_run {
    const struct command *command;
    const struct rig *rig;
    const struct run_board_options *options;
    struct linux_serial serial;
    struct board_link link;
    struct board_targets targets;
    struct occlusion_rig *hiding; ///< NULL: nothing hides targets, as far as we know
    uint64_t start_us;
    uint32_t seen_lines; ///< of status
    enum controller_mode told_mode;
    bool told, arm_sent, armed, stopping;
    const char *ended_by; ///< why the board stopped by itself
    int32_t rest_mdeg[2];
    uint32_t rest_lines;
    uint64_t targets_refused;
    bool settled;
    int32_t goal_mdeg[2];
    double error_sum;
    uint64_t error_count;
};

static uint64_t clock_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U;
}

/// A millisecond passes, and the line is served.
static uint64_t serve(struct board_run *run) {
    const struct timespec pause = {0, 1000000};
    (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, NULL);
    const uint64_t now_us = clock_us();
    board_link_poll(&run->link, now_us);
    return now_us;
}

static enum exit_status complain(const struct board_run *run, const char *what,
                                 const char *remedy) {
    message_at(run->rig->ini.file, 0, "board = serial:%s: %s; %s", run->rig->board_device, what,
               remedy);
    return EXIT_STATUS_DEVICE;
}

static enum exit_status complain_of_device(const struct board_run *run) {
    message_at(run->rig->ini.file, 0, "board = serial:%s", run->serial.error.line);
    return EXIT_STATUS_DEVICE;
}

// ---------------------------------------------------------------- who is there

static enum exit_status check_identity(const struct board_run *run) {
    const struct board_link_identity *identity = &run->link.identity;
    char what[200];
    if (identity->version != PROGRAM_LINK_VERSION) {
        snprintf(what, sizeof what, "the board speaks version %" PRIu32 " of the protocol, not %u",
                 identity->version, PROGRAM_LINK_VERSION);
        return complain(run, what, "flash it with this program's image: make flash BOARD=...");
    }
    if (!run->rig->any_board_build && strcmp(identity->build, build_id) != 0) {
        snprintf(what, sizeof what, "the board runs build %s, this program is %s",
                 message_quoted(identity->build, strlen(identity->build)).text, build_id);
        return complain(run, what, "flash it (make flash BOARD=...), or set board_build = any");
    }
    if (identity->digest != settings_digest(&run->rig->controller)) {
        return complain(run, "the board was built for another rig file, or an older state of it",
                        "flash it for this one: make flash BOARD=... RIG=FILE");
    }
    return EXIT_STATUS_OK;
}

static enum exit_status say_hello(struct board_run *run) {
    const uint64_t until_us = clock_us() + ANSWER_US;
    board_link_hello(&run->link);
    while (!run->link.identity.known && !run->link.identity.busy && !run->link.gone &&
           serve(run) < until_us && *run->options->interrupted == 0) {
    }
    if (run->link.identity.known) {
        return check_identity(run);
    }
    if (run->link.gone) {
        return complain_of_device(run);
    }
    if (run->link.identity.busy) {
        return complain(run, "another program has the board", "end that one first");
    }
    if (run->link.bytes_received != 0U) {
        return complain(run, "what is there does not answer as a Boresight board does",
                        "is board_baud right, and is the image flashed (make flash BOARD=...)?");
    }
    return complain(run, "the board is silent",
                    "is it powered and flashed (make flash BOARD=...), and TX wired to RX?");
}

// ---------------------------------------------------------------- the run

static void tell_mode(struct board_run *run) {
    const struct board_link_status *status = &run->link.status;
    if (run->told && status->mode == run->told_mode) {
        return;
    }
    run->told = true;
    run->told_mode = status->mode;
    const char *why = status->faults != 0U ? controller_fault_name(status->faults) : status->held;
    message_command(run->command->name, "%s%s%s", controller_mode_name(status->mode),
                    why[0] != '\0' ? ": " : "", why);
}

/// Pointing error of the axes against their goals, by the last status: from when the aim has
/// settled (below 0.1 degrees) until a goal jumps by more than 5.
static void measure(struct board_run *run) {
    const struct board_link_status *status = &run->link.status;
    double apart[2];
    bool jumped = status->mode != MODE_TRACKING;
    for (unsigned axis = 0; axis < 2U; axis++) {
        const int32_t at =
            status->measured[axis] ? status->measured_mdeg[axis] : status->setpoint_mdeg[axis];
        apart[axis] = (double)(status->goal_mdeg[axis] - at) / 1000.0;
        jumped = jumped || abs(status->goal_mdeg[axis] - run->goal_mdeg[axis]) > 5000;
        run->goal_mdeg[axis] = status->goal_mdeg[axis];
    }
    apart[0] *= cos((double)status->goal_mdeg[1] / 1000.0 * 3.14159265358979 / 180.0);
    const double error = sqrt(apart[0] * apart[0] + apart[1] * apart[1]);
    run->settled = !jumped && (run->settled || error < 0.1);
    if (run->settled) {
        run->error_sum += error * error;
        run->error_count++;
    }
}

static void watch_rest(struct board_run *run) {
    const struct board_link_status *status = &run->link.status;
    const bool same = run->rest_mdeg[0] == status->setpoint_mdeg[0] &&
                      run->rest_mdeg[1] == status->setpoint_mdeg[1];
    run->rest_lines = same ? run->rest_lines + 1U : 0U;
    run->rest_mdeg[0] = status->setpoint_mdeg[0];
    run->rest_mdeg[1] = status->setpoint_mdeg[1];
}

static bool is_driven(enum controller_mode mode) {
    return mode == MODE_SETTLING || mode == MODE_TRACKING || mode == MODE_HOLDING;
}

/// News from the board.
static void take_status(struct board_run *run) {
    const struct board_link_status *status = &run->link.status;
    run->seen_lines = run->link.status_count;
    tell_mode(run);
    measure(run);
    watch_rest(run);
    if (is_driven(status->mode)) {
        run->armed = true;
    } else if (run->armed && !run->stopping) {
        run->ended_by = status->faults != 0U      ? controller_fault_name(status->faults)
                        : status->held[0] != '\0' ? status->held
                                                  : "somebody else stopped it";
    }
}

/// Before arming the axes must be homed. What the board says to it is taken in drive().
static void arm(struct board_run *run, uint64_t now_us) {
    const enum controller_mode mode = run->link.status.mode;
    if (run->options->arm && !run->arm_sent && run->link.status_count != 0U &&
        mode != MODE_STARTING && run->link.command == BOARD_LINK_IDLE) {
        run->arm_sent = true;
        board_link_order(&run->link, "arm", now_us);
    }
}

static void take_target(struct board_run *run, const struct target_update *update,
                        uint64_t now_us) {
    if (!board_targets_take(&run->targets, update, now_us) && run->targets_refused++ == 0U) {
        message_command(run->command->name, CAPACITY_MESSAGE, TARGET_CAPACITY);
    }
}

static void send_targets(struct board_run *run, uint64_t now_us) {
    struct occlusion *const occlusion = run->hiding != NULL ? &run->hiding->occlusion : NULL;
    struct target_update update;
    struct target_source *source = run->options->source;
    while (source != NULL && target_source_next(source, now_us - run->start_us, &update)) {
        if (occlusion == NULL || !occlusion_report(occlusion, &update, now_us)) {
            take_target(run, &update, now_us);
        }
        target_source_taken(source);
    }
    if (occlusion != NULL) {
        occlusion_step(occlusion, now_us, true);
        while (occlusion_next(occlusion, &update)) {
            take_target(run, &update, now_us);
        }
    }
    if (board_targets_due(&run->targets, &run->link, now_us)) {
        board_targets_send(&run->targets, &run->link, now_us);
    }
}

/// Returns: why the run is over; OK: it goes on.
static enum exit_status find_trouble(struct board_run *run, uint64_t now_us) {
    if (run->link.gone) {
        return complain_of_device(run);
    }
    switch (board_link_presence(&run->link, now_us)) {
    case BOARD_LINK_SILENT:
        return complain(run, "the board has fallen silent",
                        "was it unplugged or reset? It stops by itself half a second later");
    case BOARD_LINK_LET_GO:
        return complain(run, "the board has let go of this program",
                        "it was reset, or did not hear from here for half a second");
    case BOARD_LINK_THERE:
        break;
    }
    if (run->link.command == BOARD_LINK_LOST) {
        return complain(run, "a command was never answered", "is the line disturbed?");
    }
    if (run->link.command == BOARD_LINK_ANSWERED && run->link.refused) {
        message_command(run->command->name, "the board refuses '%s': %s", run->link.command_text,
                        run->link.answer);
        return EXIT_STATUS_SAFETY_STOP;
    }
    return EXIT_STATUS_OK;
}

static void begin_stop(struct board_run *run, uint64_t now_us) {
    if (!run->stopping) {
        run->stopping = true;
        run->rest_lines = 0;
        board_link_order(&run->link, "stop", now_us);
    }
}

static enum exit_status drive(struct board_run *run) {
    run->start_us = run->link.told_us = clock_us();
    for (;;) {
        const uint64_t now_us = serve(run);
        const uint64_t limit_us = run->options->limit_us;
        const enum exit_status trouble = find_trouble(run, now_us);
        if (trouble != EXIT_STATUS_OK) {
            return trouble;
        }
        if (run->seen_lines != run->link.status_count) {
            take_status(run);
        }
        arm(run, now_us);
        if (*run->options->interrupted != 0 || run->ended_by != NULL ||
            (limit_us != 0U && now_us - run->start_us >= limit_us)) {
            begin_stop(run, now_us);
        }
        if (!run->stopping) {
            send_targets(run, now_us);
        } else if (run->rest_lines >= REST_LINES && !is_driven(run->link.status.mode) &&
                   run->link.command == BOARD_LINK_ANSWERED) {
            return run->ended_by == NULL ? EXIT_STATUS_OK : EXIT_STATUS_SAFETY_STOP;
        }
    }
}

/// Once more, if the line still works: a board that is left stops.
static void leave(struct board_run *run) {
    board_link_bye(&run->link);
    for (int i = 0; i < 100 && board_link_waiting(&run->link) != 0U && !run->link.gone; i++) {
        (void)serve(run);
    }
}

// ---------------------------------------------------------------- what came of it

static void print_summary(const struct board_run *run) {
    const struct board_link *link = &run->link;
    const struct board_link_status *status = &link->status;
    const uint64_t now_us = clock_us();
    uint64_t board_us = 0, error_us = 0;
    (void)!board_clock_read(&link->clock, now_us, &board_us, &error_us);
    struct facts facts;
    facts_begin(&facts, stdout, run->options->json);
    facts_text(&facts, "build", build_id);
    facts_text(&facts, "board", run->rig->board_device);
    facts_text(&facts, "board_build", link->identity.build);
    facts_text(&facts, "mode", controller_mode_name(status->mode));
    facts_fixed(&facts, "seconds", (double)(now_us - run->start_us) * 1e-6, 3);
    facts_u64(&facts, "targets", run->targets.most);
    facts_fixed(&facts, "hidden_percent",
                run->hiding != NULL ? sim_hidden_percent(&run->hiding->occlusion) : 0.0, 2);
    facts_u64(&facts, "bad_lines",
              run->options->source != NULL ? run->options->source->bad_lines : 0U);
    facts_u64(&facts, "updates_rejected", status->rejected + run->targets_refused);
    facts_fixed(&facts, "pan_deg", status->setpoint_mdeg[0] / 1000.0, 3);
    facts_fixed(&facts, "tilt_deg", status->setpoint_mdeg[1] / 1000.0, 3);
    const double count = run->error_count != 0U ? (double)run->error_count : 1.0;
    facts_fixed(&facts, "aim_error_rms_deg", sqrt(run->error_sum / count), 4);
    facts_u64(&facts, "status_lines", link->status_count);
    facts_u64(&facts, "status_gap_ms_max", link->gap_us_max / 1000U);
    facts_u64(&facts, "target_lines_sent", link->target_lines_sent);
    facts_u64(&facts, "lines_taken", status->taken);
    facts_u64(&facts, "lines_damaged", status->damaged + link->splitter.damaged);
    facts_u64(&facts, "lines_stale", status->stale);
    facts_u64(&facts, "frames_compact", run->targets.compact_frames);
    facts_u64(&facts, "frames_cut", run->targets.cut_frames);
    facts_u64(&facts, "clock_answers", link->clock.answers);
    facts_fixed(&facts, "clock_error_ms", (double)error_us * 1e-3, 3);
    facts_end(&facts);
}

static enum exit_status run_opened(struct board_run *run) {
    const uint8_t host = (uint8_t)((unsigned)getpid() * 31U + (unsigned)clock_us());
    board_link_init(&run->link, &run->serial.hal, run->rig->board_baud, host, clock_us());
    board_targets_init(&run->targets, run->rig->controller.position_um);
    enum exit_status status = say_hello(run);
    if (status != EXIT_STATUS_OK) {
        if (run->link.identity.known) {
            leave(run);
        }
        return status;
    }
    status = drive(run);
    if (run->ended_by != NULL) {
        message_command(run->command->name, "the board stopped: %s", run->ended_by);
    }
    leave(run);
    print_summary(run);
    return status;
}

enum exit_status run_board(const struct command *command, const struct rig *rig,
                           const struct run_board_options *options) {
    struct board_run *run = calloc(1, sizeof *run);
    if (run == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    run->command = command;
    run->rig = rig;
    run->options = options;
    enum exit_status status =
        occlusion_rig_open(options->scene, &rig->occlusion, rig->controller.position_um,
                           rig->controller.target_expiry_us, &run->hiding);
    if (status != EXIT_STATUS_OK) {
        occlusion_rig_close(run->hiding);
        free(run);
        return status;
    }
    status = EXIT_STATUS_DEVICE;
    if (linux_serial_open(&run->serial, rig->board_device, rig->board_baud) != HAL_OK) {
        status = complain_of_device(run);
    } else {
        status = run_opened(run);
        linux_serial_close(&run->serial);
    }
    occlusion_rig_close(run->hiding);
    free(run);
    return status;
}
