/// plant/axis_plant against closed formulas of motion and the numbers of the data sheet.
#include "check.h"

#include "plant/axis_plant.h"

#include <math.h>
#include <stdio.h>

#define DT  AXIS_PLANT_SUBSTEP_S
#define DEG (AXIS_PLANT_PI / 180.0)

/// Inertia only; the tests add what they are about.
static struct axis_plant_config bare(void) {
    struct axis_plant_config c = axis_plant_pan();
    c.static_nm = c.coulomb_nm = c.viscous_nms = c.gravity_nm = 0.0;
    c.stop_min_rad = -1e9;
    c.stop_max_rad = 1e9;
    return c;
}

static struct axis_plant plant_of(struct axis_plant_config c, double angle_rad) {
    struct axis_plant p;
    axis_plant_init(&p, &c, angle_rad);
    return p;
}

static void run(struct axis_plant *p, double seconds, double torque_nm, double brake_nm) {
    for (int i = (int)(seconds / DT + 0.5); i > 0; i--) {
        axis_plant_step(p, torque_nm, brake_nm);
    }
}

/// |got - wanted| <= part * |wanted|.
static bool within(double got, double wanted, double part) {
    const bool ok = fabs(got - wanted) <= part * fabs(wanted);
    if (!ok) {
        printf("# got %.9g wanted %.9g\n", got, wanted);
    }
    return ok;
}

static void constant_torque(void) {
    const struct axis_plant_config c = bare();
    for (int sign = -1; sign <= 1; sign += 2) {
        struct axis_plant p = plant_of(c, 0.3);
        const double a = sign * 0.5 / c.inertia_kgm2, t = 0.4; // below the knee all the way
        run(&p, t, sign * 0.5, 0.0);
        CHECK(fabs(p.rate_rps) < p.knee_rps);
        CHECK(within(p.rate_rps, a * t, 1e-12));
        // a t^2 / 2; semi-implicit steps lead by half a step.
        CHECK(within(p.angle_rad - 0.3, 0.5 * a * t * (t + DT), 1e-12));
    }
}

static void coulomb_friction_stops_it(void) {
    struct axis_plant_config c = bare();
    c.static_nm = c.coulomb_nm = 0.6;
    const double a = 0.6 / c.inertia_kgm2;
    for (double v = 0.5; v < 20.0; v *= 2.0) {
        struct axis_plant p = plant_of(c, 0.0);
        p.rate_rps = -v;
        double t = 0.0;
        while (p.rate_rps != 0.0 && t < 10.0) {
            axis_plant_step(&p, 0.0, 0.0);
            t += DT;
        }
        CHECK(fabs(t - v / a) <= 1.01 * DT);
        CHECK(fabs(p.angle_rad + 0.5 * v * v / a) <= v * DT);
        const double rest = p.angle_rad;
        run(&p, 1.0, 0.0, 0.0);
        CHECK(p.angle_rad == rest && p.rate_rps == 0.0);
    }
}

static void viscous_friction_decays(void) {
    struct axis_plant_config c = bare();
    c.viscous_nms = 0.05;
    struct axis_plant p = plant_of(c, 0.0);
    p.rate_rps = 3.0;
    const double tau = c.inertia_kgm2 / c.viscous_nms;
    run(&p, tau, 0.0, 0.0);
    CHECK(within(p.rate_rps, 3.0 * exp(-1.0), DT / tau));
    run(&p, 40.0 * tau, 0.0, 0.0);
    CHECK(within(p.angle_rad, 3.0 * tau, 1.01 * DT / tau));
}

