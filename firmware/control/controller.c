#include "control/controller.h"

#include "control/private.h"

/// Ticks later than this many periods count as late; so many in a row are a fault.
#define LATE_PERIODS   4U
#define LATE_TICKS_MAX 20U

static bool axis_exists(const struct controller *c, unsigned axis) {
    return c->config->axis[axis].drive.kind != DRIVE_NONE;
}

static bool axis_config_valid(const struct controller_axis_config *axis) {
    const struct limiter_config *limits = &axis->limits;
    const int64_t reach = 16 * AXIS_TURN_Q48; // what the limiter's sum holds
    return limits->min_q48 <= limits->max_q48 && limits->min_q48 >= -reach &&
           limits->max_q48 <= reach && limits->speed_max_q48 >= 1 &&
           limits->speed_max_q48 <= AXIS_TURN_Q48 && limits->accel_max_q48 >= 1 &&
           limits->accel_max_q48 <= AXIS_TURN_Q48 && limits->smooth_ticks >= 1U &&
           limits->smooth_ticks <= LIMITER_SMOOTH_TICKS_MAX && axis->home_q48 >= limits->min_q48 &&
           axis->home_q48 <= limits->max_q48 && axis->latency_us <= CONTROLLER_LATENCY_US_MAX &&
           drive_config_valid(&axis->drive);
}

static bool tracker_config_valid(const struct tracker_config *tracker) {
    return tracker->memory_q16 < 65536U && tracker->jump_q48 >= 0 &&
           tracker->jump_q48 <= TRACKER_JUMP_Q48_MAX;
}

static bool frame_valid(const struct controller_config *config) {
    const uint64_t width = config->lens.sensor_width_um, height = config->lens.sensor_height_um;
    return config->frame != CONTROLLER_FRAME_RECT ||
           (width != 0U && height != 0U && width <= UINT32_C(1) << 20 &&
            height <= UINT32_C(1) << 20 && width <= height * RECTANGLE_ASPECT_MAX &&
            height <= width * RECTANGLE_ASPECT_MAX);
}

static bool position_valid(struct vec3_i64 position_um) {
    const int64_t most = TARGET_POSITION_UM_MAX;
    return position_um.x <= most && position_um.x >= -most && position_um.y <= most &&
           position_um.y >= -most && position_um.z <= most && position_um.z >= -most;
}

/// Would both axes turn the same actuator?
static bool drives_collide(const struct drive_config *a, const struct drive_config *b) {
    return a->kind == b->kind && ((a->kind == DRIVE_RMD && a->rmd.id == b->rmd.id) ||
                                  (a->kind == DRIVE_PWM && a->pwm.channel == b->pwm.channel));
}

static bool config_valid(const struct controller_config *config) {
    const struct controller_axis_config *pan = &config->axis[AXIS_PAN],
                                        *tilt = &config->axis[AXIS_TILT],
                                        *zoom = &config->axis[AXIS_ZOOM];
    const bool zooms = zoom->drive.kind != DRIVE_NONE;
    return config->tick_us >= 100U && config->tick_us <= 20000U && axis_config_valid(pan) &&
           axis_config_valid(tilt) &&
           (!zooms || (axis_config_valid(zoom) && lens_valid(&config->lens))) &&
           !drives_collide(&pan->drive, &tilt->drive) &&
           !drives_collide(&pan->drive, &zoom->drive) &&
           !drives_collide(&tilt->drive, &zoom->drive) && position_valid(config->position_um) &&
           frame_valid(config) && config->follow_error_q48 >= 0 &&
           tracker_config_valid(&config->tracker);
}

