#include "run_board_private.h"

#include "capacity.h"

#include "app/program_link.h"
#include "app/settings_digest.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const char build_id[];

#define TICK_US       1000U
#define ANSWER_US     3000000U
#define LOOK_EVERY_US 500000U
#define REST_LINES    4U ///< so many lines of status without motion: it stands still

// ---------------------------------------------------------------- what is said

static void tell(struct board_run *run, bool severe, const char *event, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static void tell(struct board_run *run, bool severe, const char *event, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    run_log_tell(&run->log, run->command->name, severe, event, text);
}

/// Why the board is not there, once.
static enum exit_status complain_of(struct board_run *run, const char *line) {
    const bool first = run->refusal[0] == '\0';
    if (strcmp(line, run->refusal) != 0) {
        snprintf(run->refusal, sizeof run->refusal, "%s", line);
        run_log_tell_at(&run->log, run->rig->ini.file, "device", line);
        if (first && run->options->stay) {
            tell(run, false, "device", "waiting until it is there");
        }
    }
    return EXIT_STATUS_DEVICE;
}

static enum exit_status complain(struct board_run *run, const char *what, const char *remedy) {
    char line[LINUX_ERROR_BYTES];
    snprintf(line, sizeof line, "board = serial:%s: %s; %s", run->rig->board_device, what, remedy);
    return complain_of(run, line);
}

static enum exit_status complain_of_device(struct board_run *run) {
    char line[LINUX_ERROR_BYTES];
    snprintf(line, sizeof line, "board = serial:%.*s", (int)sizeof line - 20,
             run->serial.error.line);
    return complain_of(run, line);
}

// ---------------------------------------------------------------- time

/// The next millisecond, and the signals until then.
static uint64_t pass(struct board_run *run) {
    uint32_t raised = 0;
    (void)event_loop_tick(&run->loop, &raised);
    run->interrupted = run->interrupted || (raised & EVENT_LOOP_END) != 0U;
    if ((raised & EVENT_LOOP_REARM) != 0U && run->is_there && !run->stopping) {
        run_log_event(&run->log, false, "rearm", "by SIGUSR1");
        run->arm_due = true;
    }
    if ((raised & EVENT_LOOP_RELOAD) != 0U) {
        tell(run, false, "reload",
             "SIGHUP changes nothing: what the rig file says is in the board's flash");
    }
    const uint64_t now_us = event_loop_now_us();
    run_board_state(run, now_us);
    return now_us;
}

/// The same, and the line is served.
static uint64_t serve(struct board_run *run) {
    const uint64_t now_us = pass(run);
    board_link_poll(&run->link, now_us);
    return now_us;
}

static bool is_over(const struct board_run *run, uint64_t now_us) {
    const uint64_t limit_us = run->options->limit_us;
    return run->interrupted || (limit_us != 0U && now_us - run->start_us >= limit_us);
}

// ---------------------------------------------------------------- who is there

static enum exit_status check_identity(struct board_run *run) {
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
    const uint64_t until_us = event_loop_now_us() + ANSWER_US;
    board_link_hello(&run->link);
    while (!run->link.identity.known && !run->link.identity.busy && !run->link.gone &&
           serve(run) < until_us && !run->interrupted) {
    }
    if (run->link.identity.known) {
        return check_identity(run);
    }
    if (run->link.gone) {
        return complain_of_device(run);
    }
    if (run->interrupted) {
        tell(run, false, "end", "interrupted before the board answered");
        return EXIT_STATUS_DEVICE;
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
    tell(run, status->faults != 0U, status->faults != 0U ? "fault" : "mode", "%s%s%s",
         controller_mode_name(status->mode), why[0] != '\0' ? ": " : "", why);
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
    run_board_measure(run);
    watch_rest(run);
    if (is_driven(status->mode)) {
        run->armed = true;
    } else if (run->armed && !run->stopping) {
        run->ended_by = status->faults != 0U      ? controller_fault_name(status->faults)
                        : status->held[0] != '\0' ? status->held
                                                  : "somebody else stopped it";
        tell(run, true, "board", "the board stopped: %s", run->ended_by);
        run->armed = false;
    }
}

/// Before arming the axes must be homed. What the board says to it is taken in find_trouble.
static void arm(struct board_run *run, uint64_t now_us) {
    if (run->arm_due && run->link.status_count != 0U && run->link.status.mode != MODE_STARTING &&
        run->link.command != BOARD_LINK_WAITS) {
        run->arm_due = false;
        board_link_order(&run->link, "arm", now_us);
    }
}

static void take_target(struct board_run *run, const struct target_update *update,
                        uint64_t now_us) {
    if (!board_targets_take(&run->targets, update, now_us) && run->targets_refused++ == 0U) {
        tell(run, true, "capacity", CAPACITY_MESSAGE, TARGET_CAPACITY);
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
        tell(run, true, "board", "the board refuses '%s': %s", run->link.command_text,
             run->link.answer);
        run->link.command = BOARD_LINK_IDLE;
        return run->options->stay ? EXIT_STATUS_OK : EXIT_STATUS_SAFETY_STOP;
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

/// The board is there, from now on.
static void begin(struct board_run *run) {
    const uint64_t now_us = event_loop_now_us();
    if (run->known) {
        run->returns++;
    } else {
        run->start_us = now_us; // the times of a recording count from here
    }
    if (run->refusal[0] != '\0') {
        tell(run, false, "device", "the board is there%s", run->known ? " again" : "");
        run->refusal[0] = '\0';
    }
    run->known = run->is_there = true;
    run->told = run->armed = run->settled = false;
    run->seen_lines = run->rest_lines = 0;
    run->link.told_us = now_us;
    board_targets_renew(&run->targets, now_us);
}

static enum exit_status drive(struct board_run *run) {
    for (;;) {
        const uint64_t now_us = serve(run);
        const enum exit_status trouble = find_trouble(run, now_us);
        if (trouble != EXIT_STATUS_OK) {
            return trouble;
        }
        if (run->seen_lines != run->link.status_count) {
            take_status(run);
        }
        arm(run, now_us);
        if (is_over(run, now_us) || (run->ended_by != NULL && !run->options->stay)) {
            begin_stop(run, now_us);
        }
        if (!run->stopping) {
            send_targets(run, now_us);
        } else if (run->rest_lines >= REST_LINES && !is_driven(run->link.status.mode) &&
                   run->link.command == BOARD_LINK_ANSWERED) {
            return run->ended_by == NULL || run->options->stay ? EXIT_STATUS_OK
                                                               : EXIT_STATUS_SAFETY_STOP;
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

// ---------------------------------------------------------------- a board that comes and goes

/// From the opening of the line to its end.
static enum exit_status drive_once(struct board_run *run) {
    const char *const device = run->rig->board_device;
    if (linux_serial_open(&run->serial, device, run->rig->board_baud) != HAL_OK) {
        return complain_of_device(run);
    }
    const uint64_t now_us = event_loop_now_us();
    const uint8_t host = (uint8_t)((unsigned)getpid() * 31U + (unsigned)now_us);
    board_link_init(&run->link, &run->serial.hal, run->rig->board_baud, host, now_us);
    enum exit_status status = say_hello(run);
    if (status == EXIT_STATUS_OK) {
        begin(run);
        status = drive(run);
        run->is_there = false;
    }
    if (run->link.identity.known) {
        leave(run);
    }
    linux_serial_close(&run->serial);
    return status;
}

/// With `stay`, as often as it takes. After a loss nothing moves by itself.
static enum exit_status drive_on(struct board_run *run) {
    enum exit_status status = drive_once(run);
    while (status == EXIT_STATUS_DEVICE && run->options->stay) {
        const uint64_t until_us = event_loop_now_us() + LOOK_EVERY_US;
        run->arm_due = run->arm_due && !run->known;
        for (uint64_t now_us = 0; now_us < until_us;) {
            now_us = pass(run);
            if (is_over(run, now_us)) {
                return status;
            }
        }
        status = drive_once(run);
    }
    return status;
}

static enum exit_status open_parts(struct board_run *run) {
    const struct run_board_options *const options = run->options;
    const struct controller_config *const controller = &run->rig->controller;
    if (!run_log_open(&run->log, options->log, event_loop_now_us())) {
        return EXIT_STATUS_USAGE;
    }
    if (!event_loop_open(&run->loop, TICK_US)) {
        message_command(run->command->name, "no event loop: %s", strerror(errno));
        return EXIT_STATUS_FAILURE;
    }
    return occlusion_rig_open(options->scene, &run->rig->occlusion, controller->position_um,
                              controller->target_expiry_us, &run->hiding);
}

enum exit_status run_board(const struct command *command, const struct rig *rig,
                           const struct run_board_options *options) {
    struct board_run *run = calloc(1, sizeof *run);
    if (run == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    *run = (struct board_run){.command = command,
                              .rig = rig,
                              .options = options,
                              .loop = {.epoll = -1, .timer = -1, .signals = -1},
                              .start_us = event_loop_now_us(),
                              .arm_due = options->arm};
    event_loop_block_signals();
    message_aside_begin(); // a terminal that was stopped must not stop the board
    board_targets_init(&run->targets, rig->controller.position_um);
    enum exit_status status = open_parts(run);
    if (status == EXIT_STATUS_OK) {
        run_log_event(&run->log, false, "start", "%s", rig->ini.file);
        status = drive_on(run);
        run_log_event(&run->log, false, "end", "exit status %d", (int)status);
    }
    if (run->known) {
        run_board_summary(run);
    }
    occlusion_rig_close(run->hiding);
    event_loop_close(&run->loop);
    run_log_close(&run->log);
    message_aside_end();
    free(run);
    return status;
}
