/// `boresight run`: drives a rig in real time.
#include "command.h"
#include "facts.h"
#include "rig.h"
#include "run_board.h"
#include "target_source.h"

#include "sim.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

extern const char build_id[];

struct settings {
    const char *targets, *seconds;
    bool arm, json;
};

struct run {
    struct rig rig;
    struct schedule schedule; ///< empty: targets come from the source
    struct target_source source;
    bool has_source;
    struct sim *sim;
    uint64_t late_ticks;
    enum controller_mode told_mode;
};

static const struct option options[] = {
    {"--targets", "FILE|-", "target stream, JSON lines (default: none)", option_text,
     offsetof(struct settings, targets), NULL},
    {"--seconds", "S", "stop after this time (default: when interrupted)", option_text,
     offsetof(struct settings, seconds), NULL},
    {"--arm", NULL, "arm as soon as the axes are homed", option_flag,
     offsetof(struct settings, arm), NULL},
    OPTION_JSON(struct settings),
};

static volatile sig_atomic_t interrupted;

static void interrupt(int number) {
    (void)number;
    interrupted = 1;
}

static uint64_t now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U;
}

static void sleep_until_us(uint64_t until_us) {
    const struct timespec until = {(time_t)(until_us / 1000000U),
                                   (long)(until_us % 1000000U * 1000U)};
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}

static void tell_mode(const struct command *command, struct run *run) {
    const struct controller *controller = &run->sim->controller;
    if (controller->mode == run->told_mode) {
        return;
    }
    run->told_mode = controller->mode;
    message_command(command->name, "%s%s%s", controller_mode_name(controller->mode),
                    controller->faults != 0U ? ": " : "",
                    controller->faults != 0U ? controller_fault_name(controller->faults) : "");
}

/// Is every powered axis at rest?
static bool stands_still(const struct controller *controller) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (controller->powered[axis] && !limiter_at_rest(&controller->limiter[axis])) {
            return false;
        }
    }
    return true;
}

static void take_targets(struct run *run, uint64_t elapsed_us) {
    struct target_update update;
    while (run->has_source && target_source_next(&run->source, elapsed_us, &update) &&
           sim_push(run->sim, &update)) {
        target_source_taken(&run->source);
    }
}

/// Ticks by the clock until the time is over, a signal comes or a fault ends it; then decelerates
/// and holds.
static enum exit_status drive(const struct command *command, struct run *run, uint64_t limit_us) {
    const uint64_t start_us = now_us(), tick_us = run->rig.controller.tick_us;
    bool stopping = false;
    for (uint64_t tick = 0;; tick++) {
        const uint64_t due_us = start_us + tick * tick_us;
        const uint64_t late_us = now_us() > due_us ? now_us() - due_us : 0U;
        run->late_ticks += late_us > tick_us;
        sleep_until_us(due_us);
        take_targets(run, tick * tick_us);
        if (!stopping && (interrupted != 0 || (limit_us != 0U && tick * tick_us >= limit_us))) {
            pump_command(&run->sim->pump, COMMAND_STOP);
            stopping = true;
        }
        sim_step(run->sim);
        tell_mode(command, run);
        const struct controller *controller = &run->sim->controller;
        const bool faulted = controller->mode == MODE_FAULTED;
        // A fault can't be cleared from here: once all stands still, the run is over.
        if ((faulted || (stopping && controller->mode != MODE_TRACKING)) &&
            stands_still(controller)) {
            return faulted ? EXIT_STATUS_SAFETY_STOP : EXIT_STATUS_OK;
        }
    }
}

static void print_summary(const struct settings *settings, struct run *run) {
    const struct sim_summary summary = sim_summarise(run->sim);
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_text(&facts, "build", build_id);
    facts_text(&facts, "mode", controller_mode_name(run->sim->controller.mode));
    facts_fixed(&facts, "seconds", summary.seconds, 3);
    facts_u64(&facts, "steps", summary.steps);
    facts_u64(&facts, "late_ticks", run->late_ticks);
    facts_u64(&facts, "targets", summary.targets);
    facts_u64(&facts, "bad_lines", run->has_source ? run->source.bad_lines : 0U);
    facts_u64(&facts, "updates_rejected", run->sim->controller.updates_rejected);
    facts_fixed(&facts, "aim_error_rms_deg", summary.aim_error_rms_deg, 5);
    facts_fixed(&facts, "settle_s", summary.settle_s, 3);
    facts_u64(&facts, "violations", sim_violation_count(&summary.violations));
    facts_end(&facts);
}