bool controller_init(struct controller *c, const struct controller_config *config) {
    const bool valid = config_valid(config);
    c->config = config;
    c->started = false;
    c->arm_wanted = config->arm_on_start;
    c->time_us = c->settled_us = 0;
    c->last_now_us = c->tick = c->late_ticks = 0;
    c->updates_rejected = c->frames_ignored = c->aims_solved = 0;
    c->faults = 0;
    c->fault_axis = 0;
    mount_init(&c->mount, config->attitude);
    target_set_init(&c->targets, config->position_um, config->target_expiry_us);
    c->aim_reports = c->targets.rest_reports;
    c->framing = (struct framing){.status = FRAMING_EMPTY};
    c->view = (struct controller_view){.framing = c->framing, .framed_version = c->targets.version};
    c->from = c->view;
    c->panning = false;
    c->pan_started_us = 0;
    c->pan_duration_us = 0;
    c->pan_path = PAN_BY_SUM;
    c->refining_ticks = c->full_ticks = 0;
    c->framed_version = c->targets.version;
    c->zoom_version = c->framed_version - 1U; // worked out for nothing so far
    c->zoom_joints = (struct mount_joints){0};
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct controller_axis_config *settings = &config->axis[axis];
        drive_init(&c->drive[axis], &settings->drive, 0);
        const int64_t home_q48 = valid ? settings->home_q48 : 0; // or it might overflow
        limiter_reset(&c->limiter[axis], &settings->limits, home_q48);
        c->goal_q48[axis] = c->setpoint_q48[axis] = home_q48;
        c->goal_rate_q48[axis] = 0;
        c->powered[axis] = c->ever_powered[axis] = false;
        c->following_since_us[axis] = 0;
        c->restarts[axis] = 0;
    }
    tracker_reset(&c->tracker[AXIS_PAN]);
    tracker_reset(&c->tracker[AXIS_TILT]);
    c->mode = valid ? MODE_STARTING : MODE_FAULTED;
    c->faults = valid ? 0U : FAULT_CONFIG;
    return valid;
}

void controller_take_settings(struct controller *c) {
    c->targets.expiry_us = c->config->target_expiry_us;
    c->zoom_version = c->framed_version - 1U; // worked out for the old margin
}

// ---------------------------------------------------------------- inputs

static void advance_time(struct controller *c, uint32_t now_us) {
    if (c->started) {
        const uint32_t elapsed = now_us - c->last_now_us;
        // A clock that runs backwards is broken: no time passes, and the tick counts as late.
        const bool backwards = elapsed >= UINT32_C(0x80000000);
        const bool late = backwards || elapsed > LATE_PERIODS * c->config->tick_us;
        c->time_us += backwards ? 0U : elapsed;
        c->late_ticks = late ? c->late_ticks + (c->late_ticks < LATE_TICKS_MAX) : 0U;
    }
    c->started = true;
    c->last_now_us = now_us;
    c->tick++;
}

static void take_frames(struct controller *c, const struct controller_input *input) {
    const uint32_t count = input->frame_count < CONTROLLER_FRAMES_IN_MAX ? input->frame_count
                                                                         : CONTROLLER_FRAMES_IN_MAX;
    for (uint32_t i = 0; i < count; i++) {
        bool taken = false;
        const uint32_t since_us = input->now_us - input->frame_us[i];
        const uint32_t age_us = since_us < UINT32_C(0x80000000) ? since_us : 0U;
        for (unsigned axis = 0; axis < AXIS_COUNT && !taken; axis++) {
            taken = axis_exists(c, axis) &&
                    drive_receive(&c->drive[axis], &input->frame[i], c->time_us, age_us);
        }
        c->frames_ignored += !taken;
    }
}

static void take_updates(struct controller *c, const struct controller_input *input) {
    const uint32_t count =
        input->update_count < CONTROLLER_UPDATES_MAX ? input->update_count : CONTROLLER_UPDATES_MAX;
    for (uint32_t i = 0; i < count; i++) {
        c->updates_rejected +=
            target_set_apply(&c->targets, &input->update[i], c->time_us) != TARGET_OK;
    }
    (void)target_set_expire(&c->targets, c->time_us);
    const bool full = count == CONTROLLER_UPDATES_MAX && c->full_ticks < CONTROLLER_WAIT_TICKS_MAX;
    c->full_ticks = full ? c->full_ticks + 1U : 0U;
}

