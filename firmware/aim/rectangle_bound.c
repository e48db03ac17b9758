#include "aim/rectangle_tilt.h"
#include "fixed/root.h"
#include "fixed/trig.h"

/// What is not certain of an angle that tells which parts can do better.
#define ANGLE_SAME_BAM 8U

/// Beyond this far to the side (0.98) there is no bound on the second derivative.
#define ASIDE_MOST ((int64_t)1052266987)

#define RAD_PER_BAM_Q30 INT64_C(1686629713) // pi / 2: radians in Q30 for a BAM
#define BAM_PER_RAD_Q30 INT64_C(683565276)  // 2 / pi

struct rectangle_half_angles rectangle_half_angles(const struct rectangle_view *view,
                                                   uint64_t slope_q32) {
    if (slope_q32 >= UINT64_C(1) << 62) {
        return (struct rectangle_half_angles){BAM32_QUARTER, BAM32_QUARTER};
    }
    const int64_t slope = (int64_t)slope_q32;
    return (struct rectangle_half_angles){trig_atan2(slope, (int64_t)view->height_q30 * 4).bam,
                                          trig_atan2(slope, (int64_t)view->width_q30 * 4).bam};
}

// ---------------------------------------------------------------- by what moves

static uint32_t moved_at_most(const struct rectangle_view *view, uint32_t half_part_bam) {
    uint64_t most = 0; // squared distance from the pan axis
    for (uint32_t i = 0; i < view->count; i++) {
        const struct rectangle_cap *cap = &view->cap[i];
        const uint64_t off =
            (uint64_t)((int64_t)cap->right * cap->right + (int64_t)cap->ahead * cap->ahead);
        most = off > most ? off : most;
    }
    return (uint32_t)(half_part_bam * (root_u64(most) + UINT64_C(2)) >> 30) + 1U;
}

// ---------------------------------------------------------------- by the height

/// The upper or lower rim of a cap in the middle column: its direction, (level, up) turned by
/// +-e with sin e = sin / |(level, up)|, and what the bound needs of it.
struct rim {
    int32_t level, up;
    const struct rectangle_cap *cap;
    int32_t run; // root(level^2 + up^2 - sin^2) of the cap
};

/// False: the cap reaches round the axis of the tilt.
static bool find_rim(const struct rectangle_cap *cap, bool upper, struct rim *rim) {
    const int64_t level = cap->level, up = cap->up, sin = upper ? cap->sin : -cap->sin;
    *rim = (struct rim){cap->level, cap->up, cap, 0};
    if (sin == 0) {
        return true;
    }
    const int64_t run2 = level * level + up * up - sin * sin;
    rim->run = run2 > 0 ? (int32_t)root_u64((uint64_t)run2) : 0;
    rim->level = (int32_t)((level * rim->run - up * sin) >> 30);
    rim->up = (int32_t)((up * rim->run + level * sin) >> 30);
    return rim->run > 1 << 20;
}

/// The sine of the angle from a to b, times both lengths: b is above a if it is positive.
static int64_t turn_from(const struct rim *a, const struct rim *b) {
    return (int64_t)a->level * b->up - (int64_t)a->up * b->level;
}

/// How a rim's elevation changes with the pan: its derivative, and a bound on the second one as far
/// as the pans go.
struct change {
    int64_t first_q30, second_q30;
};

/// What the radius adds: e changes by tan(e) r l / q^2, and a second time by at most
/// tan(e) (1 + 4 T^2 + tan(e)^2 T^2). t2_q30, q2_least_q30: T^2 and q^2 where they are worst.
static bool add_radius(const struct rim *rim, bool upper, int64_t t2_q30, int64_t q2_least_q30,
                       int64_t q2_q30, struct change *change) {
    const int64_t one = Q30_ONE, sin = rim->cap->sin;
    const int64_t run2_least_q30 = q2_least_q30 - (sin * sin >> 30) - 1;
    if (run2_least_q30 < one >> 8 || t2_q30 > 8 * one) {
        return false;
    }
    const int64_t here_q30 = sin * one / rim->run;
    const int64_t most_q30 = sin * one / (int64_t)root_u64((uint64_t)run2_least_q30 << 30) + 1;
    const int64_t slope_q30 =
        here_q30 * ((int64_t)rim->cap->across * rim->cap->level / q2_q30) >> 30;
    const int64_t tan2_q16 = (most_q30 >> 14) * (most_q30 >> 14) >> 16; // at most 2^24
    const int64_t more_q16 = (one + 4 * t2_q30 + (tan2_q16 * (t2_q30 >> 16) >> 2)) >> 14;
    change->first_q30 += upper ? slope_q30 : -slope_q30;
    change->second_q30 += (more_q16 + 2) * ((most_q30 >> 14) + 1) >> 2;
    return true;
}

