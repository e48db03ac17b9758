/// The smallest rectangle without roll against a search of all directions: a grid, and the
/// best places of it refined. Shares nothing with the solver but the reading of points.
#include "check.h"

#include "rect.h"

#include "sphere/cone.h"

#include <math.h>
#include <stdio.h>

#define POINTS_MOST 40
#define GRID_PAN    180
#define GRID_TILT   61

static uint64_t seed = UINT64_C(0x5EED0041);
static struct vec3 directions[POINTS_MOST];
static struct vec3_i64 fine[POINTS_MOST];
static struct points points = {.directions = directions, .fine = fine, .fine_exact = true};
static double unit[POINTS_MOST][3];

static double uniform(void) {
    return (double)(check_random(&seed) >> 11) * 0x1p-53;
}

/// What the picture must be wide, by the definition: the tangents of the angles to the right and
/// up.
static double slope(double width, double height, double pan, double tilt) {
    const double sp = sin(pan), cp = cos(pan), st = sin(tilt), ct = cos(tilt);
    double most = 0;
    for (uint32_t i = 0; i < points.count; i++) {
        const double *p = unit[i];
        const double ahead = p[0] * sp * ct + p[1] * cp * ct + p[2] * st;
        const double right = p[0] * cp - p[1] * sp;
        const double up = -p[0] * sp * st - p[1] * cp * st + p[2] * ct;
        if (ahead <= 0) {
            return HUGE_VAL;
        }
        most = fmax(most, fmax(fabs(right) / width, fabs(up) / height) / ahead);
    }
    return most;
}

struct place {
    double slope, pan, tilt;
};

static const double pi = 3.14159265358979323846;

/// The best tilt for a pan: the best of a grid, then golden section beside it.
static struct place best_tilt(double width, double height, double pan) {
    const double step = pi / (GRID_TILT - 1);
    struct place best = {HUGE_VAL, pan, 0};
    for (int k = 0; k < GRID_TILT; k++) {
        const double tilt = -pi / 2 + k * step, found = slope(width, height, pan, tilt);
        if (found < best.slope) {
            best = (struct place){found, pan, tilt};
        }
    }
    double low = fmax(best.tilt - step, -pi / 2), high = fmin(best.tilt + step, pi / 2);
    for (int i = 0; i < 45; i++) {
        const double left = high - 0.618033988749895 * (high - low),
                     right = low + 0.618033988749895 * (high - low);
        if (slope(width, height, pan, left) < slope(width, height, pan, right)) {
            high = right;
        } else {
            low = left;
        }
    }
    const double tilt = (low + high) / 2, found = slope(width, height, pan, tilt);
    return found < best.slope ? (struct place){found, pan, tilt} : best;
}

/// The same for the pan, beside one that is lower than its neighbours.
static double refine(double width, double height, double pan) {
    double low = pan - 2 * pi / GRID_PAN, high = pan + 2 * pi / GRID_PAN;
    for (int i = 0; i < 40; i++) {
        const double left = high - 0.618033988749895 * (high - low),
                     right = low + 0.618033988749895 * (high - low);
        if (best_tilt(width, height, left).slope < best_tilt(width, height, right).slope) {
            high = right;
        } else {
            low = left;
        }
    }
    return best_tilt(width, height, (low + high) / 2).slope;
}

static double search_all(double width, double height) {
    static struct place row[GRID_PAN];
    double best = HUGE_VAL;
    for (int i = 0; i < GRID_PAN; i++) {
        row[i] = best_tilt(width, height, i * 2 * pi / GRID_PAN);
        best = fmin(best, row[i].slope);
    }
    const double worth_a_look = best * 1.5;
    for (int i = 0; i < GRID_PAN; i++) {
        const double before = row[(i + GRID_PAN - 1) % GRID_PAN].slope,
                     after = row[(i + 1) % GRID_PAN].slope;
        if (row[i].slope <= before && row[i].slope <= after && row[i].slope <= worth_a_look) {
            best = fmin(best, refine(width, height, row[i].pan));
        }
    }
    return best;
}

/// Points round a random direction (often near the zenith), within up to 50 degrees of it.
static void make_points(void) {
    const double z = check_random(&seed) % 3U == 0U ? 1 : 2 * uniform() - 1;
    const double turn = 6.283185307179586 * uniform(), level = sqrt(1 - z * z);
    const double axis[3] = {level * cos(turn), level * sin(turn), z};
    const double spread = 0.02 + 1.1 * uniform() * uniform();
    points.count = 1U + (uint32_t)(check_random(&seed) % (POINTS_MOST - 1U));
    if (check_random(&seed) % 2U == 0U) {
        points.count = 1U + points.count % 5U;
    }
    for (uint32_t i = 0; i < points.count; i++) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            p[k] = axis[k] + spread * (2 * uniform() - 1);
        }
        directions[i] = vec3((int32_t)lround(p[0] * 0x1p28), (int32_t)lround(p[1] * 0x1p28),
                             (int32_t)lround(p[2] * 0x1p28));
        fine[i] = vec3_widen(directions[i]);
        const double x = directions[i].x, y = directions[i].y, w = directions[i].z,
                     length = sqrt(x * x + y * y + w * w);
        unit[i][0] = x / length;
        unit[i][1] = y / length;
        unit[i][2] = w / length;
    }
}

static void best_of_all_directions(void) {
    static const double aspects[][2] = {{16, 9}, {4, 3}, {1, 1}, {9, 16}, {3, 1}};
    int64_t solved = 0, steep = 0;
    double worse = 0, better = 0;
    while (solved < 1000 && check_clean()) {
        make_points();
        struct cone_result cone;
        int64_t workspace[CONE_WORKSPACE_BYTES(POINTS_MOST) / sizeof(int64_t) + 1U];
        const struct cone_options options = {.workspace = workspace,
                                             .workspace_bytes = sizeof workspace};
        if (cone_narrowest(directions, points.count, &options, &cone) != CONE_OK) {
            continue;
        }
        const double *aspect = aspects[check_random(&seed) % 5U];
        struct rect_frame frame;
        CHECK(rect_solve(&points, aspect[0], aspect[1], cone.axis_q30, &frame));
        const double told =
            rect_slope(&points, aspect[0], aspect[1], frame.pan_rad, frame.tilt_rad);
        const double want = search_all(aspect[0], aspect[1]);
        const double off = (told - want) / (want + 1e-12);
        CHECK(fabs(told - frame.slope) <= 1e-12 + 1e-9 * told);
        CHECK(told >=
              slope(aspect[0], aspect[1], frame.pan_rad, frame.tilt_rad) * (1 - 1e-12) - 1e-15);
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
