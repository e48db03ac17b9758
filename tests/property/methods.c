/// The methods of the narrowest cone against each other, brute force and certificates.
///
/// Small sets: brute force over all pairs and triples, in exact integers and roots
/// (support/exact_roots.h), says which supports are right; each method has to name one of them, or
/// a witness where support/cone_brute.h finds the viewpoint surrounded. Every answer is checked by
/// the independent checker (support/cone_check.h). Scaling, permuting and repeating the points
/// change nothing. COUNT=N small sets, SEED=N.
#include "property/support/methods.h"
#include "check.h"
#include "property/support/cone_brute.h"
#include "property/support/cone_check.h"
#include "property/support/cone_sets.h"
#include "property/support/exact.h"
#include "property/support/exact_roots.h"
#include "vectors/cones/table.h"

#include "sphere/certify.h"

#include "sphere/shrink.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static unsigned long small_count = 9000UL;
static double excess_rad_max;

static uint32_t below(uint32_t limit) {
    return (uint32_t)((check_random(&seed) >> 32) * limit >> 32);
}

static void print_set(const char *method, const struct vec3 *points, uint32_t count) {
    printf("  # %s, set of %u:\n", method, count);
    for (uint32_t i = 0; i < count && i < 24U; i++) {
        printf("  %d %d %d\n", points[i].x, points[i].y, points[i].z);
    }
}

/// The independent checker's verdict on one answer.
static bool check_certificate(const struct vec3 *points, uint32_t count, enum cone_status status,
                              const struct cone_result *result) {
    struct cone_report report;
    const char *wrong = cone_check(points, count, status, result, &report);
    if (wrong != NULL) {
        printf("  # certificate: %s\n", wrong);
    }
    if (!CHECK(wrong == NULL) || status != CONE_OK) {
        return wrong == NULL;
    }
    if (!cone_in_claimed_range(report.half_angle_rad) &&
        report.half_angle_rad > CONE_CLAIM_FROM_RAD) {
        return CHECK(report.beyond_quarter_rad <= CONE_EXCESS_RAD_MAX);
    }
    excess_rad_max = report.excess_rad > excess_rad_max ? report.excess_rad : excess_rad_max;
    return CHECK(report.excess_rad <= CONE_EXCESS_RAD_MAX);
}

/// Two answers to one question: the axes are those of exact supports, rounded, and differ by a unit
/// at most. Near 90 degrees, where any axis that sees all points is right, only the half-angles are
/// alike.
static bool alike(const struct cone_result *a, const struct cone_result *b) {
    const int64_t quarter = (int64_t)1 << 62, band = (int64_t)1 << 32;
    const int64_t from_quarter = (int64_t)a->half_angle_turn64 - quarter;
    if (from_quarter < -band) {
        CHECK_NEAR(a->axis_q30.x, b->axis_q30.x, 1);
        CHECK_NEAR(a->axis_q30.y, b->axis_q30.y, 1);
        CHECK_NEAR(a->axis_q30.z, b->axis_q30.z, 1);
    }
    // 3 nrad
    return CHECK_NEAR(a->half_angle_turn64, b->half_angle_turn64, INT64_C(8807000000));
}

// ---------------------------------------------------------------- brute force

/// Does some set of up to three points hold the narrowest cone? *is_named: the named one does.
static bool brute_supports(const struct vec3 *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = i; j < count; j++) {
            for (uint32_t k = j; k < count; k++) {
                const uint32_t support[3] = {i, j, k};
                const unsigned size = i == k ? 1U : (i == j || j == k) ? 2U : 3U;
                const uint32_t *first = i == j ? support + 1 : support;
                if (exact_holds_cone(points, count, size == 1U ? support : first, size)) {
                    return true;
                }
            }
        }
    }
    return false;
}

