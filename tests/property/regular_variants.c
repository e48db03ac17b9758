/// Weights, directions above every plane, and axes, against brute force in long double; and the
/// exact comparison of discs against reals of 2,400 bits.
#include "check.h"
#include "property/support/regular_check.h"

#include "regular/disc.h"

#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

enum { COUNT_MOST = 9, PAIRS_MOST = COUNT_MOST * COUNT_MOST };
static struct vec3 points[3 * COUNT_MOST];
static const long double pi = 3.14159265358979323846264338327950288L;

static long double radians(uint64_t turn64) {
    return (long double)turn64 * (pi / 9223372036854775808.0L);
}

static long double real_i128(struct i128 a) {
    return (long double)a.hi * 18446744073709551616.0L + (long double)a.lo;
}

static enum regular_status optimize(const struct regular_input *in,
                                    const struct regular_options *options,
                                    struct regular_result *result) {
    const uint64_t bytes =
        regular_workspace_bytes(in->problem, REGULAR_OPTIMIZE, in->count, options);
    void *const workspace = malloc(bytes);
    const enum regular_status status = regular_optimize(in, options, workspace, bytes, result);
    free(workspace);
    return status;
}

// ---------------------------------------------------------------- weights

static struct {
    uint32_t count;
    long double angle[PAIRS_MOST], weight[PAIRS_MOST];
} weighted;

/// The smallest angle to a line, modulo half a turn, over the line's weight.
static long double weighted_value(long double angle) {
    long double least = pi;
    for (uint32_t i = 0; i < weighted.count; i++) {
        const long double off = fabsl(remainderl(angle - weighted.angle[i], pi));
        least = fminl(least, off / weighted.weight[i]);
    }
    return least;
}

/// Where two lines count the same: between them, or beyond the heavier one.
static long double weighted_best(void) {
    long double best = 0;
    for (uint32_t i = 0; i < weighted.count; i++) {
        best = fmaxl(best, weighted_value(weighted.angle[i] + pi / 2));
        for (uint32_t j = 0; j < weighted.count; j++) {
            const long double a = weighted.weight[i], b = weighted.weight[j];
            for (int turn = -2; turn <= 2; turn++) {
                const long double p = weighted.angle[i], q = weighted.angle[j] + turn * pi;
                best = fmaxl(best, weighted_value((b * p + a * q) / (a + b)));
                if (a != b) {
                    best = fmaxl(best, weighted_value((b * p - a * q) / (b - a)));
                }
            }
        }
    }
    return best;
}

static void weights(void) {
    uint64_t seed = 151;
    for (int round = 0; round < 300; round++) {
        uint32_t weight[COUNT_MOST];
        const uint32_t count = 2U + (uint32_t)(check_random(&seed) % (COUNT_MOST - 1U));
        const int32_t size = check_random(&seed) % 2U == 0U ? 4 : REGULAR_COORDINATE_MAX;
        if (!check_draw(&seed, REGULAR_POINTS2_LINE, count, size, points)) {
            continue;
        }
        weighted.count = 0;
        for (uint32_t i = 0; i < count; i++) {
            weight[i] = 1U + (uint32_t)(check_random(&seed) % (round % 3 == 0 ? 1000U : 4U));
            for (uint32_t j = 0; j < i; j++) {
                weighted.angle[weighted.count] = atan2l((long double)points[i].y - points[j].y,
                                                        (long double)points[i].x - points[j].x);
                weighted.weight[weighted.count++] = fmaxl(weight[i], weight[j]);
            }
        }
        const struct regular_input in = {REGULAR_POINTS2_LINE, points, count};
        const struct regular_options options = {.weights = weight};
        struct regular_result result;
        CHECK_EQ(optimize(&in, &options, &result), REGULAR_OK);
        const long double best = weighted_best(), tolerance = radians(result.tolerance_turn64);
        const long double there =
            weighted_value(atan2l(real_i128(result.direction.y), real_i128(result.direction.x)));
        if (!CHECK(tolerance <= there + 1e-18L) || !CHECK(tolerance > there - 1e-12L) ||
            !CHECK(there > best - 1e-12L) || !CHECK(there < best + 1e-12L)) {
            check_note("round", round);
            return;
        }
    }
}