// ---------------------------------------------------------------- faults

static bool comes_late(const struct controller *c) {
    return c->late_ticks >= LATE_TICKS_MAX;
}

static bool is_powered_mode(const struct controller *c) {
    return c->powered[AXIS_PAN] || c->powered[AXIS_TILT] || c->powered[AXIS_ZOOM];
}

static void raise_fault(struct controller *c, enum controller_fault fault, unsigned axis) {
    c->faults |= (uint32_t)fault;
    c->fault_axis = (uint8_t)axis;
    c->mode = MODE_FAULTED;
    c->arm_wanted = false;
}

/// The setpoint begins anew, at rest, where the axis is.
static void restart_axis(struct controller *c, unsigned axis, int64_t position_q48) {
    limiter_reset(&c->limiter[axis], &c->config->axis[axis].limits, position_q48);
    c->following_since_us[axis] = c->time_us;
    c->restarts[axis]++;
}

/// Is the axis near its setpoint, or has been until a moment ago?
static bool follows(struct controller *c, unsigned axis) {
    const struct drive *drive = &c->drive[axis];
    const int64_t apart = drive->position_q48 - c->setpoint_q48[axis];
    if (!drive_has_feedback(drive) || !drive->position_known ||
        (apart <= c->config->follow_error_q48 && apart >= -c->config->follow_error_q48)) {
        c->following_since_us[axis] = c->time_us;
    }
    return c->time_us - c->following_since_us[axis] <= c->config->follow_error_us;
}

/// Faults of a powered axis. What a dead drive would do with a stale setpoint when it comes back is
/// unknown, so it gets none until it is armed again; an axis that does not follow holds where it
/// is (if that is known: else it stops where it should be).
static void check_powered_axis(struct controller *c, unsigned axis) {
    struct drive *drive = &c->drive[axis];
    switch (drive_check(drive, c->time_us, c->config->silence_us)) {
    case DRIVE_FAULT_SILENT:
        raise_fault(c, FAULT_DRIVE_SILENT, axis);
        c->powered[axis] = false;
        drive_forget(drive);
        return;
    case DRIVE_FAULT_REPORTED:
        raise_fault(c, FAULT_DRIVE_ERROR, axis);
        c->powered[axis] = false;
        return;
    default:
        break;
    }
    if (!follows(c, axis)) {
        raise_fault(c, FAULT_FOLLOWING, axis);
        if (drive_position_is_fresh(drive, c->time_us, c->config->silence_us)) {
            restart_axis(c, axis, drive->position_q48);
        }
    }
}

/// A drive that falls silent without power may have restarted: it is asked anew. Before arming,
/// causes come and go and are only shown.
static void check_unpowered_axis(struct controller *c, unsigned axis, bool show) {
    struct drive *drive = &c->drive[axis];
    const enum drive_fault fault = drive_check(drive, c->time_us, c->config->silence_us);
    if (fault == DRIVE_FAULT_SILENT) {
        drive_forget(drive);
    }
    if (show && fault != DRIVE_HEALTHY) {
        c->faults |= fault == DRIVE_FAULT_SILENT ? FAULT_DRIVE_SILENT : FAULT_DRIVE_ERROR;
        c->fault_axis = (uint8_t)axis;
    }
}

static void check_faults(struct controller *c) {
    const bool idle = c->mode == MODE_STARTING || c->mode == MODE_READY;
    if (idle) {
        c->faults = 0;
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (axis_exists(c, axis) && c->powered[axis]) {
            check_powered_axis(c, axis);
        } else if (axis_exists(c, axis)) {
            check_unpowered_axis(c, axis, idle);
        }
    }
    if (comes_late(c) && is_powered_mode(c)) {
        raise_fault(c, FAULT_OVERRUN, 0);
    }
}

