#include "property/support/methods.h"

#include "check.h"

#include "sphere/pyramid.h"
#include "sphere/shrink.h"
#include "sphere/voronoi_circle.h"

static int64_t workspace[METHODS_COUNT_MAX * 64U];

static enum cone_status solve_pivot(const struct vec3 *points, uint32_t count,
                                    struct cone_result *result) {
    const struct cone_options options = {.workspace = workspace,
                                         .workspace_bytes = CONE_WORKSPACE_BYTES(count)};
    return cone_narrowest(points, count, &options, result);
}

static enum cone_status solve_shrink(const struct vec3 *points, uint32_t count,
                                     struct cone_result *result) {
    struct shrink_result shrunk;
    const enum cone_status status =
        shrink_narrowest(points, count, workspace, SHRINK_WORKSPACE_BYTES(count), &shrunk);
    *result = shrunk.cone;
    return status;
}

static enum cone_status solve_pyramid(const struct vec3 *points, uint32_t count,
                                      struct cone_result *result) {
    struct pyramid_result built;
    const enum cone_status status =
        pyramid_narrowest(points, count, workspace, PYRAMID_WORKSPACE_BYTES(count), &built);
    *result = built.cone;
    return status;
}

static enum cone_status circle(const struct vec3 *points, uint32_t count, bool hull, bool merge,
                               struct cone_result *result) {
    const struct voronoi_circle_options options = {.hull = hull, .merge = merge};
    struct voronoi_circle_result read;
    const enum cone_status status = voronoi_circle(points, count, &options, workspace,
                                                   VORONOI_CIRCLE_WORKSPACE_BYTES(count), &read);
    *result = read.cone;
    return status;
}

static enum cone_status solve_voronoi(const struct vec3 *points, uint32_t count,
                                      struct cone_result *result) {
    return circle(points, count, false, false, result);
}

static enum cone_status solve_voronoi_merged(const struct vec3 *points, uint32_t count,
                                             struct cone_result *result) {
    return circle(points, count, false, true, result);
}

static enum cone_status solve_hull_voronoi(const struct vec3 *points, uint32_t count,
                                           struct cone_result *result) {
    return circle(points, count, true, false, result);
}

static enum cone_status solve_hull_voronoi_merged(const struct vec3 *points, uint32_t count,
                                                  struct cone_result *result) {
    return circle(points, count, true, true, result);
}

const struct solve_method methods[] = {
    [METHOD_PIVOT] = {"pivot", false, solve_pivot},
    [METHOD_SHRINK] = {"shrink", true, solve_shrink},
    [METHOD_PYRAMID] = {"pyramid", true, solve_pyramid},
    [METHOD_VORONOI] = {"voronoi", true, solve_voronoi},
    [METHOD_VORONOI_MERGED] = {"voronoi, merged", true, solve_voronoi_merged},
    [METHOD_HULL_VORONOI] = {"hull-voronoi", true, solve_hull_voronoi},
    [METHOD_HULL_VORONOI_MERGED] = {"hull-voronoi, merged", true, solve_hull_voronoi_merged},
};

void methods_check_capacities(void) {
    const struct vec3 corners[] = {{1, 1, 9}, {1, -1, 9}, {-1, -1, 9}, {-1, 1, 9}};
    struct shrink_result shrunk;
    CHECK_EQ(shrink_narrowest(corners, 4, workspace, SHRINK_WORKSPACE_BYTES(4) - 1U, &shrunk),
             CONE_ERROR_WORKSPACE);
    for (unsigned way = 0; way < 4U; way++) {
        const struct voronoi_circle_options options = {.hull = way % 2U != 0U,
                                                       .merge = way / 2U != 0U};
        struct voronoi_circle_result read;
        CHECK_EQ(voronoi_circle(corners, 4, &options, workspace, 8, &read), CONE_ERROR_WORKSPACE);
        CHECK(read.bytes_needed > 8U);
        CHECK_EQ(voronoi_circle(corners, 4, &options, workspace, sizeof workspace, &read), CONE_OK);
        const size_t needed = read.bytes_needed;
        CHECK(needed <= VORONOI_CIRCLE_WORKSPACE_BYTES(4));
        CHECK_EQ(voronoi_circle(corners, 4, &options, workspace, needed - 1U, &read),
                 CONE_ERROR_WORKSPACE);
        CHECK_EQ(read.bytes_needed, needed);
        CHECK_EQ(voronoi_circle(corners, 4, &options, workspace, needed, &read), CONE_OK);
    }
    struct pyramid_result built;
    CHECK_EQ(pyramid_narrowest(corners, 4, workspace, PYRAMID_WORKSPACE_BYTES(3), &built),
             CONE_ERROR_WORKSPACE);
    CHECK_EQ(built.edges_max, 3);
    CHECK_EQ(pyramid_narrowest(corners, 4, workspace, PYRAMID_WORKSPACE_BYTES(4), &built), CONE_OK);
    CHECK_EQ(built.edges, 4);
    CHECK_EQ(built.edges_most, 4);
    CHECK(built.by_pair);
}
