/// cone_narrowest on recorded sets whose exact cones are known, and on the examples that decide
/// between the papers and their corrections. Integers only: runs on boards, too.
/// tests/property/cone_cases.c checks the same and the larger recorded sets in 256-bit numbers.
#include "check.h"
#include "vectors/cones/table.h"

#include "fixed/trig.h"
#include "sphere/cone.h"

/// 3 nrad, the accuracy that cone.h claims, in units of 2^-64 turn; and its rounding up.
#define EXCESS_TURN64_MAX (UINT64_C(8807671509) + (UINT64_C(1) << 14))

static int64_t workspace[CONE_WORKSPACE_BYTES(CONE_VECTOR_POINTS_MAX) / sizeof(int64_t) + 1U];

static enum cone_status solve(const struct vec3 *points, uint32_t count,
                              struct cone_result *result) {
    const struct cone_options options = {.workspace = workspace,
                                         .workspace_bytes = CONE_WORKSPACE_BYTES(count)};
    return cone_narrowest(points, count, &options, result);
}

/// Angle from the axis to a point, 2^64 units a turn; rounded down with the length of the product.
static uint64_t angle_turn64(struct vec3 axis_q30, struct vec3 point) {
    const uint64_t across = vec3_i64_length(vec3_cross(axis_q30, point));
    const struct i128 ahead = vec3_dot(axis_q30, point);
    const bool behind = i128_sign(ahead) < 0;
    const uint64_t size = behind ? 0U - ahead.lo : ahead.lo; // below 2^63
    const uint64_t acute = trig_atan2_turn64(across, size);
    return behind ? (UINT64_C(1) << 63) - acute : acute;
}

static bool holds_all(const struct vec3 *points, uint32_t count, const struct cone_result *result) {
    for (uint32_t i = 0; i < count; i++) {
        if (!CHECK(angle_turn64(result->axis_q30, points[i]) <= result->half_angle_turn64)) {
            return false;
        }
    }
    return true;
}

/// The support alone has the same cone.
static bool support_suffices(const struct vec3 *points, const struct cone_result *result) {
    struct vec3 support[3];
    struct cone_result alone;
    for (uint8_t i = 0; i < result->support_count; i++) {
        support[i] = points[result->support[i]];
    }
    return CHECK_EQ(solve(support, result->support_count, &alone), CONE_OK) &&
           CHECK_EQ(alone.support_count, result->support_count) &&
           CHECK_NEAR(alone.half_angle_turn64, result->half_angle_turn64,
                      (int64_t)EXCESS_TURN64_MAX);
}

/// The solver's witnesses are minimal: two opposite points, three around zero in one plane, or four
/// of which each triple has the fourth on the other side.
static bool is_witness(const struct vec3 *points, const struct cone_result *result) {
    const uint32_t *w = result->witness;
    if (result->witness_count == 4U) {
        const struct vec3 a = points[w[0]], b = points[w[1]], c = points[w[2]], d = points[w[3]];
        const int side = vec3_det_sign(a, b, c);
        return side != 0 && vec3_det_sign(a, b, d) == -side && vec3_det_sign(a, c, d) == side &&
               vec3_det_sign(b, c, d) == -side;
    }
    if (result->witness_count == 3U) {
        const struct vec3 a = points[w[0]], b = points[w[1]], c = points[w[2]];
        const struct vec3_i64 ab = vec3_cross(a, b), bc = vec3_cross(b, c), ca = vec3_cross(c, a);
        return vec3_det_sign(a, b, c) == 0 && (ab.x < 0) == (bc.x < 0) &&
               (ab.x < 0) == (ca.x < 0) && (ab.y < 0) == (bc.y < 0) && (ab.y < 0) == (ca.y < 0) &&
               (ab.z < 0) == (bc.z < 0) && (ab.z < 0) == (ca.z < 0) && (ab.x | ab.y | ab.z) != 0 &&
               (bc.x | bc.y | bc.z) != 0 && (ca.x | ca.y | ca.z) != 0;
    }
    const struct vec3_i64 normal = vec3_cross(points[w[0]], points[w[1]]);
    return result->witness_count == 2U && (normal.x | normal.y | normal.z) == 0 &&
           i128_sign(vec3_dot(points[w[0]], points[w[1]])) < 0;
}

