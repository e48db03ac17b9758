#include "degrees.h"
#include "runner_private.h"
#include "runner_state.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

/// A drive that has not answered for so long after the start is missing.
#define ANSWER_WITHIN_US 5000000U

static const char *const axis_names[AXIS_COUNT] = {"pan", "tilt", "zoom"};

// ---------------------------------------------------------------- between the ticks

static bool push(struct runner *runner, const struct target_update *update) {
    return runner->sim != NULL ? sim_push(runner->sim, update) : pump_push(runner->pump, update);
}

static void take_targets(struct runner *runner) {
    const uint64_t elapsed_us =
        (runner->loop.ticks - runner->source_since_ticks) * runner->loop.tick_us;
    struct target_update update;
    while (runner->has_source && target_source_next(&runner->source, elapsed_us, &update) &&
           push(runner, &update)) {
        target_source_taken(&runner->source);
    }
    const struct target_update *seen;
    while ((seen = camera_source_next(&runner->camera)) != NULL && push(runner, seen)) {
        camera_source_taken(&runner->camera);
    }
}

/// The mode, and why, whenever it changes.
static void tell_mode(struct runner *runner) {
    const struct controller *controller = runner->controller;
    if (controller->mode == runner->told_mode && controller->faults == runner->told_faults) {
        return;
    }
    if (controller->mode == MODE_STARTING && runner->told_mode != MODE_STARTING) {
        runner->starting_since_us = event_loop_now_us();
    }
    runner->told_mode = controller->mode;
    runner->told_faults = controller->faults;
    if (controller->mode == MODE_STARTING && controller->faults == FAULT_DRIVE_SILENT) {
        return; // as every drive at first; look_for_answers tells which stays silent
    }
    const bool faulted = controller->faults != 0U;
    runner_tell(runner, faulted, faulted ? "fault" : "mode", "%s%s%s%s%s",
                controller_mode_name(controller->mode), faulted ? ": " : "",
                faulted ? axis_names[controller->fault_axis % AXIS_COUNT] : "", faulted ? ": " : "",
                faulted ? controller_fault_name(controller->faults) : "");
}

bool runner_stands_still(const struct runner *runner) {
    const struct controller *const controller = runner->controller;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (controller->powered[axis] && !limiter_at_rest(&controller->limiter[axis])) {
            return false;
        }
    }
    return true;
}

void runner_stop(struct runner *runner) {
    pump_command(runner->pump, COMMAND_STOP);
    runner->stopping = true;
}

static void take_signals(struct runner *runner, uint32_t raised) {
    if ((raised & EVENT_LOOP_END) != 0U && !runner->stopping) {
        run_log_event(&runner->log, false, "end", "interrupted");
        runner_stop(runner);
    }
    if ((raised & EVENT_LOOP_RELOAD) != 0U && !runner->settings.fixed) {
        runner_begin_reload(runner);
    }
    if ((raised & EVENT_LOOP_REARM) != 0U && !runner->stopping && !runner->reloading) {
        run_log_event(&runner->log, false, "rearm", "by SIGUSR1");
        runner->line_stopped = runner->stop_pressed;
        memset(runner->outside, 0, sizeof runner->outside); // it is told again
        pump_command(runner->pump, COMMAND_ARM);
    }
}

// ---------------------------------------------------------------- switches

/// A stop wins over every arm command, so as long as the emergency stop is pressed nothing arms.
static void look_at_lines(struct runner *runner) {
    const struct rig_lines_state state = rig_lines_read(&runner->lines, event_loop_now_us());
    if (state.lost != NULL) {
        runner_tell(runner, true, "device", "%s", state.lost);
        runner->device_failed = true;
    }
    if (state.pressed != NULL) {
        runner_tell(runner, true, "switch", "%s is pressed", state.pressed);
        runner->pressed = state.pressed;
        runner->line_stopped = true;
    }
    if (runner->stop_pressed && !state.stop) {
        runner_tell(runner, false, "switch", "emergency stop is released");
    }
    runner->stop_pressed = state.stop;
    if (state.stop || state.pressed != NULL) {
        pump_command(runner->pump, COMMAND_STOP);
    }
}

