/// firmware/sphere/min_norm against rational arithmetic: the point of least norm of a hull by
/// solving for the weights of every subset (Gram systems, GMP), which shares nothing with the cross
/// products of the tested code.
#include "check.h"

#include "sphere/cone_answer.h"
#include "sphere/min_norm.h"

#include <gmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS 6U

static uint64_t seed = UINT64_C(19760101);

static void set_i64(mpq_t out, int64_t value) {
    char text[32];
    snprintf(text, sizeof text, "%lld", (long long)value);
    mpq_set_str(out, text, 10);
}

static void dot(mpq_t out, struct vec3_i64 a, struct vec3_i64 b) {
    const int64_t left[] = {a.x, a.y, a.z}, right[] = {b.x, b.y, b.z};
    mpq_t x, y;
    mpq_inits(x, y, NULL);
    mpq_set_ui(out, 0, 1);
    for (unsigned i = 0; i < 3U; i++) {
        set_i64(x, left[i]);
        set_i64(y, right[i]);
        mpq_mul(x, x, y);
        mpq_add(out, out, x);
    }
    mpq_clears(x, y, NULL);
}

/// Solves the weights of least norm over the affine hull of `size` points (Gauss-Jordan on G w = m
/// 1, sum w = 1). False: the points are affinely dependent.
static bool solve_weights(const struct vec3_i64 *points, unsigned size, mpq_t *weights) {
    mpq_t m[5][6], factor;
    const unsigned n = size + 1U;
    mpq_init(factor);
    for (unsigned r = 0; r < n; r++) {
        for (unsigned c = 0; c <= n; c++) {
            mpq_init(m[r][c]);
            if (r < size && c < size) {
                dot(m[r][c], points[r], points[c]);
            } else {
                mpq_set_si(m[r][c], (r == size) == (c == size) && c != n ? 0 : 1, 1);
            }
        }
        mpq_set_si(m[r][n], r == size, 1);
    }
    bool solved = true;
    for (unsigned c = 0; solved && c < n; c++) {
        unsigned pivot = c;
        while (pivot < n && mpq_sgn(m[pivot][c]) == 0) {
            pivot++;
        }
        solved = pivot < n;
        for (unsigned k = 0; solved && k <= n; k++) {
            mpq_swap(m[c][k], m[pivot][k]);
        }
        for (unsigned r = 0; solved && r < n; r++) {
            if (r == c || mpq_sgn(m[r][c]) == 0) {
                continue;
            }
            mpq_div(factor, m[r][c], m[c][c]);
            for (unsigned k = c; k <= n; k++) {
                mpq_t part;
                mpq_init(part);
                mpq_mul(part, factor, m[c][k]);
                mpq_sub(m[r][k], m[r][k], part);
                mpq_clear(part);
            }
        }
    }
    for (unsigned i = 0; solved && i < size; i++) {
        mpq_div(weights[i], m[i][n], m[i][i]);
    }
    for (unsigned r = 0; r < n; r++) {
        for (unsigned c = 0; c <= n; c++) {
            mpq_clear(m[r][c]);
        }
    }
    mpq_clear(factor);
    return solved;
}

/// x . p for the nearest point x = sum of weights times points.
static void dot_nearest(mpq_t out, const struct vec3_i64 *points, mpq_t *weights, unsigned size,
                        struct vec3_i64 p) {
    mpq_t part;
    mpq_init(part);
    mpq_set_ui(out, 0, 1);
    for (unsigned i = 0; i < size; i++) {
        dot(part, points[i], p);
        mpq_mul(part, part, weights[i]);
        mpq_add(out, out, part);
    }
    mpq_clear(part);
}

/// Is this the support of the nearest point of all points: weights positive, nearest point not
/// zero, nobody nearer?
static bool is_support(const struct vec3_i64 *all, unsigned count, const struct vec3_i64 *support,
                       unsigned size) {
    mpq_t weights[3], norm2, of_point;
    mpq_inits(norm2, of_point, NULL);
    for (unsigned i = 0; i < 3U; i++) {
        mpq_init(weights[i]);
    }
    bool right = solve_weights(support, size, weights);
    for (unsigned i = 0; right && i < size; i++) {
        right = mpq_sgn(weights[i]) > 0;
    }
    if (right) {
        dot_nearest(norm2, support, weights, size, support[0]);
        right = mpq_sgn(norm2) > 0;
    }
    for (unsigned i = 0; right && i < count; i++) {
        dot_nearest(of_point, support, weights, size, all[i]);
        right = mpq_cmp(of_point, norm2) >= 0;
    }
    for (unsigned i = 0; i < 3U; i++) {
        mpq_clear(weights[i]);
    }
    mpq_clears(norm2, of_point, NULL);
    return right;
}

/// Does any subset of at most three points hold the nearest point, with zero outside the hull?
static bool has_support(const struct vec3_i64 *all, unsigned count) {
    for (unsigned mask = 1; mask < (1U << count); mask++) {
        struct vec3_i64 subset[3];
        unsigned size = 0, members = 0;
        for (unsigned i = 0; i < count; i++) {
            members += mask >> i & 1U;
            if ((mask >> i & 1U) != 0U && size < 3U) {
                subset[size++] = all[i];
            }
        }
        if (members <= 3U && is_support(all, count, subset, size)) {
            return true;
        }
    }
    return false;
}

// ---------------------------------------------------------------- driving the tested code

/// Pivots over the points until none violates. False: it says that zero is in the hull.
static bool pivot(struct min_norm *support, const struct min_norm_point *points, unsigned count,
                  bool unit) {
    min_norm_start(support, &points[0], unit);
    for (bool moved = true; moved;) {
        moved = false;
        for (unsigned i = 0; i < count; i++) {
            if (min_norm_violated_by(support, &points[i])) {
                if (!min_norm_enter(support, &points[i])) {
                    return false;
                }
                moved = true;
            }
        }
    }
    return true;
}

