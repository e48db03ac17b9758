#include "serve.h"

#include "event_loop.h"
#include "facts.h"
#include "frame_out.h"
#include "state_line.h"
#include "target_source.h"

#include "linux/linux_can.h"
#include "linux/linux_clock.h"

#include <errno.h>
#include <string.h>

/// The simulation keeps up with the clock, but not with a gap: after a long one (a stopped process)
/// it goes on from where it was.
#define CATCH_UP_TICKS_MAX 1000U

/// What stands between the simulation and everything outside.
struct serving {
    const char *command;
    const struct serve_options *options;
    struct scenario *scenario;
    struct sim *sim;
    struct linux_clock clock;
    struct linux_can can;
    struct event_loop loop;
    struct target_source source;
    bool has_source;
    struct frame_out frames;
    bool has_frames;
    uint64_t frame_due_us, state_due_us, states_dropped;
};

static void aim_fact(struct facts *facts, const struct sim *sim) {
    const double error_deg = sim_observe(sim).error_deg;
    if (error_deg >= 0.0) {
        facts_fixed(facts, "aim_error_deg", error_deg, 4);
    } else {
        facts_null(facts, "aim_error_deg", "no targets");
    }
}

static void print_summary(const struct serving *serving) {
    const struct sim *sim = serving->sim;
    struct facts facts;
    facts_begin(&facts, stdout, serving->options->as_json);
    facts_fixed(&facts, "seconds", (double)sim->time_us * 1e-6, 3);
    facts_u64(&facts, "steps", sim->tick);
    facts_u64(&facts, "late_us_max", serving->loop.jitter.max);
    facts_u64(&facts, "frames_in", sim->served.frames_in);
    facts_u64(&facts, "frames_out", sim->served.frames_out);
    facts_u64(&facts, "frames_lost", sim->served.frames_lost);
    facts_fixed(&facts, "pan_deg", sim_joint_deg(sim, AXIS_PAN), 4);
    facts_fixed(&facts, "tilt_deg", sim_joint_deg(sim, AXIS_TILT), 4);
    aim_fact(&facts, sim);
    if (serving->has_frames) {
        facts_u64(&facts, "pictures", serving->frames.written);
        facts_u64(&facts, "pictures_dropped", serving->frames.dropped);
    }
    if (serving->options->state_s > 0.0) {
        facts_u64(&facts, "states_dropped", serving->states_dropped);
    }
    facts_u64(&facts, "violations", sim_violation_count(&sim->violations));
    facts_end(&facts);
}

static bool on_bus_only(const struct scenario *scenario) {
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        if (scenario->rig.controller.axis[axis].drive.kind != DRIVE_RMD) {
            message_at(scenario->rig.ini.file, 0,
                       "has a hobby servo for pan or tilt, which no bus reaches");
            return false;
        }
    }
    return true;
}

// ---------------------------------------------------------------- between the ticks

static void take_targets(struct serving *serving) {
    struct target_update update;
    while (serving->has_source &&
           target_source_next(&serving->source, serving->sim->time_us, &update) &&
           sim_push(serving->sim, &update)) {
        target_source_taken(&serving->source);
    }
}

static void write_state(const void *context, FILE *stream) {
    const struct sim *sim = context;
    struct facts facts;
    facts_begin(&facts, stream, true);
    facts_fixed(&facts, "t_s", (double)sim->time_us * 1e-6, 3);
    facts_fixed(&facts, "pan_deg", sim_joint_deg(sim, AXIS_PAN), 4);
    facts_fixed(&facts, "tilt_deg", sim_joint_deg(sim, AXIS_TILT), 4);
    facts_u64(&facts, "targets", sim->measure.truth.count);
    aim_fact(&facts, sim);
    facts_u64(&facts, "frames_in", sim->served.frames_in);
    facts_end(&facts);
}

static void print_state(struct serving *serving) {
    const double state_s = serving->options->state_s;
    if (state_s > 0.0 && serving->sim->time_us >= serving->state_due_us) {
        serving->state_due_us = serving->sim->time_us + (uint64_t)(state_s * 1e6);
        serving->states_dropped += state_line_print(write_state, serving->sim) ? 0U : 1U;
    }
}

/// False after a line on stderr.
static bool show_frame(struct serving *serving) {
    const struct sim *sim = serving->sim;
    struct frame_out *frames = &serving->frames;
    if (!serving->has_frames) {
        return true;
    }
    frame_out_tick(frames);
    if (sim->time_us < serving->frame_due_us) {
        return true;
    }
    serving->frame_due_us = sim->time_us + scenario_camera_period_us(&serving->scenario->camera);
    char truth[120];
    snprintf(truth, sizeof truth, "t_s %.3f pan_deg %.4f tilt_deg %.4f",
             (double)sim->time_us * 1e-6, sim_joint_deg(sim, AXIS_PAN),
             sim_joint_deg(sim, AXIS_TILT));
    if (!scenario_camera_draw(&serving->scenario->camera, sim, frames->picture) ||
        !frame_out_send(frames, truth)) {
        message_at(serving->options->frames, 0, "%s", strerror(errno));
        return false;
    }
    return true;
}

