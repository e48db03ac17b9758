/// The comparison methods of the narrowest cone (algorithms A, B and C of 1985, the pyramid of
/// 1982) on the sets on which the printed algorithms fail, and Voronoi diagrams of known sets. In
/// the debug build each method also proves its own answers. tests/property/methods.c has the random
/// sets.
#include "check.h"

#include "sphere/certify.h"
#include "sphere/pyramid.h"
#include "sphere/shrink.h"
#include "sphere/voronoi.h"
#include "sphere/voronoi_circle.h"

#define COUNT_MAX 24U

static uint64_t workspace[VORONOI_WORKSPACE_BYTES(COUNT_MAX) / sizeof(uint64_t) + 1U];

enum method { SHRINK, PYRAMID, ALGORITHM_A, ALGORITHM_A_MERGED, ALGORITHM_B, METHOD_COUNT };

static enum cone_status solve(enum method method, const struct vec3 *points, uint32_t count,
                              struct cone_result *result) {
    struct shrink_result shrunk;
    struct pyramid_result built;
    struct voronoi_circle_result read;
    enum cone_status status;
    switch (method) {
    case SHRINK:
        status = shrink_narrowest(points, count, workspace, sizeof workspace, &shrunk);
        *result = shrunk.cone;
        return status;
    case PYRAMID:
        status = pyramid_narrowest(points, count, workspace, sizeof workspace, &built);
        *result = built.cone;
        return status;
    default: {
        const struct voronoi_circle_options options = {.hull = method == ALGORITHM_B,
                                                       .merge = method == ALGORITHM_A_MERGED};
        status = voronoi_circle(points, count, &options, workspace, sizeof workspace, &read);
        *result = read.cone;
        return status;
    }
    }
}

/// Each method finds the axis, and a support that proves it.
static void check_axis(const struct vec3 *points, uint32_t count, struct vec3 axis) {
    const struct vec3 wanted = vec3_normalise(axis);
    for (enum method method = SHRINK; method < METHOD_COUNT; method++) {
        struct cone_result result;
        if (!CHECK_EQ(solve(method, points, count, &result), CONE_OK) ||
            !CHECK(certify_support(points, count, result.support, result.support_count)) ||
            !CHECK_NEAR(result.axis_q30.x, wanted.x, 1) ||
            !CHECK_NEAR(result.axis_q30.y, wanted.y, 1) ||
            !CHECK_NEAR(result.axis_q30.z, wanted.z, 1)) {
            check_note("method", method);
        }
    }
}

static void check_infeasible(const struct vec3 *points, uint32_t count) {
    for (enum method method = SHRINK; method < METHOD_COUNT; method++) {
        struct cone_result result;
        if (!CHECK_EQ(solve(method, points, count, &result), CONE_INFEASIBLE) ||
            !CHECK(certify_witness(points, result.witness, result.witness_count))) {
            check_note("method", method);
        }
    }
}

static void known_circles(void) {
    // Shrinking as printed takes corner 0 for the last one, and ends on too large a circle.
    const struct vec3 four[] = {{0, 3, 4}, {3, 0, 4}, {0, -3, 4}, {-4, 0, 3}};
    check_axis(four, 4, vec3(-1, 0, 7));
    const struct vec3 tilted[] = {{4, 3, 4}, {2, -1, 6}, {-3, 4, 4}, {3, 4, 4}};
    check_axis(tilted, 4, vec3(1, 7, 15));
    const struct vec3 arc[] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    check_axis(arc, 3, vec3(1, 1, 0));
    const struct vec3 one[] = {{0, 0, INT32_MIN}, {0, 0, -1}};
    check_axis(one, 2, vec3(0, 0, -1));
    // A square, its middle, and its corners once more: four points on the circle.
    const struct vec3 square[] = {{1, 1, 3},  {-1, 1, 3}, {0, 0, 1},  {-1, -1, 3},
                                  {1, -1, 3}, {2, 2, 6},  {-2, 2, 6}, {0, 1, 4}};
    check_axis(square, 8, vec3(0, 0, 1));
}

static void surrounded_viewpoints(void) {
    const struct vec3 flat[] = {{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    check_infeasible(flat, 3);
    const struct vec3 half[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 1}, {-1, 0, -1}, {0, -1, 0}};
    check_infeasible(half, 5);
    // Minus the sum of two edges of the pyramid: as printed, it is taken for an edge.
    const struct vec3 opposite[] = {{3, 1, 4}, {-1, 5, 9}, {2, -6, 5}, {-2, -6, -13}};
    check_infeasible(opposite, 4);
    const struct vec3 pair[] = {{INT32_MAX, 0, 0}, {INT32_MIN, 0, 0}};
    check_infeasible(pair, 2);
    const struct vec3 beside[] = {{INT32_MAX, 0, 0}, {INT32_MIN, 0, 1}};
    check_axis(beside, 2, vec3(0, 0, 1));
    // All midpoints of a cube's edges: an edge between two of them passes for a diameter, seen from
    // one side.
    const struct vec3 edges[] = {{1, -1, 0},  {0, 1, -1},  {-1, 0, 0}, {1, 1, 0},
                                 {1, -1, -1}, {0, -1, -1}, {-1, 1, 0}, {0, 1, 1}};
    check_infeasible(edges, 8);
}

static void diagrams(void) {
    const struct vec3 cube[] = {{1, 1, 1},  {1, 1, -1},  {1, -1, 1},  {1, -1, -1},
                                {-1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}, {-2, -2, -2}};
    for (unsigned i = 0; i < 4U; i++) {
        const struct voronoi_options options = {.closest = i % 2U != 0U, .merge = i / 2U != 0U};
        struct voronoi_result r;
        CHECK_EQ(voronoi_diagram(cube, 8, &options, workspace, sizeof workspace, &r), VORONOI_OK);
        CHECK_EQ(r.vertex_count, 6);
        CHECK_EQ(r.edge_count, 12);
        CHECK_EQ(r.vertices[0].count, 4);
        CHECK_EQ(r.vertices[0].at_q30.x, options.closest ? Q30_ONE : -Q30_ONE);
        CHECK_EQ(voronoi_diagram(cube, 2, &options, workspace, sizeof workspace, &r), VORONOI_OK);
        CHECK_EQ(r.edge_count, 1);
        CHECK_EQ(r.edges[0].vertex[0], VORONOI_NONE);
    }
}

int main(void) {
    TEST(known_circles);
    TEST(surrounded_viewpoints);
    TEST(diagrams);
    return check_finish();
}
