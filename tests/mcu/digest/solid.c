/// Hulls and smallest spheres of points in space, by every method.
#include "mcu/digest/sets.h"

#include "solid/solid_hull.h"
#include "solid/solid_sphere.h"

#define COUNT_MAX 40U

static struct vec3 points[COUNT_MAX];
static uint64_t workspace[SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(COUNT_MAX) / sizeof(uint64_t) + 1U];

static void fold_hull(struct digest *d, uint32_t count, enum solid_hull_method method) {
    struct solid_hull hull;
    digest_i64(d, solid_hull_find(points, count, method, workspace, sizeof workspace, &hull));
    digest_u64(d, hull.dimension);
    for (uint32_t i = 0; i < hull.vertex_count; i++) {
        digest_u64(d, hull.vertices[i]);
    }
    for (uint32_t f = 0; f < hull.face_count; f++) {
        for (unsigned i = 0; i < 3U; i++) {
            digest_u64(d, hull.faces[f].vertex[i]);
        }
    }
    digest_u64(d, hull.side_tests);
}

static void hulls(void) {
    struct digest d = digest_start(41);
    for (int i = 0; i < 60; i++) {
        const uint32_t count = i % 30 == 0 ? COUNT_MAX : 1U + digest_below(&d, 12);
        digest_draw_set(&d, points, count);
        fold_hull(&d, count, SOLID_HULL_CAPS);
        fold_hull(&d, count, SOLID_HULL_LEVINE);
        fold_hull(&d, count, SOLID_HULL_WRAP);
    }
    digest_finish(&d, "digest solid/hulls");
}

static void fold_sphere(struct digest *d, enum solid_sphere_status status,
                        const struct solid_sphere *sphere) {
    digest_i64(d, status);
    digest_vec3_i64(d, sphere->center_q30);
    digest_u64(d, sphere->radius_q30);
    for (uint8_t i = 0; i < sphere->support_count; i++) {
        digest_u64(d, sphere->support[i]);
    }
    digest_u64(d, sphere->point_tests);
}

static void spheres(void) {
    struct digest d = digest_start(43);
    for (int i = 0; i < 60; i++) {
        const uint32_t count = 1U + digest_below(&d, 12);
        struct solid_sphere sphere;
        digest_draw_set(&d, points, count);
        enum solid_sphere_status status =
            solid_sphere_find(points, count, workspace, sizeof workspace, &sphere);
        fold_sphere(&d, status, &sphere);
        status = solid_sphere_by_trial(points, count, SOLID_SPHERE_SHARPEST_FIRST, UINT32_MAX,
                                       workspace, sizeof workspace, &sphere);
        fold_sphere(&d, status, &sphere);
        status = solid_sphere_by_trial(points, count, SOLID_SPHERE_AS_LISTED, UINT32_MAX, workspace,
                                       sizeof workspace, &sphere);
        fold_sphere(&d, status, &sphere);
    }
    digest_finish(&d, "digest solid/spheres");
}

int main(void) {
    TEST(hulls);
    TEST(spheres);
    return check_finish();
}
