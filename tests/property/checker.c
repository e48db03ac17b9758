/// The checkers of support/ notice wrong answers: each fault that an answer can have is planted.
#include "check.h"
#include "property/support/cone_brute.h"
#include "property/support/cone_check.h"
#include "property/support/cone_sets.h"
#include "property/support/exact.h"

#include <stdio.h>
#include <string.h>

static struct cone_report report;

/// A square pyramid, its diagonals equal: three or two of its edges support the cone.
static const struct vec3 pyramid[] = {{1, 1, 2}, {-1, 1, 2}, {-1, -1, 2}, {1, -1, 2}, {0, 0, 5}};

/// The right answer, put together by hand: the axis is z, the half-angle atan(sqrt(1/2)).
static struct cone_result pyramid_answer(void) {
    struct cone_result answer = {
        .axis_q30 = {0, 0, Q30_ONE}, .farthest_index = 1, .support_count = 2, .support = {0, 2}};
    answer.half_angle_turn64 = cone_largest_angle_turn64(pyramid, 5, answer.axis_q30) + 1U;
    answer.half_angle_bam32 = bam32((uint32_t)(answer.half_angle_turn64 >> 32) + 1U);
    return answer;
}

static const char *check(const struct cone_result *answer) {
    return cone_check(pyramid, 5, CONE_OK, answer, &report);
}

static bool says(const char *got, const char *part) {
    if (got == NULL || strstr(got, part) == NULL) {
        printf("  # said '%s', not '%s'\n", got == NULL ? "right" : got, part);
        return false;
    }
    return true;
}

static void a_right_answer_passes(void) {
    struct cone_result answer = pyramid_answer();
    CHECK(check(&answer) == NULL);
    CHECK(report.excess_rad < 1e-60);
    CHECK(report.half_angle_rad == 0.61547970867038734); // atan(sqrt(1/2))
    answer.support_count = 3;
    answer.support[1] = 1;
    answer.support[2] = 3;
    CHECK(check(&answer) == NULL);
}

static void a_wrong_angle_is_noticed(void) {
    struct cone_result answer = pyramid_answer();
    answer.half_angle_turn64 -= 1U;
    CHECK(says(check(&answer), "too small"));
    answer = pyramid_answer();
    answer.half_angle_turn64 += (uint64_t)CONE_SLACK_TURN64_MAX;
    CHECK(says(check(&answer), "larger than claimed"));
    answer = pyramid_answer();
    answer.half_angle_bam32.bam--;
    CHECK(says(check(&answer), "half_angle_bam32"));
    answer = pyramid_answer();
    answer.farthest_index = 4;
    CHECK(says(check(&answer), "farthest"));
    answer.farthest_index = 5;
    CHECK(says(check(&answer), "farthest"));
}

static void a_wrong_axis_is_noticed(void) {
    struct cone_result answer = pyramid_answer();
    answer.axis_q30.z += 2;
    CHECK(says(check(&answer), "unit length"));
    answer = pyramid_answer();
    answer.axis_q30.x = 5; // toward the edges 0 and 3, so 1 is the farthest
    answer.half_angle_turn64 = cone_largest_angle_turn64(pyramid, 5, answer.axis_q30) + 1U;
    answer.half_angle_bam32 = bam32((uint32_t)(answer.half_angle_turn64 >> 32) + 1U);
    CHECK(check(&answer) == NULL); // a true cone, but not the narrowest
    CHECK(report.excess_rad > CONE_EXCESS_RAD_MAX);
    CHECK(report.excess_rad < 5e-9);
}

static void a_wrong_support_is_noticed(void) {
    struct cone_result answer = pyramid_answer();
    answer.support[1] = 1; // two neighbours
    CHECK(says(check(&answer), "outside the support"));
    CHECK(report.half_angle_rad == 0.61547970867038734); // found all the same
    answer = pyramid_answer();
    answer.support_count = 0;
    CHECK(says(check(&answer), "one to three"));
    answer = pyramid_answer();
    answer.support[1] = 5;
    CHECK(says(check(&answer), "not there"));
    answer = pyramid_answer();
    answer.support[0] = 2;
    answer.support[1] = 0;
    CHECK(says(check(&answer), "ascending"));
    const struct vec3 repeated[] = {{1, 1, 2}, {2, 2, 4}, {-1, -1, 2}};
    answer = pyramid_answer();
    answer.support_count = 3;
    answer.support[1] = 1;
    answer.support[2] = 2;
    CHECK(says(cone_check(repeated, 3, CONE_OK, &answer, &report), "twice"));
}