static bool check_small(const struct vec3 *points, uint32_t count, bool with_brute,
                        struct cone_result *results) {
    const bool feasible = !brute_zero_in_hull(points, count);
    bool right = !with_brute || CHECK_EQ(brute_supports(points, count), feasible);
    for (unsigned m = 0; right && m < METHOD_COUNT; m++) {
        struct cone_result *result = &results[m];
        const enum cone_status status = methods[m].solve(points, count, result);
        right = CHECK_EQ(status, feasible ? CONE_OK : CONE_INFEASIBLE) &&
                check_certificate(points, count, status, result);
        if (right && feasible) {
            right = (!methods[m].exact || CHECK(exact_holds_cone(points, count, result->support,
                                                                 result->support_count))) &&
                    alike(result, &results[0]);
        }
        if (!right) {
            print_set(methods[m].name, points, count);
        }
    }
    return right;
}

// ---------------------------------------------------------------- what must not matter

static struct vec3 scaled(struct vec3 v) {
    const int64_t size = llabs((int64_t)v.x) | llabs((int64_t)v.y) | llabs((int64_t)v.z);
    const int32_t factor = 1 + (int32_t)below((uint32_t)(INT32_MAX / (size + 1)) + 1U);
    return (int64_t)factor * size > INT32_MAX ? v : vec3(v.x * factor, v.y * factor, v.z * factor);
}

static void check_invariance(const struct vec3 *points, uint32_t count,
                             const struct cone_result *wanted) {
    struct vec3 other[2 * CONE_SETS_SMALL_MAX];
    const uint32_t total = count + below(count + 1U);
    for (uint32_t i = 0; i < total; i++) {
        other[i] = scaled(points[i < count ? i : below(count)]);
    }
    cone_sets_shuffle(&seed, other, total);
    for (unsigned m = 0; m < METHOD_COUNT; m++) {
        struct cone_result result;
        if (!CHECK_EQ(methods[m].solve(other, total, &result), CONE_OK) ||
            !alike(&result, &wanted[m])) {
            print_set(methods[m].name, points, count);
            print_set(methods[m].name, other, total);
        }
    }
}

// ---------------------------------------------------------------- the tests

static void small_sets(void) {
    unsigned long feasible = 0;
    for (unsigned long i = 0; i < small_count && check_clean(); i++) {
        struct vec3 points[CONE_SETS_SMALL_MAX];
        struct cone_result results[METHOD_COUNT];
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        if (check_small(points, count, i / CLASS_COUNT % 4U == 0U, results) &&
            results[0].witness_count == 0U) {
            feasible++;
            if (i / CLASS_COUNT % 4U == 1U) {
                check_invariance(points, count, results);
            }
        }
    }
    printf("# %lu of %lu sets feasible\n", feasible, small_count);
    CHECK(small_count < 1000UL || (feasible > small_count / 4U && feasible < small_count));
}

/// Of the 26 directions with components -1, 0, 1; of the sets of four every fourth.
static void every_set_of_up_to_three(void) {
    for (uint32_t set = 1; set < UINT32_C(1) << 26 && check_clean(); set++) {
        struct vec3 points[4];
        struct cone_result results[METHOD_COUNT];
        const uint32_t count = cone_sets_of_bits(set, 4, points);
        if (count != 0U && (count < 4U || below(4) == 0U)) {
            cone_sets_shuffle(&seed, points, count);
            check_small(points, count, set % 32U == 0U, results);
        }
    }
}

static void larger_sets(void) {
    static struct vec3 points[METHODS_COUNT_MAX];
    for (unsigned i = 0; i < 100U && check_clean(); i++) {
        const uint32_t count = 13U + below(i % 10U == 0U ? 587U : 90U);
        cone_sets_draw_large((enum cone_large_class)(i % LARGE_COUNT), &seed, points, count);
        struct cone_result first, result;
        const enum cone_status wanted = methods[0].solve(points, count, &first);
        for (unsigned m = 0; m < METHOD_COUNT; m++) {
            const enum cone_status status = methods[m].solve(points, count, &result);
            if (!CHECK_EQ(status, wanted) || !check_certificate(points, count, status, &result) ||
                (status == CONE_OK && !alike(&result, &first))) {
                printf("  # %s, class %s, %u points\n", methods[m].name,
                       cone_large_class_names[i % LARGE_COUNT], count);
            }
        }
    }
}

