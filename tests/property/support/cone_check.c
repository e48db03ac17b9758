#include "property/support/cone_check.h"

#include "property/support/exact.h"

#include <gmp.h>
#include <math.h>
#include <mpfr.h>
#include <stddef.h>

#define BITS 256

struct vector {
    mpfr_t x, y, z;
};

/// The narrowest cone of up to three unit vectors.
struct cone {
    struct vector axis;
    mpfr_t half_angle;
};

/// All numbers are made once; MPFR's allocator would else be most of the time.
static struct {
    bool ready;
    struct vector unit, base[4], edge, side, axis, printed;
    struct cone best, trial;
    mpfr_t first_half_angle, dot, product, length, angle, outside, rad_per_turn64, cosine, least,
        least_printed;
    mpz_t sum, term, scaled[3];
} v;

static void init_vector(struct vector *a) {
    mpfr_inits2(BITS, a->x, a->y, a->z, (mpfr_ptr)NULL);
}

static void clear_vector(struct vector *a) {
    mpfr_clears(a->x, a->y, a->z, (mpfr_ptr)NULL);
}

static struct vector *const vectors[] = {&v.unit,    &v.base[0],   &v.base[1],   &v.base[2],
                                         &v.base[3], &v.edge,      &v.side,      &v.axis,
                                         &v.printed, &v.best.axis, &v.trial.axis};

static void start(void) {
    if (v.ready) {
        return;
    }
    v.ready = true;
    for (unsigned i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        init_vector(vectors[i]);
    }
    mpfr_inits2(BITS, v.dot, v.product, v.length, v.angle, v.outside, v.rad_per_turn64, v.cosine,
                v.least, v.least_printed, v.best.half_angle, v.trial.half_angle, v.first_half_angle,
                (mpfr_ptr)NULL);
    mpz_inits(v.sum, v.term, v.scaled[0], v.scaled[1], v.scaled[2], (mpz_ptr)NULL);
    mpfr_const_pi(v.rad_per_turn64, MPFR_RNDN);
    mpfr_div_2ui(v.rad_per_turn64, v.rad_per_turn64, 63, MPFR_RNDN);
}

void cone_check_free(void) {
    if (v.ready) {
        for (unsigned i = 0; i < sizeof vectors / sizeof *vectors; i++) {
            clear_vector(vectors[i]);
        }
        mpfr_clears(v.dot, v.product, v.length, v.angle, v.outside, v.rad_per_turn64, v.cosine,
                    v.least, v.least_printed, v.best.half_angle, v.trial.half_angle,
                    (mpfr_ptr)NULL);
        mpz_clears(v.sum, v.term, v.scaled[0], v.scaled[1], v.scaled[2], (mpz_ptr)NULL);
        v.ready = false;
    }
    exact_free();
    mpfr_free_cache();
}

// ---------------------------------------------------------------- feasibility

/// Has the integer vector v.scaled every point strictly in front?
static bool scaled_sees_all(const struct vec3 *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        mpz_mul_si(v.sum, v.scaled[0], points[i].x);
        mpz_mul_si(v.term, v.scaled[1], points[i].y);
        mpz_add(v.sum, v.sum, v.term);
        mpz_mul_si(v.term, v.scaled[2], points[i].z);
        mpz_add(v.sum, v.sum, v.term);
        if (mpz_sgn(v.sum) <= 0) {
            return false;
        }
    }
    return true;
}

/// Some integer vector has every point in front: the printed axis, or near 90 degrees the optimum's
/// exact axis to 200 bits.
static bool proved_feasible(const struct vec3 *points, uint32_t count, struct vec3 axis) {
    mpz_set_si(v.scaled[0], axis.x);
    mpz_set_si(v.scaled[1], axis.y);
    mpz_set_si(v.scaled[2], axis.z);
    if (scaled_sees_all(points, count)) {
        return true;
    }
    mpfr_ptr component[3] = {v.best.axis.x, v.best.axis.y, v.best.axis.z};
    for (unsigned i = 0; i < 3U; i++) {
        mpfr_mul_2ui(v.product, component[i], 200, MPFR_RNDN);
        mpfr_get_z(v.scaled[i], v.product, MPFR_RNDN);
    }
    return scaled_sees_all(points, count);
}

// ---------------------------------------------------------------- real vectors

static void set_vector(struct vector *a, struct vec3 from) {
    mpfr_set_si(a->x, from.x, MPFR_RNDN);
    mpfr_set_si(a->y, from.y, MPFR_RNDN);
    mpfr_set_si(a->z, from.z, MPFR_RNDN);
}

