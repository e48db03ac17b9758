/// The image with a yard in its flash, on the emulated chip: people walk behind what stands there.
/// They are told of by the serial line, as somebody's program would.
#include "mcu/cpu/closed_loop.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define IMAGE    "build/boards/stm32f405/hidden/boresight.elf"
#define SCENARIO "tests/mcu/cpu/hidden/scenario.ini"
#define PEOPLE   5U
#define TELL_MS  50U

// ---------------------------------------------------------------- people

/// Where they begin, and how they walk, in metres.
static const double start_m[PEOPLE][2] = {{-7, 20}, {-5, 22}, {-4, 20}, {-2, 21}, {-9, 21}};
static double speed_mps[PEOPLE];

static void place(unsigned who, double s, double at_m[2]) {
    at_m[0] = start_m[who][0] + speed_mps[who] * s;
    at_m[1] = start_m[who][1];
}

static double azimuth_deg(unsigned who, double s) {
    double at_m[2];
    place(who, s, at_m);
    return atan2(at_m[0], at_m[1]) * 180.0 / acos(-1.0);
}

/// Everyone stands at the height of the gimbal: the middle of the outermost two.
static double middle_deg(unsigned count, double s) {
    double low = 180, high = -180;
    for (unsigned i = 0; i < count; i++) {
        low = fmin(low, azimuth_deg(i, s));
        high = fmax(high, azimuth_deg(i, s));
    }
    return (low + high) / 2.0;
}

static void tell_all(unsigned count, double s) {
    char line[80];
    for (unsigned i = 0; i < count; i++) {
        double at_m[2];
        place(i, s, at_m);
        snprintf(line, sizeof line, "target %u %.3f %.3f 0\r", i + 1U, at_m[0], at_m[1]);
        type(line, 0);
    }
}

/// A walk: what the aim did from the settling on.
struct walk_seen {
    double error_deg_max, rate_dps_max, end_deg;
    unsigned hidden_most; ///< of the people at a time, as `status` tells
};

static struct walk_seen walk(unsigned count, double seconds, double settle_s) {
    struct walk_seen seen = {0, 0, 0, 0};
    double before_deg = 0;
    run_ms(1500);
    for (unsigned ms = 0; ms < (unsigned)(seconds * 1000.0); ms++) {
        const double s = ms * 1e-3;
        if (ms % TELL_MS == 0U) {
            tell_all(count, s);
        }
        if (ms % 500U == 250U) {
            type("status\r", 0);
        }
        if (ms % 500U == 499U) {
            fflush(console);
            const unsigned hidden = (unsigned)strtoul(last("hidden: "), NULL, 10);
            seen.hidden_most = hidden > seen.hidden_most ? hidden : seen.hidden_most;
        }
        run_ms(1);
        const double pan_deg = sim_joint_deg(sim, AXIS_PAN);
        if (s > settle_s && ms % 10U == 0U) {
            seen.error_deg_max = fmax(seen.error_deg_max, fabs(pan_deg - middle_deg(count, s)));
            seen.rate_dps_max = fmax(seen.rate_dps_max, fabs(pan_deg - before_deg) * 100.0);
        }
        before_deg = ms % 10U == 0U ? pan_deg : before_deg;
        seen.end_deg = pan_deg;
    }
    CHECK(says_last(" us at most, missed ", "0"));
    return seen;
}

// ---------------------------------------------------------------- tests

/// A group walks past the pillar: each is hidden for some two seconds, and the aim goes on as if
/// there were none.
static void calm_past_a_pillar(void) {
    if (begin_typing(IMAGE, SCENARIO)) {
        for (unsigned i = 0; i < PEOPLE; i++) {
            speed_mps[i] = 1.0;
        }
        const struct walk_seen seen = walk(PEOPLE, 10.0, 2.5);
        printf("MEASURED past the pillar: at most %.2f deg off the middle of all, %.2f deg/s; %u "
               "hidden at a time\n",
               seen.error_deg_max, seen.rate_dps_max, seen.hidden_most);
        CHECK(seen.hidden_most >= 1U && seen.hidden_most < PEOPLE);
        CHECK(seen.error_deg_max < 0.6);
        CHECK(seen.rate_dps_max < 6.0); // the group itself: 3 degrees a second
        check_note("instructions of a turn of the loop, at most",
                   (int64_t)board.probe.counts.loop_max);
        CHECK(board.probe.counts.loop_max < 168000U);
    }
    finish_typing();
}

/// One of two goes behind the wall and stays there: the aim ends on the other one.
static void gone_behind_a_wall(void) {
    if (begin_typing(IMAGE, SCENARIO)) {
        speed_mps[0] = 0.0;
        speed_mps[1] = 2.0;
        const struct walk_seen seen = walk(2, 14.0, 2.5);
        printf(
            "MEASURED behind the wall: it ends at %.3f deg, the one in sight is at %.3f; at most "
            "%.1f deg/s\n",
            seen.end_deg, azimuth_deg(0, 0), seen.rate_dps_max);
        CHECK_EQ(seen.hidden_most, 1);
        CHECK(fabs(seen.end_deg - azimuth_deg(0, 0)) < 0.05);
        CHECK(seen.rate_dps_max < 40.0);
    }
    finish_typing();
}

/// What the board says of the scene; an aim by hand is not hidden.
static void told_and_by_hand(void) {
    if (begin_typing(IMAGE, SCENARIO)) {
        run_ms(1500);
        type("target 1 20 25 0\rtarget 2 21 25 0\r", 700);
        type("status\r", 600);
        CHECK(strncmp(last("hidden: "), "2 of 2 targets, by 4 solids or faces; a look took ", 50) ==
              0);
        type("aim 40 0\r", 2500);
        CHECK(fabs(sim_joint_deg(sim, AXIS_PAN) - 40.0) < 0.05);
    }
    finish_typing();
}

int main(void) {
    TEST(calm_past_a_pillar);
    TEST(gone_behind_a_wall);
    TEST(told_and_by_hand);
    return check_finish();
}