static bool check_vector(const struct cone_vector *vector) {
    const struct vec3 *points = &cone_vector_points[vector->first];
    struct cone_result result;
    const enum cone_status status = solve(points, vector->count, &result);
    if (vec3_is_zero(vector->axis_q30)) {
        return CHECK_EQ(status, CONE_INFEASIBLE) && CHECK(is_witness(points, &result));
    }
    // The axis is the exact one, rounded, but for the last bit.
    return CHECK_EQ(status, CONE_OK) && CHECK_NEAR(result.axis_q30.x, vector->axis_q30.x, 1) &&
           CHECK_NEAR(result.axis_q30.y, vector->axis_q30.y, 1) &&
           CHECK_NEAR(result.axis_q30.z, vector->axis_q30.z, 1) &&
           CHECK(result.half_angle_turn64 > vector->half_angle_turn64) &&
           CHECK(result.half_angle_turn64 <= vector->half_angle_turn64 + EXCESS_TURN64_MAX) &&
           holds_all(points, vector->count, &result) && support_suffices(points, &result);
}

static void recorded_sets(void) {
    for (size_t i = 0; i < CONE_VECTOR_COUNT; i++) {
        if (!check_vector(&cone_vectors[i])) {
            check_note(cone_vectors[i].name, (int64_t)i);
        }
    }
}

static uint64_t half_angle_of(const struct vec3 *points, uint32_t count, struct vec3 axis) {
    struct cone_result result;
    if (CHECK_EQ(solve(points, count, &result), CONE_OK)) {
        const struct vec3 wanted = vec3_normalise(axis);
        CHECK_NEAR(result.axis_q30.x, wanted.x, 1);
        CHECK_NEAR(result.axis_q30.y, wanted.y, 1);
        CHECK_NEAR(result.axis_q30.z, wanted.z, 1);
        holds_all(points, count, &result);
    }
    return result.half_angle_turn64;
}

static void centres_of_known_sets(void) {
    // Shrinking as printed starts wrong and ends on too large a circle.
    const struct vec3 four[] = {{0, 3, 4}, {3, 0, 4}, {0, -3, 4}, {-4, 0, 3}};
    uint64_t half_angle = half_angle_of(four, 4, vec3(-1, 0, 7));
    // Cosine squared 1/2: one eighth of a turn.
    CHECK_NEAR(half_angle, UINT64_C(1) << 61, (int64_t)EXCESS_TURN64_MAX);
    // Three contacts; cosine squared 289 / (11 * 41).
    const struct vec3 tilted[] = {{4, 3, 4}, {2, -1, 6}, {-3, 4, 4}, {3, 4, 4}};
    half_angle = half_angle_of(tilted, 4, vec3(1, 7, 15));
    CHECK_NEAR(half_angle, UINT64_C(1886807050084104448), (int64_t)EXCESS_TURN64_MAX);
    const struct vec3 arc[] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    half_angle = half_angle_of(arc, 3, vec3(1, 1, 0));
    CHECK_NEAR(half_angle, UINT64_C(1) << 61, (int64_t)EXCESS_TURN64_MAX);
}

static void one_and_two_directions(void) {
    const struct vec3 one[] = {{0, 0, INT32_MIN}, {0, 0, -1}, {0, 0, -77}};
    struct cone_result result;
    CHECK_EQ(solve(one, 3, &result), CONE_OK);
    CHECK(vec3_equal(result.axis_q30, vec3(0, 0, -Q30_ONE)));
    CHECK(result.half_angle_turn64 < UINT64_C(1) << 14);
    CHECK_EQ(result.support_count, 1);
    const struct vec3 two[] = {{5, 0, 0}, {0, 12, 0}};
    CHECK_NEAR(half_angle_of(two, 2, vec3(1, 1, 0)), UINT64_C(1) << 61, (int64_t)EXCESS_TURN64_MAX);
}