/// The devices that this build can't open. Told on stderr.
static bool devices_supported(const struct rig *rig) {
    static const char *const names[] = {"pan", "tilt", "zoom"};
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct drive_config *drive = &rig->controller.axis[axis].drive;
        const bool on_bus = drive->kind == DRIVE_RMD;
        const char *device = on_bus ? rig->bus[axis] : rig->device[axis];
        if (drive->kind != DRIVE_NONE && strcmp(device, "fake") != 0) {
            message_at(rig->ini.file, 0,
                       "%s: this build can't open '%s'; real devices come with the Linux rig, use "
                       "'%s = fake' until then",
                       names[axis], device, on_bus ? "bus" : "device");
            return false;
        }
    }
    return true;
}

static enum exit_status start(const struct command *command, const struct settings *settings,
                              uint64_t limit_us, struct run *run) {
    const bool on_board = run->rig.board_device != NULL;
    if (!on_board && !devices_supported(&run->rig)) {
        return EXIT_STATUS_DEVICE;
    }
    if (settings->targets != NULL) {
        run->has_source = target_source_open(&run->source, settings->targets);
        if (!run->has_source) {
            return EXIT_STATUS_USAGE;
        }
    }
    run->rig.controller.arm_on_start = run->rig.controller.arm_on_start || settings->arm;
    if (on_board) {
        const struct run_board_options board = {.source = run->has_source ? &run->source : NULL,
                                                .limit_us = limit_us,
                                                .arm = run->rig.controller.arm_on_start,
                                                .json = settings->json,
                                                .interrupted = &interrupted};
        return run_board(command, &run->rig, &board);
    }
    const struct sim_config config = {.controller = &run->rig.controller,
                                      .schedule = &run->schedule,
                                      .seed = 1,
                                      .fixed_focal_mm = run->rig.fixed_focal_mm};
    run->sim = sim_create(&config);
    if (run->sim == NULL) {
        message_command(command->name, "no memory for the simulated devices");
        return EXIT_STATUS_FAILURE;
    }
    run->told_mode = MODE_STARTING;
    const enum exit_status status = drive(command, run, limit_us);
    print_summary(settings, run);
    return status;
}

static enum exit_status run_command(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *file = NULL;
    size_t operands;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      &file, 1, &operands)) {
        return EXIT_STATUS_USAGE;
    }
    double seconds = 0.0;
    if (operands == 0U) {
        message_command(command->name, "which rig? give its file");
        return EXIT_STATUS_USAGE;
    }
    if (settings.seconds != NULL &&
        !option_positive(command->name, "--seconds", settings.seconds, &seconds)) {
        return EXIT_STATUS_USAGE;
    }
    struct run *run = calloc(1, sizeof *run);
    if (run == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    const struct sigaction action = {.sa_handler = interrupt};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    enum exit_status status = rig_read(file, 0, &run->rig);
    if (status == EXIT_STATUS_OK) {
        status = start(command, &settings, (uint64_t)(seconds * 1e6), run);
    }
    target_source_close(&run->source);
    sim_destroy(run->sim);
    rig_free(&run->rig);
    free(run);
    return status;
}

const struct command command_run = {
    .name = "run",
    .summary = "drive a rig toward targets, in real time",
    .operands = "RIG.ini",
    .help =
        "Homes the axes of the rig, arms them if asked to (--arm, or arm_on_start in the rig "
        "file)\n"
        "and follows the targets of a stream: JSON lines, from a pipe as they come, from a file "
        "at\n"
        "the times in it. SIGINT and SIGTERM: decelerate, hold, report, exit status 0. A fault\n"
        "does the same with exit status 5. A line that can't be read is named and skipped.\n"
        "With board = serial:DEVICE in [controller] a flashed board drives the rig, and this "
        "program\n"
        "sends it the targets. Without, this build opens fakes only (bus = fake, device = fake);\n"
        "real devices come with the Linux rig: exit status 4.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run_command,
};