static enum exit_status loop_until(struct serving *serving) {
    struct sim *sim = serving->sim;
    const double seconds = serving->options->seconds;
    struct hal_can_state state;
    uint32_t raised = 0;
    while ((raised & EVENT_LOOP_END) == 0U &&
           (seconds <= 0.0 || (double)sim->time_us * 1e-6 < seconds)) {
        uint64_t due = event_loop_tick(&serving->loop, &raised);
        due = due > CATCH_UP_TICKS_MAX ? CATCH_UP_TICKS_MAX : due;
        take_targets(serving);
        for (uint64_t i = 0; i < due; i++) {
            sim_serve_step(sim, &serving->can.hal);
        }
        print_state(serving);
        if (!show_frame(serving)) {
            return EXIT_STATUS_FAILURE;
        }
        if (hal_can_state(&serving->can.hal, &state) == HAL_ERROR_GONE) {
            return EXIT_STATUS_DEVICE;
        }
    }
    return EXIT_STATUS_OK;
}

// ---------------------------------------------------------------- opening

static enum exit_status serve_until_end(struct serving *serving) {
    if (!event_loop_open(&serving->loop, serving->scenario->rig.controller.tick_us) ||
        serving->sim == NULL) {
        message_command(serving->command, "can't start: %s", strerror(errno));
        return EXIT_STATUS_FAILURE;
    }
    enum exit_status status = loop_until(serving);
    const struct sim_violations *violations = &serving->sim->violations;
    if (status == EXIT_STATUS_DEVICE) {
        message_command(serving->command, "%s", serving->can.error.line);
    } else if (sim_violation_count(violations) != 0U) {
        message_command(serving->command, "invariant violated at %.3f s: %s",
                        (double)violations->first_us * 1e-6, violations->first);
        status = EXIT_STATUS_FAILURE;
    }
    print_summary(serving);
    return status;
}

/// Is what the options ask for there? Tells what is not.
static enum exit_status open_all(struct serving *serving) {
    const struct serve_options *options = serving->options;
    struct scenario *scenario = serving->scenario;
    const struct camera_model *lens = &scenario->rig.eye.model;
    if (options->frames != NULL && !scenario->has_camera) {
        message_at(scenario->ini.file, 0, "has no [camera], which --frames needs");
        return EXIT_STATUS_USAGE;
    }
    if (options->targets != NULL) {
        serving->has_source = target_source_open(&serving->source, options->targets);
        if (!serving->has_source) {
            return EXIT_STATUS_USAGE;
        }
    }
    if (options->frames != NULL) {
        serving->has_frames =
            frame_out_open(&serving->frames, options->frames, lens->width_px, lens->height_px);
        if (!serving->has_frames) {
            return EXIT_STATUS_FAILURE;
        }
    }
    linux_clock_open(&serving->clock, 0);
    if (linux_can_open(&serving->can, options->bus + 4, &serving->clock.hal) != HAL_OK) {
        message_command(serving->command, "%s", serving->can.error.line);
        return EXIT_STATUS_DEVICE;
    }
    return EXIT_STATUS_OK;
}

enum exit_status serve_drives(const char *command, struct scenario *scenario,
                              const struct serve_options *options) {
    static struct serving serving;
    if (strncmp(options->bus, "can:", 4) != 0) {
        message_command(command, "--serve '%s': give can:NAME, as can:vcan0", options->bus);
        return EXIT_STATUS_USAGE;
    }
    if (!on_bus_only(scenario)) {
        return EXIT_STATUS_USAGE;
    }
    serving = (struct serving){.command = command,
                               .options = options,
                               .scenario = scenario,
                               .can = {.fd = -1, .error_fd = -1},
                               .loop = {.epoll = -1, .timer = -1, .signals = -1}};
    enum exit_status status = open_all(&serving);
    if (status == EXIT_STATUS_OK) {
        scenario->sim.obstacles = NULL; // what is drawn has none
        serving.sim = sim_create(&scenario->sim);
        status = serve_until_end(&serving);
    }
    event_loop_close(&serving.loop);
    sim_destroy(serving.sim);
    linux_can_close(&serving.can);
    target_source_close(&serving.source);
    frame_out_close(&serving.frames);
    return status;
}
