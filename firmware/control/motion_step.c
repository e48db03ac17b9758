#include "control/private.h"

#include "fixed/trig.h"

static bool is_config_valid(const struct controller *c) {
    return (c->faults & FAULT_CONFIG) == 0U;
}

static bool has_zoom(const struct controller *c) {
    return is_config_valid(c) && c->config->axis[AXIS_ZOOM].drive.kind != DRIVE_NONE;
}

/// Hands a new aim to the trackers, on the turn that the limits and the shortest way ask for.
static void take_aim(struct controller *c) {
    struct mount_joints joints;
    bool pan_defined = true;
    if (c->framing.is_picture) {
        joints = (struct mount_joints){c->framing.pan_bam32, c->framing.tilt_bam32};
    } else {
        pan_defined = mount_solve(&c->mount, c->framing.ahead_q30, &joints);
    }
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        struct tracker *tracker = &c->tracker[axis];
        const struct limiter_config *limits = &c->config->axis[axis].limits;
        const int64_t from = tracker->valid ? tracker->position_q48 : c->setpoint_q48[axis];
        if (axis == AXIS_PAN && !pan_defined) { // along the pan axis every pan is right: it rests
            tracker_reset(tracker);
            tracker_update(tracker, &c->config->tracker, from);
            continue;
        }
        const bam32_t angle = axis == AXIS_PAN ? joints.pan : joints.tilt;
        tracker_update(tracker, &c->config->tracker,
                       axis_unwrap(angle, from, limits->min_q48, limits->max_q48));
    }
}

/// Angle between where the setpoints look and the aim.
static bam32_t pointing_error(const struct controller *c, struct mount_joints joints) {
    const struct vec3 looking = mount_direction(&c->mount, joints);
    const uint64_t across = vec3_i64_length(vec3_cross(looking, c->framing.ahead_q30));
    return trig_atan2((int64_t)across, vec3_dot_unit(looking, c->framing.ahead_q30));
}

static bam32_t widened(bam32_t half_angle, bam32_t by) {
    const uint64_t wide = (uint64_t)half_angle.bam + by.bam;
    return bam32(wide < BAM32_QUARTER ? (uint32_t)wide : BAM32_QUARTER);
}

/// The zoom goal frames the cone, or the picture, from where the camera looks now: wide while it
/// slews, so that the targets come into the picture early and none is lost, and closer as it
/// arrives.
static void aim_zoom(struct controller *c) {
    const struct mount_joints joints = {axis_to_bam32(c->setpoint_q48[AXIS_PAN]),
                                        axis_to_bam32(c->setpoint_q48[AXIS_TILT])};
    if (!c->panning && c->zoom_version == c->framed_version &&
        joints.pan.bam == c->zoom_joints.pan.bam && joints.tilt.bam == c->zoom_joints.tilt.bam) {
        return; // nothing moved
    }
    c->zoom_version = c->framed_version;
    c->zoom_joints = joints;
    const struct framing *framing = &c->framing;
    const bam32_t error = pointing_error(c, joints);
    const uint32_t focal_um =
        c->config->frame == CONTROLLER_FRAME_RECT
            ? lens_focal_of_picture_um(&c->config->lens, widened(framing->half_width_bam32, error),
                                       widened(framing->half_height_bam32, error))
            : lens_focal_um(&c->config->lens, widened(framing->half_angle_bam32, error));
    c->goal_q48[AXIS_ZOOM] = lens_position_q48(&c->config->lens, focal_um);
}

/// A search that is not finished has a cone that holds everything, but its axis may be degrees away
/// from where it will be in a tick or two: pan and tilt would dart there and back. They go on as
/// they were, for a while. Shown: tests/scenario/test_pedestrians.c (a quarter less error).
static bool waits_for_search(struct controller *c) {
    const bool wait = c->framing.refining && c->tracker[AXIS_PAN].valid &&
                      c->refining_ticks < CONTROLLER_REFINING_TICKS_MAX;
    c->refining_ticks = wait ? c->refining_ticks + 1U : 0U;
    return wait;
}

