#include "runner_private.h"

#include "degrees.h"

#include <stdarg.h>
#include <string.h>

void runner_tell(struct runner *runner, bool severe, const char *event, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    run_log_tell(&runner->log, runner->settings.command, severe, event, text);
}

// ---------------------------------------------------------------- the rig

enum exit_status runner_read_hiding(const struct runner *runner, const struct rig *rig,
                                    struct occlusion_rig **out) {
    const struct runner_settings *const settings = &runner->settings;
    const char *const scene = settings->see_through     ? NULL
                              : settings->scene != NULL ? settings->scene
                                                        : rig->scene;
    return occlusion_rig_open(scene, &rig->occlusion, rig->controller.position_um,
                              rig->controller.target_expiry_us, out);
}

static enum exit_status build_fakes(struct runner *runner) {
    if (runner->hiding != NULL) { // in the simulator it stands where it is, too
        runner->obstacles =
            (struct sim_obstacles){.occlusion = runner->hiding->config, .group_count = 1};
    }
    // Where the settings allow an axis to be, which 0 need not be.
    const struct controller_axis_config *axis = runner->rig.controller.axis;
    const struct sim_config config = {
        .controller = &runner->rig.controller,
        .start_deg = {degrees(axis[AXIS_PAN].home_q48), degrees(axis[AXIS_TILT].home_q48)},
        .schedule = &runner->schedule,
        .seed = 1,
        .obstacles = runner->hiding != NULL ? &runner->obstacles : NULL,
        .fixed_focal_mm = runner->rig.fixed_focal_mm};
    runner->sim = sim_create(&config);
    if (runner->sim == NULL) {
        message_command(runner->settings.command, "no memory for the simulated devices");
        return EXIT_STATUS_FAILURE;
    }
    runner->controller = &runner->sim->controller;
    runner->pump = &runner->sim->pump;
    return EXIT_STATUS_OK;
}

static enum exit_status build_devices(struct runner *runner) {
    const enum exit_status status = rig_devices_open(&runner->devices, &runner->rig);
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    runner->devices_open = true;
    runner->controller = &runner->real_controller;
    runner->pump = &runner->real_pump;
    if (!controller_init(runner->controller, &runner->rig.controller) ||
        !pump_init(runner->pump, runner->controller, &runner->devices.pump)) {
        message_at(runner->rig.ini.file, 0, "the controller can't work with these settings");
        return EXIT_STATUS_USAGE;
    }
    if (runner->hiding != NULL) {
        pump_occlusion_attach(&runner->hiding->hiding, runner->pump, &runner->hiding->occlusion,
                              true);
    }
    return EXIT_STATUS_OK;
}

static bool has_fake_camera(const struct rig *rig) {
    struct stage_camera_address address;
    return stage_camera_parse(rig->camera.device, &address);
}

/// Does time pass as fast as it can? A real camera would not keep up.
bool runner_is_hurried(const struct runner *runner) {
    return runner->settings.hurry && runner->sim != NULL &&
           (runner->rig.camera.device[0] == '\0' || has_fake_camera(&runner->rig));
}

/// What a device that can't be opened said, for whoever tells it.
static enum exit_status refused(struct runner *runner, enum exit_status status, const char *why) {
    if (status == EXIT_STATUS_DEVICE) {
        memcpy(runner->refusal, why, sizeof runner->refusal);
    }
    return status;
}

enum exit_status runner_build(struct runner *runner) {
    runner->rig.controller.arm_on_start =
        runner->rig.controller.arm_on_start || runner->settings.arm;
    runner->told_mode = MODE_STARTING;
    runner->told_faults = 0;
    memset(runner->told_silent, 0, sizeof runner->told_silent);
    memset(runner->outside, 0, sizeof runner->outside);
    runner->capacity = (struct capacity){0};
    runner->starting_since_us = event_loop_now_us();
    const enum exit_status status = rig_lines_open(&runner->lines, &runner->rig);
    if (status != EXIT_STATUS_OK) {
        return refused(runner, status, runner->lines.gpio.error.line);
    }
    const enum exit_status built =
        rig_is_fake(&runner->rig) ? build_fakes(runner) : build_devices(runner);
    if (built != EXIT_STATUS_OK) {
        return refused(runner, built, runner->devices.error.line);
    }
    // What is simulated has the simulator's time, and a real camera the computer's.
    const struct hal_clock *clock = runner->sim != NULL && has_fake_camera(&runner->rig)
                                        ? &runner->sim->clock
                                        : &runner->clock.hal;
    const enum exit_status seen =
        camera_source_open(&runner->camera, &runner->rig, clock, runner_is_hurried(runner));
    return refused(runner, seen, runner->camera.news);
}

