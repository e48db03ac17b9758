/// devices/rmd_drive: how it moves. Steps, speed limits, ramps, streamed targets, rest; with the
/// payload, without it and with more.
#include "rmd_rig.h"

static struct rig rig;

/// pan or tilt; payload is a factor on what the motor turns besides its rotor.
static struct axis_plant_config axis_of(bool tilt, double payload) {
    struct axis_plant_config c = tilt ? axis_plant_tilt() : axis_plant_pan();
    const double rotor = 0.25e-4 * c.gear * c.gear;
    c.inertia_kgm2 = rotor + payload * (c.inertia_kgm2 - rotor);
    c.gravity_nm *= payload;
    return c;
}

/// The limiter that the controller uses, in its simplest form: constant acceleration, then speed.
static double ramp(double t, double way, double speed, double accel) {
    const double up = speed / accel, cruise = way / speed - up;
    if (t < 0.0) {
        return 0.0;
    }
    if (t < up) {
        return 0.5 * accel * t * t;
    }
    if (t < up + cruise) {
        return speed * (t - 0.5 * up);
    }
    const double left = 2.0 * up + cruise - t;
    return left > 0.0 ? way - 0.5 * accel * left * left : way;
}

static void a_step_with_a_speed_limit(void) {
    rig_init(&rig, axis_of(false, 1.0), rmd_drive_defaults(1), 0.0);
    rig_position(&rig, 40.0, 30);
    double fastest = 0.0, furthest = 0.0;
    unsigned arrived = 0;
    for (unsigned ms = 1; ms <= 2500U; ms++) {
        rig_run(&rig, 1);
        fastest = rig_dps(&rig) > fastest ? rig_dps(&rig) : fastest;
        furthest = rig_deg(&rig) > furthest ? rig_deg(&rig) : furthest;
        arrived = fabs(rig_deg(&rig) - 40.0) > 0.01 ? ms : arrived;
    }
    printf("# 40 degrees at 30 dps: %.2f dps at most, overshoot %.4f deg, there after %u ms\n",
           fastest, furthest - 40.0, arrived);
    CHECK(fastest < 32.0);
    CHECK(furthest < 40.005);
    CHECK(arrived > 1330U && arrived < 1480U); // 40 / 30 s and the last e-foldings
    CHECK(fabs(rig_deg(&rig) - 40.0) < 0.005);
    // Without a limit it goes as fast as the loops let it, and still ends well.
    rig_position(&rig, -40.0, 0);
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) + 40.0) < 0.005);
}

static void a_ramp_of_its_own(void) {
    rig_init(&rig, axis_of(false, 1.0), rmd_drive_defaults(1), 0.0);
    (void)rig_ask(&rig, BYTES(0x43, 0, 0, 0, 0x90, 0x01)); // 400 dps/s up
    (void)rig_ask(&rig, BYTES(0x43, 1, 0, 0, 0xC8, 0x00)); // 200 dps/s down
    rig_position(&rig, 60.0, 60);
    double worst = 0.0;
    for (unsigned ms = 1; ms <= 150U; ms++) {
        rig_run(&rig, 1);
        const double off = fabs(rig_dps(&rig) - 0.4 * ms);
        worst = off > worst ? off : worst;
    }
    CHECK(worst < 8.0);
    rig_run(&rig, 150);
    CHECK(fabs(rig_dps(&rig) - 60.0) < 1.0);
    // 0.15 s up (4.5 deg), 0.3 s down (9 deg), 46.5 deg between: 1.225 s.
    rig_run(&rig, 675);
    const double before = rig_dps(&rig);
    rig_run(&rig, 150);
    CHECK(fabs(before - rig_dps(&rig) - 0.2 * 150) < 3.0);
    rig_run(&rig, 70);
    CHECK(fabs(rig_deg(&rig) - 60.0) < 0.4);
    CHECK(rig_deg(&rig) < 60.01);
    rig_run(&rig, 400);
    CHECK(fabs(rig_deg(&rig) - 60.0) < 0.005);
}

struct following {
    double lag_deg, slowest_dps, fastest_dps, over_deg, settle_s;
};

/// Streams a ramp of 60 dps and 400 dps/s, a target every 4 ms, as the controller does.
static struct following follow(bool tilt, double payload, double way_deg) {
    rig_init(&rig, axis_of(tilt, payload), rmd_drive_defaults(1), 0.0);
    struct following f = {.slowest_dps = 1e9};
    const double end = way_deg / 60.0 + 0.15;
    for (unsigned ms = 0; ms < 3000U; ms++) {
        const double t = ms * 0.001;
        if (ms % 4U == 0U) {
            rig_position(&rig, ramp(t, way_deg, 60.0, 400.0), 0);
            rig_send(&rig, BYTES(0x92));
        }
        rig_run(&rig, 1);
        const double over = rig_deg(&rig) - way_deg;
        f.over_deg = over > f.over_deg ? over : f.over_deg;
        if (t > 0.4 && t < end - 0.2) {
            const double lag = ramp(t + 0.001, way_deg, 60.0, 400.0) - rig_deg(&rig);
            f.lag_deg = lag > f.lag_deg ? lag : f.lag_deg;
            f.slowest_dps = fmin(f.slowest_dps, rig_dps(&rig));
            f.fastest_dps = fmax(f.fastest_dps, rig_dps(&rig));
        }
        f.settle_s = fabs(over) > 0.01 ? t - end : f.settle_s;
    }
    return f;
}

