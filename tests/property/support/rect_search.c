#include "property/support/rect_search.h"

#include "check.h"

#include <math.h>

#define GRID_PAN  180
#define GRID_TILT 61

static const double pi = 3.14159265358979323846;

static double uniform(uint64_t *seed) {
    return (double)(check_random(seed) >> 11) * 0x1p-53;
}

/// Angle from the middle to the far rim of a cap, in the plane of ahead and one side.
static double reach(double aside, double ahead, double radius) {
    return atan2(fabs(aside), ahead) + asin(sin(radius) / hypot(aside, ahead));
}

/// What the picture must be wide, by the definition: the tangents of the angles to the right and
/// up.
double rect_set_slope(const struct rect_set *set, double width, double height, double pan,
                      double tilt) {
    const double sp = sin(pan), cp = cos(pan), st = sin(tilt), ct = cos(tilt);
    double most = 0;
    for (uint32_t i = 0; i < set->count; i++) {
        const double *p = set->unit[i], radius = set->radius_rad[i];
        const double ahead = p[0] * sp * ct + p[1] * cp * ct + p[2] * st;
        const double right = p[0] * cp - p[1] * sp;
        const double up = -p[0] * sp * st - p[1] * cp * st + p[2] * ct;
        if (ahead <= sin(radius)) {
            return HUGE_VAL;
        }
        if (radius == 0) {
            most = fmax(most, fmax(fabs(right) / width, fabs(up) / height) / ahead);
            continue;
        }
        most = fmax(most, fmax(tan(reach(right, ahead, radius)) / width,
                               tan(reach(up, ahead, radius)) / height));
    }
    return most;
}

struct place {
    double slope, pan, tilt;
};

/// The best tilt for a pan: the best of a grid, then golden section beside it.
static struct place best_tilt(const struct rect_set *set, double width, double height, double pan) {
    const double step = pi / (GRID_TILT - 1);
    struct place best = {HUGE_VAL, pan, 0};
    for (int k = 0; k < GRID_TILT; k++) {
        const double tilt = -pi / 2 + k * step,
                     found = rect_set_slope(set, width, height, pan, tilt);
        if (found < best.slope) {
            best = (struct place){found, pan, tilt};
        }
    }
    double low = fmax(best.tilt - step, -pi / 2), high = fmin(best.tilt + step, pi / 2);
    for (int i = 0; i < 45; i++) {
        const double left = high - 0.618033988749895 * (high - low),
                     right = low + 0.618033988749895 * (high - low);
        if (rect_set_slope(set, width, height, pan, left) <
            rect_set_slope(set, width, height, pan, right)) {
            high = right;
        } else {
            low = left;
        }
    }
    const double tilt = (low + high) / 2, found = rect_set_slope(set, width, height, pan, tilt);
    return found < best.slope ? (struct place){found, pan, tilt} : best;
}

/// The same for the pan, beside one that is lower than its neighbours.
static double refine(const struct rect_set *set, double width, double height, double pan) {
    double low = pan - 2 * pi / GRID_PAN, high = pan + 2 * pi / GRID_PAN;
    for (int i = 0; i < 40; i++) {
        const double left = high - 0.618033988749895 * (high - low),
                     right = low + 0.618033988749895 * (high - low);
        if (best_tilt(set, width, height, left).slope <
            best_tilt(set, width, height, right).slope) {
            high = right;
        } else {
            low = left;
        }
    }
    return best_tilt(set, width, height, (low + high) / 2).slope;
}

double rect_set_search(const struct rect_set *set, double width, double height) {
    struct place row[GRID_PAN];
    double best = HUGE_VAL;
    for (int i = 0; i < GRID_PAN; i++) {
        row[i] = best_tilt(set, width, height, i * 2 * pi / GRID_PAN);
        best = fmin(best, row[i].slope);
    }
    const double worth_a_look = best * 1.5;
    for (int i = 0; i < GRID_PAN; i++) {
        const double before = row[(i + GRID_PAN - 1) % GRID_PAN].slope,
                     after = row[(i + 1) % GRID_PAN].slope;
        if (row[i].slope <= before && row[i].slope <= after && row[i].slope <= worth_a_look) {
            best = fmin(best, refine(set, width, height, row[i].pan));
        }
    }
    return best;
}

void rect_set_measure(struct rect_set *set) {
    for (uint32_t i = 0; i < set->count; i++) {
        const double x = set->direction[i].x, y = set->direction[i].y, w = set->direction[i].z,
                     length = sqrt(x * x + y * y + w * w);
        set->unit[i][0] = x / length;
        set->unit[i][1] = y / length;
        set->unit[i][2] = w / length;
    }
}

void rect_set_draw(struct rect_set *set, uint64_t *seed) {
    const double z = check_random(seed) % 3U == 0U ? 1 : 2 * uniform(seed) - 1;
    const double turn = 6.283185307179586 * uniform(seed), level = sqrt(1 - z * z);
    const double axis[3] = {level * cos(turn), level * sin(turn), z};
    const double spread = 0.02 + 1.1 * uniform(seed) * uniform(seed);
    set->count = 1U + (uint32_t)(check_random(seed) % (RECT_POINTS_MOST - 1U));
    if (check_random(seed) % 2U == 0U) {
        set->count = 1U + set->count % 5U;
    }
    for (uint32_t i = 0; i < set->count; i++) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            p[k] = axis[k] + spread * (2 * uniform(seed) - 1);
        }
        set->direction[i] = vec3((int32_t)lround(p[0] * 0x1p28), (int32_t)lround(p[1] * 0x1p28),
                                 (int32_t)lround(p[2] * 0x1p28));
        set->radius_rad[i] = 0;
    }
    rect_set_measure(set);
}
