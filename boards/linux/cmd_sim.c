/// `boresight sim`: a scenario in the simulator.
#include "capacity.h"
#include "command.h"
#include "emulator.h"
#include "event_loop.h"
#include "facts.h"
#include "make_folder.h"
#include "replay.h"
#include "scenario.h"
#include "serve.h"

#include "view/progress.h"
#include "view/report.h"
#include "view/story.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

extern const char build_id[];

struct settings {
    uint64_t seed;
    const char *seconds_text, *speed_text, *report, *record, *replay;
    const char *serve, *frames, *targets, *state_text; ///< the latter ones belong to --serve
    struct emulator_options mcu;
    double seconds, speed; ///< speed 0: as fast as it goes
    double state_s;
    bool has_seed, json, quiet;
};

enum { RUNS_MOST = 16 };

/// A scenario, and its chapter of the report.
struct run {
    struct scenario scenario;
    struct sim *sim;
    struct story story;
    struct progress progress;
    struct recorder recorder;
    void *board;  ///< of the emulator; NULL: the controller runs here
    bool watched; ///< progress is told
    struct capacity capacity;
    uint64_t exceeded_us; ///< when
    double wall_s;
};

static const char *option_seed(const struct option *option, const char *text, void *place) {
    struct settings *settings =
        (struct settings *)((char *)place - offsetof(struct settings, seed));
    settings->has_seed = true;
    return option_u64(option, text, place);
}

static const struct option options[] = {
    {"--seed", "N", "seed of everything random (default: the scenario's)", option_seed,
     offsetof(struct settings, seed), NULL},
    {"--seconds", "S", "how long (default: the scenario's)", option_text,
     offsetof(struct settings, seconds_text), NULL},
    {"--speed", "X|max", "times as fast as the clock, or as fast as it goes (default: max)",
     option_text, offsetof(struct settings, speed_text), NULL},
    {"--report", "DIR", "write DIR/report.html with plots and pictures, and the pictures alone",
     option_text, offsetof(struct settings, report), NULL},
    {"--record", "FILE", "write every input of the controller, for --replay", option_text,
     offsetof(struct settings, record), NULL},
    {"--replay", "FILE", "no scenario: do the controller's outputs match a recording's?",
     option_text, offsetof(struct settings, replay), NULL},
    {"--mcu", "IMAGE.elf", "run this image in an emulated STM32F405 instead of the controller here",
     option_text, offsetof(struct settings, mcu.image), NULL},
    {"--mcu-faults", "LIST", "faults of the board, as in can-short@2.5,pan-silent@3 (seconds)",
     option_text, offsetof(struct settings, mcu.faults), NULL},
    {"--mcu-console", "FILE", "write what the board says on its serial line; - is stderr",
     option_text, offsetof(struct settings, mcu.console), NULL},
    {"--mcu-serial", "LINK",
     "make LINK a terminal at the board's serial line, or use that port; with --speed 1",
     option_text, offsetof(struct settings, mcu.serial), NULL},
    {"--serve", "can:NAME",
     "put the scenario's drives on a CAN interface, for a controller elsewhere", option_text,
     offsetof(struct settings, serve), NULL},
    {"--frames", "PATH",
     "with --serve: what the camera sees, as PGM: a file of the newest picture, or a pipe",
     option_text, offsetof(struct settings, frames), NULL},
    {"--targets", "FILE|-", "with --serve: a target stream, besides the scenario's targets",
     option_text, offsetof(struct settings, targets), NULL},
    {"--state", "S", "with --serve: print a line of JSON every S seconds: the truth", option_text,
     offsetof(struct settings, state_text), NULL},
    {"--quiet", NULL, "no progress on stderr", option_flag, offsetof(struct settings, quiet), NULL},
    OPTION_JSON(struct settings),
};

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void tell_subject(void *context, const struct story_line *line) {
    struct run *run = context;
    const char *noun = run->scenario.schedule.noun;
    const struct progress_subject subject = {.name = line->name,
                                             .count = line->target_count,
                                             .noun = noun != NULL ? noun : "targets",
                                             .pan_deg = line->pan_deg,
                                             .tilt_deg = line->tilt_deg,
                                             .half_angle_deg = line->half_angle_deg,
                                             .focal_mm = line->focal_mm,
                                             .settled_s = line->settle_s,
                                             .error_deg = line->error_deg};
    progress_subject(&run->progress, &subject);
}

