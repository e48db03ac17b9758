#include "solid/solid_hull.h"

#include "solid/extremes.h"
#include "solid/hull_methods.h"

/// Caps, one point at a time: always the highest one above the face whose turn it is.
static void grow(struct mesh *mesh) {
    while (mesh->queue_first != MESH_NONE) {
        const uint32_t face = mesh->queue_first, tip = mesh->faces[face].head;
        const struct mesh_cap cap = mesh_add(mesh, face, tip);
        mesh_share_out(mesh, cap.first_point, cap.first_face, tip);
    }
}

static bool is_corner(const uint32_t corner[4], uint32_t index) {
    return index == corner[0] || index == corner[1] || index == corner[2] || index == corner[3];
}

/// The points that may be vertices, as a chain. apex: whether the set is flat and has one.
static uint32_t candidates(struct mesh *mesh, const struct extremes *extremes,
                           const uint32_t corner[4], bool apex) {
    const struct extremes_box box = extremes_box(mesh->points, extremes);
    uint32_t chain = MESH_NONE;
    for (uint32_t i = mesh->count; i-- != 0U;) {
        if ((apex || !extremes_inside(&box, mesh->points[i])) && !is_corner(corner, i)) {
            mesh->next[i] = chain;
            chain = i;
        }
    }
    return chain;
}

static void run_caps(struct mesh *mesh, const uint32_t corner[4], uint32_t chain) {
    mesh_start(mesh, corner);
    mesh_share_out(mesh, chain, 0, MESH_NONE);
    grow(mesh);
}

/// Does the plane of a face hold the corner beyond the edge from a to b, too?
static bool is_flat(const struct mesh *mesh, const struct mesh_face *face, uint32_t beyond,
                    uint32_t a, uint32_t b) {
    uint32_t far = MESH_NONE;
    for (unsigned k = 0; k < 3U; k++) {
        const uint32_t vertex = mesh->faces[beyond].vertex[k];
        far = vertex != a && vertex != b ? vertex : far;
    }
    const struct vec3 p = mesh_point(mesh, far);
    const int64_t value = side_value(&face->plane, p);
    if (face->plane.exact || value < -side_band(mesh->range)) {
        return value == 0;
    }
    return side_exact(mesh_point(mesh, face->vertex[0]), mesh_point(mesh, face->vertex[1]),
                      mesh_point(mesh, face->vertex[2]), p) == 0;
}

/// Counts in `outside` the true edges at each point: a vertex has three or more, a point on an edge
/// two, others none. Returns: whether all points of the polyhedron are vertices.
static bool count_edges(struct mesh *mesh) {
    for (uint32_t i = 0; i <= mesh->count; i++) {
        mesh->outside[i] = 0;
    }
    uint32_t flat = 0;
    for (uint32_t f = 0; f < mesh->slots_used; f++) {
        const struct mesh_face *const face = &mesh->faces[f];
        for (unsigned e = 0; e < 3U && face->in_use; e++) {
            const uint32_t a = face->vertex[e], b = face->vertex[(e + 1U) % 3U];
            if (a < b) { // each edge once
                if (is_flat(mesh, face, face->across[e], a, b)) {
                    flat++;
                } else {
                    mesh->outside[a]++;
                    mesh->outside[b]++;
                }
            }
        }
    }
    if (flat == 0U) {
        return true;
    }
    for (uint32_t f = 0; f < mesh->slots_used; f++) {
        const struct mesh_face *const face = &mesh->faces[f];
        for (unsigned k = 0; k < 3U && face->in_use; k++) {
            if (mesh->outside[face->vertex[k]] < 3U) {
                return false;
            }
        }
    }
    return true;
}

/// Once more, with the vertices only. Why: which of the points in a face came to be corners of
/// triangles hangs on the order in which they were added.
static void run_again(struct mesh *mesh) {
    uint32_t chain = MESH_NONE;
    for (uint32_t i = mesh->count + 1U; i-- != 0U;) {
        if (mesh->outside[i] >= 3U) {
            mesh->next[i] = chain;
            chain = i;
        }
    }
    // The first four that span space.
    uint32_t corner[4] = {chain, mesh->next[chain], MESH_NONE, MESH_NONE};
    for (uint32_t i = mesh->next[corner[1]]; corner[3] == MESH_NONE; i = mesh->next[i]) {
        const struct vec3 a = mesh_point(mesh, corner[0]), b = mesh_point(mesh, corner[1]),
                          p = mesh_point(mesh, i);
        if (corner[2] == MESH_NONE) {
            corner[2] = side_collinear(a, b, p) ? MESH_NONE : i;
        } else if (side_exact(a, b, mesh_point(mesh, corner[2]), p) != 0) {
            corner[3] = i;
        }
    }
    uint32_t rest = MESH_NONE;
    for (uint32_t i = chain; i != MESH_NONE;) {
        const uint32_t following = mesh->next[i];
        if (!is_corner(corner, i)) {
            mesh->next[i] = rest;
            rest = i;
        }
        i = following;
    }
    run_caps(mesh, corner, rest);
}

