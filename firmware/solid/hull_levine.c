#include "solid/hull_methods.h"

/// |cross product|^2 of two edges.
static struct i256 area2(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3_i128 n = vec3_i64_cross(side_between(a, b), side_between(a, c));
    return i256_add(i256_add(i256_mul(n.x, n.x), i256_mul(n.y, n.y)), i256_mul(n.z, n.z));
}

/// Of the extreme points the first three off one line; if there are none, the point farthest from
/// the line of the first two that differ.
static void three_corners(const struct mesh *mesh, const struct extremes *e, uint32_t corner[4]) {
    const struct vec3 *const points = mesh->points;
    corner[0] = e->list[0];
    uint32_t i = 1;
    while (vec3_equal(points[e->list[i]], points[corner[0]])) {
        i++;
    }
    corner[1] = e->list[i];
    const struct vec3 a = points[corner[0]], b = points[corner[1]];
    for (i++; i < e->count; i++) {
        if (!side_collinear(a, b, points[e->list[i]])) {
            corner[2] = e->list[i];
            return;
        }
    }
    corner[2] = 0;
    struct i256 best = area2(a, b, points[0]);
    for (uint32_t k = 1; k < mesh->count; k++) {
        const struct i256 area = area2(a, b, points[k]);
        const int sign = i256_sign(i256_sub(area, best));
        if (sign > 0 || (sign == 0 && side_order(points[k], points[corner[2]]) > 0)) {
            best = area;
            corner[2] = k;
        }
    }
}

/// The point farthest from the plane of three, on either side.
static void fourth_corner(struct mesh *mesh, uint32_t corner[4]) {
    const struct vec3 *const points = mesh->points;
    const struct vec3 a = points[corner[0]], b = points[corner[1]], c = points[corner[2]];
    uint32_t above = corner[0], below = corner[0];
    for (uint32_t i = 0; i < mesh->count; i++) {
        mesh->side_tests++;
        const int up = side_compare(a, b, c, points[i], points[above]),
                  down = side_compare(a, b, c, points[below], points[i]);
        above = up > 0 || (up == 0 && side_order(points[i], points[above]) > 0) ? i : above;
        below = down > 0 || (down == 0 && side_order(points[i], points[below]) > 0) ? i : below;
    }
    // |height of above| - |height of below|: the sign of a sum, by way of the mirrored point.
    const struct vec3_i128 n = vec3_i64_cross(side_between(a, b), side_between(a, c));
    const struct i256 up = vec3_i128_dot(n, side_between(a, points[above])),
                      down = i256_neg(vec3_i128_dot(n, side_between(a, points[below])));
    const int sign = i256_sign(i256_sub(up, down));
    corner[3] =
        sign > 0 || (sign == 0 && side_order(points[above], points[below]) > 0) ? above : below;
}

/// Step 4: the caps of the listed points. `tail` of a face is 0 once no point lies above it.
static void add_listed(struct mesh *mesh, uint32_t chain) {
    for (uint32_t tip = chain; tip != MESH_NONE;) {
        const uint32_t following = mesh->next[tip];
        for (uint32_t f = 0; f < mesh->slots_used; f++) {
            if (mesh->faces[f].in_use && mesh_side(mesh, f, tip) > 0) {
                (void)mesh_add(mesh, f, tip);
                break;
            }
        }
        tip = following;
    }
}

/// Step 5: every point left against every face that is not known to be final. The points inside
/// leave the chain; `head` of a face becomes its highest point.
static uint32_t test_all(struct mesh *mesh, uint32_t chain) {
    uint32_t *link = &chain;
    while (*link != MESH_NONE) {
        const uint32_t q = *link;
        bool above_any = false;
        for (uint32_t f = 0; f < mesh->slots_used; f++) {
            struct mesh_face *const face = &mesh->faces[f];
            if (!face->in_use || face->tail == 0U || mesh_side(mesh, f, q) <= 0) {
                continue;
            }
            above_any = true;
            const int64_t value = side_value(&face->plane, mesh_point(mesh, q));
            const int order = face->head == MESH_NONE
                                  ? 1
                                  : mesh_compare(mesh, f, q, value, face->head, face->farthest);
            if (order > 0 ||
                (order == 0 && side_order(mesh_point(mesh, q), mesh_point(mesh, face->head)) > 0)) {
                face->head = q;
                face->farthest = value;
            }
        }
        if (above_any) {
            link = &mesh->next[q];
        } else {
            *link = mesh->next[q];
        }
    }
    return chain;
}

/// The highest point of each face, each once, as a chain; they leave *left.
static uint32_t take_highest(struct mesh *mesh, uint32_t *left) {
    for (uint32_t i = 0; i < mesh->count; i++) {
        mesh->outside[i] = 0;
    }
    for (uint32_t f = 0; f < mesh->slots_used; f++) {
        struct mesh_face *const face = &mesh->faces[f];
        if (face->in_use && face->head != MESH_NONE) {
            mesh->outside[face->head] = 1;
            face->head = MESH_NONE;
        } else {
            face->tail = 0;
        }
    }
    uint32_t listed = MESH_NONE;
    for (uint32_t *link = left; *link != MESH_NONE;) {
        const uint32_t q = *link;
        if (mesh->outside[q] != 0U) {
            *link = mesh->next[q];
            mesh->next[q] = listed;
            listed = q;
        } else {
            link = &mesh->next[q];
        }
    }
    return listed;
}

void hull_levine(struct mesh *mesh, const struct extremes *extremes) {
    uint32_t corner[4];
    three_corners(mesh, extremes, corner);
    fourth_corner(mesh, corner);
    mesh_start(mesh, corner);
    for (uint32_t i = 0; i < mesh->count; i++) {
        mesh->outside[i] = 0;
    }
    uint32_t listed = MESH_NONE, left = MESH_NONE;
    for (unsigned k = 0; k < 4U; k++) {
        mesh->outside[corner[k]] = 1;
    }
    for (uint32_t i = 0; i < extremes->count; i++) {
        const uint32_t q = extremes->list[i];
        if (mesh->outside[q] == 0U) {
            mesh->outside[q] = 1;
            mesh->next[q] = listed;
            listed = q;
        }
    }
    for (uint32_t i = mesh->count; i-- != 0U;) {
        if (mesh->outside[i] == 0U) {
            mesh->next[i] = left;
            left = i;
        }
    }
    do { // at first all extreme points may be corners already
        add_listed(mesh, listed);
        left = test_all(mesh, left);
        listed = take_highest(mesh, &left);
    } while (listed != MESH_NONE);
}