/// Now and then: where the run is.
static void show_status(struct run *run) {
    const struct sim *sim = run->sim;
    if (sim->tick % 256U == 0U) {
        char text[80];
        snprintf(text, sizeof text, "%.1f s, %s", (double)sim->time_us * 1e-6,
                 controller_mode_name(sim->controller.mode));
        progress_status(&run->progress, (double)sim->time_us / (double)run->scenario.duration_us,
                        text);
    }
}

/// Waits until the clock has reached the simulation, at the speed asked for.
static void keep_pace(const struct sim *sim, double start_s, double speed) {
    const double ahead = (double)sim->time_us * 1e-6 / speed - (now_s() - start_s);
    if (ahead > 0.002) {
        const struct timespec nap = {(time_t)ahead, (long)((ahead - (double)(time_t)ahead) * 1e9)};
        (void)nanosleep(&nap, NULL);
    }
}

static void run_sim(struct run *run, double speed) {
    const double start_s = now_s();
    while (run->sim->time_us < run->scenario.duration_us) {
        sim_step(run->sim);
        if (capacity_exceeded(&run->capacity, &run->sim->pump.output.status)) {
            run->exceeded_us = run->sim->time_us;
        }
        story_step(&run->story);
        if (run->watched) {
            show_status(run);
        }
        if (speed > 0.0) {
            keep_pace(run->sim, start_s, speed);
        }
    }
    run->wall_s = now_s() - start_s;
    if (run->watched) {
        progress_end(&run->progress);
    }
}

// ---------------------------------------------------------------- results

__attribute__((format(printf, 3, 4))) static void add_fact(struct story *story, const char *name,
                                                           const char *format, ...) {
    char value[96];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(value, sizeof value, format, arguments);
    va_end(arguments);
    story->complete = report_add_fact(&story->report, name, value) && story->complete;
}

static void add_facts(struct run *run, const struct sim_summary *summary) {
    struct story *story = &run->story;
    add_fact(story, "simulated time", "%.1f s in %.2f s", summary->seconds, run->wall_s);
    add_fact(story, "targets at a time", "up to %u", summary->targets);
    add_fact(story, "aim error, settled", "rms %.4f deg, 99 %% below %.4f deg",
             summary->aim_error_rms_deg, summary->aim_error_p99_deg);
    add_fact(story, "time to settle", "%.2f s, mean of %" PRIu64, summary->settle_s,
             summary->settle_count);
    add_fact(story, "targets in the picture", "%.1f %% of the time", summary->in_frame_percent);
    add_fact(story, "load of the CAN bus", "%.1f %%", summary->bus_load_percent);
    add_fact(story, "violated invariants", "%" PRIu64, sim_violation_count(&summary->violations));
    add_fact(story, "trace hash", "%016" PRIx64, summary->trace_hash);
    add_fact(story, "seed", "%" PRIu64, run->scenario.sim.seed);
}

