/// hull_spherical on the examples that decide between the paper and its corrections, and on the
/// simplest sets. tests/property/hull_exact.c compares with brute force.
#include "check.h"

#include "sphere/hull.h"
#include "sphere/hull_order.h"

#define POINTS_MAX 16

static uint32_t workspace[HULL_WORKSPACE_BYTES(POINTS_MAX) / sizeof(uint32_t)];

static enum hull_status solve(const struct vec3 *points, uint32_t count,
                              struct hull_result *result) {
    return hull_spherical(points, count, workspace, HULL_WORKSPACE_BYTES(count), result);
}

static bool check_hull(const struct vec3 *points, uint32_t count, const uint32_t *wanted,
                       uint32_t wanted_count) {
    struct hull_result result;
    bool right = CHECK_EQ(solve(points, count, &result), HULL_OK) &&
                 CHECK_EQ(result.vertex_count, wanted_count);
    for (uint32_t i = 0; right && i < wanted_count; i++) {
        right = CHECK_EQ(result.vertices[i], wanted[i]);
    }
    return right;
}

static bool check_surrounded(const struct vec3 *points, uint32_t count, const uint32_t *witness,
                             uint32_t witness_count) {
    struct hull_result result;
    bool right = CHECK_EQ(solve(points, count, &result), HULL_NOT_HEMISPHERICAL) &&
                 CHECK_EQ(result.witness_count, witness_count);
    for (uint32_t i = 0; right && i < witness_count; i++) {
        right = CHECK_EQ(result.witness[i], witness[i]);
    }
    return right;
}

/// The rank of `value` among the permutations of four: the digits of a factorial number.
static void permute_four(uint32_t value, uint32_t *order) {
    uint32_t rest[4] = {0, 1, 2, 3}, left = 4;
    for (uint32_t i = 0; i < 4U; i++) {
        const uint32_t pick = value % left;
        value /= left;
        order[i] = rest[pick];
        rest[pick] = rest[--left];
    }
}

/// All four, whichever is first and in whatever order: the scan as printed loses one of them in
/// half of the orders.
static void square_in_any_order(void) {
    static const struct vec3 square[] = {{-1, 0, 1}, {0, 0, 1}, {0, 1, 1}, {-1, 1, 1}};
    for (uint32_t value = 0; value < 24U && check_clean(); value++) {
        uint32_t order[4], place[4];
        struct vec3 points[4];
        permute_four(value, order);
        for (uint32_t i = 0; i < 4U; i++) {
            points[i] = square[order[i]];
            place[order[i]] = i;
        }
        // From above, with y up: 0 is bottom left, 3 top left, 2 top right, 1 bottom right.
        uint32_t wanted[4];
        for (uint32_t i = 0; i < 4U; i++) {
            static const uint32_t clockwise[] = {0, 3, 2, 1};
            const uint32_t at = (4U - order[0]) % 4U; // of point 0 in that order
            wanted[i] = place[clockwise[(at + i) % 4U]];
        }
        check_hull(points, 4, wanted, 4);
    }
}

/// The first point is inside: the scan as printed keeps (-1, 0, 1), which is inside, too.
static void first_point_inside(void) {
    static const struct vec3 points[] = {{0, -1, 1}, {1, 1, 1}, {-2, 0, 1}, {0, -2, 1}, {-1, 0, 1}};
    static const uint32_t wanted[] = {1, 3, 2};
    check_hull(points, 5, wanted, 3);
}