static void streamed_targets_are_followed(void) {
    static const double payloads[] = {1.0, 0.0, 0.3, 2.0};
    for (unsigned i = 0; i < 8U; i++) {
        const bool tilt = i >= 4U;
        const double payload = payloads[i % 4U];
        const struct following f = follow(tilt, payload, 80.0);
        printf("# %s, payload x %.1f: lag %.3f deg at 60 dps, speed %.1f to %.1f, overshoot %.4f "
               "deg, within 0.01 deg %.0f ms after the end\n",
               tilt ? "tilt" : "pan", payload, f.lag_deg, f.slowest_dps, f.fastest_dps, f.over_deg,
               f.settle_s * 1000.0);
        // 60 dps over the gain of 80 / s, a target up to 4 ms old and 0.3 ms on the bus.
        CHECK(f.lag_deg > 0.74 && f.lag_deg < 1.05);
        CHECK(f.slowest_dps > 48.0 && f.fastest_dps < 72.0);
        CHECK(f.over_deg < 0.005);
        CHECK(f.settle_s < 0.2);
    }
}

/// After a move of any size the axis stands, within 0.005 degrees, and not a count moves any more.
static void rests_on_target(void) {
    uint64_t seed = 20;
    check_note("seed", (int64_t)seed);
    double worst = 0.0;
    for (unsigned axis = 0; axis < 6U; axis++) {
        static const double payloads[] = {1.0, 0.0, 2.0};
        rig_init(&rig, axis_of(axis % 2U == 1U, payloads[axis / 2U]), rmd_drive_defaults(1), 0.0);
        double target = 0.0;
        for (unsigned move = 0; move < 30U && check_clean(); move++) {
            const double size = move % 3U == 0U ? 60.0 : move % 3U == 1U ? 1.0 : 0.05;
            target = size * ((double)(check_random(&seed) >> 11) / 4503599627370496.0 - 1.0);
            target = (double)(int)(target * 100.0) / 100.0;
            for (unsigned ms = 0; ms < 2500U; ms++) {
                if (ms % 4U == 0U) {
                    rig_position(&rig, target, 60);
                }
                rig_run(&rig, 1);
                if (ms >= 2000U) {
                    CHECK(rig.plant.rate_rps == 0.0);
                }
            }
            const double off = fabs(rig_deg(&rig) - target);
            worst = off > worst ? off : worst;
        }
        for (unsigned ms = 0; ms < 120000U && check_clean(); ms++) { // hunting takes its time
            rig_run(&rig, 1);
            CHECK(rig.plant.rate_rps == 0.0);
        }
    }
    check_note("worst error at rest, 1e-6 deg", (int64_t)(worst * 1e6));
    CHECK(worst < 0.005);
}

/// A slow target: no stick-slip that a camera would see.
static void slow_targets(void) {
    rig_init(&rig, axis_of(true, 1.0), rmd_drive_defaults(1), 0.0);
    double worst = 0.0;
    for (unsigned ms = 0; ms < 8000U; ms++) {
        const double target = 0.5 * ms * 0.001;
        if (ms % 4U == 0U) {
            rig_position(&rig, target, 60);
        }
        rig_run(&rig, 1);
        if (ms > 1000U) {
            const double off = fabs(target - 0.5 / 80.0 - rig_deg(&rig));
            worst = off > worst ? off : worst;
        }
    }
    check_note("at 0.5 dps, worst off a smooth motion, 1e-6 deg", (int64_t)(worst * 1e6));
    CHECK(worst < 0.02);
}

/// A hand pushes and lets go: it comes back, and holds against a steady load.
static void disturbances(void) {
    rig_init(&rig, axis_of(false, 1.0), rmd_drive_defaults(1), 0.0);
    rig_position(&rig, 10.0, 60);
    rig_run(&rig, 1500);
    rig.plant.disturbance_nm = 2.0;
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) - 10.0) < 0.005);
    CHECK(rig.plant.rate_rps == 0.0);
    rig.plant.disturbance_nm = 0.0;
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) - 10.0) < 0.005);
    CHECK(rig.plant.rate_rps == 0.0);
}

int main(void) {
    TEST(a_step_with_a_speed_limit);
    TEST(a_ramp_of_its_own);
    TEST(streamed_targets_are_followed);
    TEST(rests_on_target);
    TEST(slow_targets);
    TEST(disturbances);
    return check_finish();
}
