/// cone_narrowest on random and degenerate sets, against brute force and by certificate.
///
/// Small sets (up to 12 points): feasibility by exact integers over all pairs, triples and
/// quadruples, the optimum by brute force (property/support/cone_brute.h), every sixteenth also by
/// certificate with 256-bit numbers (property/support/cone_check.h). Larger sets: by certificate.
/// COUNT=N small sets (1,200,000 unless told), SEED=N. A failure prints the set.
#include "check.h"
#include "property/support/cone_brute.h"
#include "property/support/cone_check.h"
#include "property/support/cone_sets.h"

#include "sphere/cone.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define QUARTER_RAD    1.57079632679489661923132169163975L
#define TURN64_PER_RAD (0x1p62L / QUARTER_RAD)
static uint64_t seed;
static unsigned long small_count = 1200000UL;

struct tally {
    unsigned long feasible, infeasible;
    double excess_rad_max;         // half-angles in the claimed range
    double excess_rad_max_outside; // narrower or wider
    double slack_turn64_max, support_gap_rad_max;
    uint64_t reads, points;
};

static struct tally tallies[CLASS_COUNT], large_tallies[LARGE_COUNT], huge_tallies[LARGE_COUNT];
static double reference_rad_max;
static unsigned long left_to_certificates;

static double larger(double a, double b) {
    return a > b ? a : b;
}

static void print_set(const struct vec3 *points, uint32_t count) {
    printf("  # set of %u:\n", count);
    for (uint32_t i = 0; i < count && i < 20U; i++) {
        printf("  %d %d %d\n", points[i].x, points[i].y, points[i].z);
    }
}

/// Keeps the worst excess and tells whether it is within the claim. Nearer to 90 degrees than the
/// claim reaches: the axis is within 3 nrad of one that sees all, so no point is farther than 90
/// degrees and 3 nrad.
static bool add_excess(struct tally *tally, double half_angle_rad, double excess_rad,
                       double beyond_quarter_rad) {
    if (cone_in_claimed_range(half_angle_rad)) {
        tally->excess_rad_max = larger(tally->excess_rad_max, excess_rad);
        return CHECK(excess_rad <= CONE_EXCESS_RAD_MAX);
    }
    tally->excess_rad_max_outside = larger(tally->excess_rad_max_outside, excess_rad);
    return half_angle_rad < CONE_CLAIM_FROM_RAD ? CHECK(excess_rad <= CONE_EXCESS_RAD_MAX)
                                                : CHECK(beyond_quarter_rad <= CONE_EXCESS_RAD_MAX);
}

static enum cone_status solve(const struct vec3 *points, uint32_t count, enum cone_lengths lengths,
                              struct cone_result *result) {
    static int64_t workspace[CONE_WORKSPACE_BYTES(70000) / sizeof(int64_t) + 1U];
    // Unit vectors with and without room for notes.
    const bool room = lengths == CONE_LENGTHS_ANY || count % 2U == 0U;
    const struct cone_options options = {.lengths = lengths,
                                         .workspace = workspace,
                                         .workspace_bytes =
                                             room ? CONE_WORKSPACE_BYTES(count) : 0U};
    return cone_narrowest(points, count, &options, result);
}

// ---------------------------------------------------------------- one small set

/// The printed half-angle holds every point, by long double where that is clear, else by MPFR.
static bool check_printed_angle(const struct brute *set, const struct cone_result *result,
                                long double largest_rad, struct tally *tally) {
    const double slack = (double)((long double)result->half_angle_turn64 -
                                  largest_rad * TURN64_PER_RAD); // good to 2 units
    tally->slack_turn64_max = larger(tally->slack_turn64_max, slack);
    if (slack < 8.0 &&
        !CHECK(result->half_angle_turn64 >
               cone_largest_angle_turn64(set->point, set->count, result->axis_q30))) {
        return false;
    }
    const uint64_t turn = result->half_angle_turn64;
    struct brute farthest;
    return CHECK(slack <= CONE_SLACK_TURN64_MAX) &&
           CHECK(result->half_angle_bam32.bam == (uint32_t)((turn + UINT32_MAX) >> 32)) &&
           CHECK(result->farthest_index < set->count) &&
           (brute_set(&farthest, &set->point[result->farthest_index], 1),
            CHECK(brute_largest_angle(&farthest, result->axis_q30) >= largest_rad - 0x1p-60L));
}

