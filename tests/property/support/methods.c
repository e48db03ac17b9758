#include "property/support/methods.h"

#include "check.h"

#include "sphere/pyramid.h"
#include "sphere/shrink.h"

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

const struct solve_method methods[] = {
    [METHOD_PIVOT] = {"pivot", false, solve_pivot},
    [METHOD_SHRINK] = {"shrink", true, solve_shrink},
    [METHOD_PYRAMID] = {"pyramid", true, solve_pyramid},
};

void methods_check_capacities(void) {
    const struct vec3 corners[] = {{1, 1, 9}, {1, -1, 9}, {-1, -1, 9}, {-1, 1, 9}};
    struct shrink_result shrunk;
    CHECK_EQ(shrink_narrowest(corners, 4, workspace, SHRINK_WORKSPACE_BYTES(4) - 1U, &shrunk),
             CONE_ERROR_WORKSPACE);
    struct pyramid_result built;
    CHECK_EQ(pyramid_narrowest(corners, 4, workspace, PYRAMID_WORKSPACE_BYTES(3), &built),
             CONE_ERROR_WORKSPACE);
    CHECK_EQ(built.edges_max, 3);
    CHECK_EQ(pyramid_narrowest(corners, 4, workspace, PYRAMID_WORKSPACE_BYTES(4), &built), CONE_OK);
    CHECK_EQ(built.edges, 4);
    CHECK_EQ(built.edges_most, 4);
    CHECK(built.by_pair);
}