static uint64_t axes, axes_of_units;

/// min_norm_axis gives the bits of the exact direction, whatever it does to save work.
static void check_axis(const struct min_norm *support) {
    struct min_norm quick = *support, exact = *support;
    quick.exact_known = false;
    const struct vec3 axis = min_norm_axis(&quick);
    const struct vec3 wanted = vec3_i64_normalise(min_norm_direction(&exact));
    CHECK(vec3_equal(axis, wanted));
    axes++;
    axes_of_units += support->count > 1U && !quick.exact_known;
}

static void check_set(const struct min_norm_point *points, unsigned count, bool unit) {
    struct vec3_i64 all[POINTS], held[3];
    struct min_norm support;
    for (unsigned i = 0; i < count; i++) {
        all[i] = unit ? vec3_normalise_q61(points[i].given) : points[i].exact;
    }
    if (!pivot(&support, points, count, unit)) {
        CHECK(!has_support(all, count));
        return;
    }
    for (unsigned i = 0; i < support.count; i++) {
        held[i] = all[support.point[i].index];
    }
    CHECK(is_support(all, count, held, support.count));
    if (unit) {
        check_axis(&support);
    }
}

static int64_t below(int64_t limit) {
    return (int64_t)(check_random(&seed) % (uint64_t)limit);
}

/// Small and large integers of any length, with many exact coincidences.
static void integer_points(void) {
    printf("# seed %llu\n", (unsigned long long)seed);
    for (unsigned set = 0; set < 20000U && check_clean(); set++) {
        struct min_norm_point points[POINTS];
        const unsigned count = 2U + (unsigned)below(POINTS - 1U);
        const int64_t range = set % 3U == 0U ? 3 : (set % 3U == 1U ? 9 : (int64_t)1 << 60);
        for (unsigned i = 0; i < count; i++) {
            do {
                points[i] = (struct min_norm_point){.index = i,
                                                    .exact = {below(2 * range + 1) - range,
                                                              below(2 * range + 1) - range,
                                                              below(2 * range + 1) - range}};
            } while ((points[i].exact.x | points[i].exact.y | points[i].exact.z) == 0);
        }
        check_set(points, count, false);
    }
}

/// Unit vectors: wide, narrow, near a great circle, repeated, from small integers.
static void unit_vectors(void) {
    printf("# seed %llu\n", (unsigned long long)seed);
    for (unsigned set = 0; set < 20000U && check_clean(); set++) {
        struct vec3 raw[POINTS];
        struct min_norm_point points[POINTS];
        const unsigned count = 2U + (unsigned)below(POINTS - 1U), kind = set % 4U;
        const int64_t spread = (int64_t)1 << (kind == 0U ? 30 : 2 + below(28));
        for (unsigned i = 0; i < count; i++) {
            do {
                raw[i] = kind == 3U ? vec3((int32_t)below(5) - 2, (int32_t)below(5) - 2,
                                           (int32_t)below(5) - 2)
                                    : vec3((int32_t)(below(2 * spread) - spread),
                                           (int32_t)(below(2 * spread) - spread),
                                           kind == 2U ? (int32_t)below(3) : (int32_t)(1 << 30));
            } while (vec3_is_zero(raw[i]));
            raw[i] = set % 8U < 4U ? raw[i] : vec3_normalise(raw[i]);
            points[i] = cone_point(raw, i);
            points[i].index = i;
        }
        check_set(points, count, true);
    }
    printf("# axes: %llu, of them worked out in 64 bits: %llu\n", (unsigned long long)axes,
           (unsigned long long)axes_of_units);
    CHECK(axes_of_units > axes / 10U && axes_of_units < axes);
}

/// The 64-bit filter never contradicts the exact test, also for given unit vectors whose length is
/// off by 2^-29.
static void the_filter_is_never_wrong(void) {
    uint64_t decided = 0, open = 0;
    for (unsigned set = 0; set < 200000U && check_clean(); set++) {
        struct vec3 raw[4];
        struct min_norm_point points[4];
        const int64_t spread = (int64_t)1 << (10 + below(21));
        for (unsigned i = 0; i < 4U; i++) {
            const struct vec3 any = vec3((int32_t)(below(2 * spread) - spread),
                                         (int32_t)(below(2 * spread) - spread), 1 << 30);
            raw[i] = vec3_normalise(any);
            raw[i].x += (int32_t)below(3) - 1;
            raw[i].z += (int32_t)below(3) - 1;
            points[i] = cone_point(raw, i);
        }
        struct min_norm support;
        if (!pivot(&support, points, 3, true)) {
            continue;
        }
        const int64_t depth = min_norm_depth(&support.filter, raw[3]);
        if (depth > MIN_NORM_BAND || depth < -MIN_NORM_BAND) {
            decided++;
            struct min_norm exact = support;
            for (unsigned i = 0; i < exact.count; i++) {
                exact.point[i].exact = vec3_normalise_q61(support.point[i].given);
            }
            exact.unit = false; // the exact test only
            exact.exact_known = false;
            points[3].exact = vec3_normalise_q61(points[3].given);
            CHECK_EQ(min_norm_violated_by(&exact, &points[3]), depth < 0);
        } else {
            open++;
        }
    }
    printf("# the filter decided %llu, left open %llu\n", (unsigned long long)decided,
           (unsigned long long)open);
    CHECK(decided > 50000U);
}

int main(void) {
    TEST(integer_points);
    TEST(unit_vectors);
    TEST(the_filter_is_never_wrong);
    return check_finish();
}