static void dot(mpfr_t to, const struct vector *a, const struct vector *b) {
    mpfr_mul(to, a->x, b->x, MPFR_RNDN);
    mpfr_mul(v.product, a->y, b->y, MPFR_RNDN);
    mpfr_add(to, to, v.product, MPFR_RNDN);
    mpfr_mul(v.product, a->z, b->z, MPFR_RNDN);
    mpfr_add(to, to, v.product, MPFR_RNDN);
}

static void cross(struct vector *to, const struct vector *a, const struct vector *b) {
    mpfr_mul(to->x, a->y, b->z, MPFR_RNDN);
    mpfr_mul(v.product, a->z, b->y, MPFR_RNDN);
    mpfr_sub(to->x, to->x, v.product, MPFR_RNDN);
    mpfr_mul(to->y, a->z, b->x, MPFR_RNDN);
    mpfr_mul(v.product, a->x, b->z, MPFR_RNDN);
    mpfr_sub(to->y, to->y, v.product, MPFR_RNDN);
    mpfr_mul(to->z, a->x, b->y, MPFR_RNDN);
    mpfr_mul(v.product, a->y, b->x, MPFR_RNDN);
    mpfr_sub(to->z, to->z, v.product, MPFR_RNDN);
}

static void subtract(struct vector *to, const struct vector *a, const struct vector *b) {
    mpfr_sub(to->x, a->x, b->x, MPFR_RNDN);
    mpfr_sub(to->y, a->y, b->y, MPFR_RNDN);
    mpfr_sub(to->z, a->z, b->z, MPFR_RNDN);
}

static void copy(struct vector *to, const struct vector *a) {
    mpfr_set(to->x, a->x, MPFR_RNDN);
    mpfr_set(to->y, a->y, MPFR_RNDN);
    mpfr_set(to->z, a->z, MPFR_RNDN);
}

static void normalise(struct vector *a) {
    dot(v.length, a, a);
    mpfr_rec_sqrt(v.length, v.length, MPFR_RNDN);
    mpfr_mul(a->x, a->x, v.length, MPFR_RNDN);
    mpfr_mul(a->y, a->y, v.length, MPFR_RNDN);
    mpfr_mul(a->z, a->z, v.length, MPFR_RNDN);
}

/// v.angle = angle between unit vectors a and b; small angles and those near 180 degrees keep their
/// precision. Uses v.edge and v.side.
static void angle_between(const struct vector *a, const struct vector *b) {
    cross(&v.side, a, b);
    dot(v.length, &v.side, &v.side);
    mpfr_sqrt(v.length, v.length, MPFR_RNDN);
    dot(v.dot, a, b);
    mpfr_atan2(v.angle, v.length, v.dot, MPFR_RNDN);
}

/// Axis of the narrowest cone of two unit vectors.
static void axis_of_two(struct vector *axis, const struct vector *a, const struct vector *b) {
    mpfr_add(axis->x, a->x, b->x, MPFR_RNDN);
    mpfr_add(axis->y, a->y, b->y, MPFR_RNDN);
    mpfr_add(axis->z, a->z, b->z, MPFR_RNDN);
    normalise(axis);
}

/// Axis of the narrowest cone of three unit vectors: of the two at the ends of the longest side if
/// their triangle is not acute, else the normal of the plane through them.
static void axis_of_three(struct vector *axis, const struct vector *const *p) {
    for (unsigned i = 0; i < 3U; i++) {
        const struct vector *a = p[(i + 1U) % 3U], *b = p[(i + 2U) % 3U];
        subtract(&v.edge, a, p[i]);
        subtract(&v.side, b, p[i]);
        dot(v.dot, &v.edge, &v.side);
        if (mpfr_sgn(v.dot) <= 0) {
            axis_of_two(axis, a, b);
            return;
        }
    }
    subtract(&v.edge, p[1], p[0]);
    subtract(&v.side, p[2], p[0]);
    cross(axis, &v.edge, &v.side);
    normalise(axis);
    dot(v.dot, axis, p[0]);
    if (mpfr_sgn(v.dot) < 0) {
        mpfr_neg(axis->x, axis->x, MPFR_RNDN);
        mpfr_neg(axis->y, axis->y, MPFR_RNDN);
        mpfr_neg(axis->z, axis->z, MPFR_RNDN);
    }
}