/// The support's own narrowest cone is as wide as that of all points.
static bool check_support(const struct brute *set, const struct cone_result *result,
                          long double half_angle_rad, struct tally *tally) {
    struct vec3 points[3];
    if (!CHECK(result->support_count >= 1U && result->support_count <= 3U)) {
        return false;
    }
    for (unsigned i = 0; i < result->support_count; i++) {
        if (!CHECK(result->support[i] < set->count)) {
            return false;
        }
        points[i] = set->point[result->support[i]];
    }
    struct brute support;
    brute_set(&support, points, result->support_count);
    bool sharp;
    const double gap = (double)(half_angle_rad - brute_half_angle(&support, &sharp));
    tally->support_gap_rad_max = larger(tally->support_gap_rad_max, gap);
    return CHECK(gap <= cone_support_gap_max((double)half_angle_rad) + BRUTE_RAD_MAX);
}

static bool check_with_brute(const struct brute *set, const struct cone_result *result,
                             long double half_angle_rad, struct tally *tally) {
    const long double largest_rad = brute_largest_angle(set, result->axis_q30);
    return add_excess(tally, (double)half_angle_rad, (double)(largest_rad - half_angle_rad),
                      (double)(largest_rad - QUARTER_RAD)) &&
           check_printed_angle(set, result, largest_rad, tally) &&
           check_support(set, result, half_angle_rad, tally);
}

/// By certificate. half_angle_rad: what brute force found, or NULL.
static bool certify(const struct vec3 *points, uint32_t count, enum cone_status status,
                    const struct cone_result *result, struct tally *tally,
                    const long double *half_angle_rad) {
    struct cone_report report;
    const char *wrong = cone_check(points, count, status, result, &report);
    if (wrong != NULL) {
        printf("  # certificate: %s\n", wrong);
    }
    if (!CHECK(wrong == NULL) || status != CONE_OK) {
        return wrong == NULL;
    }
    tally->slack_turn64_max = larger(tally->slack_turn64_max, report.slack_turn64);
    tally->support_gap_rad_max = larger(tally->support_gap_rad_max, report.support_gap_rad);
    if (half_angle_rad != NULL) {
        const double apart = fabs((double)*half_angle_rad - report.half_angle_rad);
        reference_rad_max = larger(reference_rad_max, apart);
        if (!CHECK(apart <= BRUTE_RAD_MAX)) {
            return false;
        }
    }
    return add_excess(tally, report.half_angle_rad, report.excess_rad, report.beyond_quarter_rad);
}

static bool check_small_feasible(const struct vec3 *points, uint32_t count,
                                 const struct cone_result *result, struct tally *tally,
                                 bool with_certificate) {
    struct brute set;
    bool sharp;
    brute_set(&set, points, count);
    const long double half_angle_rad = brute_half_angle(&set, &sharp);
    if (!sharp) {
        left_to_certificates++;
        return certify(points, count, CONE_OK, result, tally, NULL);
    }
    return check_with_brute(&set, result, half_angle_rad, tally) &&
           (!with_certificate || certify(points, count, CONE_OK, result, tally, &half_angle_rad));
}

static bool check_small(const struct vec3 *points, uint32_t count, enum cone_lengths lengths,
                        struct tally *tally, bool with_certificate, struct cone_result *result) {
    const bool feasible = !brute_zero_in_hull(points, count);
    const enum cone_status status = solve(points, count, lengths, result);
    tally->reads += result->point_reads;
    tally->points += count;
    *(feasible ? &tally->feasible : &tally->infeasible) += 1U;
    bool right = CHECK_EQ(status, feasible ? CONE_OK : CONE_INFEASIBLE);
    if (right && feasible) {
        right = check_small_feasible(points, count, result, tally, with_certificate);
    } else if (right) {
        right = certify(points, count, status, result, tally, NULL);
    }
    if (!right) {
        print_set(points, count);
    }
    return right;
}

// ---------------------------------------------------------------- what must not matter

/// The axis bit for bit; the half-angle may differ in what it is rounded up by.
static bool same_answer(const struct cone_result *a, const struct cone_result *b) {
    return CHECK_EQ(a->axis_q30.x, b->axis_q30.x) && CHECK_EQ(a->axis_q30.y, b->axis_q30.y) &&
           CHECK_EQ(a->axis_q30.z, b->axis_q30.z) &&
           CHECK_NEAR(a->half_angle_turn64, b->half_angle_turn64, (int64_t)CONE_SLACK_TURN64_MAX);
}

static uint32_t below(uint32_t limit) {
    return (uint32_t)((check_random(&seed) >> 32) * limit >> 32);
}

static struct vec3 scaled(struct vec3 v) {
    const int64_t size = llabs((int64_t)v.x) | llabs((int64_t)v.y) | llabs((int64_t)v.z);
    const int32_t factor = 1 + (int32_t)below((uint32_t)(INT32_MAX / (size + 1)) + 1U);
    return (int64_t)factor * size > INT32_MAX ? v : vec3(v.x * factor, v.y * factor, v.z * factor);
}

