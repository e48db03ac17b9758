/// `boresight run`: drives a rig in real time.
#include "facts.h"
#include "run_board.h"
#include "runner.h"
#include "runner_state.h"

#include <stdlib.h>

extern const char build_id[];

struct settings {
    const char *targets, *seconds, *state, *log, *scene;
    bool arm, stay, json;
};

static const struct option options[] = {
    {"--targets", "FILE|-", "target stream, JSON lines (default: none)", option_text,
     offsetof(struct settings, targets), NULL},
    {"--scene", "FILE", "its solids hide targets, instead of the scene that the rig file names",
     option_text, offsetof(struct settings, scene), NULL},
    {"--seconds", "S", "stop after this time (default: when interrupted)", option_text,
     offsetof(struct settings, seconds), NULL},
    {"--state", "S", "print a line of JSON every S seconds: where the rig is", option_text,
     offsetof(struct settings, state), NULL},
    {"--arm", NULL, "arm as soon as the axes are homed", option_flag,
     offsetof(struct settings, arm), NULL},
    {"--stay", NULL, "wait for missing devices, hold after a fault or a loss; SIGUSR1 re-arms",
     option_flag, offsetof(struct settings, stay), NULL},
    {"--log", "FILE|journal", "append events to a file (JSON lines) or to the system's journal",
     option_text, offsetof(struct settings, log), NULL},
    OPTION_JSON(struct settings),
};

/// What only the simulator knows, or only real devices have.
static void add_by_kind(struct facts *facts, struct runner *runner) {
    if (runner->sim != NULL) {
        const struct sim_summary summary = sim_summarise(runner->sim);
        facts_u64(facts, "targets", summary.targets);
        facts_fixed(facts, "aim_error_rms_deg", summary.aim_error_rms_deg, 5);
        facts_fixed(facts, "settle_s", summary.settle_s, 3);
        facts_u64(facts, "violations", sim_violation_count(&summary.violations));
        return;
    }
    const struct pump_errors *errors = &runner->pump->errors;
    facts_u64(facts, "targets", runner->pump->output.status.target_count);
    const struct rig_buses *buses = &runner->devices.buses;
    facts_u64(facts, "can_send_failed", errors->can_send_failed + buses->dropped);
    facts_u64(facts, "can_receive_failed", errors->can_receive_failed);
    facts_u64(facts, "can_frames_lost", buses->frames_lost);
    facts_u64(facts, "can_offs", buses->offs);
    facts_u64(facts, "can_restarts", buses->restarts);
    facts_u64(facts, "pwm_failed", errors->pwm_failed);
    const struct linux_jitter edges = rig_devices_jitter(&runner->devices);
    if (edges.count != 0U) {
        facts_fixed(facts, "edge_late_us_p50", (double)linux_jitter_quantile(&edges, 500) * 1e-3,
                    1);
        facts_fixed(facts, "edge_late_us_p99", (double)linux_jitter_quantile(&edges, 990) * 1e-3,
                    1);
        facts_fixed(facts, "edge_late_us_max", (double)edges.max * 1e-3, 1);
    }
    facts_bool(facts, "realtime_priority", runner->realtime.priority);
    facts_bool(facts, "locked_memory", runner->realtime.memory);
}

static double hidden_percent(const struct runner *runner) {
    return runner->hiding == NULL ? 0.0
           : runner->sim != NULL  ? sim_hidden_percent(&runner->sim->occlusion)
                                  : sim_hidden_percent(&runner->hiding->occlusion);
}

static void print_summary(const struct settings *settings, struct runner *runner) {
    const struct linux_jitter *jitter = &runner->loop.jitter;
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_text(&facts, "build", build_id);
    facts_text(&facts, "mode", controller_mode_name(runner->controller->mode));
    facts_fixed(&facts, "seconds", (double)(runner->loop.ticks * runner->loop.tick_us) * 1e-6, 3);
    facts_u64(&facts, "steps", runner->steps);
    facts_u64(&facts, "missed_ticks", runner->loop.missed_ticks);
    facts_u64(&facts, "late_us_p50", linux_jitter_quantile(jitter, 500));
    facts_u64(&facts, "late_us_p99", linux_jitter_quantile(jitter, 990));
    facts_u64(&facts, "late_us_p999", linux_jitter_quantile(jitter, 999));
    facts_u64(&facts, "late_us_max", jitter->max);
    runner_state_joints(runner, &facts);
    runner_state_servos(runner, &facts);
    facts_u64(&facts, "bad_lines", runner->has_source ? runner->source.bad_lines : 0U);
    facts_u64(&facts, "updates_rejected", runner->controller->updates_rejected);
    facts_u64(&facts, "reloads", runner->reloads);
    facts_fixed(&facts, "hidden_percent", hidden_percent(runner), 2);
    facts_u64(&facts, "log_dropped", run_log_dropped(&runner->log));
    if (runner->settings.state_us != 0U) {
        facts_u64(&facts, "states_dropped", runner->states_dropped);
    }
    camera_source_facts(&runner->camera, &facts);
    add_by_kind(&facts, runner);
    facts_end(&facts);
}

