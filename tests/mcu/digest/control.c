/// Drives by bus and the controller over some seconds with moving targets on pulse-width drives.
#include "mcu/digest/digest.h"

#include "control/controller.h"
#include "drive/rmd.h"

static void fold_frame(struct digest *d, const struct can_frame *frame) {
    digest_u64(d, frame->id);
    for (unsigned i = 0; i < CAN_FRAME_DATA_BYTES; i++) {
        digest_u64(d, frame->data[i]);
    }
}

static void rmd(void) {
    struct digest d = digest_start(51);
    static const uint8_t commands[] = {0x42, 0x70, 0x92, 0x9A, 0x9C, 0xA4, 0xB1, 0xB3};
    for (int i = 0; i < 3000; i++) {
        struct can_frame frame = {0};
        struct drive drive;
        struct drive_output output;
        const uint8_t id = (uint8_t)(1U + digest_below(&d, 32));
        const int64_t zero_q48 = digest_any_i64(&d) / 64;
        const struct drive_config config = {.kind = DRIVE_RMD,
                                            .rmd = {.id = id,
                                                    .reply_offset = RMD_REPLY_OFFSET_V3,
                                                    .reversed = i % 2 == 0,
                                                    .zero_q48 = zero_q48,
                                                    .speed_max_dps = (uint16_t)i}};
        drive_init(&drive, &config, 0);
        frame.id = 0x240U + id;
        frame.length = 8;
        const uint64_t data = check_random(&d.seed);
        for (unsigned k = 0; k < CAN_FRAME_DATA_BYTES; k++) {
            frame.data[k] = (uint8_t)(data >> (8U * k));
        }
        frame.data[0] = commands[digest_below(&d, sizeof commands)];
        digest_i64(&d, drive_receive(&drive, &frame, 1000, 0));
        digest_i64(&d, drive.position_q48);
        drive_tick(&drive, (uint32_t)i, true, digest_any_i64(&d) / 512, &output);
        for (uint32_t k = 0; k < output.frame_count; k++) {
            fold_frame(&d, &output.frame[k]);
        }
        digest_i64(&d, drive_cdeg_from_q48(digest_any_i64(&d)));
        digest_i64(&d, drive_q48_from_cdeg(digest_any_i64(&d) / (INT64_C(1) << 33)));
    }
    digest_finish(&d, "digest drive/rmd");
}

// ---------------------------------------------------------------- control

#define DEGREE_Q48 (AXIS_TURN_Q48 / 360)

/// Two servos and a zoom lens.
static struct controller_config servo_rig(void) {
    const struct drive_config servo = {
        .kind = DRIVE_PWM, .pwm = {0, -60 * DEGREE_Q48, 60 * DEGREE_Q48, 833333, 2166667}};
    const struct limiter_config limits = {-58 * DEGREE_Q48, 58 * DEGREE_Q48, DEGREE_Q48 / 6,
                                          DEGREE_Q48 / 1400, 20};
    struct controller_config config = {
        .tick_us = 1000,
        .position_um = {0, 0, 1500000},
        .attitude = {bam32(123456789), bam32(12345678), bam32(1234567)},
        .axis = {{limits, servo, 0, 0}, {limits, servo, 0, 0}, {limits, servo, 0, 0}},
        .lens = {.point = {{4000, 0}, {48000, AXIS_TURN_Q48 / 8}},
                 .point_count = 2,
                 .sensor_width_um = 6000,
                 .sensor_height_um = 4000,
                 .margin_q16 = 6554},
        .target_expiry_us = 400000,
        .tracker = {AXIS_TURN_Q48 / 40, 40000, 100},
        .silence_us = 50000,
        .settle_us = 200000,
        .follow_error_q48 = AXIS_TURN_Q48,
        .follow_error_us = 1000000,
        .arm_on_start = true};
    config.axis[AXIS_TILT].drive.pwm.channel = 1;
    config.axis[AXIS_ZOOM].drive.pwm.channel = 2;
    return config;
}

static void fold_output(struct digest *d, const struct controller_output *output) {
    const struct controller_status *status = &output->status;
    digest_i64(d, status->mode);
    digest_u64(d, status->faults);
    digest_u64(d, status->target_count);
    digest_u64(d, status->updates_rejected);
    digest_u64(d, status->focal_um);
    digest_vec3(d, status->framing.ahead_q30);
    for (unsigned i = 0; i < AXIS_COUNT; i++) {
        digest_u64(d, output->pulse_ns[i]);
        digest_i64(d, status->axis[i].setpoint_q48);
        digest_i64(d, status->axis[i].goal_q48);
    }
}

static void controller(void) {
    static struct controller controller;
    static struct controller_input input;
    static struct controller_output output;
    struct digest d = digest_start(61);
    const struct controller_config config = servo_rig();
    CHECK(controller_init(&controller, &config));
    uint32_t tracking = 0;
    for (uint32_t tick = 0; tick < 6000; tick++) {
        input.now_us = 0xFFFF0000U + 1000U * tick;
        input.commands = tick % 2500U == 2000U ? COMMAND_STOP : 0;
        input.commands |= tick % 2500U == 2100U ? COMMAND_ARM : 0;
        input.update_count = tick % 20U == 0U ? 5U : 0U;
        for (uint32_t i = 0; i < input.update_count; i++) {
            input.update[i] = (struct target_update){
                .kind = TARGET_POSITION, .weight_q16 = TARGET_WEIGHT_ONE_Q16, .radius_um = 300000};
            input.update[i].id = digest_below(&d, 12);
            const int64_t sway_um = (int64_t)(tick % 3000U) * 1000;
            input.update[i].position_um = (struct vec3_i64){
                sway_um + digest_below(&d, 9000000), 20000000, (int64_t)digest_below(&d, 6000000)};
        }
        controller_step(&controller, &input, &output);
        fold_output(&d, &output);
        tracking += output.status.mode == MODE_TRACKING;
    }
    CHECK(tracking > 6000 / 2);
    digest_finish(&d, "digest control/controller");
}

int main(void) {
    TEST(rmd);
    TEST(controller);
    return check_finish();
}
