/// Mount axes, joint angles and directions at random attitudes, against long double.
#include "check.h"

#include "motion/mount.h"

#include <math.h>

static const long double radian_per_bam = 6.283185307179586476925286766559005768L / 4294967296.0L;
static uint64_t seed = UINT64_C(0x5EED0003);

struct exact {
    long double x, y, z;
};

static struct exact exact(long double x, long double y, long double z) {
    return (struct exact){x, y, z};
}

static struct exact scaled(struct vec3 a) {
    const long double one = (long double)Q30_ONE;
    return exact((long double)a.x / one, (long double)a.y / one, (long double)a.z / one);
}

static long double dot(struct exact a, struct exact b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static long double angle_between(struct exact a, struct exact b) {
    const struct exact c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return atan2l(sqrtl(dot(c, c)), dot(a, b));
}

/// Largest difference of a component, in ulp of Q1.30.
static long double apart_ulp(struct vec3 got, struct exact wanted) {
    const struct exact g = scaled(got);
    return fmaxl(fabsl(g.x - wanted.x), fmaxl(fabsl(g.y - wanted.y), fabsl(g.z - wanted.z))) *
           (long double)Q30_ONE;
}

static long double radians(bam32_t angle) {
    return (long double)bam32_signed(angle) * radian_per_bam;
}

struct axes {
    struct exact right, ahead, up;
};

/// The same rotations as matrices: about the mount's own axes, one after another.
static struct axes exact_axes(struct mount_attitude attitude) {
    const long double h = radians(attitude.heading), p = radians(attitude.pitch),
                      r = radians(attitude.roll);
    const long double sh = sinl(h), ch = cosl(h), sp = sinl(p), cp = cosl(p), sr = sinl(r),
                      cr = cosl(r);
    return (struct axes){.ahead = {sh * cp, ch * cp, sp},
                         .right = {ch * cr + sh * sp * sr, -sh * cr + ch * sp * sr, -cp * sr},
                         .up = {ch * sr - sh * sp * cr, -sh * sr - ch * sp * cr, cp * cr}};
}

static struct exact exact_direction(struct axes axes, struct mount_joints joints) {
    const long double pan = radians(joints.pan), tilt = radians(joints.tilt);
    const long double x = sinl(pan) * cosl(tilt), y = cosl(pan) * cosl(tilt), z = sinl(tilt);
    return exact(x * axes.right.x + y * axes.ahead.x + z * axes.up.x,
                 x * axes.right.y + y * axes.ahead.y + z * axes.up.y,
                 x * axes.right.z + y * axes.ahead.z + z * axes.up.z);
}

/// One draw a statement, here and below: the order within an expression is the compiler's choice.
static struct vec3 any_vec3(void) {
    const int32_t x = (int32_t)check_random(&seed);
    const int32_t y = (int32_t)check_random(&seed);
    const int32_t z = (int32_t)check_random(&seed);
    return vec3(x, y, z);
}

/// Any angle; often a multiple of 45 degrees or close to one.
static bam32_t any_angle(void) {
    const uint32_t any = (uint32_t)check_random(&seed);
    switch (check_random(&seed) % 4U) {
    case 0:
        return bam32(any & UINT32_C(0xE0000000));
    case 1:
        return bam32((any & UINT32_C(0xE000003F)) - 32U);
    default:
        return bam32(any);
    }
}

static struct mount_attitude any_attitude(void) {
    const bam32_t heading = any_angle();
    const bam32_t pitch = any_angle();
    const bam32_t roll = any_angle();
    return (struct mount_attitude){heading, pitch, roll};
}

static void axes_of_any_attitude(void) {
    check_note("seed", (int64_t)seed);
    long double most = 0.0L;
    for (int i = 0; i < 1000000 && check_clean(); i++) {
        struct mount mount;
        const struct mount_attitude attitude = any_attitude();
        mount_init(&mount, attitude);
        const struct axes axes = exact_axes(attitude);
        most = fmaxl(most, apart_ulp(mount.right_q30, axes.right));
        most = fmaxl(most, apart_ulp(mount.ahead_q30, axes.ahead));
        most = fmaxl(most, apart_ulp(mount.up_q30, axes.up));
        CHECK(most <= 3.0L);
    }
    check_note("component error in 1/1000 ulp, most", (int64_t)(most * 1000.0L));
}

static void directions_of_any_joints(void) {
    check_note("seed", (int64_t)seed);
    long double most = 0.0L;
    for (int i = 0; i < 1000000 && check_clean(); i++) {
        struct mount mount;
        const struct mount_attitude attitude = any_attitude();
        mount_init(&mount, attitude);
        const bam32_t pan = any_angle();
        const bam32_t tilt = any_angle();
        const struct mount_joints joints = {pan, tilt};
        const struct vec3 got = mount_direction(&mount, joints);
        most = fmaxl(most, apart_ulp(got, exact_direction(exact_axes(attitude), joints)));
        CHECK(most <= 4.0L);
    }
    check_note("component error in 1/1000 ulp, most", (int64_t)(most * 1000.0L));
}

/// Any unit direction; every second one close to the pan axis.
static struct vec3 any_direction(const struct mount *mount) {
    struct vec3 d = any_vec3();
    if (check_random(&seed) % 2U == 0U) {
        const unsigned shift = (unsigned)(check_random(&seed) % 32U);
        const struct vec3 up =
            check_random(&seed) % 2U == 0U ? mount->up_q30 : vec3_neg(mount->up_q30);
        d = vec3(up.x + ((d.x / 2) >> shift), up.y + ((d.y / 2) >> shift),
                 up.z + ((d.z / 2) >> shift));
    }
    return vec3_is_zero(d) ? vec3(Q30_ONE, 0, 0) : vec3_normalise(d);
}

static void joints_of_any_direction(void) {
    check_note("seed", (int64_t)seed);
    long double most = 0.0L;
    int64_t undefined = 0;
    for (int i = 0; i < 100000 && check_clean(); i++) {
        struct mount mount;
        const struct mount_attitude attitude = any_attitude();
        mount_init(&mount, attitude);
        const struct axes axes = exact_axes(attitude);
        const struct vec3 direction = any_direction(&mount);
        struct mount_joints joints = {bam32(77), bam32(77)};
        const bool defined = mount_solve(&mount, direction, &joints);
        const struct exact wanted = scaled(direction);
        const long double x = dot(axes.right, wanted), y = dot(axes.ahead, wanted);
        const long double off_axis = sqrtl(x * x + y * y);
        CHECK(bam32_signed(joints.tilt) <= (int32_t)BAM32_QUARTER &&
              bam32_signed(joints.tilt) >= -(int32_t)BAM32_QUARTER);
        // The threshold is 2^-24; the axes are only so exact.
        CHECK(off_axis > 0x1.2p-24L ? defined : (off_axis < 0x0.ep-24L ? !defined : true));
        if (!defined) {
            CHECK_EQ(joints.pan.bam, 0);
            undefined++;
            // The caller keeps its pan: whatever it is, the error is what lies off the axis.
            joints.pan = any_angle();
            CHECK(angle_between(exact_direction(axes, joints), wanted) < 0x2.4p-24L);
            continue;
        }
        const long double error = angle_between(exact_direction(axes, joints), wanted);
        most = fmaxl(most, error);
        CHECK(error <= 4.0e-9L);
    }
    check_note("directions along the pan axis", undefined);
    check_note("error of direction in prad, most", (int64_t)(most * 1.0e12L));
    CHECK(undefined > 100);
}

int main(void) {
    TEST(axes_of_any_attitude);
    TEST(directions_of_any_joints);
    TEST(joints_of_any_direction);
    return check_finish();
}