/// The narrowest cone of those of v.base whose bits are set in `subset`: one to three.
static void solve_subset(struct cone *cone, unsigned subset) {
    const struct vector *p[3] = {NULL, NULL, NULL};
    unsigned count = 0;
    for (unsigned i = 0; i < 4U; i++) {
        if ((subset & (1U << i)) != 0U) {
            p[count++] = &v.base[i];
        }
    }
    if (count == 3U) {
        axis_of_three(&cone->axis, p);
    } else if (count == 2U) {
        axis_of_two(&cone->axis, p[0], p[1]);
    } else {
        copy(&cone->axis, p[0]);
    }
    mpfr_set_ui(cone->half_angle, 0, MPFR_RNDN);
    for (unsigned i = 0; i < count; i++) { // of an obtuse triangle one point lies inside
        angle_between(&cone->axis, p[i]);
        mpfr_max(cone->half_angle, cone->half_angle, v.angle, MPFR_RNDN);
    }
}

/// The point with the least cosine to the axis.
static uint32_t find_farthest(const struct vec3 *points, uint32_t count,
                              const struct vector *axis) {
    uint32_t farthest = 0;
    for (uint32_t i = 0; i < count; i++) {
        set_vector(&v.unit, points[i]);
        normalise(&v.unit);
        dot(v.cosine, &v.unit, axis);
        if (i == 0U || mpfr_less_p(v.cosine, v.least)) {
            mpfr_set(v.least, v.cosine, MPFR_RNDN);
            farthest = i;
        }
    }
    return farthest;
}

/// v.angle = angle from axis to the point.
static void angle_to(const struct vector *axis, struct vec3 point) {
    set_vector(&v.unit, point);
    normalise(&v.unit);
    angle_between(axis, &v.unit);
}

uint64_t cone_largest_angle_turn64(const struct vec3 *points, uint32_t count, struct vec3 axis) {
    start();
    set_vector(&v.printed, axis);
    normalise(&v.printed);
    angle_to(&v.printed, points[find_farthest(points, count, &v.printed)]);
    mpfr_div(v.angle, v.angle, v.rad_per_turn64, MPFR_RNDD);
    return mpfr_get_uj(v.angle, MPFR_RNDD);
}

// ---------------------------------------------------------------- one answer

static const char *check_support(const struct vec3 *points, uint32_t count,
                                 const struct cone_result *result) {
    if (result->support_count < 1U || result->support_count > 3U) {
        return "support does not have one to three points";
    }
    for (unsigned i = 0; i < result->support_count; i++) {
        if (result->support[i] >= count ||
            (i > 0U && result->support[i] <= result->support[i - 1U])) {
            return "support is not ascending, or names a point that is not there";
        }
        for (unsigned j = 0; j < i; j++) {
            const struct vec3 a = points[result->support[i]], b = points[result->support[j]];
            if (exact_parallel(a, b) && exact_dot_sign(a, b) > 0) {
                return "support names a direction twice";
            }
        }
    }
    return NULL;
}

/// v.best = the narrowest cone of the set, by pivoting from the named support: the farthest point
/// enters, and of the four the largest cone that two or three need is the next. Each is wider than
/// the last. Tells the report how far the first was off.
static void solve_from_support(const struct vec3 *points, uint32_t count,
                               const struct cone_result *result, struct cone_report *report) {
    uint32_t member[4];
    unsigned size = result->support_count;
    for (unsigned i = 0; i < size; i++) {
        member[i] = result->support[i];
    }
    for (unsigned round = 0; round < 64U; round++) {
        for (unsigned i = 0; i < size; i++) {
            set_vector(&v.base[i], points[member[i]]);
            normalise(&v.base[i]);
        }
        unsigned best = round == 0U ? (1U << size) - 1U : 0U;
        if (best != 0U) {
            solve_subset(&v.best, best);
        }
        for (unsigned subset = 1; round > 0U && subset < (1U << size) - (size == 4U); subset++) {
            solve_subset(&v.trial, subset);
            if (best == 0U || mpfr_greater_p(v.trial.half_angle, v.best.half_angle)) {
                best = subset;
                copy(&v.best.axis, &v.trial.axis);
                mpfr_set(v.best.half_angle, v.trial.half_angle, MPFR_RNDN);
            }
        }
        const uint32_t farthest = find_farthest(points, count, &v.best.axis);
        angle_to(&v.best.axis, points[farthest]);
        mpfr_sub(v.outside, v.angle, v.best.half_angle, MPFR_RNDN);
        if (round == 0U) {
            report->support_outside_rad = mpfr_get_d(v.outside, MPFR_RNDN);
            mpfr_set(v.first_half_angle, v.best.half_angle, MPFR_RNDN);
        }
        if (mpfr_cmp_d(v.outside, 1e-60) <= 0) {
            return;
        }
        unsigned kept = 0;
        for (unsigned i = 0; i < size; i++) {
            if ((best & (1U << i)) != 0U) {
                member[kept++] = member[i];
            }
        }
        member[kept] = farthest;
        size = kept + 1U;
    }
}

