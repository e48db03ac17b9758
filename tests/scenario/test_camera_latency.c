/// The latency of a camera from what it sees while the gimbal turns: sightings made from a known
/// latency, by the sines of the motion and a projection written here.
#include "check.h"

#include "camera_latency.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180.0)

static uint64_t seed = UINT64_C(0x1A7E9C);

static double noise(void) {
    return 2.0 * ((double)(check_random(&seed) >> 11) * 0x1p-53) - 1.0;
}

/// Where the gimbal is at a time.
static double pan_deg(double at_s) {
    return 12.0 + 6.0 * sin(at_s * 3.1);
}
static double tilt_deg(double at_s) {
    return -4.0 + 2.0 * sin(at_s * 2.3);
}

/// A direction at `right` degrees of pan and `up` of tilt in the axes of a level camera that looks
/// along pan and tilt.
static void see(double right_deg, double up_deg, double at_pan_deg, double at_tilt_deg,
                double ray[3]) {
    const double a = (right_deg - at_pan_deg) * DEGREE, e = up_deg * DEGREE;
    const double t = at_tilt_deg * DEGREE;
    const double x = cos(e) * sin(a), y = cos(e) * cos(a), z = sin(e);
    ray[0] = x;
    ray[1] = y * cos(t) + z * sin(t);
    ray[2] = -y * sin(t) + z * cos(t);
}

static struct camera_latency data;

/// As a model takes it whose focal length is 1 / lens of the true one.
static void mistake(double lens, double ray[3]) {
    const double x = ray[0] / ray[1] * lens, z = ray[2] / ray[1] * lens;
    const double length = sqrt(x * x + 1.0 + z * z);
    ray[0] = x / length;
    ray[1] = 1.0 / length;
    ray[2] = z / length;
}

/// 6 seconds of 30 frames a second of two things, and poses of every tick_us. The clock wraps.
static void observe_through(double lens, double latency_ms, unsigned tick_us, double noise_deg,
                            bool stands) {
    struct mount mount;
    const struct camera_seat seat = {0.0, 0.0, 0.0};
    const uint32_t start_us = 0xFFE00000U;
    mount_init(&mount, (struct mount_attitude){bam32(0), bam32(0), bam32(0)});
    camera_latency_init(&data, &mount, &seat);
    for (uint32_t at_us = 0; at_us < 6000000U; at_us += tick_us) {
        const double at_s = stands ? 0.0 : at_us * 1e-6;
        const struct camera_pose pose = {pan_deg(at_s), tilt_deg(at_s), 1.0};
        camera_latency_pose(&data, start_us + at_us, &pose);
    }
    for (uint32_t i = 0; i < 180U; i++) {
        const double stamp_s = i / 30.0, at_s = stands ? 0.0 : stamp_s - latency_ms * 1e-3;
        for (uint32_t id = 0; id < 2U; id++) {
            double ray[3];
            see(10.0 + 5.0 * id + noise_deg * noise(), -3.0 + 12.0 * id + noise_deg * noise(),
                pan_deg(at_s), tilt_deg(at_s), ray);
            mistake(lens, ray);
            camera_latency_sight(&data, start_us + (uint32_t)(int32_t)lround(stamp_s * 1e6),
                                 70U + id, ray);
        }
    }
}

static void observe(double latency_ms, unsigned tick_us, double noise_deg, bool stands) {
    observe_through(1.0, latency_ms, tick_us, noise_deg, stands);
}

static void finds_the_latency_that_was_put_in(void) {
    static const double cases[] = {0.0, 35.0, 3.3, 120.7, -40.0, 333.3, -155.5};
    for (unsigned i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct camera_latency_found got = {1e9, 0.0, 1e9};
        observe(cases[i], 1000, 0.0, false);
        CHECK(camera_latency_fit(&data, &got) == NULL);
        CHECK(fabs(got.latency_ms - cases[i]) < 0.05 && got.rms_deg < 0.01);
        CHECK(fabs(got.lens - 1.0) < 1e-4);
        observe(cases[i], 4000, 0.02, false);
        CHECK(camera_latency_fit(&data, &got) == NULL);
        CHECK(fabs(got.latency_ms - cases[i]) < 0.5 && got.rms_deg < 0.03);
        CHECK(fabs(got.lens - 1.0) < 0.002);
    }
}

/// By a lens that is known badly the latency is not.
static void finds_the_lens(void) {
    static const double lenses[] = {0.6, 0.8, 0.95, 1.02, 1.12, 1.5, 1.8};
    static const double latencies_ms[] = {0.0, 35.0, 120.7};
    for (unsigned i = 0; i < sizeof lenses / sizeof *lenses; i++) {
        for (unsigned j = 0; j < sizeof latencies_ms / sizeof *latencies_ms; j++) {
            struct camera_latency_found got = {1e9, 0.0, 1e9};
            observe_through(lenses[i], latencies_ms[j], 4000, 0.02, false);
            CHECK(camera_latency_fit(&data, &got) == NULL);
            CHECK(fabs(got.lens / lenses[i] - 1.0) < 0.002);
            CHECK(fabs(got.latency_ms - latencies_ms[j]) < 0.5 && got.rms_deg < 0.03);
        }
    }
    struct camera_latency_found got;
    observe_through(3.0, 35.0, 4000, 0.02, false); // beyond what is looked for
    CHECK(camera_latency_fit(&data, &got) != NULL);
}

static void says_when_it_can_not_tell(void) {
    struct camera_latency_found got;
    observe(35.0, 1000, 0.02, true);
    CHECK(camera_latency_fit(&data, &got) != NULL);
    observe(35.0, 1000, 10.0, false); // what moves about by itself
    CHECK(camera_latency_fit(&data, &got) != NULL);
    observe(700.0, 1000, 0.0, false); // beyond what is looked for
    CHECK(camera_latency_fit(&data, &got) != NULL);
    data.sight_count = 10;
    CHECK(camera_latency_fit(&data, &got) != NULL);
    data.sight_count = data.pose_count = 0;
    CHECK(camera_latency_fit(&data, &got) != NULL);
}

int main(void) {
    TEST(finds_the_latency_that_was_put_in);
    TEST(finds_the_lens);
    TEST(says_when_it_can_not_tell);
    return check_finish();
}
