#include "calibrate_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CREEP_DPS       10.0   ///< toward an end
#define BEHIND_DEG      0.7    ///< an axis so far behind while it creeps has met something ...
#define STUCK_US        60000U ///< ... if it comes no further for so long ...
#define STUCK_LOOKS     4U     ///< ... by that many measurements: it may be the machine that paused
#define HEADWAY_DEG     0.02
#define END_MARGIN_DEG  2.0 ///< from what stops it
#define BACK_DEG        5.0 ///< away from it at once
#define ARRIVED_DEG     0.1
#define ARRIVED_US      200000U
#define PATIENCE_US     20000000U
#define REPEAT_US       100000U ///< the aim is told again, for rigs whose targets expire
#define TILT_MOST_DEG   80.0    ///< of moves: near the zenith pan is undefined
#define TILT_END_DEG    89.5
#define SPEED_OVER_US   40000U ///< so that a hundredth of a degree, and of a tick, is little
#define RANGE_SLACK_DEG 1.0    ///< that a move keeps from the ends

static const char *const names[] = {"pan", "tilt"};
static const double amplitudes_deg[CALIBRATE_MOVES] = {10.0, 30.0, 90.0};

static double degrees(int64_t position_q48) {
    return (double)position_q48 * (360.0 / 281474976710656.0);
}

static uint64_t now_us(const struct calibrate *c) {
    return c->runner.pump->output.status.time_us;
}

static double setpoint(const struct calibrate *c, unsigned axis) {
    return degrees(c->runner.pump->output.status.axis[axis].setpoint_q48);
}

static double measured(const struct calibrate *c, unsigned axis) {
    const struct controller_axis_status *at = &c->runner.pump->output.status.axis[axis];
    return degrees(at->measured_known ? at->measured_q48 : at->setpoint_q48);
}

// ---------------------------------------------------------------- the aim

static bam32_t bam_of(double deg) {
    return bam32((uint32_t)(int64_t)llround(deg * (4294967296.0 / 360.0)));
}

static void push_aim(struct calibrate *c) {
    struct runner *runner = &c->runner;
    const struct mount_joints joints = {bam_of(c->aim_deg[0]), bam_of(c->aim_deg[1])};
    const struct target_update update = {.kind = TARGET_DIRECTION,
                                         .id = 1,
                                         .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                         .direction =
                                             mount_direction(&runner->controller->mount, joints)};
    // A queue that is full gets it the next time.
    (void)!(runner->sim != NULL ? sim_push(runner->sim, &update)
                                : pump_push(runner->pump, &update));
    c->aimed_us = now_us(c);
}

void calibrate_aim(struct calibrate *c, unsigned axis, double deg) {
    c->aim_deg[axis] = deg;
    push_aim(c);
}

bool calibrate_tick(struct calibrate *c) {
    if (now_us(c) - c->aimed_us >= REPEAT_US) {
        push_aim(c);
    }
    return runner_tick(&c->runner);
}

static bool give_up(struct calibrate *c, unsigned axis, const char *why) {
    message_command(c->runner.settings.command, "%s %s", names[axis], why);
    c->runner.status = c->runner.device_failed              ? EXIT_STATUS_DEVICE
                       : c->runner.controller->faults != 0U ? EXIT_STATUS_SAFETY_STOP
                                                            : EXIT_STATUS_FAILURE;
    return false;
}

static bool is_tracking(const struct calibrate *c) {
    return c->runner.controller->mode == MODE_TRACKING;
}

/// Until all drives have answered: nothing moves before.
static bool await_drives(struct calibrate *c) {
    while (c->runner.controller->mode == MODE_STARTING) {
        if (c->runner.device_failed) { // and told
            c->runner.status = EXIT_STATUS_DEVICE;
            return false;
        }
        if (!runner_tick(&c->runner)) {
            return false;
        }
    }
    return true;
}

/// Arms it, and waits until it takes aims.
static bool arm(struct calibrate *c) {
    const uint64_t start_us = now_us(c);
    for (uint64_t told_us = 0; !is_tracking(c);) {
        if (c->runner.stop_pressed || now_us(c) - start_us > PATIENCE_US) {
            return give_up(c, 0, "and tilt can't be armed");
        }
        if (told_us == 0U || now_us(c) - told_us > 500000U) {
            pump_command(c->runner.pump, COMMAND_ARM);
            told_us = now_us(c) + 1U;
        }
        if (!calibrate_tick(c)) {
            return false;
        }
    }
    return true;
}

static void remember_setpoint(struct calibrate *c, unsigned axis) {
    if (c->setpoint_count < CALIBRATE_SETPOINTS) {
        c->setpoint_us[c->setpoint_count] = now_us(c);
        c->setpoint_deg[c->setpoint_count++] = setpoint(c, axis);
    }
}

