/// firmware/motion/mount at attitudes whose answers are known, and there and back at random ones.
/// How exact it is: tests/property/mount.c.
#include "check.h"

#include "motion/mount.h"

#define DEGREES(d) bam32((uint32_t)((int64_t)(d) * (INT64_C(1) << 32) / 360))

static uint64_t seed = UINT64_C(0x30047);

static bool is(struct vec3 a, int x, int y, int z) {
    return vec3_equal(a, vec3(x * Q30_ONE, y * Q30_ONE, z * Q30_ONE));
}

static struct mount mount_of(int heading, int pitch, int roll) {
    struct mount mount;
    mount_init(&mount, (struct mount_attitude){DEGREES(heading), DEGREES(pitch), DEGREES(roll)});
    return mount;
}

static void axes_at_quarter_turns(void) {
    struct mount m = mount_of(0, 0, 0);
    CHECK(is(m.right_q30, 1, 0, 0) && is(m.ahead_q30, 0, 1, 0) && is(m.up_q30, 0, 0, 1));
    m = mount_of(90, 0, 0); // facing east
    CHECK(is(m.right_q30, 0, -1, 0) && is(m.ahead_q30, 1, 0, 0) && is(m.up_q30, 0, 0, 1));
    m = mount_of(0, 90, 0); // nose up
    CHECK(is(m.right_q30, 1, 0, 0) && is(m.ahead_q30, 0, 0, 1) && is(m.up_q30, 0, -1, 0));
    m = mount_of(0, 0, 90); // right side down
    CHECK(is(m.right_q30, 0, 0, -1) && is(m.ahead_q30, 0, 1, 0) && is(m.up_q30, 1, 0, 0));
    m = mount_of(0, 0, 180); // upside down
    CHECK(is(m.right_q30, -1, 0, 0) && is(m.ahead_q30, 0, 1, 0) && is(m.up_q30, 0, 0, -1));
    m = mount_of(90, 90, 90); // east, then nose up, then rolled: the order matters
    CHECK(is(m.right_q30, 1, 0, 0) && is(m.ahead_q30, 0, 0, 1) && is(m.up_q30, 0, -1, 0));
    m = mount_of(180, -90, 0);
    CHECK(is(m.right_q30, -1, 0, 0) && is(m.ahead_q30, 0, 0, -1) && is(m.up_q30, 0, -1, 0));
}

static void check_joints(struct mount mount, struct vec3 direction, int pan, int tilt) {
    struct mount_joints joints = {bam32(1), bam32(1)};
    CHECK(mount_solve(&mount, vec3_normalise(direction), &joints));
    CHECK_NEAR(bam32_diff(joints.pan, DEGREES(pan)), 0, 2);
    CHECK_NEAR(bam32_diff(joints.tilt, DEGREES(tilt)), 0, 2);
}

static void pan_is_clockwise_and_tilt_is_up(void) {
    const struct mount level = mount_of(0, 0, 0);
    check_joints(level, vec3(0, 1, 0), 0, 0);
    check_joints(level, vec3(1, 0, 0), 90, 0);
    check_joints(level, vec3(-1, 0, 0), -90, 0);
    check_joints(level, vec3(1, 1, 0), 45, 0);
    check_joints(level, vec3(0, 1, 1), 0, 45);
    check_joints(level, vec3(0, -1, -1), 180, -45);
    check_joints(mount_of(90, 0, 0), vec3(1, 0, 0), 0, 0);
    check_joints(mount_of(90, 0, 0), vec3(0, 1, 0), -90, 0);
    check_joints(mount_of(0, 45, 0), vec3(0, 1, 1), 0, 0);
    check_joints(mount_of(0, 0, 90), vec3(0, 0, -1), 90, 0);
    check_joints(mount_of(0, 0, 90), vec3(1, 1, 0), 0, 45);
}

/// Hanging from the ceiling, east is on the left and the sky below.
static void upside_down(void) {
    const struct mount hanging = mount_of(0, 0, 180);
    check_joints(hanging, vec3(0, 1, 0), 0, 0);
    check_joints(hanging, vec3(1, 0, 0), -90, 0);
    check_joints(hanging, vec3(0, 1, -1), 0, 45);
    check_joints(hanging, vec3(-1, 0, 1), 90, -45);
}

static void along_the_pan_axis(void) {
    struct mount_joints joints = {bam32(1), bam32(1)};
    struct mount mount = mount_of(33, 0, 0);
    CHECK(!mount_solve(&mount, vec3(0, 0, Q30_ONE), &joints));
    CHECK_EQ(joints.pan.bam, 0);
    CHECK_EQ(joints.tilt.bam, BAM32_QUARTER);
    CHECK(!mount_solve(&mount, vec3(0, 0, -Q30_ONE), &joints));
    CHECK_EQ(bam32_signed(joints.tilt), -(int32_t)BAM32_QUARTER);
    mount = mount_of(0, 0, 0);
    CHECK(!mount_solve(&mount, vec3(63, 0, Q30_ONE), &joints)); // 2^-24 is 64 of 2^30
    CHECK_EQ(joints.pan.bam, 0);
    CHECK(mount_solve(&mount, vec3(64, 0, Q30_ONE), &joints));
    CHECK_EQ(joints.pan.bam, BAM32_QUARTER);
    CHECK(mount_solve(&mount, vec3(0, -64, -Q30_ONE), &joints));
    CHECK_EQ(joints.pan.bam, BAM32_HALF);
    mount = mount_of(0, 0, 180);
    CHECK(!mount_solve(&mount, vec3(0, 0, Q30_ONE), &joints));
    CHECK_EQ(bam32_signed(joints.tilt), -(int32_t)BAM32_QUARTER);
}

static bam32_t any_angle(void) {
    return bam32((uint32_t)check_random(&seed));
}

static void there_and_back(void) {
    check_note("seed", (int64_t)seed);
    for (int i = 0; i < 5000 && check_clean(); i++) {
        struct mount mount;
        const bam32_t heading = any_angle();
        const bam32_t pitch = any_angle();
        const bam32_t roll = any_angle();
        mount_init(&mount, (struct mount_attitude){heading, pitch, roll});
        CHECK_NEAR(vec3_dot_unit(mount.right_q30, mount.ahead_q30), 0, INT64_C(6) << 30);
        CHECK_NEAR(vec3_dot_unit(mount.ahead_q30, mount.up_q30), 0, INT64_C(6) << 30);
        CHECK_EQ(vec3_det_sign(mount.right_q30, mount.ahead_q30, mount.up_q30), 1);
        const int32_t x = (int32_t)check_random(&seed);
        const int32_t y = (int32_t)check_random(&seed);
        const int32_t z = (int32_t)check_random(&seed) | 1;
        const struct vec3 direction = vec3_normalise(vec3(x, y, z));
        struct mount_joints joints;
        (void)mount_solve(&mount, direction, &joints);
        const struct vec3 back = mount_direction(&mount, joints);
        CHECK_NEAR(back.x, direction.x, 8);
        CHECK_NEAR(back.y, direction.y, 8);
        CHECK_NEAR(back.z, direction.z, 8);
        CHECK_NEAR(bam32_signed(joints.tilt), 0, BAM32_QUARTER);
    }
}

int main(void) {
    TEST(axes_at_quarter_turns);
    TEST(pan_is_clockwise_and_tilt_is_up);
    TEST(upside_down);
    TEST(along_the_pan_axis);
    TEST(there_and_back);
    return check_finish();
}