// ---------------------------------------------------------------- limits

/// An axis that is armed beyond its limits goes back into them by itself. Of what a hand does that
/// is a little; of a zero that is not set, or a drive that has counted another turn, it would be a
/// turn of the head with all its cables.
#define OUTSIDE_DEG 5.0

static void look_at_limits(struct runner *runner) {
    static const char *const names[] = {"pan", "tilt"};
    const struct controller *controller = runner->controller;
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        const struct drive *drive = &controller->drive[axis];
        const struct limiter_config *limits = &runner->rig.controller.axis[axis].limits;
        // A glitch of an axis that moves is no reason: its setpoint is outside only if it began so.
        const int64_t at_q48 =
            controller->powered[axis] ? controller->setpoint_q48[axis] : drive->position_q48;
        const double at_deg = degrees(at_q48);
        const double min_deg = degrees(limits->min_q48), max_deg = degrees(limits->max_q48);
        const bool outside = drive_has_feedback(drive) && drive->position_known &&
                             (at_deg < min_deg - OUTSIDE_DEG || at_deg > max_deg + OUTSIDE_DEG);
        if (outside && !runner->outside[axis]) {
            runner_tell(runner, true, "limits",
                        "%s is at %.1f degrees, beyond its limits (%.1f to %.1f), and not armed "
                        "there; turn it back by hand, or mend zero_deg",
                        names[axis], at_deg, min_deg, max_deg);
        }
        runner->outside[axis] = outside;
        if (outside) {
            runner->line_stopped |=
                runner->rig.controller.arm_on_start || controller->powered[axis];
            pump_command(runner->pump, COMMAND_STOP);
        }
    }
}

static void set_enable(struct runner *runner) {
    bool powered = false;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        powered = powered || runner->controller->powered[axis];
    }
    rig_lines_enable(&runner->lines, powered);
}

// ---------------------------------------------------------------- devices that fail

static bool any_missing(const struct runner *runner) {
    return rig_lines_lost(&runner->lines) ||
           (runner->sim == NULL && rig_devices_incomplete(&runner->devices));
}

/// A drive that never answers is as missing as an interface. Each is told of once.
static void tell_silent_drives(struct runner *runner) {
    const struct controller *controller = runner->controller;
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        const struct drive_config *drive = &runner->rig.controller.axis[axis].drive;
        if (drive->kind != DRIVE_RMD || controller->drive[axis].ready) {
            continue;
        }
        runner->device_failed = true;
        if (!runner->told_silent[axis]) {
            runner->told_silent[axis] = true;
            runner_tell(runner, true, "device",
                        "%s: drive %u does not answer; is it powered, its id and the bit rate "
                        "right, the bus terminated?",
                        runner->rig.bus[axis], drive->rmd.id);
        }
    }
}

static void look_for_answers(struct runner *runner, uint64_t now_us) {
    const bool starting = runner->controller->mode == MODE_STARTING;
    if (starting && now_us - runner->starting_since_us >= ANSWER_WITHIN_US) {
        tell_silent_drives(runner);
    }
    if (!starting && (runner->told_silent[AXIS_PAN] || runner->told_silent[AXIS_TILT])) {
        runner->told_silent[AXIS_PAN] = runner->told_silent[AXIS_TILT] = false;
        runner->device_failed = any_missing(runner);
        runner_tell(runner, false, "device", "all drives answer");
    }
}

/// Where the camera looked, and what has become of it. With --stay the rig goes on with what other
/// sources tell.
static void look_after_camera(struct runner *runner) {
    bool lost = false;
    camera_source_tick(&runner->camera);
    const char *news = camera_source_news(&runner->camera, &lost);
    if (news == NULL) {
        return;
    }
    runner_tell(runner, lost, "camera", "%s", news);
    if (lost && !runner->settings.stay) {
        runner->device_failed = true;
        pump_command(runner->pump, COMMAND_STOP);
    }
}

