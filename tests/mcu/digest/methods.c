/// The other methods of the narrowest cone, and the exact tests and axes that they stand on.
#include "mcu/digest/sets.h"

#include "sphere/certify.h"
#include "sphere/hull.h"
#include "sphere/pyramid.h"
#include "sphere/shrink.h"
#include "sphere/site_axis.h"
#include "sphere/voronoi.h"
#include "sphere/voronoi_circle.h"

#define COUNT_MAX 60U

static struct vec3 points[COUNT_MAX];
static uint64_t workspace[VORONOI_WORKSPACE_BYTES(COUNT_MAX) / sizeof(uint64_t) + 1U];

static void fold_cone(struct digest *d, const struct vec3 *set, uint32_t count,
                      enum cone_status status, const struct cone_result *result) {
    digest_i64(d, status);
    if (status == CONE_OK) {
        digest_vec3(d, result->axis_q30);
        digest_u64(d, result->half_angle_turn64);
        digest_u64(d, result->farthest_index);
        for (uint8_t i = 0; i < result->support_count; i++) {
            digest_u64(d, result->support[i]);
        }
        CHECK(certify_support(set, count, result->support, result->support_count));
    } else {
        for (uint8_t i = 0; i < result->witness_count; i++) {
            digest_u64(d, result->witness[i]);
        }
        CHECK(certify_witness(set, result->witness, result->witness_count));
    }
}

static void fold_set(struct digest *d, uint32_t count) {
    struct shrink_result shrunk;
    enum cone_status status = shrink_narrowest(points, count, workspace, sizeof workspace, &shrunk);
    fold_cone(d, points, count, status, &shrunk.cone);
    digest_u64(d, shrunk.iterations);
    struct pyramid_result built;
    status = pyramid_narrowest(points, count, workspace, sizeof workspace, &built);
    fold_cone(d, points, count, status, &built.cone);
    digest_u64(d, built.face_tests);
    const struct hull_options options = {HULL_ORDER_MERGE, false};
    struct hull_result hull;
    digest_i64(d, hull_by(points, count, &options, workspace, sizeof workspace, &hull));
    digest_u64(d, hull.comparisons);
}

static void supports(void) {
    struct digest d = digest_start(31);
    for (int i = 0; i < 200; i++) {
        const uint32_t count = i % 100 == 0 ? COUNT_MAX : 1U + digest_below(&d, 12);
        digest_draw_set(&d, points, count);
        fold_set(&d, count);
    }
    digest_finish(&d, "digest sphere/methods");
}

static void fold_diagram(struct digest *d, uint32_t count, bool merge) {
    const struct voronoi_options options = {.closest = true, .merge = merge};
    struct voronoi_result result;
    digest_i64(d, voronoi_diagram(points, count, &options, workspace, sizeof workspace, &result));
    for (uint32_t i = 0; i < result.site_count; i++) {
        digest_u64(d, result.sites[i]);
    }
    for (uint32_t v = 0; v < result.vertex_count; v++) {
        digest_vec3(d, result.vertices[v].at_q30);
        for (uint32_t i = 0; i < result.vertices[v].count; i++) {
            digest_u64(d, result.vertex_sites[result.vertices[v].first + i]);
        }
    }
    for (uint32_t e = 0; e < result.edge_count; e++) {
        for (unsigned i = 0; i < 2U; i++) {
            digest_u64(d, result.edges[e].site[i]);
            digest_u64(d, result.edges[e].vertex[i]);
        }
    }
    digest_u64(d, result.side_tests);
    struct voronoi_circle_result read;
    const struct voronoi_circle_options how = {.hull = count % 2U != 0U, .merge = merge};
    const enum cone_status status =
        voronoi_circle(points, count, &how, workspace, sizeof workspace, &read);
    fold_cone(d, points, count, status, &read.cone);
}

static void diagrams(void) {
    struct digest d = digest_start(33);
    for (int i = 0; i < 60; i++) {
        const uint32_t count = i % 30 == 0 ? COUNT_MAX : 1U + digest_below(&d, 12);
        digest_draw_set(&d, points, count);
        fold_diagram(&d, count, false);
        fold_diagram(&d, count, true);
    }
    digest_finish(&d, "digest sphere/voronoi");
}

static void sites(void) {
    struct digest d = digest_start(32);
    for (int i = 0; i < 300; i++) {
        digest_draw_set(&d, points, 4);
        struct site s[4];
        for (unsigned k = 0; k < 4U; k++) {
            s[k] = site_from(points[k]);
            digest_vec3_i64(&d, s[k].unit_q61);
        }
        digest_i64(&d, site_plane_sign(&s[0], &s[1], &s[2], &s[3]));
        digest_i64(&d, site_cap_sign(&s[0], &s[1], &s[2]));
        digest_i64(&d, site_distance_cmp(&s[0], &s[1], &s[2], &s[3]));
        digest_vec3(&d, site_circle_axis(&s[0], &s[1], &s[2]));
        digest_vec3(&d, site_middle(&s[0], &s[1]));
    }
    digest_finish(&d, "digest sphere/site");
}

int main(void) {
    TEST(sites);
    TEST(supports);
    TEST(diagrams);
    return check_finish();
}
