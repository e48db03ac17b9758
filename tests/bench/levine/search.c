#include "bench/levine/search.h"

#include "bench/levine/levine.h"

#include "check.h"

#include <stdlib.h>

static void *workspace(void) {
    static void *memory;
    memory =
        memory == NULL ? malloc(SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(LEVINE_COUNT_MOST)) : memory;
    return memory;
}

struct solid_hull search_hull(const struct vec3 *points, uint32_t count,
                              enum solid_hull_method method) {
    struct solid_hull hull;
    CHECK_EQ(solid_hull_find(points, count, method, workspace(),
                             SOLID_HULL_WORKSPACE_BYTES(LEVINE_COUNT_MOST), &hull),
             SOLID_HULL_OK);
    return hull;
}

enum solid_sphere_status search_sphere(const struct vec3 *points, uint32_t count,
                                       enum solid_sphere_order order, uint32_t place_most,
                                       struct solid_sphere *out) {
    return solid_sphere_by_trial(points, count, order, place_most, workspace(),
                                 SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(LEVINE_COUNT_MOST), out);
}

double search_expected(double n) {
    return (n * (n - 1) * (n - 2) * (n - 3) / 24 + n * (n - 1) * (n - 2) / 6 + 1) / 2;
}
