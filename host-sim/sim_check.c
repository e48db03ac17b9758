/// The invariants of docs/safety.md that hold at every tick.
#include "sim_private.h"

#include "degrees.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/// The plant may be beside its setpoint by the lag of the drive and the friction at the end of a
/// move.
#define PLANT_POSITION_SLACK_DEG 0.05
/// A drive follows setpoints that come in steps, a frame every few milliseconds: its speed ripples
/// about theirs. The ripple is no distance to stop.
#define PLANT_RIPPLE_DPS 1.5
/// A drive is told to stay below a speed 5 % above ours (rig.c), which it needs to catch up; it
/// overshoots that a little.
#define PLANT_SPEED_SLACK_FACTOR 1.25
#define PLANT_SPEED_SLACK_DPS    1.0
/// Setpoints resume from the measured position: the fine angle has 0.01 degree, and is up to 8 ms
/// old.
#define RESUME_SLACK_DEG 0.03

const char *sim_invariant_name(enum sim_invariant invariant) {
    static const char *const names[] = {"I1 position", "I2 rates", "I4 motion while not armed",
                                        "I5 same bits", "I9 resume from measured"};
    return names[invariant];
}

uint64_t sim_violation_count(const struct sim_violations *violations) {
    uint64_t sum = 0;
    for (unsigned i = 0; i < SIM_INVARIANT_COUNT; i++) {
        sum += violations->count[i];
    }
    return sum;
}

__attribute__((format(printf, 3, 4))) static void
violate(struct sim *sim, enum sim_invariant invariant, const char *format, ...) {
    struct sim_violations *violations = &sim->violations;
    if (sim_violation_count(violations) == 0U) {
        violations->first_us = sim->time_us;
        const int used = snprintf(violations->first, sizeof violations->first,
                                  "%s: ", sim_invariant_name(invariant));
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(violations->first + used, sizeof violations->first - (size_t)used, format,
                  arguments);
        va_end(arguments);
    }
    violations->count[invariant]++;
}

void sim_check_init_axes(struct sim *sim) {
    memset(sim->check, 0, sizeof sim->check);
}

void sim_check_init(struct sim *sim) {
    sim_check_init_axes(sim);
    memset(&sim->violations, 0, sizeof sim->violations);
}

// ---------------------------------------------------------------- setpoints

/// The bounds that the limiter promises, exactly; the mean of its second stage is rounded, which
/// moves a first difference by 1, a second by 2 and a third by 4 units of 2^-48 turns.
static void check_rates(struct sim *sim, unsigned axis, int64_t setpoint_q48) {
    struct sim_axis_check *check = &sim->check[axis];
    const struct limiter_config *limits = &sim->config.controller->axis[axis].limits;
    const int64_t speed = setpoint_q48 - check->setpoint_q48, accel = speed - check->speed_q48;
    const int64_t jerk = accel - check->accel_q48;
    const int64_t jerk_max = 2 * limits->accel_max_q48 / (int64_t)limits->smooth_ticks + 5;
    if (check->ticks >= 1U &&
        (speed > limits->speed_max_q48 + 1 || speed < -limits->speed_max_q48 - 1)) {
        violate(sim, SIM_I2_RATES, "axis %u: setpoint speed %.6f degrees a tick", axis,
                degrees(speed));
    }
    if (check->ticks >= 2U &&
        (accel > limits->accel_max_q48 + 2 || accel < -limits->accel_max_q48 - 2)) {
        violate(sim, SIM_I2_RATES, "axis %u: setpoint acceleration %.9f degrees a tick^2", axis,
                degrees(accel));
    }
    if (check->ticks >= 3U && (jerk > jerk_max || jerk < -jerk_max)) {
        violate(sim, SIM_I2_RATES, "axis %u: setpoint jerk %.12f degrees a tick^3", axis,
                degrees(jerk));
    }
    check->accel_q48 = check->ticks >= 1U ? accel : 0;
    check->speed_q48 = speed;
    check->setpoint_q48 = setpoint_q48;
    check->ticks += check->ticks < 3U;
}

static void check_setpoint(struct sim *sim, unsigned axis) {
    const struct controller_axis_config *settings = &sim->config.controller->axis[axis];
    struct sim_axis_check *check = &sim->check[axis];
    const struct controller *c = &sim->controller;
    const struct controller_axis_status *status = &sim->pump.output.status.axis[axis];
    if (!c->powered[axis]) {
        check->powered = false;
        return;
    }
    if (!check->powered || check->restarts != status->restarts) {
        // The setpoint began anew in this tick: at rest, where the axis really is.
        const double apart = degrees(status->setpoint_q48) - sim_joint_deg(sim, axis);
        if (settings->drive.kind == DRIVE_RMD &&
            (apart > RESUME_SLACK_DEG || apart < -RESUME_SLACK_DEG)) {
            violate(sim, SIM_I9_RESUME, "axis %u resumes %.4f degrees from where it is", axis,
                    apart);
        }
        *check = (struct sim_axis_check){.powered = true,
                                         .restarts = status->restarts,
                                         .setpoint_q48 = status->setpoint_q48,
                                         .ticks = 1};
        return;
    }
    const int64_t setpoint = status->setpoint_q48;
    if (setpoint > settings->limits.max_q48 || setpoint < settings->limits.min_q48) {
        violate(sim, SIM_I1_POSITION, "axis %u: setpoint %.4f degrees", axis, degrees(setpoint));
    }
    check_rates(sim, axis, setpoint);
}

