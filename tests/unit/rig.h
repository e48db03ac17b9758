/// A pan-tilt-zoom rig for the tests of the controller: two RMD drives that answer frames byte by
/// byte and are at once where they are told to be, a zoom lens by pulse width, and what must hold
/// at every tick, whatever happens.
///
/// A header, so that the tests of a folder that has only programs can share it.
#ifndef TESTS_UNIT_RIG_H
#define TESTS_UNIT_RIG_H

#include "check.h"

#include "control/controller.h"
#include "fixed/trig.h"

#define TURN                 AXIS_TURN_Q48
#define DEGREE               (AXIS_TURN_Q48 / 360)
#define BAM_OF(centidegrees) bam32((uint32_t)((int64_t)(centidegrees) * (INT64_C(1) << 32) / 36000))
/// The setpoint of a drive goes out once in four ticks, and is rounded to 0.01 degrees.
#define CENTIDEGREE (DEGREE / 100)

enum { RIG_PAN_ID = 1, RIG_TILT_ID = 2, RIG_ZOOM_CHANNEL = 5 };

/// What the other end of the bus does.
struct rig_drive {
    uint8_t id;
    bool lktech;
    int64_t angle_cdeg;
    bool silent;   ///< answers nothing (and moves all the same)
    bool blocked;  ///< does not move
    bool no_angle; ///< answers everything but the angle
    bool running;  ///< LKTech: has been told to run
    uint16_t error_bits;
    uint32_t watchdog_ms;
    uint32_t positions, questions, frames; ///< counted
};

struct rig {
    struct controller_config config;
    struct controller controller;
    struct controller_input input; ///< of the next tick
    struct controller_output output;
    struct rig_drive drive[2];
    uint32_t tick_us;
    bool was_armed;
    uint64_t hash;
    // Of the last tick, for the differences.
    bool known[AXIS_COUNT];
    uint32_t restarts[AXIS_COUNT];
    int64_t setpoint[AXIS_COUNT], speed[AXIS_COUNT];
};

/// The one rig of a test program; static, because the stack of a microcontroller is small.
static struct rig rig;

static inline void rig_config_axis(struct controller_axis_config *axis, uint8_t id, int64_t min,
                                   int64_t max) {
    axis->limits = (struct limiter_config){.min_q48 = min,
                                           .max_q48 = max,
                                           .speed_max_q48 = DEGREE / 10, // 100 degrees a second
                                           .accel_max_q48 = DEGREE / 2000,
                                           .smooth_ticks = 20};
    axis->drive.kind = DRIVE_RMD;
    axis->drive.rmd = (struct drive_rmd_config){
        .id = id, .reply_offset = 0x100, .speed_max_dps = 120, .watchdog_ms = 50};
}

static inline void rig_configure(void) {
    struct controller_config *config = &rig.config;
    *config = (struct controller_config){
        .tick_us = 1000,
        .lens = {.point = {{4000, 0}, {20000, TURN}},
                 .point_count = 2,
                 .sensor_width_um = 6000,
                 .sensor_height_um = 4000,
                 .margin_q16 = 6554},
        .tracker = {.jump_q48 = 2 * DEGREE, .memory_q16 = 0, .coast_ticks = 100},
        .silence_us = 50000,
        .settle_us = 30000,
        .follow_error_q48 = 3 * DEGREE,
        .follow_error_us = 40000};
    rig_config_axis(&config->axis[AXIS_PAN], RIG_PAN_ID, -400 * DEGREE, 400 * DEGREE);
    rig_config_axis(&config->axis[AXIS_TILT], RIG_TILT_ID, -100 * DEGREE, 100 * DEGREE);
    struct controller_axis_config *zoom = &config->axis[AXIS_ZOOM];
    zoom->limits = (struct limiter_config){.max_q48 = TURN,
                                           .speed_max_q48 = TURN / 400,
                                           .accel_max_q48 = TURN / 20000,
                                           .smooth_ticks = 1};
    zoom->drive.kind = DRIVE_PWM;
    zoom->drive.pwm = (struct drive_pwm_config){.channel = RIG_ZOOM_CHANNEL,
                                                .high_q48 = TURN,
                                                .low_pulse_ns = 1000000,
                                                .high_pulse_ns = 2000000};
}

/// Starts over with the configuration as it is now. garbage: what the memory held before.
static inline void rig_start(uint32_t now_us, uint8_t garbage) {
    for (size_t i = 0; i < sizeof rig.controller; i++) {
        ((uint8_t *)&rig.controller)[i] = garbage;
    }
    for (size_t i = 0; i < sizeof rig.output; i++) {
        ((uint8_t *)&rig.output)[i] = garbage;
    }
    (void)controller_init(&rig.controller, &rig.config);
    rig.input.now_us = now_us;
    rig.input.commands = 0;
    rig.input.frame_count = rig.input.update_count = 0;
    rig.drive[0] = (struct rig_drive){.id = RIG_PAN_ID};
    rig.drive[1] = (struct rig_drive){.id = RIG_TILT_ID};
    rig.tick_us = 1000;
    rig.was_armed = false;
    rig.hash = UINT64_C(0xCBF29CE484222325);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        rig.known[axis] = false;
    }
}

