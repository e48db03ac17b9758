#include "rig.h"

#include "degrees.h"
#include "rig_schema.h"
#include "u128.h"

#include "drive/rmd.h"
#include "linux/linux_camera_servo.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char *const axis_names[] = {"pan", "tilt", "zoom"};

/// Between the limits: as many as pulses of a PWM drive have nanoseconds.
#define RIG_STEPS_MAX     18000000
#define RIG_STEP_RATE_MAX 75000

/// A rate per second (or per second^power) as a rate per tick, rounded down, at least 1.
static int64_t per_tick(int64_t rate, uint32_t tick_us, unsigned power) {
    int64_t scaled = rate;
    for (unsigned i = 0; i < power; i++) {
        scaled = i64_mul_div(scaled, tick_us, 1000000);
    }
    return scaled < 1 ? 1 : scaled;
}

// ---------------------------------------------------------------- axes

static bool build_limits(const struct ini *ini, const char *name, const struct rig_axis *from,
                         uint32_t tick_us, struct limiter_config *limits) {
    if (from->limit_min_q48 > from->limit_max_q48) {
        ini_complain(ini, name, "", "limit_max_deg", "is below limit_min_deg");
        return false;
    }
    limits->min_q48 = from->limit_min_q48;
    limits->max_q48 = from->limit_max_q48;
    limits->speed_max_q48 = per_tick(from->speed_q48, tick_us, 1);
    limits->accel_max_q48 = per_tick(from->accel_q48, tick_us, 2);
    limits->smooth_ticks = 1;
    if (from->jerk_q48 != 0) {
        // 2 accel / jerk seconds of smoothing keep the jerk (motion/limiter.h). jerk_q48 has 2^40 a
        // turn.
        const int64_t smooth_us = i64_mul_div(from->accel_q48, 2000000, from->jerk_q48 * 256);
        if (smooth_us > (int64_t)LIMITER_SMOOTH_TICKS_MAX * tick_us) {
            const double most = (double)LIMITER_SMOOTH_TICKS_MAX * tick_us * 1e-6 / 2.0 *
                                (double)from->jerk_q48 * 360.0 / 1099511627776.0;
            ini_complain(ini, name, "", "accel_max_dps2",
                         "takes too long to build up at this jerk_max_dps3: at most %.1f", most);
            return false;
        }
        limits->smooth_ticks = smooth_us < 1 ? 1U : (uint32_t)((smooth_us + tick_us - 1) / tick_us);
    }
    return true;
}

static bool build_pwm(const struct ini *ini, const char *name, const struct rig_axis *from,
                      struct drive_pwm_config *pwm) {
    if (from->calibration_q48.count != 2U || from->calibration_ns.count != 2U) {
        ini_complain(ini, name, "",
                     from->calibration_q48.count != 2U ? "calibration_deg" : "calibration_us",
                     "needs two values");
        return false;
    }
    if (from->calibration_q48.item[0] >= from->calibration_q48.item[1] ||
        from->calibration_ns.item[0] == from->calibration_ns.item[1]) {
        ini_complain(ini, name, "", "calibration_deg", "needs two rising angles with two pulses");
        return false;
    }
    if (from->limit_min_q48 < from->calibration_q48.item[0] ||
        from->limit_max_q48 > from->calibration_q48.item[1]) {
        ini_complain(ini, name, "", "calibration_deg", "does not reach the limits");
        return false;
    }
    *pwm = (struct drive_pwm_config){.channel = (uint32_t)from->channel,
                                     .low_q48 = from->calibration_q48.item[0],
                                     .high_q48 = from->calibration_q48.item[1],
                                     .low_pulse_ns = (uint32_t)from->calibration_ns.item[0],
                                     .high_pulse_ns = (uint32_t)from->calibration_ns.item[1]};
    return true;
}

/// A turn has so many arc-seconds, and each is a nanosecond of pulse.
#define TURN_ARCSEC 1296000

