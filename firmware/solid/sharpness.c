#include "solid/sharpness.h"

#include "fixed/trig.h"

static struct vec3 unit_between(struct vec3 from, struct vec3 to) {
    return vec3_i64_normalise(side_between(from, to));
}

/// The solid angle of the triangle of three unit vectors, in half BAM: 2^33 a turn, 2^34 a sphere.
static int64_t excess(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3_i64 n = vec3_cross(b, c);
    const struct vec3 rounded = {(int32_t)round_shift_i64(n.x, 30),
                                 (int32_t)round_shift_i64(n.y, 30),
                                 (int32_t)round_shift_i64(n.z, 30)};
    const int64_t det = vec3_dot_unit(a, rounded);
    const int64_t rest =
        ((int64_t)1 << 60) + vec3_dot_unit(a, b) + vec3_dot_unit(b, c) + vec3_dot_unit(c, a);
    return trig_atan2(det < 0 ? -det : det, rest).bam; // 0 to half a turn
}

static void solid_angles(const struct vec3 *points, const struct solid_hull *hull, int64_t *angle,
                         uint32_t *neighbour) {
    for (uint32_t f = 0; f < hull->face_count; f++) {
        for (unsigned k = 0; k < 3U; k++) {
            neighbour[hull->faces[f].vertex[k]] = hull->faces[f].vertex[(k + 1U) % 3U];
        }
    }
    // A fan about each vertex' neighbour: the triangles at that one itself have no size.
    for (uint32_t f = 0; f < hull->face_count; f++) {
        for (unsigned k = 0; k < 3U; k++) {
            const uint32_t v = hull->faces[f].vertex[k], a = hull->faces[f].vertex[(k + 1U) % 3U],
                           b = hull->faces[f].vertex[(k + 2U) % 3U];
            if (a != neighbour[v] && b != neighbour[v]) {
                angle[v] +=
                    excess(unit_between(points[v], points[neighbour[v]]),
                           unit_between(points[v], points[a]), unit_between(points[v], points[b]));
            }
        }
    }
}

/// Of a polygon: by the cosine, which falls as the angle grows.
static void plane_angles(const struct vec3 *points, const struct solid_hull *hull, int64_t *angle) {
    const uint32_t n = hull->vertex_count;
    for (uint32_t i = 0; i < n; i++) {
        const struct vec3 at = points[hull->vertices[i]];
        angle[hull->vertices[i]] =
            -vec3_dot_unit(unit_between(at, points[hull->vertices[(i + 1U) % n]]),
                           unit_between(at, points[hull->vertices[(i + n - 1U) % n]]));
    }
}

void sharpness_sort(const struct vec3 *points, uint32_t count, const struct solid_hull *hull,
                    int64_t *angle, uint32_t *neighbour, uint32_t *order) {
    for (uint32_t i = 0; i < count; i++) {
        angle[i] = 0;
    }
    if (hull->dimension == 3U) {
        solid_angles(points, hull, angle, neighbour);
    } else if (hull->dimension == 2U) {
        plane_angles(points, hull, angle);
    }
    for (uint32_t i = 0; i < hull->vertex_count; i++) { // by insertion: the trials take far longer
        const uint32_t v = hull->vertices[i];
        uint32_t at = i;
        while (at != 0U && (angle[order[at - 1U]] > angle[v] ||
                            (angle[order[at - 1U]] == angle[v] && order[at - 1U] > v))) {
            order[at] = order[at - 1U];
            at--;
        }
        order[at] = v;
    }
}