static inline void rig_init(void) {
    rig_configure();
    rig_start(0, 0x55);
}

// ---------------------------------------------------------------- the drives

static inline int32_t rig_value(const struct can_frame *frame) {
    return (int32_t)(frame->data[4] | (uint32_t)frame->data[5] << 8 |
                     (uint32_t)frame->data[6] << 16 | (uint32_t)frame->data[7] << 24);
}

static inline void rig_receive(struct can_frame frame) {
    if (rig.input.frame_count < CONTROLLER_FRAMES_IN_MAX) {
        rig.input.frame_us[rig.input.frame_count] = rig.input.now_us;
        rig.input.frame[rig.input.frame_count++] = frame;
    }
}

/// Puts a number into the bytes from `first` to the last.
static inline void rig_put(struct can_frame *frame, unsigned first, int64_t value) {
    for (unsigned i = first; i < 8U; i++) {
        frame->data[i] = (uint8_t)((uint64_t)value >> (8U * (i - first)));
    }
}

/// Obeys and answers one request. The answer arrives with the next tick.
static inline void rig_drive_hear(struct rig_drive *drive, const struct can_frame *request) {
    struct can_frame reply = {.id = drive->lktech ? 0x140U + drive->id : 0x240U + drive->id,
                              .length = 8,
                              .data = {request->data[0]}};
    drive->frames++;
    switch (request->data[0]) {
    case 0xA4:
        drive->positions++;
        if (!drive->blocked && (!drive->lktech || drive->running)) {
            drive->angle_cdeg = rig_value(request);
        }
        reply.data[1] = 30;
        break;
    case 0x92:
        drive->questions++;
        rig_put(&reply, drive->lktech ? 1U : 4U, drive->angle_cdeg);
        if (drive->no_angle) {
            return;
        }
        break;
    case 0x9A:
        drive->questions++;
        reply.data[1] = 30;
        reply.data[4] = 240;
        reply.data[6] = (uint8_t)drive->error_bits;
        reply.data[7] = (uint8_t)(drive->error_bits >> 8);
        break;
    case 0xB3:
        drive->watchdog_ms = (uint32_t)rig_value(request);
        rig_put(&reply, 4, drive->watchdog_ms);
        break;
    case 0x42:
        drive->questions++;
        break;
    case 0x88:
        drive->running = true;
        break;
    default:
        CHECK(false); // nothing else is ever sent
        return;
    }
    if (!drive->silent) {
        rig_receive(reply);
    }
}

// ---------------------------------------------------------------- every tick

static inline void rig_fold(uint64_t value) {
    rig.hash = (rig.hash ^ value) * UINT64_C(0x100000001B3);
}

/// Every output that has a meaning, but the counters of refused inputs.
static inline void rig_fold_output(void) {
    const struct controller_output *out = &rig.output;
    rig_fold(out->frame_count);
    for (uint32_t i = 0; i < out->frame_count; i++) {
        rig_fold(out->frame[i].id | (uint64_t)out->frame[i].length << 32);
        for (unsigned k = 0; k < 8U; k++) {
            rig_fold(out->frame[i].data[k]);
        }
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct controller_axis_status *status = &out->status.axis[axis];
        rig_fold(out->pulse_set[axis] | (uint64_t)out->pulse_ns[axis] << 1);
        rig_fold(out->pulse_channel[axis]);
        rig_fold((uint64_t)status->setpoint_q48);
        rig_fold((uint64_t)status->goal_q48);
        rig_fold((uint64_t)status->measured_q48 ^ status->measured_known);
        rig_fold(status->restarts);
    }
    const struct controller_status *status = &out->status;
    rig_fold(status->time_us);
    rig_fold((uint64_t)status->mode | (uint64_t)status->faults << 8);
    rig_fold(status->fault_axis);
    rig_fold((uint64_t)(uint32_t)status->framing.status);
    rig_fold((uint32_t)status->framing.ahead_q30.x);
    rig_fold((uint32_t)status->framing.ahead_q30.y);
    rig_fold((uint32_t)status->framing.ahead_q30.z);
    rig_fold(status->framing.half_angle_bam32.bam);
    rig_fold(status->framing.framed_count | (uint64_t)status->target_count << 32);
    rig_fold(status->focal_um | (uint64_t)status->aims_solved << 32);
}

static inline bool rig_is_armed(enum controller_mode mode) {
    return mode == MODE_SETTLING || mode == MODE_TRACKING || mode == MODE_HOLDING ||
           mode == MODE_STOPPED;
}

static inline int64_t rig_size_of(int64_t value) {
    return value < 0 ? -value : value;
}