// ---------------------------------------------------------------- plant

/// Position with the distance that it takes to stop, and speed, as they really are.
static void check_plant(struct sim *sim, unsigned axis) {
    const struct limiter_config *limits = &sim->config.controller->axis[axis].limits;
    const struct sim_axis *built = &sim->axis[axis];
    if (built->kind != DRIVE_RMD || !(sim->controller.powered[axis] || sim->served.on)) {
        return; // a hobby servo's speed is its own, and an unpowered axis was not moved by us
    }
    const double ticks_per_s = 1e6 / sim->config.controller->tick_us;
    const double speed_max = degrees(limits->speed_max_q48) * ticks_per_s;
    const double accel_max = degrees(limits->accel_max_q48) * ticks_per_s * ticks_per_s;
    const double sign = sim->config.controller->axis[axis].drive.rmd.reversed ? -1.0 : 1.0;
    const double position = sim_joint_deg(sim, axis);
    const double speed = sign * built->plant.rate_rps * 180.0 / AXIS_PLANT_PI;
    const double steady = fmax(fabs(speed) - PLANT_RIPPLE_DPS, 0.0);
    const double stop = steady * steady / (2.0 * accel_max);
    const double reach = speed > 0.0 ? position + stop : position - stop;
    if (reach > degrees(limits->max_q48) + PLANT_POSITION_SLACK_DEG ||
        reach < degrees(limits->min_q48) - PLANT_POSITION_SLACK_DEG) {
        violate(sim, SIM_I1_POSITION, "axis %u at %.4f degrees and %.2f degrees/s", axis, position,
                speed);
    }
    const double most = speed_max * PLANT_SPEED_SLACK_FACTOR + PLANT_SPEED_SLACK_DPS;
    if (speed > most || speed < -most) {
        violate(sim, SIM_I2_RATES, "axis %u turns at %.2f degrees/s", axis, speed);
    }
}

void sim_check_served(struct sim *sim) {
    check_plant(sim, AXIS_PAN);
    check_plant(sim, AXIS_TILT);
}

/// Pulses to a servo, like motion commands to a drive, only while the axis is powered.
static void check_pulses(struct sim *sim) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct drive_config *drive = &sim->config.controller->axis[axis].drive;
        if (drive->kind == DRIVE_PWM && !sim->controller.powered[axis] &&
            sim->pulse_ns[drive->pwm.channel % SIM_PWM_CHANNELS] != 0U) {
            violate(sim, SIM_I4_UNARMED_MOTION, "axis %u gets pulses", axis);
        }
    }
}

/// May the controller move anything? Once armed it never goes back to a state in which it may not.
static bool may_move(const struct sim *sim) {
    const bool *ever = sim->controller.ever_powered;
    return ever[AXIS_PAN] || ever[AXIS_TILT] || ever[AXIS_ZOOM];
}

void sim_check_frame(struct sim *sim, const struct can_transfer *transfer) {
    const uint8_t command = transfer->frame.data[0];
    const bool motion =
        command == 0xA1 || command == 0xA2 || command == 0xA4 || command == 0xA6 || command == 0xA8;
    if (transfer->sender == sim->own_node && motion && !may_move(sim) && !sim->served.on) {
        violate(sim, SIM_I4_UNARMED_MOTION, "frame %03X %02X in mode %s", transfer->frame.id,
                command, controller_mode_name(sim->controller.mode));
    }
}

// ---------------------------------------------------------------- same bits

static bool same_frames(const struct controller_output *a, const struct controller_output *b) {
    bool same = a->frame_count == b->frame_count;
    for (uint32_t i = 0; same && i < a->frame_count; i++) {
        same = can_frame_equal(&a->frame[i], &b->frame[i]);
    }
    return same;
}

static bool same_output(const struct controller_output *a, const struct controller_output *b) {
    bool same = same_frames(a, b) && a->status.mode == b->status.mode &&
                a->status.faults == b->status.faults && a->status.time_us == b->status.time_us &&
                a->status.target_count == b->status.target_count &&
                vec3_equal(a->status.framing.ahead_q30, b->status.framing.ahead_q30) &&
                a->status.framing.half_angle_bam32.bam == b->status.framing.half_angle_bam32.bam &&
                a->status.framing.half_width_bam32.bam == b->status.framing.half_width_bam32.bam &&
                a->status.framing.pan_bam32.bam == b->status.framing.pan_bam32.bam;
    for (unsigned axis = 0; same && axis < AXIS_COUNT; axis++) {
        same = a->pulse_set[axis] == b->pulse_set[axis] && a->pulse_ns[axis] == b->pulse_ns[axis] &&
               a->status.axis[axis].setpoint_q48 == b->status.axis[axis].setpoint_q48 &&
               a->status.axis[axis].goal_q48 == b->status.axis[axis].goal_q48 &&
               a->status.axis[axis].measured_q48 == b->status.axis[axis].measured_q48;
    }
    return same;
}

void sim_check_step(struct sim *sim) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (sim->config.controller->axis[axis].drive.kind != DRIVE_NONE) {
            check_setpoint(sim, axis);
        }
        if (axis <= AXIS_TILT) {
            check_plant(sim, axis);
        }
    }
    check_pulses(sim);
    if (!same_output(&sim->pump.output, &sim->shadow_output)) {
        violate(sim, SIM_I5_SAME_BITS, "a second controller with the same inputs differs");
    }
}
