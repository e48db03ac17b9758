/// Usage: same_rig RIG.ini   Compares the settings that were compiled in with those of the rig
/// file, member by member.
#include "compiled_rig.h"
#include "rig.h"

#include <stdio.h>

static int differences;

#define SAME(member)                                                                               \
    do {                                                                                           \
        if (a->member != b->member) {                                                              \
            printf("%s differs\n", #member);                                                       \
            differences++;                                                                         \
        }                                                                                          \
    } while (0)

static void compare_drive(const struct drive_config *a, const struct drive_config *b) {
    SAME(kind);
    if (a->kind == DRIVE_RMD) {
        SAME(rmd.id);
        SAME(rmd.reply_offset);
        SAME(rmd.reversed);
        SAME(rmd.zero_q48);
        SAME(rmd.speed_max_dps);
        SAME(rmd.watchdog_ms);
    } else if (a->kind == DRIVE_PWM) {
        SAME(pwm.channel);
        SAME(pwm.low_q48);
        SAME(pwm.high_q48);
        SAME(pwm.low_pulse_ns);
        SAME(pwm.high_pulse_ns);
    }
}

static void compare_axis(const struct controller_axis_config *a,
                         const struct controller_axis_config *b) {
    SAME(limits.min_q48);
    SAME(limits.max_q48);
    SAME(limits.speed_max_q48);
    SAME(limits.accel_max_q48);
    SAME(limits.smooth_ticks);
    SAME(home_q48);
    SAME(latency_us);
    compare_drive(&a->drive, &b->drive);
}

static void compare_lens(const struct lens_config *a, const struct lens_config *b) {
    SAME(point_count);
    SAME(sensor_width_um);
    SAME(sensor_height_um);
    SAME(margin_q16);
    for (uint32_t i = 0; i < a->point_count; i++) {
        SAME(point[i].focal_um);
        SAME(point[i].position_q48);
    }
}

static void compare(const struct controller_config *a, const struct controller_config *b) {
    SAME(tick_us);
    SAME(position_um.x);
    SAME(position_um.y);
    SAME(position_um.z);
    SAME(attitude.heading.bam);
    SAME(attitude.pitch.bam);
    SAME(attitude.roll.bam);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        compare_axis(&a->axis[axis], &b->axis[axis]);
    }
    compare_lens(&a->lens, &b->lens);
    SAME(frame);
    SAME(target_expiry_us);
    SAME(tracker.jump_q48);
    SAME(tracker.memory_q16);
    SAME(tracker.coast_ticks);
    SAME(silence_us);
    SAME(settle_us);
    SAME(follow_error_q48);
    SAME(follow_error_us);
    SAME(arm_on_start);
}

static void compare_occlusion(const struct occlusion_settings *a,
                              const struct occlusion_settings *b) {
    SAME(policy);
    SAME(frame_us);
    SAME(ahead_us);
    SAME(fade_us);
    SAME(hidden_q16);
}

int main(int argc, char **argv) {
    static struct rig rig;
    if (argc != 2 || rig_read(argv[1], 0, &rig) != EXIT_STATUS_OK) {
        return 2;
    }
    compare(&rig.controller, &compiled_rig);
    if (!rig.has_occlusion) {
        rig.occlusion.policy = OCCLUSION_IGNORE; // a board has no scene of its own accord
    }
    compare_occlusion(&rig.occlusion, &compiled_occlusion);
    rig_free(&rig);
    return differences == 0 ? 0 : 1;
}
