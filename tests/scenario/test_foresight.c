/// Things that go about a sphere by a formula, seen now and then and a while ago: where they are
/// said to be now, against where they are.
#include "check.h"

#include "detect/foresight.h"

#include <math.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180.0)

static uint64_t seed = UINT64_C(0xF0E51);
static struct foresight foresight;

static double any(double low, double high) {
    return low + (high - low) * (double)(check_random(&seed) >> 11) * 0x1p-53;
}

static void toward(double pan_deg, double tilt_deg, double world[3]) {
    const double pan = pan_deg * DEGREE, tilt = tilt_deg * DEGREE;
    world[0] = cos(tilt) * sin(pan);
    world[1] = cos(tilt) * cos(pan);
    world[2] = sin(tilt);
}

static double apart_deg(const double a[3], const double b[3]) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return 2.0 * asin(0.5 * sqrt(x * x + y * y + z * z)) / DEGREE;
}

/// rms of the error after the first ten sights, and of what was seen, each age_ms later. rate_dps
/// to the right; swing_deg to and fro beside it; noise_deg of a sight.
static double error_of(double rate_dps, double swing_deg, double noise_deg, unsigned age_ms,
                       double *seen_rms_deg) {
    double sum = 0.0, seen_sum = 0.0;
    unsigned count = 0;
    foresight_init(&foresight);
    for (unsigned i = 0; i < 300U; i++) {
        // 25 frames a second, irregular as USB has them; the clock wraps on the way.
        const double then_s = i * 0.04 + any(-0.005, 0.005), now_s = then_s + age_ms * 1e-3;
        const uint32_t seen_us = UINT32_C(0xFFC00000) + (uint32_t)(then_s * 1e6 + 1e4);
        double world[3], truth[3], seen[3];
        toward(rate_dps * now_s + swing_deg * sin(now_s), swing_deg * cos(now_s), truth);
        toward(rate_dps * then_s + swing_deg * sin(then_s) + any(-1.7, 1.7) * noise_deg,
               swing_deg * cos(then_s) + any(-1.7, 1.7) * noise_deg, world);
        memcpy(seen, world, sizeof seen);
        foresight_see(&foresight, 7, seen_us, seen_us + age_ms * 1000U, world);
        const double size = sqrt(world[0] * world[0] + world[1] * world[1] + world[2] * world[2]);
        CHECK(fabs(size - 1.0) < 1e-9);
        if (i >= 10U) {
            sum += pow(apart_deg(world, truth), 2.0);
            seen_sum += pow(apart_deg(seen, truth), 2.0);
            count++;
        }
    }
    *seen_rms_deg = sqrt(seen_sum / count);
    return sqrt(sum / count);
}

static void what_goes_is_where_it_is_by_now(void) {
    double seen;
    check_note("seed", (int64_t)seed);
    for (unsigned age_ms = 0; age_ms <= 100U; age_ms += 20U) {
        for (double rate = 5.0; rate <= 60.0; rate *= 2.0) {
            const double error = error_of(rate, 0.0, 0.02, age_ms, &seen);
            // What is left is the noise and that its way is bent.
            CHECK(error < 0.035 + 0.0008 * rate * rate * age_ms * 1e-3);
            CHECK(age_ms < 40U || error < 0.2 * seen);
        }
        // 5 degrees to and fro in 6 seconds: up to 7 degrees a second.
        const double error = error_of(0.0, 5.0, 0.02, age_ms, &seen);
        CHECK(error < 0.05 + 0.0012 * age_ms && (age_ms < 40U || error < 0.4 * seen));
    }
}

/// What stands still is hardly less still for it.
static void noise_does_not_grow(void) {
    double seen;
    for (unsigned age_ms = 0; age_ms <= 100U; age_ms += 20U) {
        const double error = error_of(0.0, 0.0, 0.05, age_ms, &seen);
        CHECK(error < 1.6 * seen);
    }
}

/// A tag that is taken away and shown elsewhere is not thrown beyond.
static void a_jump_is_no_speed(void) {
    double world[3], truth[3];
    foresight_init(&foresight);
    for (unsigned i = 0; i < 40U; i++) {
        const uint32_t seen_us = i * 50000U;
        toward(i < 20U ? 0.0 : 15.0, 3.0, truth);
        memcpy(world, truth, sizeof world);
        foresight_see(&foresight, 7, seen_us, seen_us + 60000U, world);
        CHECK(apart_deg(world, truth) < 1e-6);
    }
}

static void what_is_not_known_is_where_it_was_seen(void) {
    double world[3], truth[3];
    foresight_init(&foresight);
    for (unsigned i = 0; i < 12U; i++) { // the first two sights; a gap; far too old
        const uint32_t seen_us = i < 6U ? i * 50000U : i * 50000U + 2000000U;
        toward(i * 1.0, 0.0, truth);
        memcpy(world, truth, sizeof world);
        foresight_see(&foresight, 7, seen_us, seen_us + (i == 11U ? 400000U : 50000U), world);
        const bool carried = apart_deg(world, truth) > 0.5;
        CHECK(carried == ((i >= 2U && i < 6U) || (i >= 8U && i < 11U)));
    }
    foresight_forget(&foresight, 7);
    CHECK_EQ(foresight.count, 0);
    for (uint32_t id = 0; id < FORESIGHT_THINGS + 5U; id++) { // as many as there is room for
        toward(1.0, 0.0, world);
        foresight_see(&foresight, id, 0, 50000U, world);
    }
    CHECK_EQ(foresight.count, FORESIGHT_THINGS);
}

int main(void) {
    TEST(what_goes_is_where_it_is_by_now);
    TEST(noise_does_not_grow);
    TEST(a_jump_is_no_speed);
    TEST(what_is_not_known_is_where_it_was_seen);
    return check_finish();
}