// ---------------------------------------------------------------- modes

static bool drive_ready(const struct controller *c, const struct drive *drive) {
    return drive->ready && drive_check(drive, c->time_us, c->config->silence_us) == DRIVE_HEALTHY &&
           drive_position_is_fresh(drive, c->time_us, c->config->silence_us);
}

static bool drives_ready(const struct controller *c) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (axis_exists(c, axis) && !drive_ready(c, &c->drive[axis])) {
            return false;
        }
    }
    return true;
}

static bool all_at_rest(const struct controller *c) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (c->powered[axis] && !limiter_at_rest(&c->limiter[axis])) {
            return false;
        }
    }
    return true;
}

/// Powers every axis from where it is: as measured, or as last told, or (never told anything) at
/// home.
static void arm(struct controller *c) {
    c->settled_us = c->time_us;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (!axis_exists(c, axis)) {
            continue;
        }
        if (drive_has_feedback(&c->drive[axis])) {
            c->setpoint_q48[axis] = c->drive[axis].position_q48;
        } else if (!c->ever_powered[axis]) {
            c->settled_us = c->time_us + c->config->settle_us;
        }
        restart_axis(c, axis, c->setpoint_q48[axis]);
        c->powered[axis] = c->ever_powered[axis] = true;
    }
    tracker_reset(&c->tracker[AXIS_PAN]);
    tracker_reset(&c->tracker[AXIS_TILT]);
    c->framed_version = c->view.framed_version = c->targets.version - 1U; // aim anew
    c->faults = 0;
    c->arm_wanted = false;
    c->mode = MODE_SETTLING;
}

static void take_commands(struct controller *c, uint32_t commands) {
    const bool stands = c->mode == MODE_READY || c->mode == MODE_STARTING ||
                        c->mode == MODE_STOPPED || c->mode == MODE_FAULTED;
    if ((commands & COMMAND_STOP) != 0U) {
        c->arm_wanted = false;
        if (!stands) {
            c->mode = MODE_STOPPED;
        }
    } else if ((commands & COMMAND_ARM) != 0U && stands) {
        c->arm_wanted = true;
    }
}

static void change_mode(struct controller *c) {
    if (c->mode == MODE_STARTING || c->mode == MODE_READY) {
        c->mode = drives_ready(c) ? MODE_READY : MODE_STARTING;
    }
    const bool can_arm =
        c->mode == MODE_READY || c->mode == MODE_STOPPED || c->mode == MODE_FAULTED;
    if (c->arm_wanted && can_arm && all_at_rest(c)) {
        if (drives_ready(c) && !comes_late(c)) {
            arm(c);
            return; // the aim of this tick was worked out from somewhere else
        }
        c->arm_wanted = c->mode != MODE_FAULTED; // refused: the cause is still there
    }
    if (c->mode == MODE_SETTLING && c->time_us >= c->settled_us) {
        c->mode = MODE_HOLDING;
    }
    if (c->mode == MODE_TRACKING && c->framing.status != FRAMING_OK) {
        c->mode = MODE_HOLDING;
    } else if (c->mode == MODE_HOLDING && c->framing.status == FRAMING_OK) {
        c->mode = MODE_TRACKING;
    }
}

// ---------------------------------------------------------------- the step

void controller_step(struct controller *c, const struct controller_input *input,
                     struct controller_output *output) {
    advance_time(c, input->now_us);
    if ((c->faults & FAULT_CONFIG) == 0U) { // else nothing can be relied on
        take_frames(c, input);
        take_updates(c, input);
        if (input->pan_set) {
            controller_start_pan(c, &input->pan);
        }
        take_commands(c, input->commands); // given before the faults of this tick were known
        check_faults(c);
        controller_aim(c);
        change_mode(c);
        controller_move(c);
    }
    controller_report(c, output);
}