static void print_summary(const struct settings *settings, const struct run *run,
                          const struct sim_summary *summary) {
    char hash[17];
    snprintf(hash, sizeof hash, "%016" PRIx64, summary->trace_hash);
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_text(&facts, "scenario", run->scenario.name);
    facts_text(&facts, "build", build_id);
    facts_fixed(&facts, "seconds", summary->seconds, 3);
    facts_u64(&facts, "targets", summary->targets);
    facts_u64(&facts, "steps", summary->steps);
    facts_u64(&facts, "seed", run->scenario.sim.seed);
    facts_text(&facts, "trace_hash", hash);
    facts_fixed(&facts, "aim_error_rms_deg", summary->aim_error_rms_deg, 5);
    facts_fixed(&facts, "aim_error_p99_deg", summary->aim_error_p99_deg, 5);
    facts_fixed(&facts, "aim_error_max_deg", summary->aim_error_max_deg, 5);
    facts_fixed(&facts, "in_frame_percent", summary->in_frame_percent, 2);
    facts_fixed(&facts, "hidden_percent", summary->hidden_percent, 2);
    facts_fixed(&facts, "settle_s", summary->settle_s, 3);
    facts_fixed(&facts, "bus_load_percent", summary->bus_load_percent, 2);
    facts_u64(&facts, "faults_injected",
              run->board != NULL ? emulator->faults_injected(run->board) : 0U);
    facts_u64(&facts, "violations", sim_violation_count(&summary->violations));
    facts_text(&facts, "mode", controller_mode_name(run->sim->controller.mode));
    facts_fixed(&facts, "times_real_time", run->wall_s > 0.0 ? summary->seconds / run->wall_s : 0.0,
                0);
    if (run->board != NULL) {
        emulator->facts(run->board, &facts);
    }
    facts_end(&facts);
}

/// Prints what the run gave; a violated invariant is a failure.
static enum exit_status conclude(const struct command *command, const struct settings *settings,
                                 struct run *run) {
    const struct sim_summary summary = sim_summarise(run->sim);
    add_facts(run, &summary);
    print_summary(settings, run, &summary);
    if (!recorder_close(&run->recorder)) {
        message_at(settings->record, 0, "%s", strerror(errno));
        return EXIT_STATUS_FAILURE;
    }
    if (run->capacity.told) {
        message_command(command->name, "at %.3f s " CAPACITY_MESSAGE,
                        (double)run->exceeded_us * 1e-6, TARGET_CAPACITY);
        return EXIT_STATUS_USAGE;
    }
    if (sim_violation_count(&summary.violations) == 0U) {
        return run->board == NULL || emulator->is_sound(run->board) ? EXIT_STATUS_OK
                                                                    : EXIT_STATUS_FAILURE;
    }
    message_command(command->name, "invariant violated at %.3f s: %s",
                    (double)summary.violations.first_us * 1e-6, summary.violations.first);
    return EXIT_STATUS_FAILURE;
}

/// What the options add to a scenario: another length and seed, a recording, a board.
static enum exit_status apply(const struct settings *settings, struct run *run) {
    struct sim_config *sim = &run->scenario.sim;
    if (settings->seconds_text != NULL) {
        run->scenario.duration_us = (uint64_t)(settings->seconds * 1e6);
    }
    if (settings->has_seed) {
        sim->seed = settings->seed;
        run->scenario.camera.stage.seed = settings->seed;
    }
    if (settings->record != NULL) {
        if (!recorder_open(&run->recorder, settings->record)) {
            message_at(settings->record, 0, "%s", strerror(errno));
            return EXIT_STATUS_FAILURE;
        }
        sim->recorder = &run->recorder;
    }
    return settings->mcu.image != NULL
               ? emulator->open(&settings->mcu, sim->controller, &sim->board, &run->board)
               : EXIT_STATUS_OK;
}