/// Tries to open what is missing; tells when it is all there.
static void mend(struct runner *runner) {
    if (rig_lines_lost(&runner->lines)) {
        (void)rig_lines_mend(&runner->lines);
    }
    if (runner->sim == NULL) {
        rig_devices_mend(&runner->devices);
    }
    const bool missing = any_missing(runner);
    if (runner->was_missing && !missing) {
        runner->device_failed = false;
        runner_tell(runner, false, "device", "all devices are there again");
    }
    runner->was_missing = missing;
}

static void look_after_devices(struct runner *runner) {
    if (runner->sim == NULL) {
        rig_devices_tick(&runner->devices);
        bool severe = false;
        const char *news = rig_buses_news(&runner->devices.buses, &severe);
        if (news != NULL) {
            runner_tell(runner, severe, "device", "%s", news);
        }
        const char *lost = rig_devices_newly_lost(&runner->devices);
        if (lost != NULL) {
            runner_tell(runner, true, "device", "%s", lost);
            runner->device_failed = true;
            runner->looked_us =
                event_loop_now_us(); // what leaves is let leave before it is looked for
            pump_command(runner->pump, COMMAND_STOP);
        }
    }
    const uint64_t now_us = event_loop_now_us();
    if (now_us - runner->looked_us < RUNNER_LOOK_EVERY_US) {
        return;
    }
    runner->looked_us = now_us;
    if (runner->sim == NULL) {
        look_for_answers(runner, now_us);
    }
    if (runner->was_missing || any_missing(runner)) {
        mend(runner);
    }
}

// ---------------------------------------------------------------- the loop

/// Once all stands still: is it over, and with which status?
static bool is_over(const struct runner *runner, enum exit_status *status) {
    const struct controller *controller = runner->controller;
    const bool faulted = controller->mode == MODE_FAULTED;
    const bool failed = faulted || runner->device_failed || runner->line_stopped;
    if (!runner->stopping && !(failed && !runner->settings.stay)) {
        return false;
    }
    if (controller->mode == MODE_TRACKING || controller->mode == MODE_SETTLING ||
        !runner_stands_still(runner)) {
        return false;
    }
    *status = runner->device_failed             ? EXIT_STATUS_DEVICE
              : faulted || runner->line_stopped ? EXIT_STATUS_SAFETY_STOP
                                                : EXIT_STATUS_OK;
    return true;
}

static void step(struct runner *runner, uint64_t due) {
    if (runner->sim == NULL) {
        if (runner->hiding != NULL) {
            pump_occlusion_step(&runner->hiding->hiding, runner->pump);
        }
        // A tick that was missed is past: the controller is told the time, not the number.
        pump_step(runner->pump);
        runner->steps++;
        const struct controller_status *status = &runner->pump->output.status;
        camera_source_pose(&runner->camera, status, status->time_us, NULL);
        return;
    }
    for (uint64_t i = 0; i < due; i++) { // the simulator's time keeps up with the clock
        sim_step(runner->sim);
        runner->steps++;
        const struct sim_view seen = sim_observe(runner->sim);
        const struct camera_pose truth = {seen.pan_deg, seen.tilt_deg,
                                          seen.focal_mm / runner->rig.eye.focal_mm};
        camera_source_pose(&runner->camera, &runner->pump->output.status, runner->sim->time_us,
                           &truth);
    }
}

/// Waits for the next tick. Returns how many are due; 0: it can't.
static uint64_t await_tick(struct runner *runner, uint32_t *raised) {
    if (runner_is_hurried(runner)) {
        *raised = 0;
        runner->loop.ticks++;
        return 1;
    }
    return event_loop_tick(&runner->loop, raised);
}

