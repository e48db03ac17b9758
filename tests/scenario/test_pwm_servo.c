/// devices/pwm_servo: the hobby servo and the zoom lens, in numbers worked out by hand.
#include "check.h"

#include "devices/pwm_servo.h"

#include <math.h>

#define MS UINT64_C(1000000)

static struct pwm_servo new_servo(double angle_deg, uint64_t seed) {
    const struct pwm_servo_config c = pwm_servo_defaults();
    struct pwm_servo s;
    pwm_servo_init(&s, &c, angle_deg, 0, seed);
    return s;
}

static void run(struct pwm_servo *s, unsigned ms) {
    pwm_servo_advance(s, s->now_ns + ms * MS);
}

static bool near(double got, double wanted, double tolerance) {
    return got - wanted <= tolerance && wanted - got <= tolerance;
}

static void pulses_are_angles(void) {
    static const struct {
        uint32_t pulse_ns;
        double angle_deg;
    } cases[] = {{1500000, 0.0},  {2000000, 45.0}, {1000000, -45.0}, {1600000, 9.0},
                 {800000, -63.0}, {2200000, 63.0}, {1501000, 0.0}};
    for (unsigned i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct pwm_servo s = new_servo(0.0, i);
        pwm_servo_set_pulse(&s, cases[i].pulse_ns);
        run(&s, 1000);
        CHECK(near(s.angle_deg, cases[i].angle_deg, 0.0901)); // half the dead band
        CHECK(s.rate_dps == 0.0);
    }
}

static void sixty_degrees_in_a_tenth_of_a_second(void) {
    struct pwm_servo s = new_servo(-30.0, 3);
    pwm_servo_set_pulse(&s, 2200000);
    unsigned moving = 0;
    double last = s.angle_deg, fastest = 0.0;
    while (s.angle_deg < 30.0 && moving < 1000U) {
        run(&s, 1);
        moving += s.rate_dps != 0.0 ? 1U : 0U;
        fastest = s.angle_deg - last > fastest ? s.angle_deg - last : fastest;
        last = s.angle_deg;
    }
    CHECK_NEAR(moving, 100, 1);
    CHECK(near(fastest, 0.6, 1e-9)); // 600 degrees a second
}

/// 2 us wide, so 1 us or 0.09 degrees either way.
static void dead_band(void) {
    static const struct {
        uint32_t pulse_ns;
        bool moves;
    } cases[] = {{1699100, false}, {1700900, false}, {1698900, true}, {1701100, true}};
    for (unsigned i = 0; i < 4U; i++) {
        struct pwm_servo s = new_servo(18.0, 5); // where 1,700 us hold it
        pwm_servo_set_pulse(&s, cases[i].pulse_ns);
        run(&s, 500);
        CHECK((s.angle_deg != 18.0) == cases[i].moves);
        CHECK(near(s.angle_deg, 18.0, 0.099));
    }
}

static void bad_pulses_are_ignored(void) {
    struct pwm_servo s = new_servo(0.0, 6);
    pwm_servo_set_pulse(&s, 1800000);
    run(&s, 500);
    const double rest = s.angle_deg;
    static const uint32_t bad[] = {1, 799999, 2200001, 20000000, UINT32_MAX};
    for (unsigned i = 0; i < 5U; i++) {
        pwm_servo_set_pulse(&s, bad[i]);
        run(&s, 100);
        CHECK(s.angle_deg == rest);
        CHECK(pwm_servo_powered(&s));
    }
    CHECK_EQ(s.ignored, 25); // one sample in 20 ms
    s = new_servo(7.0, 6);   // bad from the start: it never had a target
    pwm_servo_set_pulse(&s, 300000);
    run(&s, 500);
    CHECK(s.angle_deg == 7.0);
}