static enum exit_status simulate(const struct command *command, const struct settings *settings,
                                 const char *file, struct run *run) {
    enum exit_status status = scenario_read(file, &run->scenario);
    if (status == EXIT_STATUS_OK) {
        status = apply(settings, run);
    }
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    run->sim = sim_create(&run->scenario.sim);
    if (run->sim == NULL || !story_begin(&run->story, run->sim, run->scenario.name, build_id,
                                         run->scenario.duration_us, settings->report != NULL)) {
        message_command(command->name, "no memory for the simulation");
        return EXIT_STATUS_FAILURE;
    }
    run->watched = !settings->quiet && !settings->json;
    if (run->watched) {
        progress_start(&run->progress, stderr, stderr);
        run->progress.name_columns = 12;
        progress_line(&run->progress, run->scenario.name);
        run->story.tell = tell_subject;
        run->story.tell_context = run;
    }
    run_sim(run, settings->speed);
    return conclude(command, settings, run);
}

/// DIR/1-03-Aur.svg: the third picture of the first chapter. Letters and digits of its title only.
static bool write_picture(const char *folder, size_t chapter, size_t number,
                          const struct report_picture *picture) {
    char name[32], path[4096];
    size_t size = 0;
    for (const char *at = picture->title; *at != '\0' && size + 1U < sizeof name; at++) {
        if (isalnum((unsigned char)*at)) {
            name[size++] = *at;
        }
    }
    name[size] = '\0';
    snprintf(path, sizeof path, "%s/%zu-%02zu-%s.svg", folder, chapter + 1U, number + 1U, name);
    return report_picture_svg(picture, path);
}

static enum exit_status write_report(const struct command *command, const char *folder,
                                     const struct run *runs, size_t count) {
    const struct report *chapters[RUNS_MOST];
    char path[4096];
    snprintf(path, sizeof path, "%s/report.html", folder);
    bool complete = true, written = make_folder(folder);
    for (size_t i = 0; i < count; i++) {
        chapters[i] = &runs[i].story.report;
        complete = complete && runs[i].story.complete;
        for (size_t k = 0; written && k < chapters[i]->picture_count; k++) {
            written = write_picture(folder, i, k, &chapters[i]->pictures[k]);
        }
    }
    if (!complete) {
        message_command(command->name, "no memory for the whole report");
    } else if (!written || !report_write(chapters, count, path)) {
        message_at(path, 0, "%s", strerror(errno));
    } else {
        return EXIT_STATUS_OK;
    }
    return EXIT_STATUS_FAILURE;
}

