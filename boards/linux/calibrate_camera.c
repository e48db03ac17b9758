#include "calibrate_private.h"

#include <math.h>

#define LOOK_US       3000000U ///< for something to be seen
#define SEEN_FRAMES   5U       ///< that show it
#define SWING_DEG     8.0      ///< to either side, at most
#define SWING_PART    0.3      ///< of the picture's width, at most
#define SWING_S       2.0      ///< there and back
#define SWINGS        4U
#define SWING_DEG_MIN 2.0

static const double turn = 2.0 * 3.14159265358979323846;

static uint64_t now_us(const struct calibrate *c) {
    return c->runner.pump->output.status.time_us;
}

static void see(void *context, const struct eye *eye) {
    struct calibrate *c = context;
    const struct detections *found = eye_last(eye);
    for (uint32_t i = 0; i < found->count; i++) {
        double ray[3];
        if (eye_last_ray(eye, i, ray)) {
            camera_latency_sight(&c->sights, eye_last_stamp_us(eye), found->item[i].id, ray);
        }
    }
}

void calibrate_camera_rests(struct calibrate *c) {
    c->runner.camera.seen = see;
    c->runner.camera.seen_context = c;
    c->runner.camera.resting = true;
}

static void begin(struct calibrate *c) {
    camera_latency_init(&c->sights, &c->runner.controller->mount, &c->runner.rig.eye.seat);
}

static bool tick(struct calibrate *c) {
    const bool good = calibrate_tick(c);
    camera_latency_pose(&c->sights, c->runner.camera.pose_us, &c->runner.camera.pose);
    return good;
}

static bool is_stopped(const struct calibrate *c) {
    return c->runner.controller->mode != MODE_TRACKING;
}

/// Waits until something is seen. False: the rig was stopped.
static bool look(struct calibrate *c) {
    const uint64_t start_us = now_us(c);
    begin(c);
    while (c->sights.sight_count < SEEN_FRAMES && now_us(c) - start_us < LOOK_US) {
        if (!tick(c)) {
            return false;
        }
    }
    if (c->sights.sight_count < SEEN_FRAMES) {
        c->camera.why_not = "the camera sees nothing to measure by: put a tag or a lamp before it";
    }
    return true;
}

/// How far pan may swing, so that what is in the middle stays in the picture, and around what.
static double room(const struct calibrate *c, double *middle_deg) {
    const struct camera_model *model = &c->runner.rig.eye.model;
    const double width_deg = atan(0.5 * model->width_px / model->fx_px) * 2.0 * (360.0 / turn);
    const double swing_deg = fmin(SWING_DEG, SWING_PART * width_deg);
    const double low_deg = c->axis[AXIS_PAN].end_deg[0], high_deg = c->axis[AXIS_PAN].end_deg[1];
    const double most_deg = fmin(swing_deg, 0.5 * (high_deg - low_deg));
    *middle_deg = calibrate_clamp(c->aim_deg[AXIS_PAN], low_deg + most_deg, high_deg - most_deg);
    return most_deg;
}

bool calibrate_camera(struct calibrate *c) {
    double middle_deg;
    if (c->runner.camera.eye == NULL) {
        return true;
    }
    c->runner.camera.resting = false;
    if (!look(c)) {
        return false;
    }
    const double swing_deg = room(c, &middle_deg);
    if (c->camera.why_not == NULL && swing_deg < SWING_DEG_MIN) {
        c->camera.why_not = "pan has too little room";
    }
    begin(c);
    const uint64_t start_us = now_us(c);
    for (double at_s = 0.0; c->camera.why_not == NULL && at_s < SWINGS * SWING_S;
         at_s = (double)(now_us(c) - start_us) * 1e-6) {
        calibrate_aim(c, AXIS_PAN, middle_deg + swing_deg * sin(turn * at_s / SWING_S));
        if (!tick(c)) {
            return false;
        }
        if (is_stopped(c)) {
            message_command(c->runner.settings.command, "pan was stopped on its way");
            c->runner.status = EXIT_STATUS_SAFETY_STOP;
            return false;
        }
    }
    c->runner.camera.resting = true;
    return true;
}

void calibrate_camera_fit(struct calibrate *c) {
    struct calibrate_camera *camera = &c->camera;
    if (c->runner.camera.seen == NULL || c->runner.rig.camera.device[0] == '\0' ||
        camera->why_not != NULL) {
        return;
    }
    camera->sights = c->sights.sight_count;
    struct camera_latency_found found;
    camera->why_not = camera_latency_fit(&c->sights, &found);
    camera->measured = camera->why_not == NULL;
    if (camera->measured) {
        camera->latency_ms = found.latency_ms;
        camera->rms_deg = found.rms_deg;
        camera->given_fx_px = c->runner.rig.eye.model.fx_px;
        camera->given_fy_px = c->runner.rig.eye.model.fy_px;
        camera->fx_px = camera->given_fx_px * found.lens;
    }
}