static void surrounded_viewpoints(void) {
    struct cone_result result;
    // All in a closed half-space, none in an open one.
    const struct vec3 flat[] = {{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    CHECK_EQ(solve(flat, 3, &result), CONE_INFEASIBLE);
    CHECK(is_witness(flat, &result));
    const struct vec3 half[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 1}, {-1, 0, -1}, {0, -1, 0}};
    CHECK_EQ(solve(half, 5, &result), CONE_INFEASIBLE);
    CHECK(is_witness(half, &result));
    // Minus the sum of two edges of a pyramid: inside the opposite pyramid's border.
    const struct vec3 opposite[] = {{3, 1, 4}, {-1, 5, 9}, {2, -6, 5}, {-2, -6, -13}};
    CHECK_EQ(solve(opposite, 4, &result), CONE_INFEASIBLE);
    CHECK(is_witness(opposite, &result));
    CHECK_EQ(result.witness_count, 3);
    // One unit to the front, at the end of the range: feasible.
    const struct vec3 beside[] = {{INT32_MAX, 0, 0}, {INT32_MIN, 0, 1}};
    CHECK_EQ(solve(beside, 2, &result), CONE_OK);
    const struct vec3 exactly[] = {{INT32_MAX, 0, 0}, {INT32_MIN, 0, 0}};
    CHECK_EQ(solve(exactly, 2, &result), CONE_INFEASIBLE);
    CHECK(is_witness(exactly, &result));
}

/// Feasible by so little that rounded directions surround the viewpoint; found by random search.
/// The last point turned to the other side of zero makes it infeasible.
static void one_unit_from_the_boundary(void) {
    struct vec3 points[] = {{2147483646, 2147483647, 1},
                            {-2147483647, 2, 2147483647},
                            {1, INT32_MIN, 1073741824},
                            {2147483646, 2147483647, 1073741824},
                            {2147483646, 2147483647, 2147483647},
                            {1, 1, 2147483646},
                            {INT32_MIN, INT32_MIN, 0},
                            {-2147483647, 1, 1073741823},
                            {-1, -1, 1073741823},
                            {-1, -1, 1},
                            {0, 1073741824, 2147483647}};
    const uint64_t quarter = UINT64_C(1) << 62;
    struct cone_result result;
    CHECK_EQ(solve(points, 11, &result), CONE_OK);
    CHECK_NEAR(result.half_angle_turn64, quarter, (int64_t)EXCESS_TURN64_MAX);
    holds_all(points, 11, &result);
    points[9] = vec3(1, 1, -1);
    CHECK_EQ(solve(points, 11, &result), CONE_INFEASIBLE);
    CHECK(is_witness(points, &result));
    // Zero is exactly on the border; with one unit more, it is just outside.
    struct vec3 border[] = {{3, -7, 26},   {-6, 12, -21},  {30, 12, -13}, {-16, 20, 6},
                            {-6, 19, 11},  {-16, 29, -25}, {15, 7, 4},    {-23, 3, 16},
                            {-31, -4, -4}, {-2, -6, 16},   {39, 28, -60}};
    CHECK_EQ(solve(border, 11, &result), CONE_INFEASIBLE);
    CHECK(is_witness(border, &result));
}

static void errors(void) {
    const struct vec3 points[] = {{1, 2, 3}, {0, 0, 0}};
    struct cone_result result;
    CHECK_EQ(solve(points, 0, &result), CONE_EMPTY);
    CHECK_EQ(solve(points, 2, &result), CONE_ERROR_ZERO_VECTOR);
    CHECK_EQ(result.bad_index, 1);
    const struct cone_options options = {.workspace = workspace,
                                         .workspace_bytes = CONE_WORKSPACE_BYTES(2) - 1U};
    CHECK_EQ(cone_narrowest(points, 2, &options, &result), CONE_ERROR_WORKSPACE);
}

int main(void) {
    TEST(recorded_sets);
    TEST(centres_of_known_sets);
    TEST(one_and_two_directions);
    TEST(surrounded_viewpoints);
    TEST(one_unit_from_the_boundary);
    TEST(errors);
    return check_finish();
}