/// Another order, some points twice and, unless they must be unit vectors, other lengths: the same
/// answer.
static bool check_invariance(const struct vec3 *points, uint32_t count, enum cone_lengths lengths,
                             const struct cone_result *wanted) {
    struct vec3 other[2 * CONE_SETS_SMALL_MAX];
    const uint32_t total = count + below(count + 1U);
    for (uint32_t i = 0; i < total; i++) {
        other[i] = points[i < count ? i : below(count)];
        if (lengths == CONE_LENGTHS_ANY && below(4) != 0U) {
            other[i] = scaled(other[i]);
        }
    }
    cone_sets_shuffle(&seed, other, total);
    struct cone_result result;
    const bool right =
        CHECK_EQ(solve(other, total, lengths, &result), CONE_OK) && same_answer(&result, wanted);
    if (!right) {
        print_set(points, count);
        print_set(other, total);
    }
    return right;
}

// ---------------------------------------------------------------- the tests

static void small_set(enum cone_class class, unsigned long number) {
    struct vec3 points[CONE_SETS_SMALL_MAX];
    const uint32_t count = cone_sets_draw(class, &seed, points);
    struct tally *tally = &tallies[class];
    const bool with_certificate = number % 16U == 0U;
    struct cone_result result, unit_result;
    if (!check_small(points, count, CONE_LENGTHS_ANY, tally, with_certificate, &result)) {
        return;
    }
    const bool feasible = result.witness_count == 0U;
    if (number % 8U == 1U && feasible &&
        !check_invariance(points, count, CONE_LENGTHS_ANY, &result)) {
        return;
    }
    bool all_unit = true;
    for (uint32_t i = 0; i < count; i++) {
        all_unit = all_unit && cone_sets_is_unit(points[i]);
    }
    if (all_unit && feasible) {
        // The promise saves the copies, and changes nothing else.
        if (CHECK_EQ(solve(points, count, CONE_LENGTHS_UNIT, &unit_result), CONE_OK) &&
            same_answer(&unit_result, &result) && number % 8U == 2U) {
            check_invariance(points, count, CONE_LENGTHS_UNIT, &result);
        }
    } else if (number % 4U == 3U) {
        for (uint32_t i = 0; i < count; i++) {
            points[i] = cone_sets_normalise(points[i]);
        }
        check_small(points, count, CONE_LENGTHS_UNIT, tally, with_certificate, &unit_result);
    }
}

static void small_sets(void) {
    for (unsigned long i = 0; i < small_count && check_clean(); i++) {
        small_set((enum cone_class)(i % CLASS_COUNT), i / CLASS_COUNT);
    }
    printf(
        "# brute force against certificates: half-angles differ by at most %.1e rad; %lu sets left "
        "to certificates\n",
        reference_rad_max, left_to_certificates);
}

/// Of the 26 directions with components -1, 0, 1.
static void every_set_of_up_to_five(void) {
    static struct tally tally;
    for (uint32_t set = 1; set < UINT32_C(1) << 26 && check_clean(); set++) {
        struct vec3 points[5];
        struct cone_result result;
        const uint32_t count = cone_sets_of_bits(set, 5, points);
        if (count != 0U) {
            cone_sets_shuffle(&seed, points, count);
            check_small(points, count, CONE_LENGTHS_ANY, &tally, false, &result);
        }
    }
    printf("# small integers: %lu feasible, %lu infeasible, excess %.3f nrad\n", tally.feasible,
           tally.infeasible, tally.excess_rad_max * 1e9);
}

/// Vectors that are no unit vectors, zero among them, though CONE_LENGTHS_UNIT promised: any
/// answer, but an answer.
static void a_broken_promise_ends(void) {
    unsigned answers = 0;
    for (unsigned i = 0; i < 60000U; i++) {
        struct vec3 points[CONE_SETS_SMALL_MAX];
        struct cone_result result;
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        if (i % 7U == 0U) {
            points[below(count)] = vec3(0, 0, 0);
        }
        const struct cone_options options = {.lengths = CONE_LENGTHS_UNIT};
        const enum cone_status status = cone_narrowest(points, count, &options, &result);
        answers +=
            status == CONE_OK || status == CONE_INFEASIBLE || status == CONE_ERROR_ZERO_VECTOR;
    }
    CHECK_EQ(answers, 60000);
}

static struct vec3 large[70000];

