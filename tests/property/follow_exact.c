/// The followed cone against the best of all candidates in long double: the axes on the arcs
/// between two caps, and those of equal reach to three, by Newton's iteration on angles.
#include "check.h"

#include "fixed/trig.h"
#include "sphere/follow.h"

#include <math.h>

#define CAPS_MOST 9

struct axis {
    long double x, y, z;
};

static uint64_t seed = UINT64_C(0x5EED0023);
static const long double rad_per_bam = 6.283185307179586476925286766559005768L / 4294967296.0L;
static struct vec3 centre[CAPS_MOST];
static struct follow_radius radius[CAPS_MOST];
static uint32_t count;
static bool sized;

static struct axis from_vec3(struct vec3 a) {
    const long double x = a.x, y = a.y, z = a.z, length = sqrtl(x * x + y * y + z * z);
    return (struct axis){x / length, y / length, z / length};
}

static struct axis cross(struct axis a, struct axis b) {
    return (struct axis){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static long double dot(struct axis a, struct axis b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct axis blend(struct axis a, long double s, struct axis b, long double t) {
    return (struct axis){a.x * s + b.x * t, a.y * s + b.y * t, a.z * s + b.z * t};
}

static struct axis unit(struct axis a) {
    return blend(a, 1.0L / sqrtl(dot(a, a)), a, 0);
}

static long double angle(struct axis a, struct axis b) {
    const struct axis c = cross(a, b);
    return atan2l(sqrtl(dot(c, c)), dot(a, b));
}

static long double reach(struct axis axis, uint32_t i) {
    return angle(axis, from_vec3(centre[i])) +
           (sized ? (long double)radius[i].angle.bam * rad_per_bam : 0.0L);
}

static long double reach_of_all(struct axis axis) {
    long double most = 0;
    for (uint32_t i = 0; i < count; i++) {
        most = fmaxl(most, reach(axis, i));
    }
    return most;
}

static long double best;

static void consider(struct axis axis) {
    best = fminl(best, reach_of_all(axis));
}

static void consider_two(uint32_t i, uint32_t k) {
    const struct axis a = from_vec3(centre[i]), b = from_vec3(centre[k]);
    const long double apart = angle(a, b), ri = reach(a, i), rk = reach(b, k);
    const long double from_a = (apart + rk - ri) / 2;
    if (from_a > 0 && from_a < apart && apart < 3.1L) {
        consider(unit(blend(a, sinl(apart - from_a), b, sinl(from_a))));
    }
}

/// Newton: reach_i + g_i . d = R for three caps, d in the plane across the axis.
static void consider_three(const uint32_t member[3], struct axis axis) {
    for (int round = 0; round < 60; round++) {
        const struct axis e1 = unit(fabsl(axis.x) < 0.6L ? cross(axis, (struct axis){1, 0, 0})
                                                         : cross(axis, (struct axis){0, 1, 0}));
        const struct axis e2 = cross(axis, e1);
        long double g[3][2], r[3];
        for (int i = 0; i < 3; i++) {
            const struct axis c = from_vec3(centre[member[i]]);
            const long double x = dot(c, e1), y = dot(c, e2), size = hypotl(x, y);
            g[i][0] = size > 0 ? -x / size : 0;
            g[i][1] = size > 0 ? -y / size : 0;
            r[i] = reach(axis, member[i]);
        }
        const long double a = g[1][0] - g[0][0], b = g[1][1] - g[0][1], c = g[2][0] - g[0][0],
                          d = g[2][1] - g[0][1], det = a * d - b * c;
        if (fabsl(det) < 1e-15L) {
            return;
        }
        const long double p = r[0] - r[1], q = r[0] - r[2];
        long double dx = (p * d - b * q) / det, dy = (a * q - p * c) / det;
        const long double step = hypotl(dx, dy), longest = reach_of_all(axis) / 4;
        if (step > longest) {
            dx *= longest / step;
            dy *= longest / step;
        }
        axis = unit(blend(blend(axis, 1, e1, dx), 1, e2, dy));
        if (step < 1e-18L) {
            break;
        }
    }
    consider(axis);
}

static void find_best(void) {
    best = 4;
    for (uint32_t i = 0; i < count; i++) {
        consider(from_vec3(centre[i]));
        for (uint32_t k = 0; k < i; k++) {
            consider_two(i, k);
            for (uint32_t l = 0; l < k; l++) {
                const uint32_t member[3] = {i, k, l};
                consider_three(member,
                               unit(blend(blend(from_vec3(centre[i]), 1, from_vec3(centre[k]), 1),
                                          1, from_vec3(centre[l]), 1)));
            }
        }
    }
}

static int32_t draw(unsigned shift) {
    return (int32_t)(check_random(&seed) >> 32) >> shift;
}

/// Caps within a random spread of a random direction; often some on one circle, repeated, or inside
/// others.
static void make_caps(void) {
    const unsigned spread = 2U + (unsigned)(check_random(&seed) % 20U);
    const int32_t x = draw(2), y = draw(2), z = draw(2);
    count = 1U + (uint32_t)(check_random(&seed) % CAPS_MOST);
    sized = check_random(&seed) % 4U != 0U;
    const unsigned radius_shift = 2U + (unsigned)(check_random(&seed) % 26U);
    for (uint32_t i = 0; i < count; i++) {
        const int32_t dx = draw(spread), dy = draw(spread), dz = draw(spread);
        centre[i] = vec3_normalise(vec3(x + dx, y + dy, z + dz));
        if (check_random(&seed) % 8U == 0U && i != 0U) {
            centre[i] = centre[i - 1U];
        }
        const uint32_t bam = (uint32_t)(check_random(&seed) >> 34) >> radius_shift;
        const bam32_t a = bam32(check_random(&seed) % 3U == 0U ? 0U : bam);
        const struct sincos s = trig_sincos(a);
        radius[i] = (struct follow_radius){a, s.sin_q30, s.cos_q30};
    }
}

static enum follow_status solve(struct follow_result *result) {
    const struct follow_input input = {
        .centre_q30 = centre, .radius = sized ? radius : NULL, .count = count};
    return follow_narrowest(&input, result);
}

static void narrowest_of_random_sets(void) {
    long double excess = 0, slack = 0, least_spread = 4;
    int64_t solved = 0, infeasible = 0, three = 0;
    for (int i = 0; i < 6000 && check_clean(); i++) {
        make_caps();
        find_best();
        struct follow_result result;
        const enum follow_status status = solve(&result);
        if (best > 1.57079632679L - 1e-6L) {
            CHECK(status == FOLLOW_INFEASIBLE || best < 1.57079632679L);
            infeasible++;
            continue;
        }
        if (!CHECK_EQ(status, FOLLOW_OK)) {
            break;
        }
        const long double got = reach_of_all(from_vec3(result.axis_q30));
        const long double told = (long double)result.half_angle.bam * rad_per_bam;
        CHECK(got <= best + 10e-9L);
        CHECK(told >= got);
        CHECK(told <= got + 9 * rad_per_bam);
        excess = fmaxl(excess, got - best);
        slack = fmaxl(slack, told - got);
        least_spread = fminl(least_spread, best);
        three += result.support_count == 3U;
        solved++;
    }
    check_note("sets solved", solved);
    check_note("with a support of three", three);
    check_note("infeasible", infeasible);
    check_note("excess over the optimum in prad, most", (int64_t)(excess * 1e12L));
    check_note("half-angle above the largest reach in prad, most", (int64_t)(slack * 1e12L));
    check_note("narrowest in nrad", (int64_t)(least_spread * 1e9L));
    CHECK(solved > 5000);
    CHECK(three > 1000);
}

/// Another order, and every warm start, right or wrong: the same cone within its accuracy.
static void order_and_warm_start_do_not_matter(void) {
    for (int i = 0; i < 5000 && check_clean(); i++) {
        make_caps();
        struct follow_result cold;
        if (solve(&cold) != FOLLOW_OK) {
            continue;
        }
        const long double reached = reach_of_all(from_vec3(cold.axis_q30));
        uint32_t warm[4];
        for (int k = 0; k < 4; k++) {
            warm[k] = (uint32_t)(check_random(&seed) % count);
        }
        const struct follow_input input = {.centre_q30 = centre,
                                           .radius = sized ? radius : NULL,
                                           .count = count,
                                           .warm = warm,
                                           .warm_count = (uint8_t)(check_random(&seed) % 5U),
                                           .pending = true};
        struct follow_input tried = input;
        tried.pending = tried.warm_count == 4U || (tried.warm_count != 0U && warm[3] % 2U == 0U);
        struct follow_result result;
        enum follow_status status = follow_narrowest(&tried, &result);
        for (int calls = 0; status == FOLLOW_UNFINISHED && calls < 50; calls++) {
            tried.warm = result.support;
            tried.warm_count = (uint8_t)(result.support_count + result.pending);
            tried.pending = result.pending;
            tried.pending_step = result.pending_step;
            const struct follow_result last = result;
            tried.warm = last.support;
            status = follow_narrowest(&tried, &result);
        }
        CHECK_EQ(status, FOLLOW_OK);
        CHECK(fabsl(reach_of_all(from_vec3(result.axis_q30)) - reached) < 10e-9L);
    }
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(narrowest_of_random_sets);
    TEST(order_and_warm_start_do_not_matter);
    return check_finish();
}
