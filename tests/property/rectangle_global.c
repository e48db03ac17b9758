/// firmware/aim/rectangle against a search of all directions in doubles, and (points) against the
/// host's boards/linux/rect.c: to the end at once, and in calls of bounded work that end at the
/// same picture; and caps that move all the time.
#include "check.h"

#include "property/support/rect_search.h"

#include "aim/rectangle.h"
#include "fixed/trig.h"
#include "rect.h"

#include <math.h>
#include <stdio.h>

#define WORK_LIMIT 2500U // of the controller
#define CALLS_MOST 4000U

static uint64_t seed = UINT64_C(0x5EED0061);
static struct rect_set set;
#define CAPS_MOST 256 // of the controller
static struct vec3 centre[CAPS_MOST];
static struct follow_radius radius[CAPS_MOST];
static struct rectangle_search search;
static struct rectangle_workspace workspace;

static const double rad_per_bam = 6.283185307179586 / 4294967296.0;

static const struct rectangle_base upright = {{Q30_ONE, 0, 0}, {0, Q30_ONE, 0}, {0, 0, Q30_ONE}};

static double uniform(void) {
    return (double)(check_random(&seed) >> 11) * 0x1p-53;
}

/// A set in Q1.30, and a direction that sees it. False: there is none.
static bool draw(bool sized, struct vec3 *ahead) {
    rect_set_draw(&set, &seed);
    const double size = uniform() * 0.3;
    for (uint32_t i = 0; i < set.count; i++) {
        set.direction[i] = centre[i] = vec3_normalise(set.direction[i]);
        const bool is_cap = sized && check_random(&seed) % 4U != 0U;
        const uint32_t bam = is_cap ? (uint32_t)(size * uniform() / rad_per_bam) : 0U;
        const struct sincos of = trig_sincos(bam32(bam));
        radius[i] = (struct follow_radius){bam32(bam), of.sin_q30, of.cos_q30};
        set.radius_rad[i] = bam * rad_per_bam;
    }
    rect_set_measure(&set);
    const struct follow_input input = {
        .centre_q30 = centre, .radius = sized ? radius : NULL, .count = set.count};
    struct follow_result cone;
    if (follow_narrowest(&input, &cone) != FOLLOW_OK || cone.half_angle.bam > 0x38000000U) {
        return false;
    }
    *ahead = cone.axis_q30;
    return true;
}

static struct rectangle_input input_for(bool sized, const double aspect[2]) {
    return (struct rectangle_input){.centre_q30 = centre,
                                    .radius = sized ? radius : NULL,
                                    .count = set.count,
                                    .base = upright,
                                    .width = (uint32_t)aspect[0] * 100U,
                                    .height = (uint32_t)aspect[1] * 100U};
}

/// By how much the picture's half width, or height, exceeds the best, in nrad: the larger of both.
/// Checks that the picture holds every cap.
static double excess_nrad(const struct rectangle_result *result, const double aspect[2],
                          double best) {
    const double needed =
        rect_set_slope(&set, aspect[0], aspect[1], result->pan_bam32.bam * rad_per_bam,
                       bam32_signed(result->tilt_bam32) * rad_per_bam);
    const double wide = result->half_width_bam32.bam * rad_per_bam,
                 high = result->half_height_bam32.bam * rad_per_bam;
    CHECK(wide >= atan(needed * aspect[0]));
    CHECK(high >= atan(needed * aspect[1]));
    return 1e9 * fmax(wide - atan(best * aspect[0]), high - atan(best * aspect[1]));
}

/// The host's solver, which shares no code with this one.
static double of_the_host(const double aspect[2], struct vec3 ahead) {
    static struct vec3_i64 fine[RECT_POINTS_MOST];
    for (uint32_t i = 0; i < set.count; i++) {
        fine[i] = vec3_widen(centre[i]);
    }
    const struct points points = {
        .count = set.count, .directions = centre, .fine = fine, .fine_exact = true};
    struct rect_frame frame;
    CHECK(rect_solve(&points, aspect[0], aspect[1], ahead, &frame));
    return frame.slope;
}

struct tally {
    int64_t solved, steep, calls_most, work_most;
    double most, least;
};

