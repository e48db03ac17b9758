/// Pans between two objects that no direction sees at once, typed at the serial line of the flashed
/// image, which frames each by the picture's own sides. Each takes the time that was typed, at
/// minimum jerk, and no step takes more than 60 % of its tick.
#include "mcu/cpu/closed_loop.h"

#include "aim/orient.h"

#include <math.h>

#define IMAGE    "build/boards/stm32f405/objects/boresight.elf"
#define SCENARIO "tests/mcu/cpu/objects/scenario.ini"
/// 60 % of a millisecond at 168 MHz, an instruction a cycle.
#define STEP_MOST 100800U

/// The movers of the scenario.
struct place {
    unsigned object;
    double x, y, z;
};
static const struct place places[] = {
    {1, -12, 0.5, -1}, {1, -12, 3, 2}, {2, 10, 1.5, 0}, {2, 10, -1.2, -1.5}, {2, 9, 0, 3}};

static double angle_between(struct vec3 a, struct vec3 b) {
    const double x = (double)a.y * b.z - (double)a.z * b.y,
                 y = (double)a.z * b.x - (double)a.x * b.z,
                 z = (double)a.x * b.y - (double)a.y * b.x,
                 dot = (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z;
    return atan2(sqrt(x * x + y * y + z * z), dot);
}

static double dot(struct vec3 unit_q30, const struct place *p) {
    return (unit_q30.x * p->x + unit_q30.y * p->y + unit_q30.z * p->z) * 0x1p-30;
}

static double tangent(bam32_t angle) {
    return tan(ldexp(angle.bam, -32) * 2.0 * acos(-1.0));
}

/// Every target of this object is in the picture, none of the other is, and the axes are there.
static void frames(unsigned object) {
    const struct controller_status *const status = &sim->pump.output.status;
    const struct framing *const framing = &status->framing;
    const struct vec3 ahead = framing->ahead_q30;
    const struct orient_axes axes = orient_axes(ahead, vec3(0, 0, 1));
    CHECK_EQ(status->mode, MODE_TRACKING);
    CHECK_EQ(framing->status, FRAMING_OK);
    CHECK(!status->panning && framing->is_picture);
    CHECK_EQ(framing->framed_count, object == 1U ? 2 : 3);
    for (unsigned i = 0; i < sizeof places / sizeof places[0]; i++) {
        const struct place *const p = &places[i];
        const double a = dot(ahead, p), x = dot(axes.right_q30, p) / a, y = dot(axes.up_q30, p) / a;
        const bool inside = a > 0.0 && fabs(x) <= tangent(framing->half_width_bam32) &&
                            fabs(y) <= tangent(framing->half_height_bam32);
        CHECK_EQ(inside, p->object == object);
    }
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        CHECK(llabs(status->axis[axis].measured_q48 - status->axis[axis].goal_q48) <
              INT64_C(1) << 40); // 1.4 degrees
    }
}

/// Types a pan and follows it: how long it takes, how much faster than on average it gets.
static void pans(const char *line, unsigned wanted_ms, double wanted_peak) {
    const struct controller_status *const status = &sim->pump.output.status;
    const struct vec3 from = status->framing.ahead_q30;
    double last = 0.0, fastest = 0.0;
    unsigned waited = 0, ms = 0;
    type(line, 0);
    while (!status->panning && waited < 1000U) {
        run_ms(1);
        waited++;
    }
    for (; status->panning && ms < 10000U; ms++) {
        CHECK_EQ(status->mode, MODE_TRACKING);
        const double gone = angle_between(from, status->framing.ahead_q30);
        CHECK(gone > last - 1e-6);
        fastest = fmax(fastest, gone - last);
        last = gone;
        run_ms(1);
    }
    const double whole = angle_between(from, status->framing.ahead_q30);
    CHECK_NEAR(ms, wanted_ms, 3);
    CHECK(whole > 2.5);
    printf("# %u ms to the board, %u ms of pan over %.1f degrees, at most %.3f of the mean speed\n",
           waited, ms, whole * 180.0 / acos(-1.0), fastest * ms / whole);
    CHECK(fabs(fastest * ms / whole - wanted_peak) < 0.01 * wanted_peak);
}

static void from_one_object_to_the_other_and_back(void) {
    if (begin_typing(IMAGE, SCENARIO)) {
        run_ms(1500);
        CHECK_EQ(sim->pump.output.status.mode, MODE_HOLDING); // no direction sees both
        CHECK_EQ(sim->pump.output.status.framing.status, FRAMING_INFEASIBLE);
        type("pan 1 0\r", 6000);
        frames(1);
        probe_restart_counts(&board.probe);
        pans("pan 2 4 angle\r", 4000, 15.0 / 8.0); // the derivative of 10 s^3 - 15 s^4 + 6 s^5
        run_ms(5000);
        frames(2);
        pans("pan 1 2.5 angle\r", 2500, 15.0 / 8.0);
        run_ms(5000);
        frames(1);
        const struct probe_counts *const counts = &board.probe.counts;
        check_note("instructions of a step, at most", (int64_t)counts->step_max);
        CHECK(counts->ticks > 16000U && counts->step_max <= STEP_MOST);
        CHECK(counts->loop_max < 168000U);
        type("status\r", 300);
        CHECK(says_last(" us at most, missed ", "0"));
    }
    finish_typing();
}

/// What is no pan is told, and one to what nothing sees waits where it is.
static void what_cannot_be(void) {
    if (begin_typing(IMAGE, SCENARIO)) {
        run_ms(1500);
        type("pan 2\r", 300);
        type("pan x 1\r", 300);
        type("pan 1 1 slowly\r", 300);
        unsigned told = 0;
        for (const char *at = said; (at = strstr(at, "error: expected OBJECT or all")) != NULL;
             at++) {
            told++;
        }
        CHECK_EQ(told, 3);
        CHECK_EQ(sim->pump.output.status.mode, MODE_HOLDING);
        type("pan 2 0\r", 6000);
        frames(2);
        const struct vec3 before = sim->pump.output.status.framing.ahead_q30;
        type("pan all 1\r", 3000); // nothing sees all
        CHECK_EQ(sim->pump.output.status.mode, MODE_TRACKING);
        CHECK(angle_between(before, sim->pump.output.status.framing.ahead_q30) < 1e-6);
        type("pan 1 0\r", 6000);
        frames(1);
    }
    finish_typing();
}

int main(void) {
    TEST(from_one_object_to_the_other_and_back);
    TEST(what_cannot_be);
    return check_finish();
}