static void closed_half_spheres(void) {
    static const struct vec3 flat[] = {{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    static const uint32_t all_three[] = {0, 1, 2};
    check_surrounded(flat, 3, all_three, 3);
    static const struct vec3 half[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 1}, {-1, 0, -1}, {0, -1, 0}};
    struct hull_result result;
    CHECK_EQ(solve(half, 5, &result), HULL_NOT_HEMISPHERICAL);
    // Either the opposite pair or the triple around zero.
    if (result.witness_count == 2U) {
        CHECK_EQ(result.witness[0], 1);
        CHECK_EQ(result.witness[1], 4);
    } else {
        CHECK_EQ(result.witness_count, 3);
        CHECK_EQ(result.witness[0], 0);
        CHECK_EQ(result.witness[1], 2);
        CHECK_EQ(result.witness[2], 3);
    }
    static const struct vec3 not_the_first[] = {{-1, -2, 0}, {-1, 1, 0}, {1, -1, 0}};
    static const uint32_t last_two[] = {1, 2};
    check_surrounded(not_the_first, 3, last_two, 2);
    static const struct vec3 tetrahedron[] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    static const uint32_t all_four[] = {0, 1, 2, 3};
    check_surrounded(tetrahedron, 4, all_four, 4);
}

/// One unit beside an opposite pair at the ends of the range.
static void ends_of_the_range(void) {
    static const struct vec3 points[] = {{INT32_MAX, 1, 0}, {INT32_MIN, 1, 0}, {0, INT32_MIN, 1}};
    static const uint32_t wanted[] = {0, 2, 1};
    check_hull(points, 3, wanted, 3);
}

static void points_and_arcs(void) {
    static const struct vec3 arc[] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    static const uint32_t ends[] = {0, 2};
    check_hull(arc, 3, ends, 2);
    static const struct vec3 one[] = {{0, 0, 7}};
    static const uint32_t first[] = {0};
    check_hull(one, 1, first, 1);
    static const struct vec3 parallel[] = {{0, 3, 7}, {0, 6, 14}, {0, 9, 21}};
    check_hull(parallel, 3, first, 1);
    static const struct vec3 two[] = {{0, 3, 7}, {0, 6, 14}, {0, 9, 22}, {0, 18, 44}};
    check_hull(two, 4, ends, 2);
}

/// Of equal directions the first, of collinear ones the ends.
static void repeated_and_collinear(void) {
    static const struct vec3 points[] = {{0, 0, 1}, {0, 0, 2}, {2, 0, 1}, {4, 0, 2}, {1, 0, 1},
                                         {0, 2, 1}, {1, 1, 1}, {0, 1, 1}, {1, 1, 3}, {0, 6, 3}};
    static const uint32_t wanted[] = {0, 5, 2};
    check_hull(points, 10, wanted, 3);
}

/// Rays on the limit between two buckets, closer together than their keys can tell: the rounded
/// keys are in the wrong order, which the exact check of the whole order notices.
static void rays_closer_than_their_keys(void) {
    enum { COUNT = 1024 };
    static struct vec3 points[COUNT + 1];
    static uint32_t merged[2][COUNT], bucketed[2][COUNT], keys[COUNT], starts[COUNT + 1];
    uint64_t seed = 85;
    points[COUNT] = vec3(123457, 67891, INT32_MAX - 1234);
    for (uint32_t i = 0; i < COUNT; i++) {
        const int32_t dx = (int32_t)(check_random(&seed) >> 60);
        const int32_t dy = (int32_t)(check_random(&seed) >> 60);
        const int32_t dz = (int32_t)(check_random(&seed) >> 48);
        points[i] = vec3((1 << 30) + dx, (1 << 30) + dy, dz);
        merged[0][i] = bucketed[0][i] = i;
    }
    struct hull_pivot pivot = hull_pivot(points, COUNT);
    hull_order_merge(&pivot, merged[0], merged[1], COUNT);
    hull_order_buckets(&pivot, bucketed[0], bucketed[1], keys, starts, COUNT);
    for (uint32_t i = 0; i < COUNT; i++) {
        if (!CHECK_EQ(bucketed[1][i], merged[0][i])) {
            return;
        }
    }
}

static void errors(void) {
    static const struct vec3 points[] = {{1, 2, 3}, {4, 5, 6}, {0, 0, 0}};
    struct hull_result result;
    CHECK_EQ(solve(points, 0, &result), HULL_EMPTY);
    CHECK_EQ(solve(points, 3, &result), HULL_ERROR_ZERO_VECTOR);
    CHECK_EQ(result.bad_index, 2);
    CHECK_EQ(hull_spherical(points, 2, workspace, HULL_WORKSPACE_BYTES(2) - 1U, &result),
             HULL_ERROR_WORKSPACE);
}

int main(void) {
    TEST(square_in_any_order);
    TEST(first_point_inside);
    TEST(closed_half_spheres);
    TEST(ends_of_the_range);
    TEST(points_and_arcs);
    TEST(repeated_and_collinear);
    TEST(rays_closer_than_their_keys);
    TEST(errors);
    return check_finish();
}