static void static_friction_holds(void) {
    struct axis_plant_config c = bare();
    c.static_nm = 0.8;
    c.coulomb_nm = 0.6;
    struct axis_plant p = plant_of(c, 0.1);
    run(&p, 1.0, 0.7999, 0.0);
    run(&p, 1.0, -0.7999, 0.0);
    CHECK(p.angle_rad == 0.1 && p.rate_rps == 0.0);
    run(&p, 1.0, 0.8001, 0.0);
    CHECK(p.rate_rps > 1.0); // once it slips, friction falls to Coulomb's
    p = plant_of(c, 0.1);
    run(&p, 1.0, 5.7, 5.0); // with the brake on
    CHECK(p.rate_rps == 0.0);
    run(&p, 1.0, -5.9, 5.0);
    CHECK(p.rate_rps < -1.0);
    // From slow to fast: static plus, Stribeck half-way, Coulomb.
    const double fraction[] = {0.01, 1.0, 100.0}, part[] = {1.0, 0.5, 0.0};
    for (int i = 0; i < 3; i++) {
        p = plant_of(c, 0.0);
        p.rate_rps = fraction[i] * c.stribeck_rps;
        const double before = p.rate_rps;
        axis_plant_step(&p, 1.0, 0.0);
        const double friction = 1.0 - (p.rate_rps - before) / DT * c.inertia_kgm2;
        CHECK(fabs(friction - (0.6 + 0.2 * part[i])) < 1e-4);
    }
}

/// A load hanging below the axis: the period of a pendulum, with the first term for its amplitude.
static void gravity_is_a_pendulum(void) {
    struct axis_plant_config c = bare();
    c.gravity_nm = 0.147;
    c.lever_rad = 0.25;
    const double bottom = -0.5 * AXIS_PLANT_PI - c.lever_rad, swing = 0.2;
    struct axis_plant p = plant_of(c, bottom + swing);
    double crossed = 0.0, period = 0.0;
    for (int i = 1; period == 0.0 && i < 100000; i++) {
        const double before = p.angle_rad - bottom;
        axis_plant_step(&p, 0.0, 0.0);
        const double after = p.angle_rad - bottom;
        if (before < 0.0 && after >= 0.0) {
            const double t = (i - after / (after - before)) * DT;
            period = crossed != 0.0 ? t - crossed : 0.0;
            crossed = t;
        }
    }
    const double wanted =
        2.0 * AXIS_PLANT_PI * sqrt(c.inertia_kgm2 / c.gravity_nm) * (1.0 + swing * swing / 16.0);
    CHECK(within(period, wanted, 1e-4));
    run(&p, 60.0, 0.0, 0.0); // semi-implicit: no energy comes or goes
    const double height = 1.0 - cos(p.angle_rad - bottom);
    const double energy = 0.5 * c.inertia_kgm2 * p.rate_rps * p.rate_rps + c.gravity_nm * height;
    CHECK(within(energy, c.gravity_nm * (1.0 - cos(swing)), 2e-3));
    // Tilt in the middle: the whole moment pulls the nose down.
    c = axis_plant_tilt();
    c.static_nm = c.coulomb_nm = c.viscous_nms = 0.0;
    p = plant_of(c, 0.0);
    axis_plant_step(&p, 0.0, 0.0);
    CHECK(within(p.rate_rps, -0.14715 / c.inertia_kgm2 * DT, 1e-9));
}

static void cosine(void) {
    double worst = 0.0;
    for (double x = -20.0; x < 20.0; x += 0.0007) {
        const double error = fabs(axis_plant_cos(x) - cos(x));
        worst = error > worst ? error : worst;
    }
    for (double x = -1.0e6; x < 1.0e6; x += 777.7) {
        const double error = fabs(axis_plant_cos(x) - cos(x));
        worst = error > worst ? error : worst;
    }
    check_note("worst error of the cosine, 1e-12", (int64_t)(worst * 1e12));
    CHECK(worst < 3e-9);
    CHECK(axis_plant_cos(0.0) == 1.0);
}

static void motor_limits(void) {
    struct axis_plant_config c = bare();
    struct axis_plant p = plant_of(c, 0.0);
    axis_plant_step(&p, 50.0, 0.0);
    CHECK(p.motor_nm == 10.0);
    axis_plant_step(&p, -50.0, 0.0);
    CHECK(p.motor_nm == -10.0);
    // At 30 rad/s: (24 V - 30 * 0.7162 V) / 0.64 ohm * 0.7162 Nm/A; braking has the full torque.
    const double emf = 0.06 / (2.0 * AXIS_PLANT_PI) * 60.0 / 10.0 * 12.5;
    p.rate_rps = 30.0;
    axis_plant_step(&p, 50.0, 0.0);
    CHECK(within(p.motor_nm, (24.0 - 30.0 * emf) / 0.64 * emf, 1e-12));
    p.rate_rps = 30.0;
    axis_plant_step(&p, -50.0, 0.0);
    CHECK(p.motor_nm == -10.0);
    p.rate_rps = -60.0;
    axis_plant_step(&p, -50.0, 0.0);
    CHECK(p.motor_nm == 0.0); // faster than the supply can push
    CHECK(axis_plant_torque_max(&p, 0.0) == 10.0);
}