/// A camera's own axis: half a turn to either side, whatever it can do of that; its channels are in
/// the order of the axes.
static bool build_uvc(const struct ini *ini, unsigned axis, const struct rig_axis *from,
                      struct drive_pwm_config *pwm) {
    if (from->limit_min_q48 < -AXIS_TURN_Q48 / 2 || from->limit_max_q48 > AXIS_TURN_Q48 / 2) {
        ini_complain(ini, axis_names[axis], "", "drive",
                     "is uvc: its limits are at most 180 degrees to either side");
        return false;
    }
    *pwm = (struct drive_pwm_config){.channel = axis,
                                     .low_q48 = -AXIS_TURN_Q48 / 2,
                                     .high_q48 = AXIS_TURN_Q48 / 2,
                                     .low_pulse_ns = LINUX_CAMERA_SERVO_ZERO_NS - TURN_ARCSEC / 2,
                                     .high_pulse_ns = LINUX_CAMERA_SERVO_ZERO_NS + TURN_ARCSEC / 2};
    return true;
}

/// Of an angle, rounded down; per_turn_micro: millionths of a step a turn.
static int64_t steps(int64_t angle_q48, int64_t per_turn_micro) {
    return i64_mul_div(angle_q48, per_turn_micro, AXIS_TURN_Q48) / 1000000;
}

/// Steps as pulses of a PWM drive: see rig.h.
static bool build_step(const struct ini *ini, const char *name, const struct rig_axis *from,
                       struct drive_pwm_config *pwm, struct rig_step *step) {
    if (strncmp(from->device, "gpio:", 5) != 0) {
        ini_complain(ini, name, "", "device", "is '%s'; a stepper driver is on gpio:CHIP",
                     from->device);
        return false;
    }
    const int64_t per_turn_micro = from->steps_per_deg_micro * 360;
    const int64_t count = steps(from->limit_max_q48 - from->limit_min_q48, per_turn_micro) + 1;
    if (from->steps_per_deg_micro == 0 || count > RIG_STEPS_MAX) {
        ini_complain(ini, name, "", "steps_per_deg",
                     from->steps_per_deg_micro == 0 ? "has to be told for drive = step"
                                                    : "gives too many steps between the limits");
        return false;
    }
    const int64_t unit_ns = RIG_STEPS_MAX / count < 1000 ? RIG_STEPS_MAX / count : 1000;
    const int64_t rate = steps(from->speed_q48, per_turn_micro);
    if (rate > RIG_STEP_RATE_MAX) {
        ini_complain(ini, name, "", "speed_max_dps", "takes more than %d steps a second",
                     RIG_STEP_RATE_MAX);
        return false;
    }
    *pwm = (struct drive_pwm_config){
        .channel = (uint32_t)from->channel,
        .low_q48 = from->limit_min_q48,
        .high_q48 =
            from->limit_min_q48 + i64_mul_div(count * 1000000, AXIS_TURN_Q48, per_turn_micro),
        .low_pulse_ns = RIG_STEP_BASE_NS,
        .high_pulse_ns = RIG_STEP_BASE_NS + (uint32_t)(count * unit_ns)};
    *step = (struct rig_step){.unit_ns = (uint32_t)unit_ns,
                              .direction_channel = (uint32_t)from->direction_channel,
                              .rate_max = (uint32_t)(rate + rate / 4 + 50), // to catch up
                              .home_steps =
                                  steps(from->home_q48 - from->limit_min_q48, per_turn_micro)};
    return true;
}

