/// Mounts, axes, lenses, limiters and trackers.
#include "mcu/digest/digest.h"

#include "fixed/trig.h"
#include "motion/axis.h"
#include "motion/lens.h"
#include "motion/limiter.h"
#include "motion/mount.h"
#include "motion/tracker.h"

static bam32_t any_angle(struct digest *d) {
    return bam32((uint32_t)check_random(&d->seed));
}

static void mount(void) {
    struct digest d = digest_start(41);
    for (int i = 0; i < 2000; i++) {
        struct mount mount;
        struct mount_joints joints;
        const bam32_t heading = any_angle(&d), pitch = any_angle(&d), roll = any_angle(&d);
        mount_init(&mount, (struct mount_attitude){heading, pitch, roll});
        digest_vec3(&d, mount.right_q30);
        digest_vec3(&d, mount.ahead_q30);
        digest_vec3(&d, mount.up_q30);
        digest_i64(&d, mount_solve(&mount, vec3_normalise(digest_any_direction(&d)), &joints));
        digest_u64(&d, joints.pan.bam);
        digest_u64(&d, joints.tilt.bam);
        digest_vec3(&d, mount_direction(&mount, joints));
    }
    digest_finish(&d, "digest motion/mount");
}

static void axis(void) {
    struct digest d = digest_start(42);
    for (int i = 0; i < 3000; i++) {
        const int64_t a = digest_any_i64(&d) / 4, b = digest_any_i64(&d) / 4;
        const bam32_t angle = any_angle(&d);
        const int64_t from = digest_any_i64(&d);
        digest_i64(&d, axis_unwrap(angle, from, a < b ? a : b, a < b ? b : a));
        digest_u64(&d, axis_to_bam32(a).bam);
        digest_i64(&d, axis_from_bam(digest_any_i32(&d)));
    }
    digest_finish(&d, "digest motion/axis");
}

static void lens(void) {
    struct digest d = digest_start(43);
    for (int i = 0; i < 1000; i++) {
        struct lens_config lens;
        lens.point_count = 2U + digest_below(&d, LENS_TABLE_MAX - 1U);
        lens.sensor_width_um = 1U + digest_below(&d, 40000);
        lens.sensor_height_um = 1U + digest_below(&d, 40000);
        lens.margin_q16 = digest_below(&d, 10U << 16);
        uint32_t focal_um = 0;
        int64_t position_q48 = -AXIS_TURN_Q48;
        for (uint32_t k = 0; k < lens.point_count; k++) {
            focal_um += 1U + digest_below(&d, 9000);
            position_q48 += 1 + (int64_t)(check_random(&d.seed) >> 20);
            lens.point[k] = (struct lens_point){focal_um, position_q48};
        }
        digest_i64(&d, lens_valid(&lens));
        for (int k = 0; k < 4; k++) {
            const uint32_t focal = lens_focal_um(&lens, bam32((uint32_t)digest_any_u64(&d)));
            const int64_t position = lens_position_q48(&lens, focal);
            digest_u64(&d, focal);
            digest_i64(&d, position);
            digest_u64(&d, lens_focal_at_um(&lens, position + 12345));
        }
    }
    digest_finish(&d, "digest motion/lens");
}

static void limiter(void) {
    static struct limiter limiter;
    struct digest d = digest_start(44);
    for (int run = 0; run < 8; run++) {
        struct limiter_config config = {.min_q48 = -AXIS_TURN_Q48 / 3,
                                        .max_q48 = AXIS_TURN_Q48 / 2};
        config.speed_max_q48 = 1 + digest_below(&d, UINT32_MAX) * INT64_C(30);
        config.accel_max_q48 = 1 + digest_below(&d, UINT32_MAX);
        config.smooth_ticks = 1U + digest_below(&d, LIMITER_SMOOTH_TICKS_MAX);
        limiter_reset(&limiter, &config, digest_any_i64(&d) / 64);
        int64_t goal_q48 = 0, rate_q48 = 0;
        for (int tick = 0; tick < 600; tick++) {
            if (digest_below(&d, 40) == 0U) {
                goal_q48 = digest_any_i64(&d);
                rate_q48 = digest_any_i64(&d) / 1024;
            }
            digest_i64(&d, tick % 100 < 90 ? limiter_follow(&limiter, goal_q48, rate_q48)
                                           : limiter_stop(&limiter));
            digest_i64(&d, limiter.output_speed_q48);
            digest_i64(&d, limiter_at_rest(&limiter));
        }
        const int64_t distance_q48 = (int64_t)(digest_any_u64(&d) >> 4);
        const int64_t accel_q48 = 1 + (int64_t)(digest_any_u64(&d) >> 5);
        digest_i64(&d, limiter_brake_speed(distance_q48, accel_q48));
    }
    digest_finish(&d, "digest motion/limiter");
}

static void tracker(void) {
    struct digest d = digest_start(45);
    struct tracker tracker;
    tracker_reset(&tracker);
    for (int i = 0; i < 5000; i++) {
        struct tracker_config config;
        config.jump_q48 = (int64_t)(digest_any_u64(&d) >> 4);
        config.memory_q16 = digest_below(&d, 65536);
        config.coast_ticks = digest_below(&d, 200);
        tracker_advance(&tracker, &config);
        if (digest_below(&d, 8) == 0U) {
            tracker_update(&tracker, &config, digest_any_i64(&d) / 16);
        }
        digest_i64(&d, tracker.position_q48);
        digest_i64(&d, tracker.rate_q48);
        digest_i64(&d, tracker.valid);
    }
    digest_finish(&d, "digest motion/tracker");
}

int main(void) {
    TEST(mount);
    TEST(axis);
    TEST(lens);
    TEST(limiter);
    TEST(tracker);
    return check_finish();
}
