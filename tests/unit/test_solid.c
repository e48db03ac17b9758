/// Hull and smallest sphere of points in space: the examples that decide between the thesis and its
/// corrections, and sets that are no solid. tests/property/solid_*.c compare with the definitions.
#include "check.h"

#include "solid/solid_sphere.h"

#define POINTS_MAX 16U

static uint64_t workspace[SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(POINTS_MAX) / sizeof(uint64_t)];

static void check_vertices(const struct vec3 *points, uint32_t count, uint8_t dimension,
                           const uint32_t *wanted, uint32_t wanted_count) {
    for (int method = SOLID_HULL_CAPS; method <= SOLID_HULL_WRAP; method++) {
        struct solid_hull hull;
        if (!CHECK_EQ(solid_hull_find(points, count, (enum solid_hull_method)method, workspace,
                                      sizeof workspace, &hull),
                      SOLID_HULL_OK) ||
            !CHECK_EQ(hull.dimension, dimension) || !CHECK_EQ(hull.vertex_count, wanted_count)) {
            return;
        }
        CHECK_EQ(hull.face_count, dimension == 3U ? 2U * wanted_count - 4U : 0U);
        for (uint32_t i = 0; i < wanted_count; i++) {
            CHECK_EQ(hull.vertices[i], wanted[i]);
        }
    }
}

