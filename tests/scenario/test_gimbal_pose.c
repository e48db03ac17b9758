/// Where the gimbal is between and after its measurements: axes that do exactly what they are told,
/// some milliseconds late, whose place is therefore known by a formula.
#include "check.h"

#include "detect/gimbal_pose.h"

#include <math.h>

#define RATE_DPS 60.0

/// What the axis is told: at rest, then 60 degrees a second, then at rest elsewhere.
static double told_deg(double at_s) {
    return 40.0 + RATE_DPS * (at_s < 1.0 ? 0.0 : at_s > 2.0 ? 1.0 : at_s - 1.0);
}

static int64_t q48(double deg) {
    return llround(deg / 360.0 * 281474976710656.0);
}

/// Ticks of 1 ms for three seconds; axes that measure are heard of every period_ms, age_ms late (0:
/// never). Returns the largest error of the poses.
static double worst_error(uint32_t latency_us, uint32_t known_us, unsigned period_ms,
                          unsigned age_ms) {
    static struct gimbal_pose gimbal;
    struct controller_config config = {.axis[AXIS_PAN].latency_us = known_us,
                                       .axis[AXIS_TILT].latency_us = known_us};
    struct controller_status status = {.focal_um = 12000};
    double worst = 0.0;
    gimbal_pose_init(&gimbal, &config, 5.0, 6.0);
    for (unsigned i = 0; i < 3000U; i++) {
        const double now_s = i * 1e-3, late_s = latency_us * 1e-6;
        status.time_us = UINT64_C(4294000000) + i * UINT64_C(1000); // its low word wraps on the way
        for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
            const double sign = axis == AXIS_PAN ? 1.0 : -1.0;
            struct controller_axis_status *at = &status.axis[axis];
            at->setpoint_q48 = q48(sign * told_deg(now_s));
            if (period_ms != 0U && i % period_ms == 0U && i >= age_ms) {
                at->measured_known = true;
                at->measured_us = status.time_us - age_ms * UINT64_C(1000);
                at->measured_q48 = q48(sign * told_deg(now_s - age_ms * 1e-3 - late_s));
            }
        }
        const struct camera_pose pose = gimbal_pose_tick(&gimbal, &status, status.time_us);
        CHECK(pose.zoom == 2.0);
        // Half a tick later it has gone on, if what it was told by then is known already.
        const struct camera_pose next = gimbal_pose_tick(&gimbal, &status, status.time_us + 500U);
        if (i > 600U && latency_us >= 1000U && known_us == latency_us) {
            CHECK(fabs(next.pan_deg - told_deg(now_s + 0.0005 - late_s)) < 1e-6);
        }
        if (i > 600U) { // the history is as long as the longest latency
            const double truth = told_deg(now_s - late_s);
            worst = fmax(worst, fmax(fabs(pose.pan_deg - truth), fabs(pose.tilt_deg + truth)));
        }
    }
    return worst;
}

static void axes_without_feedback_are_late(void) {
    CHECK(worst_error(0, 0, 0, 0) < 1e-9);
    CHECK(worst_error(50000, 50000, 0, 0) < 1e-6);
    CHECK(worst_error(123456, 123456, 0, 0) < 1e-6);
    CHECK(worst_error(CONTROLLER_LATENCY_US_MAX, CONTROLLER_LATENCY_US_MAX, 0, 0) < 1e-6);
    const double unknown = worst_error(50000, 0, 0, 0);
    CHECK(fabs(unknown - 0.05 * RATE_DPS) < 1e-6); // what it is good for
}

static void measurements_are_carried_on(void) {
    CHECK(worst_error(15500, 15500, 4, 0) < 1e-6);
    CHECK(worst_error(15500, 15500, 4, 3) < 1e-6);
    CHECK(worst_error(80000, 80000, 40, 10) < 1e-6);
    CHECK(worst_error(0, 0, 20, 0) < 1e-6);
    // A latency that is not known costs at the changes of speed only: for as long as the axis is
    // late by, the pose goes on ahead of it, by what it turns between two measurements at most.
    CHECK(worst_error(15500, 0, 4, 0) < 4e-3 * RATE_DPS);
}

/// A drive that fell silent long ago is where it was measured.
static void an_old_measurement_stays(void) {
    static struct gimbal_pose gimbal;
    const struct controller_config config = {0};
    struct controller_status status = {
        .axis[AXIS_PAN] = {.measured_known = true, .measured_q48 = q48(12.0), .measured_us = 0}};
    gimbal_pose_init(&gimbal, &config, 6.0, 6.0);
    for (unsigned i = 0; i < 2000U; i++) {
        status.time_us = i * UINT64_C(1000);
        status.axis[AXIS_PAN].setpoint_q48 = q48(12.0 + i * 0.001);
        (void)gimbal_pose_tick(&gimbal, &status, status.time_us);
    }
    CHECK(fabs(gimbal_pose_tick(&gimbal, &status, status.time_us).pan_deg - 12.0) < 1e-9);
}

int main(void) {
    TEST(axes_without_feedback_are_late);
    TEST(measurements_are_carried_on);
    TEST(an_old_measurement_stays);
    return check_finish();
}
