#include "sphere/voronoi_mesh.h"

#include "fixed/root_sum.h"
#include "fixed/sort.h"

// ---------------------------------------------------------------- sites

bool voronoi_is_front(struct vec3 a) {
    return a.x != 0 ? a.x > 0 : (a.y != 0 ? a.y > 0 : a.z > 0);
}

/// With p = (0, e, -1), e infinitesimal: the sign of p . (a x b), and where that is zero, which of
/// the two, then in the plane of y and z, is nearer to p.
static bool site_before(const void *points, uint32_t index_a, uint32_t index_b) {
    const struct vec3 a = ((const struct vec3 *)points)[index_a],
                      b = ((const struct vec3 *)points)[index_b];
    const bool front = voronoi_is_front(a);
    if (front != voronoi_is_front(b)) {
        return front;
    }
    const struct vec3_i64 cross = vec3_cross(a, b);
    if (cross.z != 0) {
        return cross.z < 0;
    }
    if (cross.y != 0) {
        return cross.y > 0;
    }
    return front ? cross.x > 0 : cross.x < 0;
}

void voronoi_sites(struct voronoi_mesh *mesh, void *memory, const struct vec3 *points,
                   const uint32_t *list, uint32_t count, uint32_t *spare) {
    struct site *const site = memory;
    struct voronoi_triangle *const triangle = (struct voronoi_triangle *)(void *)(site + count);
    uint32_t *const point = (uint32_t *)(void *)(triangle + 2U * (size_t)count);
    *mesh = (struct voronoi_mesh){.site = site, .point = point, .triangle = triangle};
    for (uint32_t i = 0; i < count; i++) {
        point[i] = list != NULL ? list[i] : i;
    }
    sort_indices(point, spare, count, site_before, points);
    for (uint32_t i = 0; i < count; i++) {
        // Stable: of equal directions the first point leads.
        if (i == 0U || site_before(points, point[mesh->site_count - 1U], point[i])) {
            point[mesh->site_count] = point[i];
            site[mesh->site_count++] = site_from(points[point[i]]);
        }
    }
}

// ---------------------------------------------------------------- sides

/// For sites on one great circle: the sign of the first component that is not zero of the normal
/// (b - a) x (c - a) of their unit vectors. Times their lengths: a x b |c| + b x c |a| + c x a |b|.
static int turn_sign(const struct site *a, const struct site *b, const struct site *c) {
    const struct vec3_i64 cross[3] = {vec3_cross(b->vector, c->vector),
                                      vec3_cross(c->vector, a->vector),
                                      vec3_cross(a->vector, b->vector)};
    const struct site *const across[3] = {a, b, c};
    const bool x = (cross[0].x | cross[1].x | cross[2].x) != 0,
               y = (cross[0].y | cross[1].y | cross[2].y) != 0;
    struct root_term term[3];
    for (unsigned i = 0; i < 3U; i++) {
        const int64_t size = x ? cross[i].x : (y ? cross[i].y : cross[i].z);
        root_term_set(&term[i], size > 0 ? 1 : -1, (struct u128){u64_abs(size), 0},
                      (struct u128){vec3_norm2(across[i]->vector), 0});
    }
    return root_sum_3(&term[0], &term[1], &term[2]);
}

/// Which way the normal of three sites of one circle points: from zero, or on a great circle by
/// turn_sign.
static int normal_sign(const struct site *a, const struct site *b, const struct site *c) {
    const int sign = site_side(a, b, c);
    return sign != 0 ? sign : turn_sign(a, b, c);
}

int voronoi_side(struct voronoi_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    mesh->side_tests++;
    const struct site *const s = mesh->site;
    const int sign = site_plane_sign(&s[a], &s[b], &s[c], &s[d]);
    if (sign != 0) {
        return sign;
    }
    // On one circle. With a the site that is displaced most, the volume gets the sign of -det(b, c,
    // d) by moving it outward, and on a great circle that of -(normal of b, c, d) along the first
    // axis that is not in the plane.
    if (a < b && a < c && a < d) {
        return -normal_sign(&s[b], &s[c], &s[d]);
    }
    if (b < c && b < d) { // each swap of two turns the sign
        return normal_sign(&s[a], &s[c], &s[d]);
    }
    return c < d ? -normal_sign(&s[a], &s[b], &s[d]) : normal_sign(&s[a], &s[b], &s[c]);
}

bool voronoi_mesh_joined(const struct voronoi_mesh *mesh, uint32_t t, unsigned i) {
    const struct site *const s = mesh->site;
    const uint32_t *const here = mesh->triangle[t].site;
    const struct voronoi_triangle *const there = &mesh->triangle[mesh->triangle[t].next[i]];
    for (unsigned k = 0; k < 3U; k++) {
        const uint32_t apex = there->site[k];
        if (apex != here[0] && apex != here[1] && apex != here[2] &&
            site_plane_sign(&s[here[0]], &s[here[1]], &s[here[2]], &s[apex]) != 0) {
            return false;
        }
    }
    return normal_sign(&s[here[0]], &s[here[1]], &s[here[2]]) ==
           normal_sign(&s[there->site[0]], &s[there->site[1]], &s[there->site[2]]);
}

void voronoi_mesh_few(struct voronoi_mesh *mesh) {
    mesh->triangle_count = 0;
    if (mesh->site_count == 3U) {
        mesh->triangle[0] = (struct voronoi_triangle){{0, 1, 2}, {1, 1, 1}};
        mesh->triangle[1] = (struct voronoi_triangle){{0, 2, 1}, {0, 0, 0}};
        mesh->triangle_count = 2;
    }
}
