/// Poses at the time of an exposure, and the camera's axes in the world: by hand, against the
/// firmware's own mount_direction, and against rotations composed another way.
#include "check.h"

#include "detect/camera_pose.h"

#include <math.h>

static uint64_t seed = UINT64_C(0xCA3E7A);

static double any(double low, double high) {
    return low + (high - low) * (double)(check_random(&seed) >> 11) * 0x1p-53;
}

static bam32_t bam(double degrees) {
    return bam32((uint32_t)(int64_t)llround(degrees / 360.0 * 4294967296.0));
}

static struct camera_pose pose(double pan_deg, double tilt_deg, double zoom) {
    return (struct camera_pose){pan_deg, tilt_deg, zoom};
}

// ---------------------------------------------------------------- history

static void between_two_poses(void) {
    static struct pose_history history;
    struct camera_pose at;
    pose_history_init(&history);
    CHECK(pose_history_at(&history, 5, &at) == POSE_ERROR_UNKNOWN);
    // The clock wraps between the second and the third.
    const struct camera_pose poses[] = {pose(10, 0, 1), pose(20, -2, 1), pose(40, -4, 2)};
    for (uint32_t i = 0; i < 3U; i++) {
        pose_history_add(&history, 0xFFFFE000U + i * 8000U, &poses[i]);
    }
    CHECK(pose_history_at(&history, 0xFFFFE000U + 2000U, &at) == POSE_OK);
    CHECK(fabs(at.pan_deg - 12.5) < 1e-12 && fabs(at.tilt_deg + 0.5) < 1e-12);
    CHECK(pose_history_at(&history, 0xFFFFE000U + 14000U, &at) == POSE_OK);
    CHECK(fabs(at.pan_deg - 35.0) < 1e-12 && fabs(at.zoom - 1.75) < 1e-12);
    CHECK(pose_history_at(&history, 0xFFFFE000U + 8000U, &at) == POSE_OK && at.pan_deg == 20.0);
    CHECK(pose_history_at(&history, 0xFFFFE000U, &at) == POSE_OK && at.pan_deg == 10.0);
    CHECK(pose_history_at(&history, 0xFFFFE000U + 16000U, &at) == POSE_OK && at.pan_deg == 40.0);
    CHECK(pose_history_at(&history, 0xFFFFE000U - 1U, &at) == POSE_ERROR_TOO_OLD);
    // It goes on until the next one would be due.
    CHECK(pose_history_at(&history, 0xFFFFE000U + 18000U, &at) == POSE_OK);
    CHECK(fabs(at.pan_deg - 45.0) < 1e-12 && fabs(at.tilt_deg + 4.5) < 1e-12 && at.zoom == 2.0);
    CHECK(pose_history_at(&history, 0xFFFFE000U + 116000U, &at) == POSE_OK);
    CHECK(fabs(at.pan_deg - 60.0) < 1e-12 && fabs(at.tilt_deg + 6.0) < 1e-12 && at.zoom == 2.0);
    CHECK(pose_history_at(&history, 0xFFFFE000U + 116001U, &at) == POSE_ERROR_TOO_NEW);
}

/// A pan that turns 1 degree in 10 ms, told in irregular steps, for longer than is kept.
static void a_long_history(void) {
    static struct pose_history history;
    pose_history_init(&history);
    check_note("seed", (int64_t)seed);
    uint32_t now_us = 0xFFF00000U;
    const uint32_t start_us = now_us;
    for (int i = 0; i < 20000 && check_clean(); i++) {
        now_us += 100U + (uint32_t)(check_random(&seed) % 3000U);
        const struct camera_pose told = pose((now_us - start_us) * 1e-4, 0.0, 1.0);
        pose_history_add(&history, now_us, &told);
        const uint32_t back_us = (uint32_t)(check_random(&seed) % 500000U);
        if (back_us < now_us - start_us - 4000U && i > 2) {
            struct camera_pose at;
            CHECK(pose_history_at(&history, now_us - back_us, &at) == POSE_OK);
            CHECK(fabs(at.pan_deg - (now_us - start_us - back_us) * 1e-4) < 1e-6);
        }
    }
    struct camera_pose at;
    const struct camera_pose other = pose(1.0, 2.0, 3.0);
    pose_history_add(&history, now_us - 5000U, &other); // the clock ran back
    CHECK(history.count == 1U);
    CHECK(pose_history_at(&history, now_us, &at) == POSE_OK && at.zoom == 3.0);
}

