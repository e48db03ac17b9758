#include "calibrate_private.h"

#include "degrees.h"

#include <math.h>
#include <string.h>

#define CREEP_DPS      10.0   ///< toward an end
#define BEHIND_DEG     0.7    ///< an axis so far behind while it creeps has met something ...
#define STUCK_US       60000U ///< ... if it comes no further for so long ...
#define STUCK_LOOKS    4U     ///< ... by that many measurements: it may be the machine that paused
#define HEADWAY_DEG    0.02
#define END_MARGIN_DEG 2.0 ///< from what stops it
#define BACK_DEG       5.0 ///< away from it at once
#define ARRIVED_US     200000U
#define PATIENCE_US    20000000U
#define REPEAT_US      100000U ///< the aim is told again, for rigs whose targets expire
#define TILT_END_DEG   89.5

static const char *const names[] = {"pan", "tilt"};

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

bool calibrate_give_up(struct calibrate *c, unsigned axis, const char *why) {
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
        if (c->runner.stop_pressed || c->runner.outside[AXIS_PAN] || c->runner.outside[AXIS_TILT] ||
            now_us(c) - start_us > PATIENCE_US) {
            return calibrate_give_up(c, 0, "and tilt can't be armed");
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

/// Goes to an angle and stays there for a while; the trace tells how. Returns whether it arrived.
bool calibrate_go(struct calibrate *c, unsigned axis, double deg) {
    const uint64_t start_us = now_us(c);
    uint64_t there_us = 0;
    calibrate_aim(c, axis, deg);
    calibrate_trace_begin(&c->trace);
    while (there_us == 0U || now_us(c) - there_us < ARRIVED_US) {
        if (!calibrate_tick(c)) {
            return false;
        }
        if (!is_tracking(c)) {
            return calibrate_give_up(c, axis, "was stopped on its way");
        }
        const struct drive *const drive = &c->runner.controller->drive[axis];
        calibrate_trace_add(&c->trace, now_us(c), setpoint(c, axis), drive->position_us,
                            degrees(drive->position_q48));
        const bool there = fabs(measured(c, axis) - deg) <= CALIBRATE_ARRIVED_DEG;
        there_us = !there ? 0U : there_us != 0U ? there_us : now_us(c);
        if (now_us(c) - start_us > PATIENCE_US + (uint64_t)(1e6 * fabs(deg))) {
            return calibrate_give_up(c, axis, "does not arrive where it is sent");
        }
    }
    return true;
}

// ---------------------------------------------------------------- ends

/// Leads the axis away from what stopped it, armed again if that stopped the rig.
static bool lead_back(struct calibrate *c, unsigned axis, double deg) {
    calibrate_aim(c, axis, deg);
    return (is_tracking(c) || arm(c)) && calibrate_go(c, axis, deg);
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
                return calibrate_give_up(c, axis, "was stopped on its way to an end");
            }
            result->end[side] = pressed ? CALIBRATE_END_SWITCH : CALIBRATE_END_STOP;
            result->end_deg[side] = at_deg - way * END_MARGIN_DEG;
            return lead_back(c, axis, at_deg - way * BACK_DEG);
        }
        if (fabs(at_deg - limit_deg) <= CALIBRATE_ARRIVED_DEG) {
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
    const double middle = calibrate_clamp(0.0, limit_deg[0], limit_deg[1]);
    for (unsigned side = 0; side < 2U; side++) {
        if (!find_end(c, axis, side, limit_deg[side])) {
            return false;
        }
        if (c->axis[axis].end_deg[0] >= c->axis[axis].end_deg[1]) {
            return calibrate_give_up(c, axis, "has no room between its ends");
        }
        const double back =
            calibrate_clamp(middle, c->axis[axis].end_deg[0], c->axis[axis].end_deg[1]);
        if (!calibrate_go(c, axis, back)) {
            return false;
        }
    }
    return true;
}

// ---------------------------------------------------------------- the whole

static bool measure_axes(struct calibrate *c, bool with_ends, double limit_deg[2][2]) {
    for (unsigned axis = 0; axis < 2U; axis++) {
        if (c->axis[axis].measured && !calibrate_go(c, axis, c->aim_deg[axis])) {
            return false;
        }
    }
    for (unsigned axis = 0; axis < 2U; axis++) {
        if (c->axis[axis].measured &&
            ((with_ends && !find_ends(c, axis, limit_deg[axis])) || !calibrate_moves(c, axis))) {
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