/// Runs the scenarios one after the other; stops at the first that fails.
static enum exit_status simulate_all(const struct command *command, const struct settings *settings,
                                     const char *const *files, size_t count) {
    struct run *runs = calloc(count, sizeof *runs);
    if (runs == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    enum exit_status status = EXIT_STATUS_OK;
    size_t done = 0;
    while (done < count && status == EXIT_STATUS_OK) {
        status = simulate(command, settings, files[done], &runs[done]);
        done++;
    }
    const bool all_ran = done == count && runs[count - 1U].sim != NULL;
    if (settings->report != NULL &&
        all_ran) { // also when an invariant was violated: it shows where
        const enum exit_status written = write_report(command, settings->report, runs, count);
        status = status == EXIT_STATUS_OK ? written : status;
    }
    for (size_t i = 0; i < done; i++) {
        story_end(&runs[i].story);
        sim_destroy(runs[i].sim);
        (void)recorder_close(&runs[i].recorder);
        if (runs[i].board != NULL) {
            emulator->close(runs[i].board);
        }
        scenario_free(&runs[i].scenario);
    }
    free(runs);
    return status;
}

/// One scenario's drives on a bus, until interrupted or for --seconds.
static enum exit_status serve(const struct command *command, const struct settings *settings,
                              const char *file) {
    struct scenario *scenario = calloc(1, sizeof *scenario);
    if (scenario == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    event_loop_block_signals(); // a camera has a thread
    enum exit_status status = scenario_read(file, scenario);
    if (status == EXIT_STATUS_OK) {
        scenario->sim.seed = settings->has_seed ? settings->seed : scenario->sim.seed;
        scenario->camera.stage.seed = settings->has_seed ? settings->seed : scenario->sim.seed;
        status = serve_drives(command->name, scenario,
                              &(struct serve_options){.bus = settings->serve,
                                                      .frames = settings->frames,
                                                      .targets = settings->targets,
                                                      .seconds = settings->seconds,
                                                      .state_s = settings->state_s,
                                                      .as_json = settings->json});
    }
    scenario_free(scenario);
    free(scenario);
    return status;
}

static enum exit_status run_command(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *files[RUNS_MOST];
    size_t count;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      files, RUNS_MOST, &count)) {
        return EXIT_STATUS_USAGE;
    }
    if ((count == 0U) != (settings.replay != NULL)) {
        message_command(command->name, count == 0U ? "which scenario? give its file"
                                                   : "--replay takes no scenario");
        return EXIT_STATUS_USAGE;
    }
    if (settings.replay != NULL) {
        return replay_file(command, settings.replay, settings.json);
    }
    if (settings.mcu.image == NULL &&
        (settings.mcu.faults != NULL || settings.mcu.console != NULL ||
         settings.mcu.serial != NULL)) {
        message_command(command->name,
                        "--mcu-faults, --mcu-console and --mcu-serial belong to --mcu");
        return EXIT_STATUS_USAGE;
    }
    if (settings.record != NULL && count != 1U) {
        message_command(command->name, "--record takes one scenario");
        return EXIT_STATUS_USAGE;
    }
    if (settings.mcu.image != NULL && emulator == NULL) {
        return emulator_run_program(command->name, argc, argv);
    }
    const bool limited = settings.speed_text != NULL && strcmp(settings.speed_text, "max") != 0;
    if ((settings.seconds_text != NULL &&
         !option_positive(command->name, "--seconds", settings.seconds_text, &settings.seconds)) ||
        (limited &&
         !option_positive(command->name, "--speed", settings.speed_text, &settings.speed)) ||
        (settings.state_text != NULL &&
         !option_positive(command->name, "--state", settings.state_text, &settings.state_s))) {
        return EXIT_STATUS_USAGE;
    }
    if (settings.serve != NULL) {
        if (count != 1U || limited || settings.report != NULL) {
            message_command(command->name,
                            "--serve takes one scenario, and no --speed and no --report");
            return EXIT_STATUS_USAGE;
        }
        return serve(command, &settings, files[0]);
    }
    if (settings.frames != NULL || settings.targets != NULL || settings.state_text != NULL) {
        message_command(command->name, "--frames, --targets and --state belong to --serve");
        return EXIT_STATUS_USAGE;
    }
    return simulate_all(command, &settings, files, count);
}

const struct command command_sim = {
    .name = "sim",
    .summary = "run a scenario in the simulator",
    .operands = "SCENARIO.ini...",
    .help =
        "Runs the firmware's controller on a simulated gimbal, in virtual time, and prints a\n"
        "summary. The same seed gives the same trace hash. Exit status 1: an invariant of\n"
        "docs/safety.md was violated.\n\n"
        "results:\n"
        "  trace_hash         of every frame, pulse and plant state of every tick\n"
        "  aim_error_*_deg    between camera and optimal axis, once the aim has settled (below\n"
        "                     0.25 degree) and until it jumps by more than 5 degrees\n"
        "  in_frame_percent   of all targets at all times while tracking\n"
        "  hidden_percent     of all looks at what hides targets, how many found one hidden\n"
        "  settle_s           mean time from a jump of the aim until it has settled\n"
        "  times_real_time    simulated time by elapsed time\n\n"
        "With --serve no controller runs here: the scenario's drives and their physics sit on a\n"
        "CAN interface, in real time, and answer whoever speaks to them ('boresight run' with\n"
        "'bus = can:NAME'). SIGINT ends it; pan_deg and tilt_deg are where the axes really are,\n"
        "aim_error_deg how far the camera looks past the axis that is best for the targets as\n"
        "they really are. With --frames the camera of the scenario's [camera] sees them.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run_command,
};