static bool build_axis(const struct rig_file *file, const struct ini *ini, unsigned axis,
                       struct rig *rig) {
    const struct rig_axis *from = &file->axis[axis];
    struct controller_axis_config *to = &rig->controller.axis[axis];
    const char *name = axis_names[axis];
    if (!build_limits(ini, name, from, rig->controller.tick_us, &to->limits)) {
        return false;
    }
    if (from->home_q48 < from->limit_min_q48 || from->home_q48 > from->limit_max_q48) {
        ini_complain(ini, name, "", "home_deg", "is outside the limits");
        return false;
    }
    to->home_q48 = from->home_q48;
    if (from->move_mdeg.count != from->move_ms.count) {
        ini_complain(ini, name, "", "move_s", "needs as many values as move_deg");
        return false;
    }
    to->latency_us = (uint32_t)from->latency_us;
    rig->bus[axis] = from->drive == RIG_DRIVE_FAKE ? "fake" : from->bus;
    rig->device[axis] = from->device;
    rig->limit_switch[axis][0] = from->switch_min;
    rig->limit_switch[axis][1] = from->switch_max;
    if (from->drive == RIG_DRIVE_PWM) {
        to->drive.kind = DRIVE_PWM;
        return build_pwm(ini, name, from, &to->drive.pwm);
    }
    if (from->drive == RIG_DRIVE_UVC) {
        rig->is_uvc[axis] = true;
        to->drive.kind = DRIVE_PWM;
        return build_uvc(ini, axis, from, &to->drive.pwm);
    }
    if (from->drive == RIG_DRIVE_STEP) {
        to->drive.kind = DRIVE_PWM;
        return build_step(ini, name, from, &to->drive.pwm, &rig->step[axis]);
    }
    // A little above our own limit: a drive that lags needs some speed to catch up.
    const double speed_dps = degrees(from->speed_q48);
    to->drive.kind = DRIVE_RMD;
    to->drive.rmd = (struct drive_rmd_config){
        .id = (uint8_t)(from->id != 0 ? from->id : axis + 1),
        .reply_offset = from->dialect == 0 ? RMD_REPLY_OFFSET_V3 : RMD_REPLY_OFFSET_LK,
        .reversed = from->reversed,
        .zero_q48 = from->zero_q48,
        .speed_max_dps = (uint16_t)(speed_dps * 1.05 + 1.0),
        .watchdog_ms = (uint32_t)file->safety.watchdog_ms};
    return true;
}

// ---------------------------------------------------------------- zoom

/// The lens' axis runs in proportion to its pulse width: 0 at the first, one turn at the last
/// calibrated point.
static bool build_lens(const struct rig_zoom *from, const struct ini_numbers *pulse_ns,
                       const char *key, const struct ini *ini, struct rig *rig) {
    struct lens_config *lens = &rig->controller.lens;
    const uint32_t count = from->focal_um.count;
    if (count != pulse_ns->count || count < 2U || count > LENS_TABLE_MAX) {
        ini_complain(ini, "zoom", "", "focal_mm",
                     "and %s need as many values as each other, 2 to %u", key, LENS_TABLE_MAX);
        return false;
    }
    const int64_t first = pulse_ns->item[0], last = pulse_ns->item[count - 1U];
    lens->point_count = count;
    for (uint32_t i = 0; i < count; i++) {
        const int64_t part = pulse_ns->item[i] - first, whole = last - first;
        lens->point[i].focal_um = (uint32_t)from->focal_um.item[i];
        lens->point[i].position_q48 = whole == 0 ? 0 : i64_mul_div(part, AXIS_TURN_Q48, whole);
    }
    if (first == last || !lens_valid(lens)) {
        ini_complain(ini, "zoom", "", first == last ? key : "focal_mm",
                     "must rise from point to point (%s may also fall)", key);
        return false;
    }
    return true;
}