// ---------------------------------------------------------------- above

struct real3 {
    long double x, y, z;
};

static struct real3 unit_of(struct vec3_i64 n) {
    const long double x = (long double)n.x, y = (long double)n.y, z = (long double)n.z;
    const long double size = sqrtl(x * x + y * y + z * z) * (n.z < 0 ? -1 : 1);
    return (struct real3){x / size, y / size, z / size};
}

static struct real3 plus(struct real3 a, long double by, struct real3 b) {
    return (struct real3){a.x + by * b.x, a.y + by * b.y, a.z + by * b.z};
}

static struct real3 cross(struct real3 a, struct real3 b) {
    return (struct real3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The smallest angle above a plane.
static long double above_value(const struct real3 *up, uint32_t count, struct real3 v) {
    long double least = pi;
    for (uint32_t i = 0; i < count; i++) {
        const struct real3 c = cross(v, up[i]);
        least = fminl(least, atan2l(v.x * up[i].x + v.y * up[i].y + v.z * up[i].z,
                                    sqrtl(c.x * c.x + c.y * c.y + c.z * c.z)));
    }
    return least;
}

static long double above_best(const struct real3 *up, uint32_t count) {
    long double best = -pi;
    for (uint32_t i = 0; i < count; i++) {
        best = fmaxl(best, above_value(up, count, up[i]));
        for (uint32_t j = 0; j < i; j++) {
            best = fmaxl(best, above_value(up, count, plus(up[i], 1, up[j])));
            for (uint32_t k = 0; k < j; k++) {
                const struct real3 v = cross(plus(up[i], -1, up[j]), plus(up[k], -1, up[j]));
                best = fmaxl(best, above_value(up, count, v));
                best = fmaxl(best, above_value(up, count, plus((struct real3){0, 0, 0}, -1, v)));
            }
        }
    }
    return best;
}

static void above(void) {
    uint64_t seed = 161;
    int64_t none = 0;
    for (int round = 0; round < 400; round++) {
        const uint32_t count = 1U + (uint32_t)(check_random(&seed) % COUNT_MOST);
        const int32_t size = check_random(&seed) % 2U == 0U ? 5 : REGULAR_COORDINATE_MAX;
        if (!check_draw(&seed, REGULAR_FACES_VERTICAL, count, size, points)) {
            continue;
        }
        struct real3 up[COUNT_MOST];
        bool vertical = false;
        for (uint32_t i = 0; i < count; i++) {
            const struct vec3 *const f = &points[3 * i];
            const struct vec3_i64 n =
                vec3_cross(vec3(f[1].x - f[0].x, f[1].y - f[0].y, f[1].z - f[0].z),
                           vec3(f[2].x - f[0].x, f[2].y - f[0].y, f[2].z - f[0].z));
            vertical = vertical || n.z == 0;
            up[i] = unit_of(n);
        }
        const struct regular_input in = {REGULAR_FACES_VERTICAL, points, count};
        const struct regular_options options = {.above = true};
        struct regular_result result;
        const enum regular_status status = optimize(&in, &options, &result);
        CHECK_EQ(status, vertical ? REGULAR_NONE : REGULAR_OK);
        none += vertical;
        if (status != REGULAR_OK) {
            CHECK(check_conflict(&in, &result.conflict));
            continue;
        }
        const struct real3 v = {real_i128(result.direction.x), real_i128(result.direction.y),
                                real_i128(result.direction.z)};
        const long double there = above_value(up, count, v), best = above_best(up, count);
        if (!CHECK(radians(result.tolerance_turn64) <= there + 1e-18L) ||
            !CHECK(radians(result.tolerance_turn64) > there - 1e-12L) ||
            !CHECK(fabsl(there - best) < 1e-12L)) {
            check_note("round", round);
            return;
        }
    }
    CHECK(none > 20);
}

// ---------------------------------------------------------------- axes

static void axes(void) {
    uint64_t seed = 171;
    for (int round = 0; round < 60; round++) {
        const enum regular_problem problem =
            round % 2 == 0 ? REGULAR_POINTS3_XY : REGULAR_POINTS3_XYZ;
        const uint32_t count = 2U + (uint32_t)(check_random(&seed) % (COUNT_MOST - 1U));
        if (!check_draw(&seed, problem, count, round % 4 < 2 ? 3 : 500000, points)) {
            continue;
        }
        const struct regular_input in = {problem, points, count};
        struct regular_result result;
        CHECK_EQ(optimize(&in, NULL, &result), REGULAR_OK);
        struct check_vector rows[3];
        long double least = pi;
        for (int k = 0; k < 3; k++) {
            check_vector_init(&rows[k]);
            check_vector_set(&rows[k], result.rotation[k]);
            const struct real3 row = {real_i128(result.rotation[k].x),
                                      real_i128(result.rotation[k].y),
                                      real_i128(result.rotation[k].z)};
            for (uint32_t i = 0; i < count && (k < 2 || problem == REGULAR_POINTS3_XYZ); i++) {
                for (uint32_t j = 0; j < i; j++) {
                    const struct real3 d = {(long double)points[i].x - points[j].x,
                                            (long double)points[i].y - points[j].y,
                                            (long double)points[i].z - points[j].z};
                    least = fminl(least, fabsl(above_value(&row, 1, d)));
                }
            }
        }
        CHECK(check_axes(&in, rows));
        CHECK(radians(result.tolerance_turn64) <= least + 1e-18L);
        CHECK(radians(result.tolerance_turn64) > least - 1e-12L);
        CHECK(result.tolerance_turn64 > 0U && result.tolerance_is_bound);
        for (int k = 0; k < 3; k++) {
            check_vector_clear(&rows[k]);
        }
    }
}

// ---------------------------------------------------------------- discs

enum { BITS = 2400 };

static void unit_mpfr(mpfr_t to[3], struct vec3_i64 a) {
    mpfr_t size, part;
    mpfr_inits2(BITS, size, part, (mpfr_ptr)NULL);
    const int64_t at[3] = {a.x, a.y, a.z};
    mpfr_set_zero(size, 1);
    for (int i = 0; i < 3; i++) {
        mpfr_set_si(part, at[i], MPFR_RNDN);
        mpfr_sqr(part, part, MPFR_RNDN);
        mpfr_add(size, size, part, MPFR_RNDN);
    }
    mpfr_sqrt(size, size, MPFR_RNDN);
    for (int i = 0; i < 3; i++) {
        mpfr_set_si(to[i], at[i], MPFR_RNDN);
        mpfr_div(to[i], to[i], size, MPFR_RNDN);
    }
    mpfr_clears(size, part, (mpfr_ptr)NULL);
}

/// cos^2 of the cap: (a.v)^2 / v.v for a normal v of the plane through the corners; of two, a + b.
static void cosine_mpfr(mpfr_t to, const struct disc *disc) {
    mpfr_t u[3][3], v[3], part, size;
    mpfr_inits2(BITS, v[0], v[1], v[2], part, size, (mpfr_ptr)NULL);
    for (int i = 0; i < 3; i++) {
        mpfr_inits2(BITS, u[i][0], u[i][1], u[i][2], (mpfr_ptr)NULL);
        unit_mpfr(u[i], disc->support[i % disc->count]);
    }
    for (int i = 0; i < 3; i++) {
        if (disc->count == 3U) {
            mpfr_t p, q;
            mpfr_inits2(BITS, p, q, (mpfr_ptr)NULL);
            mpfr_sub(p, u[1][(i + 1) % 3], u[0][(i + 1) % 3], MPFR_RNDN);
            mpfr_sub(q, u[2][(i + 2) % 3], u[0][(i + 2) % 3], MPFR_RNDN);
            mpfr_mul(v[i], p, q, MPFR_RNDN);
            mpfr_sub(p, u[1][(i + 2) % 3], u[0][(i + 2) % 3], MPFR_RNDN);
            mpfr_sub(q, u[2][(i + 1) % 3], u[0][(i + 1) % 3], MPFR_RNDN);
            mpfr_mul(p, p, q, MPFR_RNDN);
            mpfr_sub(v[i], v[i], p, MPFR_RNDN);
            mpfr_clears(p, q, (mpfr_ptr)NULL);
        } else {
            mpfr_add(v[i], u[0][i], u[1][i], MPFR_RNDN);
        }
    }
    mpfr_set_zero(to, 1);
    mpfr_set_zero(size, 1);
    for (int i = 0; i < 3; i++) {
        mpfr_mul(part, u[0][i], v[i], MPFR_RNDN);
        mpfr_add(to, to, part, MPFR_RNDN);
        mpfr_sqr(part, v[i], MPFR_RNDN);
        mpfr_add(size, size, part, MPFR_RNDN);
    }
    mpfr_sqr(to, to, MPFR_RNDN);
    mpfr_div(to, to, size, MPFR_RNDN);
    for (int i = 0; i < 3; i++) {
        mpfr_clears(u[i][0], u[i][1], u[i][2], (mpfr_ptr)NULL);
    }
    mpfr_clears(v[0], v[1], v[2], part, size, (mpfr_ptr)NULL);
}

static bool compare_both(const struct disc *a, const struct disc *b) {
    mpfr_t p, q;
    mpfr_inits2(BITS, p, q, (mpfr_ptr)NULL);
    cosine_mpfr(p, a);
    cosine_mpfr(q, b);
    mpfr_sub(p, p, q, MPFR_RNDN);
    const int sign = mpfr_zero_p(p) || mpfr_get_exp(p) < -1800 ? 0 : mpfr_sgn(p);
    mpfr_clears(p, q, (mpfr_ptr)NULL);
    return CHECK_EQ(disc_compare(a, b), sign);
}

static struct vec3_i64 any_normal(uint64_t *seed, unsigned bits) {
    struct vec3_i64 n;
    n.x = (int64_t)(check_random(seed) >> (64U - bits)) - ((int64_t)1 << (bits - 1U));
    n.y = (int64_t)(check_random(seed) >> (64U - bits)) - ((int64_t)1 << (bits - 1U));
    n.z = (int64_t)(check_random(seed) >> (64U - bits)) + 1;
    return n;
}

/// Nearly the same disc: every component off by a unit at most.
static struct vec3_i64 beside(uint64_t *seed, struct vec3_i64 n) {
    n.x += (int64_t)(check_random(seed) % 3U) - 1;
    n.y += (int64_t)(check_random(seed) % 3U) - 1;
    n.z += (int64_t)(check_random(seed) % 3U) - 1;
    return n;
}

static void discs(void) {
    // All on one circle about z, with norms of 50 and of other radicands.
    static const struct vec3_i64 ring[] = {{3, 4, 5},    {-3, -4, 5}, {4, -3, 5},  {5, 0, 5},
                                           {0, -7, 7},   {-4, 3, 5},  {5, 12, 13}, {-5, -12, 13},
                                           {8, -15, 17}, {-1, 0, 1}};
    uint64_t seed = 181;
    for (int round = 0; round < 1200; round++) {
        struct disc a = {.count = (uint8_t)(2U + check_random(&seed) % 2U)};
        struct disc b = {.count = (uint8_t)(2U + check_random(&seed) % 2U)};
        const unsigned bits = round % 3 == 0 ? 42U : 3U + (unsigned)(check_random(&seed) % 39U);
        for (int i = 0; i < 3; i++) {
            a.support[i] = any_normal(&seed, bits);
            b.support[i] = round % 2 == 0 ? any_normal(&seed, bits) : beside(&seed, a.support[i]);
        }
        if (round % 5 == 0) { // the same circle, held by others
            for (int i = 0; i < 3; i++) {
                a.support[i] = ring[(unsigned)i];
                b.support[i] = ring[3U + (unsigned)((check_random(&seed) % 2U) * 3U) + (unsigned)i];
            }
            a.count = round % 10 == 0 ? 2 : 3;
            b.count = 3;
        }
        if (!compare_both(&a, &b)) {
            check_note("round", round);
            return;
        }
    }
}

int main(void) {
    check_note("seeds", 151);
    TEST(weights);
    TEST(above);
    TEST(axes);
    TEST(discs);
    mpfr_free_cache();
    return check_finish();
}