static void without_pulses_it_lets_go(void) {
    struct pwm_servo s = new_servo(20.0, 7);
    CHECK(!pwm_servo_powered(&s));
    run(&s, 200);
    CHECK(s.angle_deg == 20.0);
    pwm_servo_set_pulse(&s, 800000);
    run(&s, 60);
    CHECK(pwm_servo_powered(&s));
    pwm_servo_set_pulse(&s, 0);
    run(&s, 39);
    CHECK(pwm_servo_powered(&s));
    run(&s, 22);
    CHECK(!pwm_servo_powered(&s));
    const double rest = s.angle_deg;
    CHECK(rest > -62.0); // it was still on its way
    run(&s, 500);
    CHECK(s.angle_deg == rest);
    pwm_servo_set_pulse(&s, 1500000);
    run(&s, 500);
    CHECK(near(s.angle_deg, 0.0, 0.0901));
    s.stuck = true;
    pwm_servo_set_pulse(&s, 2000000);
    run(&s, 500);
    CHECK(near(s.angle_deg, 0.0, 0.0901));
}

/// The phase of the frame is spread over the 20 ms, and a pulse is seen when it comes round.
static void samples_once_a_frame(void) {
    unsigned quarter[4] = {0, 0, 0, 0};
    for (uint64_t seed = 0; seed < 400U; seed++) {
        struct pwm_servo s = new_servo(0.0, seed);
        CHECK(s.next_sample_ns < 20U * MS);
        quarter[s.next_sample_ns / (5U * MS)]++;
        const unsigned due = (unsigned)((s.next_sample_ns + MS - 1U) / MS);
        run(&s, due == 0U ? 1U : due); // the first frame has no pulse
        pwm_servo_set_pulse(&s, 2000000);
        run(&s, 19);
        CHECK(s.angle_deg == 0.0);
        run(&s, 1);
        CHECK(s.angle_deg > 0.0);
        if (!check_clean()) {
            return;
        }
    }
    for (unsigned i = 0; i < 4U; i++) {
        CHECK_NEAR(quarter[i], 100, 45); // 5 sigma
    }
}

static void the_zoom_lens(void) {
    const struct zoom_lens_config c = zoom_lens_defaults();
    struct zoom_lens lens;
    zoom_lens_init(&lens, &c, 0, 11);
    CHECK(zoom_lens_focal_mm(&lens) == 6.0);
    pwm_servo_set_pulse(&lens.servo, 1500000);
    run(&lens.servo, 3000);
    CHECK(near(zoom_lens_focal_mm(&lens), sqrt(6.0 * 60.0), 0.1));
    pwm_servo_set_pulse(&lens.servo, 1000000);
    run(&lens.servo, 3000);
    CHECK(near(zoom_lens_focal_mm(&lens), 6.0, 0.03));
    pwm_servo_set_pulse(&lens.servo, 2000000);
    double last = zoom_lens_focal_mm(&lens);
    unsigned ms = 0;
    while (lens.servo.angle_deg < c.tele_deg - 2.0 && ms < 9000U) {
        run(&lens.servo, 1);
        ms++;
        CHECK(zoom_lens_focal_mm(&lens) >= last);
        last = zoom_lens_focal_mm(&lens);
    }
    CHECK_NEAR(ms, 1960, 40); // 88 of 90 degrees at 45 a second, and up to 20 ms of waiting
    run(&lens.servo, 1000);
    CHECK(near(zoom_lens_focal_mm(&lens), 60.0, 0.3));
    // Every tabulated length is one factor from its neighbour.
    for (unsigned i = 1; i < ZOOM_LENS_POINTS; i++) {
        CHECK(near(c.focal_mm[i] / c.focal_mm[i - 1U], pow(10.0, 0.125), 1e-12));
    }
    lens.servo.angle_deg = c.tele_deg + 5.0;
    CHECK(zoom_lens_focal_mm(&lens) == c.focal_mm[ZOOM_LENS_POINTS - 1]);
    lens.servo.angle_deg = c.wide_deg - 5.0;
    CHECK(zoom_lens_focal_mm(&lens) == 6.0);
}

int main(void) {
    TEST(pulses_are_angles);
    TEST(sixty_degrees_in_a_tenth_of_a_second);
    TEST(dead_band);
    TEST(bad_pulses_are_ignored);
    TEST(without_pulses_it_lets_go);
    TEST(samples_once_a_frame);
    TEST(the_zoom_lens);
    return check_finish();
}