// ---------------------------------------------------------------- who controls the rig

/// A flashed board does.
static enum exit_status drive_board(const struct command *command, const struct settings *settings,
                                    const struct rig *rig, uint64_t limit_us, uint64_t state_us) {
    struct target_source *source = calloc(1, sizeof *source);
    if (source == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    enum exit_status status = EXIT_STATUS_USAGE;
    if (settings->targets == NULL || target_source_open(source, settings->targets)) {
        const struct run_board_options board = {
            .source = settings->targets != NULL ? source : NULL,
            .scene = settings->scene != NULL ? settings->scene : rig->scene,
            .limit_us = limit_us,
            .state_us = state_us,
            .log = settings->log,
            .arm = rig->controller.arm_on_start || settings->arm,
            .json = settings->json,
            .stay = settings->stay};
        status = run_board(command, rig, &board);
        target_source_close(source);
    }
    free(source);
    return status;
}

/// This program does.
static enum exit_status drive_devices(const struct command *command,
                                      const struct settings *settings, const char *file,
                                      uint64_t limit_us, uint64_t state_us) {
    struct runner *runner = calloc(1, sizeof *runner);
    if (runner == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    const struct runner_settings running = {.command = command->name,
                                            .rig_file = file,
                                            .targets = settings->targets,
                                            .log = settings->log,
                                            .scene = settings->scene,
                                            .limit_us = limit_us,
                                            .state_us = state_us,
                                            .arm = settings->arm,
                                            .stay = settings->stay,
                                            .wait = settings->stay};
    const enum exit_status status = runner_run(runner, &running);
    if (runner->steps > 0U && runner->controller != NULL) {
        print_summary(settings, runner);
    }
    runner_close(runner);
    free(runner);
    return status;
}

static enum exit_status run_command(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *file = NULL;
    double seconds = 0.0, state_s = 0.0;
    if (!options_read_file(command->name, command->options, command->option_count, argc, argv,
                           &settings, "rig", &file) ||
        (settings.seconds != NULL &&
         !option_positive(command->name, "--seconds", settings.seconds, &seconds)) ||
        (settings.state != NULL &&
         !option_positive(command->name, "--state", settings.state, &state_s))) {
        return EXIT_STATUS_USAGE;
    }
    struct rig rig;
    enum exit_status status = rig_read(file, 0, &rig);
    if (status == EXIT_STATUS_OK) {
        const uint64_t limit_us = (uint64_t)(seconds * 1e6), state_us = (uint64_t)(state_s * 1e6);
        status = rig.board_device != NULL
                     ? drive_board(command, &settings, &rig, limit_us, state_us)
                     : drive_devices(command, &settings, file, limit_us, state_us);
    }
    rig_free(&rig);
    return status;
}

const struct command command_run = {
    .name = "run",
    .summary = "drive a rig toward targets, in real time",
    .operands = "RIG.ini",
    .help =
        "Homes the axes of the rig, arms them if asked to (--arm, or arm_on_start in the rig\n"
        "file) and follows the targets of a stream: JSON lines, from a pipe as they come, from a\n"
        "file at the times in it. A line that can't be read is named and skipped.\n\n"
        "SIGINT, SIGTERM: decelerate, hold, report, exit status 0. SIGHUP: come to rest and start\n"
        "anew with the rig file as it is then. A fault ends the run with exit status 5, a device\n"
        "that is missing or leaves with 4. With --stay the rig waits at the start until all is\n"
        "there, holds when something leaves, opens it again when it is back, and SIGUSR1 arms\n"
        "it.\n\n"
        "With device = ... in [camera] the targets are what the detectors find in the frames of\n"
        "that camera, besides those of the stream.\n\n"
        "With --scene, or scene = FILE in [occlusion], targets hidden behind the solids and\n"
        "faces of that scene do not count, or count less, as policy = ... in [occlusion]\n"
        "has it.\n\n"
        "With board = serial:DEVICE in [controller] a flashed board drives the rig, and this\n"
        "program sends it the targets.\n\n"
        "A rig whose devices are all fakes is simulated in real time. Real devices get real-time\n"
        "priority and locked memory where this user may have them.\n\n"
        "results:\n"
        "  late_us_*      how late the ticks came: half of them at most, 99 %, 99.9 %, the latest\n"
        "  edge_late_us_* the same of servo pulses and steps that come from GPIO lines\n"
        "  missed_ticks   due while an earlier one was worked on\n"
        "  hidden_percent of all looks at targets, how many found one hidden as a whole\n"
        "  pan_deg ...    where the axes are\n"
        "  camera_*       frames that came, that were lost on the way (by their numbers)\n"
        "  detected_*     frames that were looked at; those that were not, because the one before\n"
        "                 was still worked on or their pose is not known; updates of targets\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run_command,
};