static bool build_zoom(const struct rig_file *file, const struct ini *ini, struct rig *rig) {
    struct lens_config *lens = &rig->controller.lens;
    lens->sensor_width_um = (uint32_t)file->camera.sensor_width_um;
    lens->sensor_height_um = (uint32_t)file->camera.sensor_height_um;
    lens->margin_q16 = (uint32_t)file->camera.margin_q16;
    rig->controller.frame = (enum controller_frame)file->camera.frame;
    rig->fixed_focal_mm = (double)file->camera.focal_um / 1000.0;
    const int64_t width = file->camera.sensor_width_um, height = file->camera.sensor_height_um;
    if (rig->controller.frame == CONTROLLER_FRAME_RECT &&
        (width > height * RECTANGLE_ASPECT_MAX || height > width * RECTANGLE_ASPECT_MAX)) {
        ini_complain(ini, "camera", "", "frame", "rect needs sides of at most %d to 1",
                     RECTANGLE_ASPECT_MAX);
        return false;
    }
    if (!file->has_zoom) {
        return true;
    }
    const struct rig_zoom *from = &file->zoom;
    struct controller_axis_config *zoom = &rig->controller.axis[AXIS_ZOOM];
    const uint32_t tick_us = rig->controller.tick_us;
    zoom->limits = (struct limiter_config){.max_q48 = AXIS_TURN_Q48, .smooth_ticks = 1};
    zoom->limits.speed_max_q48 =
        per_tick(i64_mul_div(AXIS_TURN_Q48, 1000000, from->travel_us), tick_us, 1);
    const int64_t ramp_ticks = from->ramp_us / tick_us < 1 ? 1 : from->ramp_us / tick_us;
    zoom->limits.accel_max_q48 = zoom->limits.speed_max_q48 / ramp_ticks;
    zoom->limits.accel_max_q48 += zoom->limits.accel_max_q48 == 0;
    zoom->drive.kind = DRIVE_PWM;
    rig->device[AXIS_ZOOM] = from->device;
    struct ini_numbers pulse_ns = from->pulse_ns;
    rig->is_uvc[AXIS_ZOOM] = from->drive == RIG_ZOOM_UVC;
    if (rig->is_uvc[AXIS_ZOOM]) {
        pulse_ns = from->units;
        for (uint32_t i = 0; i < pulse_ns.count; i++) {
            pulse_ns.item[i] += LINUX_CAMERA_SERVO_ZERO_NS;
        }
    }
    if (!build_lens(from, &pulse_ns, rig->is_uvc[AXIS_ZOOM] ? "zoom_units" : "pulse_us", ini,
                    rig)) {
        return false;
    }
    zoom->drive.pwm = (struct drive_pwm_config){
        .channel = rig->is_uvc[AXIS_ZOOM] ? (uint32_t)AXIS_ZOOM : (uint32_t)from->channel,
        .low_q48 = 0,
        .high_q48 = AXIS_TURN_Q48,
        .low_pulse_ns = (uint32_t)pulse_ns.item[0],
        .high_pulse_ns = (uint32_t)pulse_ns.item[pulse_ns.count - 1U]};
    return true;
}

// ---------------------------------------------------------------- the whole

static bam32_t wrap_bam(int64_t bam) {
    return bam32((uint32_t)(uint64_t)bam);
}

static bool build_mount(const struct rig_file *file, const struct ini *ini,
                        struct controller_config *controller) {
    const struct ini_numbers *position = &file->mount.position_um;
    if (position->count != 3U) {
        ini_complain(ini, "mount", "", "position_m", "needs three values: east, north, up");
        return false;
    }
    controller->position_um =
        (struct vec3_i64){position->item[0], position->item[1], position->item[2]};
    controller->attitude =
        (struct mount_attitude){wrap_bam(file->mount.heading_bam), wrap_bam(file->mount.pitch_bam),
                                wrap_bam(file->mount.roll_bam)};
    return true;
}

static void build_settings(const struct rig_file *file, struct controller_config *controller) {
    controller->target_expiry_us = (uint64_t)file->controller.expiry_us;
    controller->tracker = (struct tracker_config){
        .jump_q48 = file->controller.jump_q48,
        .memory_q16 = (uint32_t)file->controller.smoothing_q16,
        .coast_ticks = (uint32_t)(file->controller.coast_us / controller->tick_us)};
    controller->silence_us = (uint32_t)file->safety.silence_us;
    controller->settle_us = (uint32_t)file->safety.settle_us;
    controller->follow_error_q48 = file->safety.follow_error_q48;
    controller->follow_error_us = (uint32_t)file->safety.follow_error_us;
    controller->arm_on_start = file->safety.arm_on_start;
}