/// Limits, speed and acceleration of the setpoint of an axis that is under way.
static inline void rig_check_axis(unsigned axis) {
    const struct limiter_config *limits = &rig.config.axis[axis].limits;
    const struct controller_axis_status *status = &rig.output.status.axis[axis];
    const bool goes_on =
        rig.controller.powered[axis] && rig.known[axis] && rig.restarts[axis] == status->restarts;
    const int64_t speed = goes_on ? status->setpoint_q48 - rig.setpoint[axis] : 0;
    if (goes_on) {
        const int64_t from = rig.setpoint[axis], to = status->setpoint_q48;
        CHECK(to <= (from > limits->max_q48 ? from : limits->max_q48));
        CHECK(to >= (from < limits->min_q48 ? from : limits->min_q48));
        CHECK(rig_size_of(speed) <= limits->speed_max_q48);
        CHECK(rig_size_of(speed - rig.speed[axis]) <= limits->accel_max_q48 + 1);
    }
    rig.known[axis] = rig.controller.powered[axis];
    rig.restarts[axis] = status->restarts;
    rig.setpoint[axis] = status->setpoint_q48;
    rig.speed[axis] = speed;
}

static inline void rig_check_output(void) {
    const struct controller_output *out = &rig.output;
    CHECK(out->frame_count <= CONTROLLER_FRAMES_OUT_MAX);
    for (uint32_t i = 0; i < out->frame_count; i++) {
        CHECK(can_frame_is_valid(&out->frame[i]));
        CHECK(out->frame[i].data[0] != 0xA4 || rig.was_armed);
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        rig_check_axis(axis);
        CHECK(out->pulse_ns[axis] == 0U || rig.was_armed);
    }
    // An armed controller has no fault, and a faulted one has.
    const enum controller_mode mode = out->status.mode;
    CHECK(!rig_is_armed(mode) || out->status.faults == 0U);
    CHECK(mode != MODE_FAULTED || out->status.faults != 0U);
}

/// One tick: the controller, the drives, the invariants.
static inline void rig_tick(void) {
    controller_step(&rig.controller, &rig.input, &rig.output);
    rig.was_armed = rig.was_armed || rig_is_armed(rig.output.status.mode);
    rig_check_output();
    rig_fold_output();
    rig.input.now_us += rig.tick_us;
    rig.input.commands = 0;
    rig.input.frame_count = rig.input.update_count = 0;
    for (uint32_t i = 0; i < rig.output.frame_count; i++) {
        for (unsigned d = 0; d < 2U; d++) {
            if (rig.output.frame[i].id == 0x140U + rig.drive[d].id) {
                rig_drive_hear(&rig.drive[d], &rig.output.frame[i]);
            }
        }
    }
}

static inline void rig_ticks(uint32_t count) {
    for (uint32_t i = 0; i < count && check_clean(); i++) {
        rig_tick();
    }
}

static inline enum controller_mode rig_mode(void) {
    return rig.output.status.mode;
}

/// Ticks until the mode is reached; false after `most` of them.
static inline bool rig_until(enum controller_mode mode, uint32_t most) {
    for (uint32_t i = 0; i < most && check_clean(); i++) {
        rig_tick();
        if (rig_mode() == mode) {
            return true;
        }
    }
    return false;
}

static inline void rig_command(uint32_t commands) {
    rig.input.commands = commands;
    rig_tick();
}

static inline void rig_arm(void) {
    CHECK(rig_until(MODE_READY, 100));
    rig_command(COMMAND_ARM);
    CHECK(rig_until(MODE_HOLDING, 100) || rig_mode() == MODE_TRACKING);
}

// ---------------------------------------------------------------- targets

static inline void rig_update(struct target_update update) {
    if (rig.input.update_count < CONTROLLER_UPDATES_MAX) {
        rig.input.update[rig.input.update_count++] = update;
    }
}

/// A target that a level mount sees at this pan and tilt, in hundredths of a degree.
static inline void rig_target(uint32_t id, int pan, int tilt) {
    const struct sincos p = trig_sincos(BAM_OF(pan)), t = trig_sincos(BAM_OF(tilt));
    rig_update((struct target_update){
        .kind = TARGET_DIRECTION,
        .id = id,
        .weight_q16 = TARGET_WEIGHT_ONE_Q16,
        .direction = {q30_mul(p.sin_q30, t.cos_q30), q30_mul(p.cos_q30, t.cos_q30), t.sin_q30}});
}

static inline void rig_gone(uint32_t id) {
    rig_update((struct target_update){.kind = TARGET_GONE, .id = id});
}

/// The setpoint of an axis within a millionth of a degree of a position in hundredths.
static inline bool rig_is_at(unsigned axis, int centidegrees) {
    return CHECK_NEAR(rig.output.status.axis[axis].setpoint_q48, centidegrees * (DEGREE / 100),
                      DEGREE / 100000);
}

#endif