/// The faces close up, and become what the caller gets.
static void report_solid(struct mesh *mesh, struct solid_hull *result) {
    struct solid_face *const faces = (struct solid_face *)(void *)mesh->faces;
    for (uint32_t i = 0; i < mesh->count; i++) {
        mesh->outside[i] = 0;
    }
    uint32_t count = 0;
    for (uint32_t f = 0; f < mesh->slots_used; f++) {
        if (!mesh->faces[f].in_use) {
            continue;
        }
        const uint32_t v[3] = {mesh->faces[f].vertex[0], mesh->faces[f].vertex[1],
                               mesh->faces[f].vertex[2]};
        const unsigned first = v[0] < v[1] ? (v[0] < v[2] ? 0U : 2U) : (v[1] < v[2] ? 1U : 2U);
        for (unsigned k = 0; k < 3U; k++) {
            faces[count].vertex[k] = v[(first + k) % 3U];
            mesh->outside[v[k]] = 1;
        }
        count++;
    }
    result->faces = faces;
    result->face_count = count;
    uint32_t *const vertices = mesh->next;
    for (uint32_t i = 0; i < mesh->count; i++) {
        if (mesh->outside[i] != 0U) {
            vertices[result->vertex_count++] = i;
        }
    }
    result->vertices = vertices;
}

static void run_solid(struct mesh *mesh, const struct extremes *extremes, const uint32_t corner[4],
                      enum solid_hull_method method, struct solid_hull *result) {
    if (method == SOLID_HULL_WRAP) {
        hull_wrap(mesh, result);
        return;
    }
    if (method == SOLID_HULL_LEVINE) {
        hull_levine(mesh, extremes);
    } else {
        run_caps(mesh, corner, candidates(mesh, extremes, corner, false));
    }
    result->side_tests = mesh->side_tests;
    if (!count_edges(mesh)) {
        run_again(mesh);
        result->side_tests = mesh->side_tests;
    }
    report_solid(mesh, result);
}

/// A point beside the plane of a flat set; *upward tells on which side: see solid_hull.vertices.
static struct vec3 apex_beside(const struct vec3 *points, const uint32_t corner[4], bool *upward) {
    const struct vec3 a = points[corner[0]];
    const struct vec3_i128 n =
        vec3_i64_cross(side_between(a, points[corner[1]]), side_between(a, points[corner[2]]));
    struct vec3 apex = a;
    int32_t *const axis = i128_sign(n.z) != 0 ? &apex.z : i128_sign(n.y) != 0 ? &apex.y : &apex.x;
    *upward = *axis < 0;
    *axis += *upward ? 1 : -1;
    return apex;
}

/// The polygon is what the apex sees of the pyramid from above.
static void report_polygon(struct mesh *mesh, bool upward, struct solid_hull *result) {
    uint32_t *const following = mesh->outside, *const vertices = mesh->next;
    uint32_t first = MESH_NONE;
    for (uint32_t f = 0; f < mesh->slots_used; f++) {
        const struct mesh_face *const face = &mesh->faces[f];
        for (unsigned k = 0; k < 3U && face->in_use; k++) {
            if (face->vertex[k] == mesh->count) {
                const uint32_t a = face->vertex[(k + 1U) % 3U], b = face->vertex[(k + 2U) % 3U];
                following[upward ? a : b] = upward ? b : a;
                first = a < first ? a : first;
            }
        }
    }
    uint32_t at = first;
    do {
        vertices[result->vertex_count++] = at;
        at = following[at];
    } while (at != first);
    result->vertices = vertices;
}

static void run_flat(struct mesh *mesh, const struct extremes *extremes, const uint32_t corner[4],
                     struct solid_hull *result) {
    bool upward;
    mesh->apex = apex_beside(mesh->points, corner, &upward);
    mesh->range.bits = (uint8_t)(mesh->range.bits < 32U ? mesh->range.bits + 1U : 32U);
    const uint32_t corners[4] = {corner[0], corner[1], corner[2], mesh->count};
    run_caps(mesh, corners, candidates(mesh, extremes, corners, true));
    if (!count_edges(mesh)) {
        run_again(mesh);
    }
    result->side_tests = mesh->side_tests;
    report_polygon(mesh, upward, result);
}

/// All points on one line, or equal: the ends in side_order.
static void report_line(const struct vec3 *points, uint32_t count, uint32_t *vertices,
                        struct solid_hull *result) {
    uint32_t low = 0, high = 0;
    for (uint32_t i = 1; i < count; i++) {
        low = side_order(points[i], points[low]) < 0 ? i : low;
        high = side_order(points[i], points[high]) > 0 ? i : high;
    }
    vertices[0] = low < high ? low : high;
    vertices[1] = low < high ? high : low;
    result->vertices = vertices;
    result->vertex_count = low == high ? 1U : 2U;
}

enum solid_hull_status solid_hull_find(const struct vec3 *points, uint32_t count,
                                       enum solid_hull_method method, void *workspace,
                                       size_t workspace_bytes, struct solid_hull *result) {
    *result = (struct solid_hull){0};
    if (count == 0U) {
        return SOLID_HULL_EMPTY;
    }
    if (count > SOLID_HULL_COUNT_MAX) {
        return SOLID_HULL_ERROR_COUNT;
    }
    if (workspace_bytes < SOLID_HULL_WORKSPACE_BYTES(count)) {
        return SOLID_HULL_ERROR_WORKSPACE;
    }
    struct extremes extremes;
    extremes_find(points, count, &extremes);
    uint32_t corner[4];
    result->dimension = extremes_span(points, count, &extremes, corner);
    if (result->dimension < 2U) {
        report_line(points, count, workspace, result);
        return SOLID_HULL_OK;
    }
    struct mesh mesh;
    mesh_open(&mesh, points, count, extremes.range, workspace);
    if (result->dimension == 2U) {
        run_flat(&mesh, &extremes, corner, result);
    } else {
        run_solid(&mesh, &extremes, corner, method, result);
    }
    return SOLID_HULL_OK;
}