/// `serial:DEVICE`, or nothing.
static bool build_board(const struct rig_file *file, const struct ini *ini, struct rig *rig) {
    static const char scheme[] = "serial:";
    const size_t size = sizeof scheme - 1U;
    const char *board = file->controller.board;
    rig->board_baud = (uint32_t)file->controller.board_baud;
    rig->any_board_build = file->controller.board_build == RIG_BOARD_ANY;
    if (board[0] == '\0') {
        return true;
    }
    if (strncmp(board, scheme, size) != 0 || board[size] == '\0') {
        ini_complain(ini, "controller", "", "board", "needs serial: and a device: %s",
                     "serial:/dev/ttyACM0");
        return false;
    }
    rig->board_device = board + size;
    return true;
}

static bool channels_differ(const struct rig *rig) {
    const struct ini *ini = &rig->ini;
    const struct controller_config *controller = &rig->controller;
    for (unsigned a = 0; a < AXIS_COUNT; a++) {
        for (unsigned b = a + 1U; b < AXIS_COUNT; b++) {
            const struct drive_config *x = &controller->axis[a].drive,
                                      *y = &controller->axis[b].drive;
            if (x->kind == DRIVE_PWM && y->kind == DRIVE_PWM && x->pwm.channel == y->pwm.channel &&
                strcmp(rig->device[a], rig->device[b]) == 0) {
                ini_complain(ini, axis_names[b], "", "channel", "is that of %s", axis_names[a]);
                return false;
            }
            if (x->kind == DRIVE_RMD && y->kind == DRIVE_RMD && x->rmd.id == y->rmd.id) {
                ini_complain(ini, axis_names[b], "", "id", "is that of %s", axis_names[a]);
                return false;
            }
        }
    }
    return true;
}

static bool build_occlusion(const struct rig_file *file, struct rig *rig) {
    rig->has_occlusion = file->has_occlusion;
    rig->scene =
        file->occlusion.scene[0] != '\0' ? ini_beside(&rig->ini, file->occlusion.scene) : NULL;
    return occlusion_file_read(&file->occlusion, &rig->ini, &rig->occlusion);
}

enum exit_status rig_read(const char *path, uint32_t tick_us, struct rig *out) {
    memset(out, 0, sizeof *out);
    struct rig_file file;
    memset(&file, 0, sizeof file);
    enum exit_status status = ini_read(path, &out->ini);
    if (status == EXIT_STATUS_OK) {
        status = ini_apply(&out->ini, &rig_schema, &file);
    }
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    out->controller.tick_us = tick_us != 0U ? tick_us : (uint32_t)file.controller.tick_us;
    build_settings(&file, &out->controller);
    out->estop = file.safety.estop;
    out->enable = file.safety.enable;
    out->debounce_us = (uint32_t)file.safety.debounce_us;
    const bool built =
        build_mount(&file, &out->ini, &out->controller) && build_board(&file, &out->ini, out) &&
        build_axis(&file, &out->ini, AXIS_PAN, out) &&
        build_axis(&file, &out->ini, AXIS_TILT, out) && build_zoom(&file, &out->ini, out) &&
        channels_differ(out) && rig_camera_build(&file.camera, &out->ini, &out->eye) &&
        rig_frames_build(&file.camera, &out->ini, &out->camera) && build_occlusion(&file, out);
    if (!built || (out->board_device != NULL && !rig_fits_board(out))) {
        return EXIT_STATUS_USAGE;
    }
    if (out->board_device != NULL && out->camera.device[0] != '\0') {
        ini_complain(&out->ini, "camera", "", "device",
                     "is not looked at when a board drives the rig: leave it out");
        return EXIT_STATUS_USAGE;
    }
    return EXIT_STATUS_OK;
}