/// What the sheet says of the free actuator: 317 rpm without load, 24 W going in.
static void the_sheet(void) {
    struct axis_plant_config c = axis_plant_pan();
    c.inertia_kgm2 = 0.25e-4 * 12.5 * 12.5;
    c.stop_max_rad = 1e9;
    struct axis_plant p = plant_of(c, 0.0);
    run(&p, 5.0, 10.0, 0.0);
    const double rpm = p.rate_rps * 60.0 / (2.0 * AXIS_PLANT_PI);
    check_note("no-load speed, 0.1 rpm", (int64_t)(rpm * 10.0));
    CHECK(within(rpm, 317.0, 0.02));
    CHECK(within(p.motor_nm * p.rate_rps, 24.0 - 1.8, 0.03));
    // 4 Nm at 238 rpm are within its limits.
    CHECK(axis_plant_torque_max(&p, 238.0 * 2.0 * AXIS_PLANT_PI / 60.0) > 4.0);
}

static void end_stops(void) {
    struct axis_plant_config c = axis_plant_tilt();
    struct axis_plant p = plant_of(c, 0.0);
    run(&p, 3.0, 4.0, 0.0);
    CHECK(p.angle_rad == c.stop_max_rad && p.rate_rps == 0.0 && p.at_stop == 1);
    run(&p, 3.0, -4.0, 0.0);
    CHECK(p.angle_rad == c.stop_min_rad && p.rate_rps == 0.0 && p.at_stop == -1);
    run(&p, 0.1, 4.0, 0.0);
    CHECK(p.angle_rad > c.stop_min_rad && p.at_stop == 0);
    p = plant_of(c, 0.0);
    p.disturbance_nm = -3.0;
    run(&p, 3.0, 0.0, 0.0);
    CHECK(p.at_stop == -1);
}

static void encoder_counts(void) {
    struct axis_plant p = plant_of(bare(), 0.0);
    const double count = 2.0 * AXIS_PLANT_PI / (131072.0 * 12.5);
    for (int i = -3000000; i <= 3000000; i += 1237) {
        p.angle_rad = (i + 0.01) * count;
        CHECK_EQ(axis_plant_counts(&p), i);
        p.angle_rad = (i + 0.99) * count;
        CHECK_EQ(axis_plant_counts(&p), i);
        if (!check_clean()) {
            return;
        }
    }
    p.angle_rad = 0.0;
    CHECK_EQ(axis_plant_counts(&p), 0);
    p.angle_rad = -1e-12;
    CHECK_EQ(axis_plant_counts(&p), -1);
}

static void the_hash_covers_the_state(void) {
    struct axis_plant p = plant_of(axis_plant_pan(), 0.1);
    const uint64_t before = axis_plant_hash(&p, 1);
    p.angle_rad += 1e-16;
    CHECK(axis_plant_hash(&p, 1) != before);
    p = plant_of(axis_plant_pan(), 0.1);
    p.rate_rps = 1e-300;
    CHECK(axis_plant_hash(&p, 1) != before);
    CHECK(axis_plant_hash(&p, 1) != axis_plant_hash(&p, 2));
}

int main(void) {
    TEST(constant_torque);
    TEST(coulomb_friction_stops_it);
    TEST(viscous_friction_decays);
    TEST(static_friction_holds);
    TEST(gravity_is_a_pendulum);
    TEST(cosine);
    TEST(motor_limits);
    TEST(the_sheet);
    TEST(end_stops);
    TEST(encoder_counts);
    TEST(the_hash_covers_the_state);
    return check_finish();
}