/// No three of the points that are extreme along the thesis' directions are off one line.
static void extremes_on_one_line(void) {
    static const struct vec3 points[] = {
        {10, 10, 10}, {-10, -10, -10}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t wanted[] = {0, 1, 2, 3, 4};
    check_vertices(points, 5, 3, wanted, 5);
}

/// Points in faces and on edges are no vertices, whatever the order they come in.
static void cube_with_points_on_it(void) {
    static const struct vec3 points[] = {{1, 1, 0}, {1, 0, 0}, {0, 0, 0}, {2, 0, 0}, {0, 2, 0},
                                         {2, 2, 0}, {0, 0, 2}, {2, 0, 2}, {0, 2, 2}, {2, 2, 2},
                                         {1, 1, 1}, {2, 1, 1}, {2, 2, 1}, {2, 2, 2}};
    static const uint32_t wanted[] = {2, 3, 4, 5, 6, 7, 8, 9};
    check_vertices(points, 14, 3, wanted, 8);
}

static void flat_sets(void) {
    static const struct vec3 upright[] = {{0, 5, 0}, {0, 5, 4}, {4, 5, 4}, {4, 5, 0},
                                          {2, 5, 2}, {2, 5, 0}, {0, 5, 0}};
    // Counter-clockwise from +y, where x points left of z.
    static const uint32_t square[] = {0, 1, 2, 3};
    check_vertices(upright, 7, 2, square, 4);
    static const struct vec3 level[] = {{0, 0, 7}, {1, 1, 7}, {2, 0, 7}, {1, 0, 7}};
    static const uint32_t triangle[] = {0, 2, 1};
    check_vertices(level, 4, 2, triangle, 3);
    static const struct vec3 line[] = {{1, 2, 3}, {3, 6, 9}, {-2, -4, -6}, {3, 6, 9}};
    static const uint32_t ends[] = {1, 2};
    check_vertices(line, 4, 1, ends, 2);
    static const struct vec3 same[] = {{9, 9, 9}, {9, 9, 9}, {9, 9, 9}};
    static const uint32_t first[] = {0};
    check_vertices(same, 3, 0, first, 1);
    check_vertices(same, 1, 0, first, 1);
}

/// One unit decides, at the ends of the range.
static void ends_of_the_range(void) {
    const int32_t low = INT32_MIN, high = INT32_MAX;
    const struct vec3 points[] = {{low, low, low},   {high, low, low},      {low, high, low},
                                  {high, high, low}, {low, low, high},      {high, low, high},
                                  {low, high, high}, {high, high, high},    {0, 0, high},
                                  {0, 0, high - 1},  {high, high - 1, high}};
    static const uint32_t wanted[] = {0, 1, 2, 3, 4, 5, 6, 7};
    check_vertices(points, 11, 3, wanted, 8);
    // The slanted face y = z: one point on it, one a unit above.
    const struct vec3 wedge[] = {{low, low, low},    {high, low, low}, {low, high, high},
                                 {high, high, high}, {low, high, low}, {0, 0, 0},
                                 {0, 0, 1}};
    static const uint32_t above[] = {0, 1, 2, 3, 4, 6};
    check_vertices(wedge, 7, 3, above, 6);
}

static void check_sphere(const struct vec3 *points, uint32_t count, struct vec3_i64 center_q30,
                         uint64_t radius_q30, const uint32_t *support, uint8_t support_count) {
    for (int method = 0; method < 3; method++) {
        struct solid_sphere sphere;
        const enum solid_sphere_status status =
            method == 0 ? solid_sphere_find(points, count, workspace, sizeof workspace, &sphere)
                        : solid_sphere_by_trial(points, count,
                                                method == 1 ? SOLID_SPHERE_SHARPEST_FIRST
                                                            : SOLID_SPHERE_AS_LISTED,
                                                0, workspace, sizeof workspace, &sphere);
        if (!CHECK_EQ(status, SOLID_SPHERE_OK) || !CHECK_EQ(sphere.support_count, support_count)) {
            return;
        }
        CHECK_EQ(sphere.center_q30.x, center_q30.x);
        CHECK_EQ(sphere.center_q30.y, center_q30.y);
        CHECK_EQ(sphere.center_q30.z, center_q30.z);
        CHECK(sphere.radius_q30 >= radius_q30 && sphere.radius_q30 - radius_q30 <= 5U);
        for (unsigned i = 0; i < support_count; i++) {
            CHECK_EQ(sphere.support[i], support[i]);
        }
    }
}

/// The optimum goes through the last point: the thesis' loop ends before it. R^2 = 81/34.
static void last_point_is_tried(void) {
    static const struct vec3 points[] = {{-1, -1, -1}, {1, 0, 1}, {0, 1, -1}, {1, 1, 0}};
    static const uint32_t support[] = {0, 1, 3};
    const int64_t one = (int64_t)1 << 30;
    struct solid_sphere sphere;
    CHECK_EQ(solid_sphere_by_trial(points, 4, SOLID_SPHERE_SHARPEST_FIRST, 0, workspace,
                                   sizeof workspace, &sphere),
             SOLID_SPHERE_OK);
    const int64_t d[3] = {sphere.center_q30.x + one, sphere.center_q30.y + one,
                          sphere.center_q30.z + one};
    // 34 R^2 = 81 in units of 2^-56.
    const int64_t square =
        (d[0] >> 2) * (d[0] >> 2) + (d[1] >> 2) * (d[1] >> 2) + (d[2] >> 2) * (d[2] >> 2);
    CHECK_NEAR(square / ((int64_t)1 << 26), (81 * ((int64_t)1 << 30)) / 34, 64);
    check_sphere(points, 4, sphere.center_q30, sphere.radius_q30 - 3U, support, 3);
}

static void spheres_of_few(void) {
    const int64_t one = (int64_t)1 << 30, high = INT32_MAX, low = INT32_MIN;
    static const uint32_t first[] = {0}, pair[] = {0, 1};
    const struct vec3 points[] = {{3, 0, 0}, {-1, 0, 0}, {1, 1, 1}, {1, 2, 0}};
    check_sphere(points, 1, (struct vec3_i64){3 * one, 0, 0}, 0, first, 1);
    check_sphere(points, 2, (struct vec3_i64){one, 0, 0}, (uint64_t)(2 * one), pair, 2);
    check_sphere(points, 4, (struct vec3_i64){one, 0, 0}, (uint64_t)(2 * one), pair, 2);
    const struct vec3 ends[] = {{INT32_MIN, INT32_MIN, INT32_MIN},
                                {INT32_MAX, INT32_MAX, INT32_MAX}};
    const int64_t middle = (high + low) * (one / 2);
    // sqrt(3) (2^32 - 1) / 2 in units of 2^-30.
    check_sphere(ends, 2, (struct vec3_i64){middle, middle, middle}, UINT64_C(3993837245305741078),
                 pair, 2);
}

int main(void) {
    TEST(extremes_on_one_line);
    TEST(cube_with_points_on_it);
    TEST(flat_sets);
    TEST(ends_of_the_range);
    TEST(last_point_is_tried);
    TEST(spheres_of_few);
    return check_finish();
}