/// One set; nothing for one that no direction sees.
static void one_set(bool sized, struct tally *tally) {
    static const double aspects[][2] = {{16, 9}, {4, 3}, {1, 1}, {9, 16}, {3, 1}};
    struct vec3 ahead;
    if (!draw(sized, &ahead)) {
        return;
    }
    const double *aspect = aspects[check_random(&seed) % 5U];
    struct rectangle_input input = input_for(sized, aspect);
    struct rectangle_result result, resumed;
    rectangle_begin(&search, &input.base, ahead);
    if (!CHECK(rectangle_follow(&input, &search, &workspace, &result))) {
        return;
    }
    CHECK(!result.refining);
    const double best = rect_set_search(&set, aspect[0], aspect[1]);
    const double off = excess_nrad(&result, aspect, best);
    if (!CHECK(off <= 40)) {
        printf("  # set %ld, %u caps: %.1f nrad\n", (long)tally->solved, set.count, off);
    }
    if (!sized) {
        CHECK(fabs(excess_nrad(&result, aspect, of_the_host(aspect, ahead))) <= 40);
    }
    // The same with bounded calls: each holds every cap, and the end is the same.
    rectangle_begin(&search, &input.base, ahead);
    input.work_limit = WORK_LIMIT;
    int64_t calls = 0;
    do {
        CHECK(rectangle_follow(&input, &search, &workspace, &resumed));
        (void)excess_nrad(&resumed, aspect, best);
        calls++;
        tally->work_most = resumed.work > tally->work_most ? resumed.work : tally->work_most;
    } while (resumed.refining && CHECK(calls < CALLS_MOST));
    CHECK_NEAR(resumed.half_width_bam32.bam, result.half_width_bam32.bam, 8);
    tally->most = fmax(tally->most, off);
    tally->least = fmin(tally->least, off);
    tally->calls_most = calls > tally->calls_most ? calls : tally->calls_most;
    tally->steep += fabs(bam32_signed(result.tilt_bam32) * rad_per_bam) > 1.2;
    tally->solved++;
}

static void against_all_directions(bool sized, int64_t sets) {
    struct tally tally = {0};
    while (tally.solved < sets && check_clean()) {
        one_set(sized, &tally);
    }
    check_note("sets", tally.solved);
    check_note("  of these steeper than 69 degrees", tally.steep);
    check_note("  half width or height above the search's, nrad, most", (int64_t)tally.most);
    check_note("  below it, nrad, most", (int64_t)-tally.least);
    check_note("  calls of 2,500 units to the end, most", tally.calls_most);
    check_note("  work of one of them, most", tally.work_most);
    CHECK(tally.steep > sets / 20);
}

/// Caps that wander for a while and then rest: every call's picture holds them all, and in the end
/// it is the best.
static void wandering(bool sized, int64_t sets) {
    static const double aspect[2] = {4, 3};
    double widest = 0, worst = 0;
    int64_t measured = 0;
    for (int64_t k = 0; k < sets && check_clean();) {
        struct vec3 ahead;
        struct rectangle_result result;
        if (!draw(sized, &ahead)) {
            continue;
        }
        struct rectangle_input input = input_for(sized, aspect);
        input.work_limit = WORK_LIMIT;
        rectangle_begin(&search, &input.base, ahead);
        const double step = 0.0005 * uniform();
        bool seen = true;
        for (int tick = 0; tick < 200 && seen; tick++) {
            input.moved = tick != 0;
            for (uint32_t i = 0; i < set.count && tick != 0; i++) {
                const int32_t most = (int32_t)(step * 0x1p30) + 1;
                centre[i].x += (int32_t)(check_random(&seed) % (2U * (uint32_t)most)) - most;
                centre[i].y += (int32_t)(check_random(&seed) % (2U * (uint32_t)most)) - most;
                centre[i].z += (int32_t)(check_random(&seed) % (2U * (uint32_t)most)) - most;
                set.direction[i] = centre[i] = vec3_normalise(centre[i]);
            }
            rect_set_measure(&set);
            seen = rectangle_follow(&input, &search, &workspace, &result);
            if (seen) {
                (void)excess_nrad(&result, aspect, 1); // it holds them all
            }
            if (seen && set.count > 1U && tick % 40 == 39) {
                const double best = rect_set_search(&set, aspect[0], aspect[1]);
                const double ratio =
                    tan(result.half_width_bam32.bam * rad_per_bam) / (best * aspect[0]);
                widest = fmax(widest, ratio);
                measured++;
            }
        }
        if (!seen) { // they wandered out of sight
            continue;
        }
        input.moved = false;
        for (int64_t calls = 0; result.refining && CHECK(calls < CALLS_MOST); calls++) {
            CHECK(rectangle_follow(&input, &search, &workspace, &result));
        }
        worst = fmax(worst, excess_nrad(&result, aspect, rect_set_search(&set, 4, 3)));
        k++;
    }
    check_note("pictures of moving caps compared", measured);
    check_note("  wider than the best, in 1/1000, most", (int64_t)((widest - 1) * 1000));
    check_note("  at rest above the best, nrad, most", (int64_t)worst);
    CHECK(worst <= 40);
}