static void recorded_sets(void) {
    for (size_t i = 0; i < CONE_VECTOR_COUNT; i++) {
        const struct cone_vector *vector = &cone_vectors[i];
        const struct vec3 *points = &cone_vector_points[vector->first];
        const bool feasible = !vec3_is_zero(vector->axis_q30);
        for (unsigned m = 0; m < METHOD_COUNT; m++) {
            struct cone_result result;
            const enum cone_status status = methods[m].solve(points, vector->count, &result);
            if (!CHECK_EQ(status, feasible ? CONE_OK : CONE_INFEASIBLE) ||
                !check_certificate(points, vector->count, status, &result) ||
                (feasible && (!CHECK_NEAR(result.axis_q30.x, vector->axis_q30.x, 1) ||
                              !CHECK_NEAR(result.axis_q30.y, vector->axis_q30.y, 1) ||
                              !CHECK_NEAR(result.axis_q30.z, vector->axis_q30.z, 1)))) {
                printf("  # %s: %s\n", methods[m].name, vector->name);
            }
        }
    }
}

/// What proves an answer does not prove a wrong one.
static void certificates_refuse(void) {
    unsigned refused = 0, proved = 0;
    for (unsigned i = 0; i < 20000U && check_clean(); i++) {
        struct vec3 points[CONE_SETS_SMALL_MAX];
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        const uint32_t support[3] = {below(count), below(count), below(count)};
        const unsigned size = 1U + below(3);
        const bool holds = exact_holds_cone(points, count, support, size);
        CHECK_EQ(certify_support(points, count, support, size), holds);
        refused += !holds;
        proved += holds;
        const uint32_t four[4] = {support[0], support[1], support[2], below(count)};
        if (four[0] < four[1] && four[1] < four[2] && four[2] < four[3]) {
            CHECK_EQ(certify_witness(points, four, 4),
                     exact_check_witness(points, count, four, 4) == NULL &&
                         exact_det_sign(points[four[0]], points[four[1]], points[four[2]]) != 0);
        }
    }
    CHECK(refused > 1000U && proved > 100U);
}

static void errors_are_named(void) {
    const struct vec3 points[] = {{1, 2, 3}, {0, 0, 0}};
    for (unsigned m = 0; m < METHOD_COUNT; m++) {
        struct cone_result result;
        CHECK_EQ(methods[m].solve(points, 0, &result), CONE_EMPTY);
        CHECK_EQ(methods[m].solve(points, 2, &result), CONE_ERROR_ZERO_VECTOR);
        CHECK_EQ(result.bad_index, 1);
    }
    methods_check_capacities();
}

/// The quadratic case of algorithm C: points exactly on one circle (Pythagorean triples) cost it a
/// circle for every two of them, so n^2 reads in all. Rounded to Q1.30 they would not: that breaks
/// the ties.
static void algorithm_c_is_quadratic(void) {
    static struct vec3 points[800];
    static int64_t workspace[SHRINK_WORKSPACE_BYTES(800) / sizeof(int64_t) + 1U];
    for (uint32_t n = 100; n <= 800U; n *= 2U) {
        for (uint32_t i = 0; i < n; i++) {
            const double half_turn = 3.14159265358979323846 * (i + 0.5) / n;
            const int64_t p = lround(32700 * cos(half_turn)), q = lround(32700 * sin(half_turn));
            points[i] =
                vec3((int32_t)(p * p - q * q), (int32_t)(2 * p * q), (int32_t)(p * p + q * q));
        }
        struct shrink_result result;
        CHECK_EQ(shrink_narrowest(points, n, workspace, sizeof workspace, &result), CONE_OK);
        CHECK_EQ(result.hull_size, n);
        CHECK_EQ(result.iterations, n / 2U - 1U);
        CHECK(result.corner_reads > (uint64_t)n * n / 3U);
    }
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19820101U;
    small_count = count_text != NULL ? strtoul(count_text, NULL, 0) : small_count;
    printf("# seed %llu, %lu small sets\n", (unsigned long long)seed, small_count);
    TEST(errors_are_named);
    TEST(recorded_sets);
    TEST(small_sets);
    TEST(every_set_of_up_to_three);
    TEST(larger_sets);
    TEST(certificates_refuse);
    TEST(algorithm_c_is_quadratic);
    printf("# worst excess %.3f nrad\n", excess_rad_max * 1e9);
    exact_roots_free();
    cone_check_free();
    return check_finish();
}