void runner_dismantle(struct runner *runner) {
    camera_source_close(&runner->camera);
    rig_lines_close(&runner->lines);
    if (runner->devices_open) {
        rig_devices_close(&runner->devices);
        runner->devices_open = false;
    }
    sim_destroy(runner->sim);
    runner->sim = NULL;
    runner->controller = NULL;
    runner->pump = NULL;
}

// ---------------------------------------------------------------- another rig file

/// The file's [camera] as it is in use.
static const struct rig *camera_rig(const struct runner *runner) {
    return runner->camera_reloads == 0U ? &runner->rig
                                        : &runner->camera_rig[(runner->camera_reloads - 1U) % 2U];
}

void runner_forget_camera_rigs(struct runner *runner) {
    rig_free(&runner->camera_rig[0]);
    rig_free(&runner->camera_rig[1]);
    runner->camera_reloads = 0;
}

/// What of [camera] the controller goes by.
static bool same_optics(const struct rig *a, const struct rig *b) {
    const struct lens_config *x = &a->controller.lens, *y = &b->controller.lens;
    return x->sensor_width_um == y->sensor_width_um && x->sensor_height_um == y->sensor_height_um &&
           x->margin_q16 == y->margin_q16 && a->controller.frame == b->controller.frame &&
           a->fixed_focal_mm == b->fixed_focal_mm;
}

/// Is the rig that was read the same but for its camera? Where nothing at all has changed, all
/// begins anew. A camera of the simulator and a real one have different clocks: they don't take
/// each other's place.
static bool changes_only_camera(const struct runner *runner) {
    const struct rig *now = camera_rig(runner), *next = &runner->next_rig;
    const bool one_clock = runner->sim == NULL || now->camera.device[0] == '\0' ||
                           next->camera.device[0] == '\0' ||
                           has_fake_camera(now) == has_fake_camera(next);
    return one_clock && same_optics(now, next) && ini_same_but(&now->ini, &next->ini, "camera") &&
           !ini_same_but(&now->ini, &next->ini, NULL);
}

/// Drives, lines and controller go on as they are; the camera is let go of and opened in the
/// background.
static void reload_camera(struct runner *runner) {
    if (camera_source_is_changing(&runner->camera)) {
        runner_tell(runner, true, "reload", "%s is not used yet: the camera is just being changed",
                    runner->settings.rig_file);
        return;
    }
    struct rig *rig = &runner->camera_rig[runner->camera_reloads++ % 2U];
    rig_free(rig); // of the camera before the one in use
    *rig = runner->next_rig;
    memset(&runner->next_rig, 0, sizeof runner->next_rig);
    runner->reloads++;
    runner_tell(runner, false, "reload", "%s is read again: only the camera changes",
                runner->settings.rig_file);
    camera_source_change(&runner->camera, rig);
}

void runner_drop_next(struct runner *runner) {
    rig_free(&runner->next_rig);
    occlusion_rig_close(runner->next_hiding);
    runner->next_hiding = NULL;
}

/// In the background.
static void read_next(void *context) {
    struct runner *const runner = context;
    runner->job_status = rig_read(runner->settings.rig_file, 0, &runner->next_rig);
    if (runner->job_status == EXIT_STATUS_OK) {
        runner->job_status = runner_read_hiding(runner, &runner->next_rig, &runner->next_hiding);
    }
}

void runner_begin_reload(struct runner *runner) {
    if (runner->reading || runner->reloading) {
        runner->read_again = true;
        return;
    }
    runner->read_again = false;
    runner->reading = !runner->stopping && side_job_start(&runner->job, read_next, runner);
}

// ---------------------------------------------------------------- everything anew

/// In the background: devices close and open as long as they like.
static void rebuild(void *context) {
    struct runner *const runner = context;
    runner_dismantle(runner);
    rig_free(&runner->rig);
    occlusion_rig_close(runner->hiding);
    runner->hiding = runner->next_hiding;
    runner->next_hiding = NULL;
    runner_forget_camera_rigs(runner);
    runner->rig = runner->next_rig;
    memset(&runner->next_rig, 0, sizeof runner->next_rig);
    // The controller has forgotten its targets; a recording has them, a live stream sends new ones.
    if (runner->has_source && runner->source.is_recording) {
        target_source_close(&runner->source);
        runner->has_source = target_source_open(&runner->source, runner->settings.targets);
    }
    runner->job_status = runner_build(runner);
}

