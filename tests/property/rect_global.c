/// The smallest rectangle without roll against a search of all directions. Shares nothing with the
/// solver but the reading of points.
#include "check.h"

#include "property/support/rect_search.h"
#include "rect.h"

#include "sphere/cone.h"

#include <math.h>
#include <stdio.h>

static uint64_t seed = UINT64_C(0x5EED0041);
static struct rect_set set;
static struct vec3_i64 fine[RECT_POINTS_MOST];
static struct points points = {.directions = set.direction, .fine = fine, .fine_exact = true};

static void make_points(void) {
    rect_set_draw(&set, &seed);
    points.count = set.count;
    for (uint32_t i = 0; i < set.count; i++) {
        fine[i] = vec3_widen(set.direction[i]);
    }
}

static void best_of_all_directions(void) {
    static const double aspects[][2] = {{16, 9}, {4, 3}, {1, 1}, {9, 16}, {3, 1}};
    int64_t solved = 0, steep = 0;
    double worse = 0, better = 0;
    while (solved < 1000 && check_clean()) {
        make_points();
        struct cone_result cone;
        int64_t workspace[CONE_WORKSPACE_BYTES(RECT_POINTS_MOST) / sizeof(int64_t) + 1U];
        const struct cone_options options = {.workspace = workspace,
                                             .workspace_bytes = sizeof workspace};
        if (cone_narrowest(set.direction, points.count, &options, &cone) != CONE_OK) {
            continue;
        }
        const double *aspect = aspects[check_random(&seed) % 5U];
        struct rect_frame frame;
        CHECK(rect_solve(&points, aspect[0], aspect[1], cone.axis_q30, &frame));
        const double told =
            rect_slope(&points, aspect[0], aspect[1], frame.pan_rad, frame.tilt_rad);
        const double want = rect_set_search(&set, aspect[0], aspect[1]);
        const double off = (told - want) / (want + 1e-12);
        CHECK(fabs(told - frame.slope) <= 1e-12 + 1e-9 * told);
        CHECK(told >= rect_set_slope(&set, aspect[0], aspect[1], frame.pan_rad, frame.tilt_rad) *
                              (1 - 1e-12) -
                          1e-15);
        if (points.count > 1U && !CHECK(off < 1e-7)) {
            printf("  # set %ld, %u points, told %.12g, found %.12g\n", (long)solved, points.count,
                   told, want);
        }
        if (points.count > 1U) {
            worse = fmax(worse, off);
            better = fmin(better, off);
        }
        steep += fabs(frame.tilt_rad) > 1.2;
        solved++;
    }
    check_note("sets", solved);
    check_note("of these steeper than 69 degrees", steep);
    check_note("worse than the search by parts in 10^12, most", (int64_t)(worse * 1e12));
    check_note("better than the search by parts in 10^12, most", (int64_t)(-better * 1e12));
    CHECK(steep > 100);
    CHECK(better > -0.01); // the search is worth comparing with
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(best_of_all_directions);
    return check_finish();
}