void controller_aim(struct controller *c) {
    tracker_advance(&c->tracker[AXIS_PAN], &c->config->tracker);
    tracker_advance(&c->tracker[AXIS_TILT], &c->config->tracker);
    const bool waits = c->full_ticks != 0U; // for the rest of a frame
    if (!waits && controller_look(c)) {
        if (c->framing.status == FRAMING_OK) {
            if (!waits_for_search(c)) {
                take_aim(c);
            }
        } else {
            tracker_reset(&c->tracker[AXIS_PAN]);
            tracker_reset(&c->tracker[AXIS_TILT]);
        }
    } else if (!waits && c->aim_reports != c->targets.rest_reports &&
               c->framing.status == FRAMING_OK) {
        take_aim(c); // the same aim again: that it stands still is news
    }
    c->aim_reports = c->targets.rest_reports;
    if (c->framing.status != FRAMING_OK) {
        return;
    }
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        c->goal_q48[axis] = c->tracker[axis].position_q48;
        c->goal_rate_q48[axis] = c->tracker[axis].rate_q48;
    }
    if (has_zoom(c)) {
        aim_zoom(c);
    }
}

/// How far a goal goes on while its axis is still on the way to where it is: |rate| is at most a
/// turn, and the latency 5,000 ticks, so the product stays below 2^61.
static int64_t lead(const struct controller *c, unsigned axis) {
    const int64_t ticks_q8 =
        (int64_t)(c->config->axis[axis].latency_us * 256U / c->config->tick_us);
    return (c->goal_rate_q48[axis] >> 8) * ticks_q8;
}

void controller_move(struct controller *c) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (!c->powered[axis]) {
            // What is measured is shown as the setpoint, so that arming starts from there.
            if (drive_has_feedback(&c->drive[axis]) && c->drive[axis].position_known) {
                c->setpoint_q48[axis] = c->drive[axis].position_q48;
            }
            continue;
        }
        c->setpoint_q48[axis] =
            c->mode == MODE_TRACKING
                ? limiter_follow(&c->limiter[axis], c->goal_q48[axis] + lead(c, axis),
                                 c->goal_rate_q48[axis])
                : limiter_stop(&c->limiter[axis]);
    }
}

/// Axes take turns in the cycle of frames: the bus then carries them evenly.
static uint32_t axis_tick(const struct controller *c, unsigned axis) {
    return c->tick + axis;
}

static void send(struct controller *c, struct controller_output *output) {
    output->frame_count = 0;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        struct drive_output sent = {0};
        if (is_config_valid(c)) {
            drive_tick(&c->drive[axis], axis_tick(c, axis), c->powered[axis], c->setpoint_q48[axis],
                       &sent);
        }
        for (uint32_t i = 0;
             i < sent.frame_count && output->frame_count < CONTROLLER_FRAMES_OUT_MAX; i++) {
            output->frame[output->frame_count++] = sent.frame[i];
        }
        output->pulse_set[axis] = sent.pulse_set;
        output->pulse_ns[axis] = sent.pulse_ns;
        output->pulse_channel[axis] = sent.pulse_set ? c->config->axis[axis].drive.pwm.channel : 0U;
    }
}

void controller_report(struct controller *c, struct controller_output *output) {
    send(c, output);
    struct controller_status *status = &output->status;
    status->time_us = c->time_us;
    status->mode = c->mode;
    status->faults = c->faults;
    status->fault_axis = c->fault_axis;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        status->axis[axis] =
            (struct controller_axis_status){.setpoint_q48 = c->setpoint_q48[axis],
                                            .goal_q48 = c->goal_q48[axis],
                                            .measured_q48 = c->drive[axis].position_q48,
                                            .measured_us = c->drive[axis].position_us,
                                            .measured_known = c->drive[axis].position_known,
                                            .restarts = c->restarts[axis]};
    }
    status->framing = c->framing;
    status->panning = c->panning;
    status->focal_um =
        has_zoom(c) ? lens_focal_at_um(&c->config->lens, c->setpoint_q48[AXIS_ZOOM]) : 0U;
    status->target_count = c->targets.count;
    status->updates_rejected = c->updates_rejected;
    status->frames_ignored = c->frames_ignored;
    status->aims_solved = c->aims_solved;
}

const char *controller_mode_name(enum controller_mode mode) {
    static const char *const names[] = {"starting", "ready",   "settling", "tracking",
                                        "holding",  "stopped", "faulted"};
    return names[mode];
}

const char *controller_fault_name(uint32_t faults) {
    static const char *const names[] = {"the settings are not valid", "a drive does not answer",
                                        "a drive reports an error",
                                        "an axis does not follow its setpoint", "ticks came late"};
    for (unsigned i = 0; i < sizeof names / sizeof *names; i++) {
        if ((faults >> i & 1U) != 0U) {
            return names[i];
        }
    }
    return "none";
}