static void begin_rebuilding(struct runner *runner) {
    runner->reloading = runner->absent = false;
    runner->told_refusal[0] = '\0';
    runner->reloads++;
    camera_source_unwatch(&runner->camera);
    runner->rebuilding = side_job_start(&runner->job, rebuild, runner);
    if (!runner->rebuilding) { // no room for a thread: then everything waits for it
        rebuild(runner);
        runner->rebuilding = true;
    } else if (runner_is_hurried(runner)) {
        side_job_wait(&runner->job); // time is not real
    }
}

static void take_next(struct runner *runner) {
    runner->reading = false;
    if (runner->stopping) {
        runner_drop_next(runner);
    } else if (runner->job_status != EXIT_STATUS_OK) {
        runner_tell(runner, true, "reload", "%s is not used: the rig stays as it was",
                    runner->settings.rig_file);
        runner_drop_next(runner);
    } else if (runner->next_rig.controller.tick_us != runner->rig.controller.tick_us) {
        runner_tell(runner, true, "reload",
                    "tick_us can't change while it runs: the rig stays as it was");
        runner_drop_next(runner);
    } else if (runner->absent) {
        begin_rebuilding(runner);
    } else if (changes_only_camera(runner)) {
        reload_camera(runner);
        runner_drop_next(runner);
    } else {
        runner->reloading = true;
        pump_command(runner->pump, COMMAND_STOP);
    }
}

// ---------------------------------------------------------------- devices that are not there yet

bool runner_waits(struct runner *runner, enum exit_status status) {
    if (status == EXIT_STATUS_DEVICE && strcmp(runner->refusal, runner->told_refusal) != 0) {
        const bool first = runner->told_refusal[0] == '\0';
        memcpy(runner->told_refusal, runner->refusal, sizeof runner->told_refusal);
        run_log_tell_at(&runner->log, runner->rig.ini.file, "device", runner->refusal);
        if (first && runner->settings.wait) {
            runner_tell(runner, false, "device", "waiting until it can be opened");
        }
    }
    runner->absent = status == EXIT_STATUS_DEVICE && runner->settings.wait;
    runner->rebuilding = runner->rebuilding || runner->absent;
    runner->tried_us = event_loop_now_us();
    return runner->absent;
}

/// In the background.
static void build_again(void *context) {
    struct runner *const runner = context;
    runner_dismantle(runner);
    runner->job_status = runner_build(runner);
}

/// An arm command of now is none for whenever the devices come.
static void wait_for_devices(struct runner *runner) {
    const uint32_t raised = runner->held_signals;
    const uint64_t limit_us = runner->settings.limit_us;
    runner->held_signals = 0;
    if ((raised & EVENT_LOOP_END) != 0U ||
        (limit_us != 0U && runner->loop.ticks * runner->loop.tick_us > limit_us)) {
        runner->status = EXIT_STATUS_DEVICE;
    } else if ((raised & EVENT_LOOP_RELOAD) != 0U) {
        runner_begin_reload(runner);
    } else if (event_loop_now_us() - runner->tried_us >= RUNNER_LOOK_EVERY_US) {
        runner->absent = !side_job_start(&runner->job, build_again, runner);
    }
}

/// Everything is open: from here on the ticks are the controller's again.
static void begin_anew(struct runner *runner) {
    runner->rebuilding = false;
    runner->source_since_ticks = runner->loop.ticks;
    if (runner->told_refusal[0] != '\0') {
        runner_tell(runner, false, "device", "all devices are there");
        runner->told_refusal[0] = '\0';
        runner->held_signals &= ~(uint32_t)EVENT_LOOP_REARM; // it was for what was there then
    } else {
        runner_tell(runner, false, "reload", "%s is read again", runner->settings.rig_file);
    }
    if (!camera_source_watch(&runner->camera, &runner->loop)) {
        message_command(runner->settings.command, "no room in the event loop");
        runner->status = EXIT_STATUS_FAILURE;
    }
}

static void take_rebuilt(struct runner *runner) {
    if (runner->job_status == EXIT_STATUS_OK) {
        begin_anew(runner);
    } else if (!runner_waits(runner, runner->job_status)) {
        runner->status = runner->job_status;
    }
}

void runner_reload_tick(struct runner *runner) {
    if (runner->reloading && runner_stands_still(runner)) {
        begin_rebuilding(runner);
    }
    if (!side_job_is_over(&runner->job)) {
        return;
    }
    if (runner->reading) {
        take_next(runner);
    } else if (runner->absent) {
        wait_for_devices(runner);
    } else if (runner->rebuilding) {
        take_rebuilt(runner);
    }
    const bool building = runner->rebuilding && !runner->absent;
    if (runner->read_again && !runner->reloading && !building) {
        runner_begin_reload(runner);
    }
}
