#include "sphere/voronoi_circle.h"

#include "sphere/cone_settle.h"
#include "sphere/witness.h"

/// A vertex with r < 90 degrees: its triangle is seen from zero.
static bool seen_from_zero(const struct voronoi_mesh *mesh, uint32_t t) {
    const uint32_t *const v = mesh->triangle[t].site;
    return site_side(&mesh->site[v[0]], &mesh->site[v[1]], &mesh->site[v[2]]) < 0;
}

/// The third site of a triangle.
static uint32_t apex_of(const struct voronoi_triangle *triangle, uint32_t a, uint32_t b) {
    for (unsigned k = 0; k < 2U; k++) {
        if (triangle->site[k] != a && triangle->site[k] != b) {
            return triangle->site[k];
        }
    }
    return triangle->site[2];
}

/// Does the edge of the farthest-point diagram between two sites hold their midpoint? Then no site
/// lies outside the circle on the diameter between them. The edge's ends tell: they lie on either
/// side of the midpoint if the third sites of both are inside that circle. If both lie on it, the
/// midpoint is itself a vertex, or the opposite of one. (Opposite sites have no midpoint, all
/// others on that circle, and no triangle that is seen from zero.)
static bool edge_holds_midpoint(const struct voronoi_mesh *mesh, uint32_t t, unsigned i) {
    const struct voronoi_triangle *const here = &mesh->triangle[t];
    const uint32_t across = here->next[i], a = here->site[(i + 1U) % 3U],
                   b = here->site[(i + 2U) % 3U];
    const struct site *const s = mesh->site;
    const int one = site_cap_sign(&s[a], &s[b], &s[here->site[i]]);
    if (one > 0) {
        return false;
    }
    const int other = site_cap_sign(&s[a], &s[b], &s[apex_of(&mesh->triangle[across], a, b)]);
    return other <= 0 &&
           (one < 0 || other < 0 || seen_from_zero(mesh, t) || seen_from_zero(mesh, across));
}

/// The smallest of the circles around such vertices is that whose vertex lies among its own sites,
/// so that they have no obtuse angle; no radius needs to be compared.
static bool vertex_is_center(const struct voronoi_mesh *mesh, uint32_t t) {
    const uint32_t *const v = mesh->triangle[t].site;
    const struct site *const a = &mesh->site[v[0]], *const b = &mesh->site[v[1]],
                             *const c = &mesh->site[v[2]];
    return seen_from_zero(mesh, t) && site_cap_sign(a, b, c) >= 0 && site_cap_sign(b, c, a) >= 0 &&
           site_cap_sign(c, a, b) >= 0;
}

/// The support, as sites; 0: there is none, the set is infeasible.
static uint8_t read_support(const struct voronoi_mesh *mesh, uint32_t support[3]) {
    if (mesh->site_count <= 2U) {
        const struct vec3 a = mesh->site[0].vector, b = mesh->site[mesh->site_count - 1U].vector;
        const struct vec3_i64 cross = vec3_cross(a, b);
        const bool opposite = mesh->site_count == 2U && (cross.x | cross.y | cross.z) == 0;
        support[0] = 0;
        support[1] = 1;
        return opposite ? 0 : (uint8_t)mesh->site_count;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (unsigned i = 0; i < 3U; i++) {
            if (t < mesh->triangle[t].next[i] && edge_holds_midpoint(mesh, t, i)) {
                support[0] = mesh->triangle[t].site[(i + 1U) % 3U];
                support[1] = mesh->triangle[t].site[(i + 2U) % 3U];
                return 2;
            }
        }
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (vertex_is_center(mesh, t)) {
            for (unsigned i = 0; i < 3U; i++) {
                support[i] = mesh->triangle[t].site[i];
            }
            return 3;
        }
    }
    return 0;
}