static bool large_set(enum cone_large_class class, uint32_t count, enum cone_lengths lengths,
                      struct tally *tally) {
    cone_sets_draw_large(class, &seed, large, count);
    for (uint32_t i = 0; lengths == CONE_LENGTHS_UNIT && i < count; i++) {
        large[i] = cone_sets_normalise(large[i]);
    }
    struct cone_result result;
    const enum cone_status status = solve(large, count, lengths, &result);
    tally->reads += result.point_reads;
    tally->points += count;
    *(status == CONE_OK ? &tally->feasible : &tally->infeasible) += 1U;
    bool right = certify(large, count, status, &result, tally, NULL);
    if (right && status == CONE_OK) {
        struct cone_result other;
        cone_sets_shuffle(&seed, large, count);
        right =
            CHECK_EQ(solve(large, count, lengths, &other), CONE_OK) && same_answer(&other, &result);
    }
    if (!right) {
        printf("  # %s of %u points\n", cone_large_class_names[class], count);
        print_set(large, count);
    }
    return right;
}

static void larger_sets(void) {
    const unsigned long sets = 3000UL + small_count / 1000UL;
    for (unsigned long i = 0; i < sets && check_clean(); i++) {
        const uint32_t count = 13U + below(1U << (5U + below(7)));
        large_set((enum cone_large_class)(i % LARGE_COUNT), count < 2000U ? count : 2000U,
                  i % 2U == 0U ? CONE_LENGTHS_ANY : CONE_LENGTHS_UNIT,
                  &large_tallies[i % LARGE_COUNT]);
    }
}

static void sets_of_65000(void) {
    for (unsigned class = 0; class < LARGE_COUNT && check_clean(); class ++) {
        large_set((enum cone_large_class) class, 65000, CONE_LENGTHS_UNIT, &huge_tallies[class]);
    }
}

static void errors_are_named(void) {
    const struct vec3 points[] = {vec3(1, 2, 3), vec3(0, 0, 0), vec3(0, 0, 0)};
    struct cone_result result;
    int64_t workspace[CONE_WORKSPACE_BYTES(1) / sizeof(int64_t) + 1U];
    CHECK_EQ(solve(points, 0, CONE_LENGTHS_ANY, &result), CONE_EMPTY);
    CHECK_EQ(solve(points, 0, CONE_LENGTHS_UNIT, &result), CONE_EMPTY);
    CHECK_EQ(solve(points, 3, CONE_LENGTHS_ANY, &result), CONE_ERROR_ZERO_VECTOR);
    CHECK_EQ(result.bad_index, 1);
    struct cone_options options = {.workspace = workspace,
                                   .workspace_bytes = CONE_WORKSPACE_BYTES(1) - 1U};
    CHECK_EQ(cone_narrowest(points, 1, &options, &result), CONE_ERROR_WORKSPACE);
    options.workspace_bytes++;
    CHECK_EQ(cone_narrowest(points, 1, &options, &result), CONE_OK);
}

static void print_tallies(const struct tally *tally, const char *const *names, unsigned count) {
    printf("# %-18s %9s %10s %12s %12s %12s %11s %7s\n", "class", "feasible", "infeasible",
           "excess nrad", "(elsewhere)", "slack 2^-64", "gap rad", "reads/n");
    for (unsigned i = 0; i < count; i++) {
        const struct tally *t = &tally[i];
        printf("# %-18s %9lu %10lu %12.3f %12.3g %12.0f %11.1e %7.2f\n", names[i], t->feasible,
               t->infeasible, t->excess_rad_max * 1e9, t->excess_rad_max_outside * 1e9,
               t->slack_turn64_max, t->support_gap_rad_max,
               t->points != 0U ? (double)t->reads / (double)t->points : 0.0);
    }
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    const uint64_t first_seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19650917U;
    small_count = count_text != NULL ? strtoul(count_text, NULL, 0) : small_count;
    printf("# seed %llu, %lu small sets\n", (unsigned long long)first_seed, small_count);
    seed = first_seed;
    TEST(small_sets);
    TEST(every_set_of_up_to_five);
    TEST(larger_sets);
    TEST(sets_of_65000);
    TEST(a_broken_promise_ends);
    TEST(errors_are_named);
    printf("# sets of 1 to 12 points\n");
    print_tallies(tallies, cone_class_names, CLASS_COUNT);
    printf("# sets of 13 to 2,000 points\n");
    print_tallies(large_tallies, cone_large_class_names, LARGE_COUNT);
    printf("# sets of 65,000 points\n");
    print_tallies(huge_tallies, cone_large_class_names, LARGE_COUNT);
    cone_check_free();
    return check_finish();
}