bool rig_fits_board(const struct rig *rig) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (rig->is_uvc[axis]) {
            ini_complain(&rig->ini, axis_names[axis], "", "drive",
                         "is uvc, which only this computer can drive, not a board");
            return false;
        }
        if (axis < AXIS_ZOOM && rig->step[axis].unit_ns != 0U) {
            ini_complain(&rig->ini, axis_names[axis], "", "drive",
                         "is step, which only this computer can drive, not a board");
            return false;
        }
    }
    return true;
}

void rig_free(struct rig *rig) {
    ini_free(&rig->ini);
}

bool rig_is_fake(const struct rig *rig) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct drive_config *drive = &rig->controller.axis[axis].drive;
        const bool fake_bus = drive->kind != DRIVE_RMD || strcmp(rig->bus[axis], "fake") == 0;
        const bool fake_device = drive->kind != DRIVE_PWM || strcmp(rig->device[axis], "fake") == 0;
        if (!fake_bus || !fake_device) {
            return false;
        }
    }
    return true;
}

// ---------------------------------------------------------------- explanation

/// Time from standstill to standstill over an angle, at these limits.
static double slew_s(const struct limiter_config *limits, uint32_t tick_us, double angle_deg) {
    const double ticks = 1e6 / tick_us;
    const double speed = degrees(limits->speed_max_q48) * ticks;
    const double accel = degrees(limits->accel_max_q48) * ticks * ticks;
    const double smooth = limits->smooth_ticks / ticks;
    const double ramp_deg = speed * speed / accel;
    if (angle_deg >= ramp_deg) {
        return angle_deg / speed + speed / accel + smooth;
    }
    double root = angle_deg / accel + 1.0;
    for (int i = 0; i < 60; i++) { // Heron, so that nothing here needs libm
        root = 0.5 * (root + angle_deg / accel / root);
    }
    return 2.0 * root + smooth;
}

void rig_explain(const struct rig *rig, FILE *stream) {
    ini_explain(&rig->ini, &rig_schema, stream);
    fprintf(stream, "\nwhat follows from it\n");
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        const struct limiter_config *limits = &rig->controller.axis[axis].limits;
        fprintf(
            stream,
            "  %-6s turns 10 degrees in %.2f s and 90 degrees in %.2f s, smoothed over %.0f ms\n",
            axis_names[axis], slew_s(limits, rig->controller.tick_us, 10.0),
            slew_s(limits, rig->controller.tick_us, 90.0),
            limits->smooth_ticks * rig->controller.tick_us / 1000.0);
    }
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        const uint32_t latency_us = rig->controller.axis[axis].latency_us;
        if (latency_us != 0U) {
            fprintf(
                stream,
                "  %-6s is %.1f ms behind its setpoint, which leads moving targets by as much\n",
                axis_names[axis], latency_us / 1000.0);
        }
    }
    const struct lens_config *lens = &rig->controller.lens;
    if (lens->point_count != 0U) {
        fprintf(stream, "  zoom   %.1f to %.1f mm\n", lens->point[0].focal_um / 1000.0,
                lens->point[lens->point_count - 1U].focal_um / 1000.0);
    } else {
        fprintf(stream, "  zoom   none: a fixed lens of %.1f mm\n", rig->fixed_focal_mm);
    }
    if (rig->has_occlusion && rig->scene == NULL) {
        fprintf(stream, "  hidden nothing here: no scene (a board may have one in its flash)\n");
    }
    if (rig->board_device != NULL) {
        fprintf(stream, "  rig    driven by the board at %s\n", rig->board_device);
        return;
    }
    fprintf(stream, "  rig    %s\n",
            rig_is_fake(rig) ? "simulated: every device is a fake" : "names real devices");
}