/// Zero lies in the hull: in the tetrahedron of the first site and some triangle.
static enum cone_status infeasible(const struct voronoi_mesh *mesh, const struct vec3 *points,
                                   struct cone_result *result) {
    uint32_t witness[4] = {mesh->point[0], mesh->point[mesh->site_count - 1U], 0, 0};
    uint8_t size = 0;
    if (mesh->site_count == 2U) {
        const uint32_t pair[2] = {witness[0], witness[1]};
        size = witness_find(points, pair, 2, witness);
    }
    for (uint32_t t = 0; size == 0U && t < mesh->triangle_count; t++) {
        const uint32_t *const s = mesh->triangle[t].site;
        const bool apex_apart = s[0] != 0U && s[1] != 0U && s[2] != 0U;
        const uint32_t candidates[4] = {mesh->point[s[0]], mesh->point[s[1]], mesh->point[s[2]],
                                        mesh->point[0]};
        size = witness_find(points, candidates, apex_apart ? 4 : 3, witness);
    }
    return cone_settle_witness(points, witness, size, result);
}

/// The corners of the hull, or all points; the workspace that is left begins at *used.
static enum cone_status choose_sites(const struct vec3 *points, uint32_t count, bool hull,
                                     void *workspace, size_t workspace_bytes, size_t *used,
                                     struct hull_result *chosen,
                                     struct voronoi_circle_result *result) {
    *chosen = (struct hull_result){.vertices = NULL, .vertex_count = count};
    *used = 0;
    if (!hull) {
        return CONE_OK;
    }
    *used = (HULL_WORKSPACE_BYTES(count) + 7U) & ~(size_t)7U;
    result->bytes_needed = *used;
    if (workspace_bytes < *used) {
        return CONE_ERROR_WORKSPACE;
    }
    result->cone.point_reads += count;
    if (hull_spherical(points, count, workspace, HULL_WORKSPACE_BYTES(count), chosen) != HULL_OK) {
        return cone_settle_witness(points, chosen->witness, chosen->witness_count, &result->cone);
    }
    return CONE_OK;
}

enum cone_status voronoi_circle(const struct vec3 *points, uint32_t count,
                                const struct voronoi_circle_options *options, void *workspace,
                                size_t workspace_bytes, struct voronoi_circle_result *result) {
    *result = (struct voronoi_circle_result){0};
    const enum cone_status start = cone_settle_start(points, count, &result->cone);
    if (start != CONE_OK) {
        return start;
    }
    size_t used;
    struct hull_result chosen;
    const enum cone_status status = choose_sites(points, count, options->hull, workspace,
                                                 workspace_bytes, &used, &chosen, result);
    if (status != CONE_OK) {
        return status;
    }
    const uint32_t sites = chosen.vertex_count;
    const size_t mesh_end = used + VORONOI_MESH_BYTES(sites);
    result->bytes_needed =
        mesh_end + (options->merge ? VORONOI_MERGE_BYTES(sites) : VORONOI_INSERT_BYTES(sites));
    if (workspace_bytes < result->bytes_needed) {
        return CONE_ERROR_WORKSPACE;
    }
    uint32_t *const scratch = (uint32_t *)(void *)((char *)workspace + mesh_end);
    struct voronoi_mesh mesh;
    voronoi_sites(&mesh, (char *)workspace + used, points, chosen.vertices, sites, scratch);
    if (!options->merge || !voronoi_merge(&mesh, scratch)) {
        voronoi_insert(&mesh, scratch);
    }
    result->cone.point_reads += sites;
    result->site_count = mesh.site_count;
    result->triangle_count = mesh.triangle_count;
    result->side_tests = mesh.side_tests;
    uint32_t support[3];
    const uint8_t size = read_support(&mesh, support);
    if (size == 0U) {
        return infeasible(&mesh, points, &result->cone);
    }
    for (uint8_t i = 0; i < size; i++) {
        support[i] = mesh.point[support[i]];
    }
    result->by_pair = size == 2U;
    return cone_settle_support(points, count, support, size, &result->cone);
}