/// Goes to an angle and stays there for a while. Returns whether it arrived; *took_s: how long
/// until it was there for good.
static bool go(struct calibrate *c, unsigned axis, double deg, double *took_s) {
    const uint64_t start_us = now_us(c);
    uint64_t there_us = 0;
    calibrate_aim(c, axis, deg);
    c->setpoint_count = 0;
    while (there_us == 0U || now_us(c) - there_us < ARRIVED_US) {
        if (!calibrate_tick(c)) {
            return false;
        }
        if (!is_tracking(c)) {
            return give_up(c, axis, "was stopped on its way");
        }
        remember_setpoint(c, axis);
        const bool there = fabs(measured(c, axis) - deg) <= ARRIVED_DEG;
        there_us = !there ? 0U : there_us != 0U ? there_us : now_us(c);
        if (now_us(c) - start_us > PATIENCE_US + (uint64_t)(1e6 * fabs(deg))) {
            return give_up(c, axis, "does not arrive where it is sent");
        }
    }
    *took_s = (double)(there_us - start_us) * 1e-6;
    return true;
}

// ---------------------------------------------------------------- ends

/// Leads the axis away from what stopped it, armed again if that stopped the rig.
static bool lead_back(struct calibrate *c, unsigned axis, double deg) {
    double took_s;
    calibrate_aim(c, axis, deg);
    return (is_tracking(c) || arm(c)) && go(c, axis, deg, &took_s);
}

/// How far an axis came on its way, and since when it is there.
struct headway {
    double most;
    uint64_t since_us, seen_us;
    uint32_t looks; ///< ticks with a new measurement since then
};

/// A rig that is slow to answer is behind, too, but comes nearer.
static bool is_stuck(const struct calibrate *c, unsigned axis, double way,
                     struct headway *headway) {
    const uint64_t seen_us = c->runner.controller->drive[axis].position_us;
    const double at_deg = measured(c, axis);
    headway->looks += seen_us != headway->seen_us ? 1U : 0U;
    headway->seen_us = seen_us;
    if (headway->since_us == 0U || way * at_deg > headway->most + HEADWAY_DEG ||
        way * (setpoint(c, axis) - at_deg) < BEHIND_DEG) {
        *headway = (struct headway){way * at_deg, now_us(c), seen_us, 0};
    }
    return headway->looks >= STUCK_LOOKS && now_us(c) - headway->since_us >= STUCK_US;
}

/// Creeps toward an end. side: 0 low, 1 high.
static bool find_end(struct calibrate *c, unsigned axis, unsigned side, double limit_deg) {
    struct calibrate_axis *result = &c->axis[axis];
    const double way = side == 0U ? -1.0 : 1.0;
    const double tick_s = (double)c->runner.rig.controller.tick_us * 1e-6;
    double aim_deg = measured(c, axis);
    struct headway headway = {0};
    c->runner.pressed = NULL;
    for (;;) {
        aim_deg += way * CREEP_DPS * tick_s;
        aim_deg = way * (aim_deg - limit_deg) > 0.0 ? limit_deg : aim_deg;
        calibrate_aim(c, axis, aim_deg);
        if (!calibrate_tick(c)) {
            return false;
        }
        const double at_deg = measured(c, axis);
        const bool stopped = is_stuck(c, axis, way, &headway);
        const bool pressed = c->runner.pressed != NULL;
        if (stopped || pressed || !is_tracking(c)) {
            if (!stopped && !pressed) {
                return give_up(c, axis, "was stopped on its way to an end");
            }
            result->end[side] = pressed ? CALIBRATE_END_SWITCH : CALIBRATE_END_STOP;
            result->end_deg[side] = at_deg - way * END_MARGIN_DEG;
            return lead_back(c, axis, at_deg - way * BACK_DEG);
        }
        if (fabs(at_deg - limit_deg) <= ARRIVED_DEG) {
            result->end[side] = CALIBRATE_END_LIMIT;
            result->end_deg[side] = limit_deg;
            return true;
        }
    }
}

double calibrate_clamp(double value, double least, double most) {
    return value < least ? least : value > most ? most : value;
}

static void take_limits(struct calibrate *c, unsigned axis, double limit_deg[2]) {
    const struct limiter_config *limits = &c->runner.rig.controller.axis[axis].limits;
    const double most = axis == AXIS_TILT ? TILT_END_DEG : 3600.0;
    limit_deg[0] = calibrate_clamp(degrees(limits->min_q48), -most, most);
    limit_deg[1] = calibrate_clamp(degrees(limits->max_q48), -most, most);
    for (unsigned side = 0; side < 2U; side++) {
        c->axis[axis].end[side] = CALIBRATE_END_LIMIT;
        c->axis[axis].end_deg[side] = limit_deg[side];
    }
}