bool runner_tick(struct runner *runner) {
    const uint64_t limit_us = runner->settings.limit_us;
    uint32_t raised;
    const uint64_t due = await_tick(runner, &raised);
    if (due == 0U) {
        message_command(runner->settings.command, "the event loop failed: %s", strerror(errno));
        runner->status = EXIT_STATUS_FAILURE;
        return false;
    }
    if (runner->rebuilding) { // no controller runs: what is asked of it waits
        runner->held_signals |= raised;
        runner_reload_tick(runner);
        return runner->status == EXIT_STATUS_OK;
    }
    take_targets(runner);
    take_signals(runner, raised | runner->held_signals);
    runner->held_signals = 0;
    if (limit_us != 0U && !runner->stopping &&
        runner->loop.ticks * runner->loop.tick_us > limit_us) {
        if (runner->sim == NULL && runner->controller->mode == MODE_STARTING) {
            tell_silent_drives(runner); // nothing has come of all that time
        }
        runner_stop(runner);
    }
    look_at_lines(runner);
    look_at_limits(runner);
    look_after_devices(runner);
    step(runner, due);
    look_after_camera(runner);
    set_enable(runner);
    tell_mode(runner);
    if (capacity_exceeded(&runner->capacity, &runner->pump->output.status)) {
        runner_tell(runner, true, "capacity", CAPACITY_MESSAGE, TARGET_CAPACITY);
    }
    runner_state_tick(runner);
    if (is_over(runner, &runner->status)) {
        return false;
    }
    runner_reload_tick(runner);
    return runner->status == EXIT_STATUS_OK;
}

static enum exit_status start(struct runner *runner) {
    const struct runner_settings *settings = &runner->settings;
    enum exit_status status = rig_read(settings->rig_file, 0, &runner->rig);
    if (status == EXIT_STATUS_OK) {
        status = runner_read_hiding(runner, &runner->rig, &runner->hiding);
    }
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    if (settings->targets != NULL) {
        runner->has_source = target_source_open(&runner->source, settings->targets);
        if (!runner->has_source) {
            return EXIT_STATUS_USAGE;
        }
    }
    return run_log_open(&runner->log, settings->log, event_loop_now_us()) ? runner_build(runner)
                                                                          : EXIT_STATUS_USAGE;
}

enum exit_status runner_start(struct runner *runner, const struct runner_settings *settings) {
    memset(runner, 0, sizeof *runner);
    runner->settings = *settings;
    runner->loop = (struct event_loop){.epoll = -1, .timer = -1, .signals = -1};
    linux_clock_open(&runner->clock, 0);
    event_loop_block_signals();
    message_aside_begin();
    const enum exit_status status = start(runner);
    if (status != EXIT_STATUS_OK && !runner_waits(runner, status)) {
        return status;
    }
    if (!rig_is_fake(&runner->rig)) {
        realtime_enter(&runner->realtime);
        if (runner->realtime.advice[0] != '\0') {
            runner_tell(runner, false, "realtime", "%s", runner->realtime.advice);
        }
    }
    if (!event_loop_open(&runner->loop, runner->rig.controller.tick_us) ||
        !camera_source_watch(&runner->camera, &runner->loop)) {
        message_command(settings->command, "no event loop: %s", strerror(errno));
        return EXIT_STATUS_FAILURE;
    }
    run_log_event(&runner->log, false, "start", "%s", settings->rig_file);
    return EXIT_STATUS_OK;
}

enum exit_status runner_run(struct runner *runner, const struct runner_settings *settings) {
    const enum exit_status status = runner_start(runner, settings);
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    while (runner_tick(runner)) {
    }
    run_log_event(&runner->log, false, "end", "exit status %d", (int)runner->status);
    return runner->status;
}

void runner_close(struct runner *runner) {
    realtime_leave();
    side_job_wait(&runner->job);
    event_loop_close(&runner->loop);
    target_source_close(&runner->source);
    runner_dismantle(runner);
    rig_free(&runner->rig);
    occlusion_rig_close(runner->hiding);
    runner_drop_next(runner);
    runner_forget_camera_rigs(runner);
    run_log_close(&runner->log);
    message_aside_end();
}