/// Caps that all go round the pan axis, so that the best picture stays as it is and goes with them,
/// and that move in every call. At 30 degrees a second and 1,000 calls.
static void going_round(bool sized) {
    static const double aspect[2] = {4, 3};
    static const uint32_t counts[] = {1, 2, 5, 20, 100, CAPS_MOST};
    const double step_rad = 0.03 / 57.29577951308232;
    for (unsigned k = 0; k < 6U && check_clean(); k++) {
        static double pan_rad[CAPS_MOST], tilt_rad[CAPS_MOST];
        set.count = counts[k];
        for (uint32_t i = 0; i < set.count; i++) {
            pan_rad[i] = 0.3 * uniform();
            tilt_rad[i] = 0.1 + 0.2 * uniform();
            const uint32_t bam = sized ? (uint32_t)(0.02 * uniform() / rad_per_bam) : 0U;
            const struct sincos of = trig_sincos(bam32(bam));
            radius[i] = (struct follow_radius){bam32(bam), of.sin_q30, of.cos_q30};
        }
        struct rectangle_input input = input_for(sized, aspect);
        struct rectangle_result first = {0}, result = {0};
        double widest_rad = 0;
        for (int call = 0; call < 3000 && check_clean(); call++) {
            for (uint32_t i = 0; i < set.count; i++) {
                const double pan = pan_rad[i] + call * step_rad, level = cos(tilt_rad[i]);
                centre[i] = vec3_normalise(vec3((int32_t)(0x1p30 * sin(pan) * level),
                                                (int32_t)(0x1p30 * cos(pan) * level),
                                                (int32_t)(0x1p30 * sin(tilt_rad[i]))));
            }
            if (call == 0) {
                rectangle_begin(&search, &input.base, centre[0]);
                CHECK(rectangle_follow(&input, &search, &workspace, &first)); // to the end
                input.work_limit = WORK_LIMIT;
                input.moved = true;
                continue;
            }
            CHECK(rectangle_follow(&input, &search, &workspace, &result));
            CHECK(result.work <= WORK_LIMIT * 2U);
            widest_rad = fmax(widest_rad, ((double)result.half_width_bam32.bam -
                                           (double)first.half_width_bam32.bam) *
                                              rad_per_bam);
        }
        check_note("caps that go round", set.count);
        check_note("  half width above the best, 1/1000 degree, most",
                   (int64_t)(widest_rad * 57295.77951308232));
        CHECK(widest_rad < 0.5 / 57.29577951308232);
    }
}

static void points_that_go_round(void) {
    going_round(false);
}

static void caps_that_go_round(void) {
    going_round(true);
}

static void points_that_wander(void) {
    wandering(false, 40);
}

static void caps_that_wander(void) {
    wandering(true, 20);
}

static void points(void) {
    against_all_directions(false, 1000);
}

static void caps(void) {
    against_all_directions(true, 300);
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(points);
    TEST(caps);
    TEST(points_that_go_round);
    TEST(caps_that_go_round);
    TEST(points_that_wander);
    TEST(caps_that_wander);
    return check_finish();
}