static void a_wrong_verdict_is_noticed(void) {
    struct cone_result answer = pyramid_answer();
    CHECK(says(cone_check(pyramid, 5, CONE_INFEASIBLE, &answer, &report), "one to four"));
    CHECK(says(cone_check(pyramid, 5, CONE_EMPTY, &answer, &report), "status"));
    // Zero is on the border of the hull of the first three.
    const struct vec3 border[] = {{3, 0, 0}, {-1, 2, 0}, {-1, -1, 0}, {0, 0, 7}, {1, 1, 9}};
    answer =
        (struct cone_result){.axis_q30 = {0, 0, Q30_ONE}, .support_count = 3, .support = {0, 1, 2}};
    CHECK(says(cone_check(border, 5, CONE_OK, &answer, &report), "called feasible"));
    CHECK(brute_zero_in_hull(border, 5));
    answer.support[2] = 3;
    CHECK(says(cone_check(border, 5, CONE_OK, &answer, &report), "called feasible"));
    // One unit to the front, and it is feasible indeed.
    const struct vec3 beside[] = {{3, 0, 0}, {-1, 2, 0}, {-1, -1, 1}, {0, 0, 7}, {1, 1, 9}};
    CHECK(!brute_zero_in_hull(beside, 5));
    CHECK(says(cone_check(beside, 5, CONE_OK, &answer, &report), "too small")); // no angle given
}

static void a_wrong_witness_is_noticed(void) {
    const struct vec3 points[] = {{3, 0, 0},  {-1, 2, 0}, {-1, -1, 0}, {0, 0, 7},
                                  {0, 0, -1}, {1, 1, 1},  {-2, -2, -3}};
    const uint32_t three[] = {0, 1, 2}, two[] = {3, 4}, four[] = {0, 1, 2, 3}, both[] = {0, 3, 4},
                   neither[] = {0, 1, 3, 5}, twice[] = {3, 3}, descending[] = {4, 3},
                   beyond[] = {3, 7}, space[] = {0, 1, 5, 6};
    CHECK(exact_check_witness(points, 7, three, 3) == NULL);
    CHECK(exact_check_witness(points, 7, two, 2) == NULL);
    CHECK(says(exact_check_witness(points, 7, three, 2), "not in the hull"));
    CHECK(says(exact_check_witness(points, 7, neither, 4), "not in the hull"));
    CHECK(says(exact_check_witness(points, 7, four, 4), "no use"));
    CHECK(says(exact_check_witness(points, 7, both, 3), "no use"));
    CHECK(says(exact_check_witness(points, 7, twice, 2), "ascending"));
    CHECK(says(exact_check_witness(points, 7, descending, 2), "ascending"));
    CHECK(says(exact_check_witness(points, 7, beyond, 2), "not there"));
    CHECK(says(exact_check_witness(points, 7, two, 0), "one to four"));
    CHECK(says(exact_check_witness(points, 7, space, 4), "not in the hull"));
    const struct vec3 tetrahedron[] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    const uint32_t all[] = {0, 1, 2, 3};
    CHECK(exact_check_witness(tetrahedron, 4, all, 4) == NULL);
}

/// The fast reference and the certificate know nothing of each other.
static void brute_force_agrees_with_exact_integers(void) {
    uint64_t random = 271828;
    for (unsigned i = 0; i < 20000U && check_clean(); i++) {
        struct vec3 p[CONE_SETS_SMALL_MAX];
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &random, p);
        for (uint32_t k = 0; k + 2U < count; k++) {
            CHECK_EQ(brute_det_sign(p[k], p[k + 1U], p[k + 2U]),
                     exact_det_sign(p[k], p[k + 1U], p[k + 2U]));
            CHECK_EQ(brute_parallel(p[k], p[k + 1U]),
                     exact_parallel(p[k], p[k + 1U]) ? exact_dot_sign(p[k], p[k + 1U]) : 0);
        }
        // All subsets of four, by the check of witnesses.
        const uint32_t n = count < 4U ? count : 4U;
        const uint32_t all[] = {0, 1, 2, 3};
        const char *wrong = exact_check_witness(p, n, all, n);
        CHECK_EQ(brute_zero_in_hull(p, n), wrong == NULL || strstr(wrong, "no use") != NULL);
    }
}

int main(void) {
    TEST(a_right_answer_passes);
    TEST(a_wrong_angle_is_noticed);
    TEST(a_wrong_axis_is_noticed);
    TEST(a_wrong_support_is_noticed);
    TEST(a_wrong_verdict_is_noticed);
    TEST(a_wrong_witness_is_noticed);
    TEST(brute_force_agrees_with_exact_integers);
    cone_check_free();
    return check_finish();
}