// ---------------------------------------------------------------- view

static const struct camera_seat straight = {0.0, 0.0, 0.0};

static struct mount mount_at(double heading, double pitch, double roll) {
    struct mount mount;
    mount_init(&mount, (struct mount_attitude){bam(heading), bam(pitch), bam(roll)});
    return mount;
}

static bool is(const double a[3], double x, double y, double z) {
    return fabs(a[0] - x) < 5e-9 && fabs(a[1] - y) < 5e-9 && fabs(a[2] - z) < 5e-9;
}

static void views_worked_out_by_hand(void) {
    const struct mount level = mount_at(0, 0, 0);
    struct camera_pose at = pose(0, 0, 1);
    struct camera_view view = camera_view_at(&level, &straight, &at);
    CHECK(is(view.right, 1, 0, 0) && is(view.ahead, 0, 1, 0) && is(view.up, 0, 0, 1));
    at = pose(90, 0, 1); // pan is clockwise seen from above: east
    view = camera_view_at(&level, &straight, &at);
    CHECK(is(view.right, 0, -1, 0) && is(view.ahead, 1, 0, 0) && is(view.up, 0, 0, 1));
    at = pose(90, 30, 1);
    view = camera_view_at(&level, &straight, &at);
    CHECK(is(view.ahead, sqrt(0.75), 0, 0.5) && is(view.up, -0.5, 0, sqrt(0.75)));
    at = pose(0, 0, 1);
    // Rolled clockwise as seen from behind: its up points to the right.
    view = camera_view_at(&level, &(struct camera_seat){0, 0, 90}, &at);
    CHECK(is(view.up, 1, 0, 0) && is(view.right, 0, 0, -1) && is(view.ahead, 0, 1, 0));
    view = camera_view_at(&level, &(struct camera_seat){90, 30, 0}, &at);
    CHECK(is(view.ahead, sqrt(0.75), 0, 0.5) && is(view.right, 0, -1, 0));
}

static void views_like_the_firmware_has_them(void) {
    check_note("seed", (int64_t)seed);
    double worst = 0.0;
    for (int i = 0; i < 20000; i++) {
        const struct mount mount = mount_at(any(-180, 180), any(-180, 180), any(-180, 180));
        const struct camera_pose at = pose(any(-180, 180), any(-90, 90), 1.0);
        const struct camera_view view = camera_view_at(&mount, &straight, &at);
        const struct vec3 ahead =
            mount_direction(&mount, (struct mount_joints){bam(at.pan_deg), bam(at.tilt_deg)});
        const double off[3] = {view.ahead[0] - ldexp(ahead.x, -30),
                               view.ahead[1] - ldexp(ahead.y, -30),
                               view.ahead[2] - ldexp(ahead.z, -30)};
        worst = fmax(worst, sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]));
    }
    CHECK(worst < 12e-9);
    check_note("view against mount_direction, worst, in 1e-12 rad", (int64_t)(worst * 1e12));
}

static void directions_there_and_back(void) {
    for (int i = 0; i < 1000 && check_clean(); i++) {
        const struct mount mount = mount_at(any(-180, 180), any(-90, 90), any(-180, 180));
        const struct camera_pose at = pose(any(-400, 400), any(-90, 90), 1.0);
        const struct camera_seat seat = {any(-10, 10), any(-10, 10), any(-180, 180)};
        const struct camera_view view = camera_view_at(&mount, &seat, &at);
        const double camera[3] = {any(-1, 1), any(0.1, 1), any(-1, 1)};
        double world[3], back[3];
        camera_view_to_world(&view, camera, world);
        camera_view_from_world(&view, world, back);
        for (unsigned k = 0; k < 3U; k++) {
            CHECK(fabs(back[k] - camera[k]) < 2e-8);
        }
    }
    const struct vec3 q30 = camera_direction_q30((const double[3]){-3.0, 0.75, 0.0});
    CHECK(vec3_equal(q30, vec3(-(1 << 30), 1 << 28, 0)));
}

int main(void) {
    TEST(between_two_poses);
    TEST(a_long_history);
    TEST(views_worked_out_by_hand);
    TEST(views_like_the_firmware_has_them);
    TEST(directions_there_and_back);
    return check_finish();
}