static bool find_ends(struct calibrate *c, unsigned axis, const double limit_deg[2]) {
    double took_s;
    const double middle = calibrate_clamp(0.0, limit_deg[0], limit_deg[1]);
    for (unsigned side = 0; side < 2U; side++) {
        if (!find_end(c, axis, side, limit_deg[side])) {
            return false;
        }
        if (c->axis[axis].end_deg[0] >= c->axis[axis].end_deg[1]) {
            return give_up(c, axis, "has no room between its ends");
        }
        const double back =
            calibrate_clamp(middle, c->axis[axis].end_deg[0], c->axis[axis].end_deg[1]);
        if (!go(c, axis, back, &took_s)) {
            return false;
        }
    }
    return true;
}

// ---------------------------------------------------------------- moves

/// How long ago the setpoint was where the axis is now; negative: it can't be told.
static double lag_ms(const struct calibrate *c, double at_deg, uint64_t at_us, double fast_dps) {
    for (uint32_t i = c->setpoint_count; i-- > 1U;) {
        const double a = c->setpoint_deg[i - 1U], b = c->setpoint_deg[i];
        const double step_s = (double)(c->setpoint_us[i] - c->setpoint_us[i - 1U]) * 1e-6;
        if (a == b || (at_deg - a) * (at_deg - b) > 0.0) {
            continue;
        }
        if (fabs(b - a) < fast_dps * step_s) {
            return -1.0;
        }
        const double then_us =
            (double)c->setpoint_us[i - 1U] + (at_deg - a) / (b - a) * step_s * 1e6;
        return ((double)at_us - then_us) * 1e-3;
    }
    return -1.0;
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/// As go, and looks at each measurement on the way.
static bool go_measured(struct calibrate *c, unsigned axis, double deg, double fast_dps) {
    const struct drive *drive = &c->runner.controller->drive[axis];
    const uint64_t start_us = now_us(c);
    uint64_t seen_us = drive->position_us, from_us = seen_us;
    double from_deg = degrees(drive->position_q48);
    calibrate_aim(c, axis, deg);
    c->setpoint_count = 0;
    while (fabs(measured(c, axis) - deg) > ARRIVED_DEG && now_us(c) - start_us < PATIENCE_US) {
        if (!calibrate_tick(c) || !is_tracking(c)) {
            return false;
        }
        remember_setpoint(c, axis);
        if (drive->position_us == seen_us) {
            continue;
        }
        const double at_deg = degrees(drive->position_q48);
        if (drive->position_us - from_us >= SPEED_OVER_US) {
            const double speed =
                fabs(at_deg - from_deg) * 1e6 / (double)(drive->position_us - from_us);
            c->axis[axis].speed_dps = fmax(c->axis[axis].speed_dps, speed);
            from_us = drive->position_us;
            from_deg = at_deg;
        }
        seen_us = drive->position_us;
        const double lag = lag_ms(c, at_deg, seen_us, fast_dps);
        if (lag >= 0.0 && c->lag_count < CALIBRATE_LAGS) {
            c->lag_ms[c->lag_count++] = lag;
        }
    }
    return true;
}

static bool measure_moves(struct calibrate *c, unsigned axis) {
    struct calibrate_axis *result = &c->axis[axis];
    const double most = axis == AXIS_TILT ? TILT_MOST_DEG : 3600.0;
    const double low = calibrate_clamp(result->end_deg[0] + RANGE_SLACK_DEG, -most, most);
    const double high = calibrate_clamp(result->end_deg[1] - RANGE_SLACK_DEG, -most, most);
    double from = low, to = high, there_s, back_s;
    for (unsigned i = 0; i < CALIBRATE_MOVES && amplitudes_deg[i] <= high - low; i++) {
        from = 0.5 * (low + high - amplitudes_deg[i]);
        to = from + amplitudes_deg[i];
        if (!go(c, axis, from, &there_s) || !go(c, axis, to, &there_s) ||
            !go(c, axis, from, &back_s)) {
            return false;
        }
        result->move_deg[result->move_count] = amplitudes_deg[i];
        result->move_s[result->move_count++] = fmax(there_s, back_s);
    }
    // Half of the top speed of a move this long: the fast part.
    const struct limiter_config *limits = &c->runner.rig.controller.axis[axis].limits;
    const double ticks = 1e6 / c->runner.rig.controller.tick_us;
    const double accel = degrees(limits->accel_max_q48) * ticks * ticks;
    const double top = fmin(degrees(limits->speed_max_q48) * ticks, sqrt(accel * fabs(to - from)));
    c->lag_count = 0;
    if (!go(c, axis, from, &there_s) || !go_measured(c, axis, to, 0.5 * top) ||
        !go(c, axis, to, &there_s) || !go_measured(c, axis, from, 0.5 * top) ||
        !go(c, axis, from, &there_s)) {
        return false;
    }
    if (c->lag_count == 0U) {
        return give_up(c, axis, "has too little room to measure its latency");
    }
    qsort(c->lag_ms, c->lag_count, sizeof *c->lag_ms, compare);
    result->latency_ms = c->lag_ms[c->lag_count / 2U];
    return go(c, axis, calibrate_clamp(0.0, low, high), &there_s);
}

// ---------------------------------------------------------------- the whole

static bool measure_axes(struct calibrate *c, bool with_ends, double limit_deg[2][2]) {
    for (unsigned axis = 0; axis < 2U; axis++) {
        double took_s;
        if (c->axis[axis].measured && !go(c, axis, c->aim_deg[axis], &took_s)) {
            return false;
        }
    }
    for (unsigned axis = 0; axis < 2U; axis++) {
        if (c->axis[axis].measured &&
            ((with_ends && !find_ends(c, axis, limit_deg[axis])) || !measure_moves(c, axis))) {
            return false;
        }
    }
    return true;
}

static bool measure(struct calibrate *c, const struct calibrate_settings *settings) {
    double limit_deg[2][2];
    for (unsigned axis = 0; axis < 2U; axis++) {
        take_limits(c, axis, limit_deg[axis]);
        c->aim_deg[axis] = calibrate_clamp(0.0, limit_deg[axis][0], limit_deg[axis][1]);
        c->axis[axis].measured =
            !settings->only_camera && drive_has_feedback(&c->runner.controller->drive[axis]);
    }
    if (!runner_tick(&c->runner)) {
        return false;
    }
    if (!await_drives(c)) {
        return false;
    }
    message_command(settings->command, "pan and tilt move now, within the limits of %s",
                    settings->rig_file);
    push_aim(c);
    return arm(c) && measure_axes(c, settings->with_ends, limit_deg) && calibrate_camera(c);
}

/// Is there anything to measure? Tells why not.
static bool has_something(const struct calibrate *c, const struct calibrate_settings *settings) {
    const bool camera = c->runner.camera.eye != NULL;
    bool any = camera;
    for (unsigned axis = 0; axis < 2U && !settings->only_camera; axis++) {
        any = any || drive_has_feedback(&c->runner.controller->drive[axis]);
    }
    if (!any) {
        message_at(settings->rig_file, 0,
                   settings->only_camera
                       ? "[camera] names no device: there is nothing to measure"
                       : "neither axis measures its position, and there is no camera: there is "
                         "nothing to measure");
    }
    return any;
}

/// What a board drives is not this program's to move, and the drives in the file are not here.
static enum exit_status refuse_board(const char *file) {
    struct rig rig;
    enum exit_status status = rig_read(file, 0, &rig);
    if (status == EXIT_STATUS_OK && rig.board_device != NULL) {
        ini_complain(&rig.ini, "controller", "", "board",
                     "drives the rig: only what this program drives itself can be measured");
        status = EXIT_STATUS_USAGE;
    }
    rig_free(&rig);
    return status;
}

enum exit_status calibrate_run(struct calibrate *c, const struct calibrate_settings *settings) {
    const struct runner_settings running = {.command = settings->command,
                                            .rig_file = settings->rig_file,
                                            .see_through = true,
                                            .arm = true,
                                            .stay = true,
                                            .hurry = true,
                                            .fixed = true};
    enum exit_status status = refuse_board(settings->rig_file);
    status = status == EXIT_STATUS_OK ? runner_start(&c->runner, &running) : status;
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    if (!has_something(c, settings)) {
        return EXIT_STATUS_USAGE;
    }
    calibrate_camera_rests(c);
    const bool good = measure(c, settings);
    status = c->runner.status;
    if (!good && status == EXIT_STATUS_OK) {
        message_command(settings->command, "interrupted: nothing is written");
        return EXIT_STATUS_FAILURE;
    }
    c->runner.status = EXIT_STATUS_OK;
    runner_stop(&c->runner);
    while (runner_tick(&c->runner)) {
    }
    calibrate_camera_fit(c); // takes its time, and all stands still
    return good ? c->runner.status : status;
}

void calibrate_close(struct calibrate *c) {
    runner_close(&c->runner);
}