static const char *check_printed_angle(uint32_t farthest, const struct vec3 *points,
                                       const struct cone_result *result,
                                       struct cone_report *report) {
    // v.angle is the largest true angle from the printed axis.
    mpfr_div(v.angle, v.angle, v.rad_per_turn64, MPFR_RNDN);
    mpfr_ui_sub(v.cosine, result->half_angle_turn64, v.angle, MPFR_RNDN);
    report->slack_turn64 = mpfr_get_d(v.cosine, MPFR_RNDN);
    if (mpfr_sgn(v.cosine) < 0) {
        return "half_angle_turn64 is too small";
    }
    if (report->slack_turn64 > CONE_SLACK_TURN64_MAX) {
        return "half_angle_turn64 is larger than claimed";
    }
    const uint64_t up = (result->half_angle_turn64 >> 32) +
                        ((result->half_angle_turn64 & UINT32_MAX) != 0U ? 1U : 0U);
    if (result->half_angle_bam32.bam != up) {
        return "half_angle_bam32 is not half_angle_turn64 rounded up";
    }
    if (result->farthest_index != farthest) {
        mpfr_set(v.cosine, v.angle, MPFR_RNDN);
        angle_to(&v.printed, points[result->farthest_index]);
        mpfr_div(v.angle, v.angle, v.rad_per_turn64, MPFR_RNDN);
        mpfr_sub(v.cosine, v.cosine, v.angle, MPFR_RNDN);
        if (mpfr_cmp_d(v.cosine, 0x1p-100) > 0) {
            return "farthest_index is not a farthest point";
        }
    }
    return NULL;
}

static bool support_is_right(const struct cone_report *report) {
    const double gap_max = cone_support_gap_max(report->half_angle_rad);
    return report->support_gap_rad <= gap_max && (report->support_outside_rad <= gap_max ||
                                                  !cone_in_claimed_range(report->half_angle_rad));
}

static const char *check_ok(const struct vec3 *points, uint32_t count,
                            const struct cone_result *result, struct cone_report *report) {
    const char *wrong = check_support(points, count, result);
    if (wrong != NULL) {
        return wrong;
    }
    if (result->farthest_index >= count) {
        return "farthest_index names a point that is not there";
    }
    solve_from_support(points, count, result, report);
    report->half_angle_rad = mpfr_get_d(v.best.half_angle, MPFR_RNDN);
    mpfr_sub(v.outside, v.best.half_angle, v.first_half_angle, MPFR_RNDN);
    report->support_gap_rad = mpfr_get_d(v.outside, MPFR_RNDN);
    if (!proved_feasible(points, count, result->axis_q30)) {
        return "called feasible, but neither the printed nor the optimum's axis sees all points";
    }
    set_vector(&v.printed, result->axis_q30);
    dot(v.length, &v.printed, &v.printed);
    mpfr_sqrt(v.length, v.length, MPFR_RNDN);
    if (fabs(mpfr_get_d(v.length, MPFR_RNDN) - 0x1p30) > 1.0) {
        return "axis is not of unit length within one unit";
    }
    normalise(&v.printed);
    const uint32_t farthest = find_farthest(points, count, &v.printed);
    angle_to(&v.printed, points[farthest]);
    mpfr_sub(v.cosine, v.angle, v.best.half_angle, MPFR_RNDN);
    report->excess_rad = mpfr_get_d(v.cosine, MPFR_RNDU);
    mpfr_mul_2ui(v.cosine, v.rad_per_turn64, 62, MPFR_RNDN);
    mpfr_sub(v.cosine, v.angle, v.cosine, MPFR_RNDN);
    report->beyond_quarter_rad = mpfr_get_d(v.cosine, MPFR_RNDU);
    const char *angle_wrong = check_printed_angle(farthest, points, result, report);
    if (angle_wrong == NULL && !support_is_right(report)) {
        return "a point lies outside the support's own narrowest cone";
    }
    return angle_wrong;
}

const char *cone_check(const struct vec3 *points, uint32_t count, enum cone_status status,
                       const struct cone_result *result, struct cone_report *report) {
    start();
    *report = (struct cone_report){0};
    if (status == CONE_OK) {
        return check_ok(points, count, result, report);
    }
    if (status == CONE_INFEASIBLE) {
        return exact_check_witness(points, count, result->witness, result->witness_count);
    }
    return "status is neither OK nor INFEASIBLE";
}