/// With r across, l along and z up, q^2 = l^2 + z^2 and T = r / q, the elevation of a centre in the
/// middle column changes by z r / q^2, and a second time by at most (1 + 2 T^2) / 2.
static bool differentiate(const struct rim *rim, bool upper, int64_t reach_q30,
                          struct change *change) {
    const struct rectangle_cap *cap = rim->cap;
    const int64_t out = (int64_t)cap->aside + reach_q30, one = Q30_ONE;
    if (out > ASIDE_MOST) {
        return false;
    }
    const int64_t level = cap->level, up = cap->up;
    const int64_t q2_q30 = ((level * level + up * up) >> 30) + 1;
    const int64_t q2_least_q30 = one - (out * out >> 30);
    const int64_t t2_q30 = out * out / q2_least_q30 + 1;
    change->first_q30 = up * cap->across / q2_q30;
    change->second_q30 = (one + 2 * t2_q30) / 2 + 1;
    return cap->sin == 0 || add_radius(rim, upper, t2_q30, q2_least_q30, q2_q30, change);
}

/// Half of the least angle between the highest and the lowest rim, BAM; 0: not known.
static uint32_t height_at_least(const struct rectangle_view *view, uint32_t half_part_bam) {
    struct rim top = {0}, bottom = {0}, rim;
    for (uint32_t i = 0; i < view->count; i++) {
        if (!find_rim(&view->cap[i], true, &rim)) {
            return 0;
        }
        top = i == 0U || turn_from(&top, &rim) > 0 ? rim : top;
        (void)find_rim(&view->cap[i], false, &rim);
        bottom = i == 0U || turn_from(&bottom, &rim) < 0 ? rim : bottom;
    }
    const int64_t reach_q30 = ((int64_t)half_part_bam * RAD_PER_BAM_Q30 >> 30) + 1;
    struct change of_top, of_bottom;
    if (!differentiate(&top, true, reach_q30, &of_top) ||
        !differentiate(&bottom, false, reach_q30, &of_bottom)) {
        return 0;
    }
    const int64_t apart_bam =
        trig_atan2(turn_from(&bottom, &top),
                   (int64_t)bottom.level * top.level + (int64_t)bottom.up * top.up)
            .bam;
    const int64_t first = (int64_t)u64_abs(of_top.first_q30 - of_bottom.first_q30),
                  second = of_top.second_q30 + of_bottom.second_q30;
    const int64_t less_q30 =
        (first * reach_q30 >> 30) + ((second >> 14) * (reach_q30 * reach_q30 >> 30) >> 17) + 3;
    const int64_t less_bam = (less_q30 * BAM_PER_RAD_Q30 >> 30) + 1;
    return apart_bam > less_bam ? (uint32_t)((apart_bam - less_bam) / 2) : 0U;
}

bool rectangle_is_no_better(struct rectangle_view *view, const struct rectangle_place *middle,
                            uint32_t half_part_bam, uint64_t best_slope_q32) {
    const uint32_t moved = moved_at_most(view, half_part_bam);
    const struct rectangle_half_angles best = rectangle_half_angles(view, best_slope_q32),
                                       part = rectangle_half_angles(view, middle->slope_q32);
    view->work += RECTANGLE_BOUND_WORK;
    if (part.width + ANGLE_SAME_BAM >= best.width + moved &&
        part.height + ANGLE_SAME_BAM >= best.height + moved) {
        return true;
    }
    return middle->slope_q32 != UINT64_MAX &&
           height_at_least(view, half_part_bam) + ANGLE_SAME_BAM >= best.height;
}
