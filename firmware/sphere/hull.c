#include "sphere/hull.h"

#include "sphere/witness.h"

#include <stdbool.h>

/// The scan in progress. "Ray" is the half great circle from the pivot through a point: the points
/// are sorted by the angles of their rays, clockwise seen from outside.
struct scan {
    const struct vec3 *points;
    struct vec3 pivot;
    struct vec3 first_ray; // where the angular order starts
    struct hull_result *result;
};

static bool is_zero(struct vec3_i64 a) {
    return (a.x | a.y | a.z) == 0;
}

static bool same_ray(const struct scan *scan, struct vec3 a, struct vec3 b) {
    const struct vec3_i64 to_a = vec3_cross(scan->pivot, a), to_b = vec3_cross(scan->pivot, b);
    return vec3_det_sign(scan->pivot, a, b) == 0 && witness_same_sense(to_a, to_b);
}

/// 0 for rays less than a half turn clockwise from the first ray, else 1.
static int half_turn(const struct scan *scan, struct vec3 a) {
    const int side = vec3_det_sign(scan->pivot, scan->first_ray, a);
    if (side != 0) {
        return side < 0 ? 0 : 1;
    }
    return same_ray(scan, scan->first_ray, a) ? 0 : 1;
}

/// Does the ray of a come strictly before that of b?
static bool before(const struct scan *scan, struct vec3 a, struct vec3 b) {
    const int half_a = half_turn(scan, a), half_b = half_turn(scan, b);
    return half_a != half_b ? half_a < half_b : vec3_det_sign(scan->pivot, a, b) < 0;
}

/// Bottom-up merge sort, stable. Returns which of the two buffers holds the result.
static uint32_t *sort_by_angle(const struct scan *scan, uint32_t *list, uint32_t *spare,
                               uint32_t count) {
    uint32_t *from = list, *to = spare;
    for (uint32_t width = 1; width < count; width *= 2U) {
        for (uint32_t start = 0; start < count; start += 2U * width) {
            const uint32_t middle = count - start < width ? count : start + width;
            const uint32_t end = count - middle < width ? count : middle + width;
            uint32_t left = start, right = middle;
            for (uint32_t at = start; at < end; at++) {
                const bool take_right =
                    right < end && (left >= middle || before(scan, scan->points[from[right]],
                                                             scan->points[from[left]]));
                to[at] = take_right ? from[right++] : from[left++];
            }
        }
        uint32_t *swap = from;
        from = to;
        to = swap;
    }
    return from;
}

/// Of points on one ray only the farthest from the pivot can be extreme. Keeps the first of equal
/// ones.
static uint32_t keep_farthest(const struct scan *scan, uint32_t *order, uint32_t count) {
    uint32_t kept = 1;
    for (uint32_t i = 1; i < count; i++) {
        const struct vec3 last = scan->points[order[kept - 1U]], next = scan->points[order[i]];
        if (!same_ray(scan, last, next)) {
            order[kept++] = order[i];
            continue;
        }
        const struct vec3_i64 onward = vec3_cross(last, next);
        if (!is_zero(onward) && witness_same_sense(onward, vec3_cross(scan->pivot, last))) {
            order[kept - 1U] = order[i];
        }
    }
    return kept;
}

/// The pivot is extreme if and only if some clockwise gap between neighbouring rays is a half turn
/// or more; the order must then start behind the gap, or a true vertex is lost (docs/geometry.md,
/// "The hull"). Returns the index of the ray after the gap, 0 if there is none.
static uint32_t ray_after_gap(const struct scan *scan, const uint32_t *order, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t next = i + 1U < count ? i + 1U : 0U;
        const struct vec3 a = scan->points[order[i]], b = scan->points[order[next]];
        const int side = vec3_det_sign(scan->pivot, a, b);
        if (side > 0 || (side == 0 && !same_ray(scan, a, b))) {
            return next;
        }
    }
    return 0;
}

static enum hull_status not_hemispherical(const struct scan *scan, const uint32_t *candidates,
                                          uint8_t count) {
    scan->result->witness_count =
        witness_find(scan->points, candidates, count, scan->result->witness);
    return HULL_NOT_HEMISPHERICAL;
}

/// The opposite of point `index` lies in the closed polygon: finds the triangle of its fan that
/// holds it.
static enum hull_status opposite_inside(const struct scan *scan, const uint32_t *polygon,
                                        uint32_t size, uint32_t index) {
    if (size == 2U) {
        const uint32_t candidates[3] = {polygon[0], polygon[1], index};
        return not_hemispherical(scan, candidates, 3);
    }
    for (uint32_t i = 1; i + 1U < size; i++) {
        const uint32_t candidates[4] = {polygon[0], polygon[i], polygon[i + 1U], index};
        if (not_hemispherical(scan, candidates, 4) == HULL_NOT_HEMISPHERICAL &&
            scan->result->witness_count != 0U) {
            break;
        }
    }
    return HULL_NOT_HEMISPHERICAL;
}

/// Anderson's scan, corrected. order: count >= 2 rays, clockwise, gap first. Vertices go to
/// list[*first..*last].
static enum hull_status scan_rays(const struct scan *scan, const uint32_t *order, uint32_t count,
                                  uint32_t pivot_index, uint32_t *list, uint32_t *first,
                                  uint32_t *last) {
    const struct vec3 *p = scan->points;
    uint32_t j = 0, k = 1;
    list[0] = pivot_index;
    list[1] = order[0];
    for (uint32_t i = 1; i < count; i++) {
        const struct vec3 next = p[order[i]];
        if (k - j >= 2U && vec3_det_sign(p[list[k]], p[list[j]], next) <= 0) {
            continue; // right of the closing edge: inside the hull so far, or on it
        }
        const uint32_t tail = k;
        while (k > j && vec3_det_sign(p[list[k - 1U]], p[list[k]], next) >= 0) {
            k--;
        }
        if (k == j) {
            return opposite_inside(scan, list + j, tail - j + 1U, order[i]);
        }
        while (vec3_det_sign(p[list[j]], p[list[j + 1U]], next) >= 0) {
            j++;
        }
        list[++k] = order[i];
    }
    *first = j;
    *last = k;
    return HULL_OK;
}

/// Turns list[first..last] so that the smallest index leads, into `turned`.
static void finish(struct scan *scan, const uint32_t *list, uint32_t first, uint32_t last,
                   uint32_t *turned) {
    const uint32_t size = last - first + 1U;
    uint32_t lead = 0;
    for (uint32_t i = 1; i < size; i++) {
        lead = list[first + i] < list[first + lead] ? i : lead;
    }
    for (uint32_t i = 0; i < size; i++) {
        const uint32_t from = lead + i < size ? lead + i : lead + i - size;
        turned[i] = list[first + from];
    }
    scan->result->vertices = turned;
    scan->result->vertex_count = size;
}

/// Lists the points that are not parallel to the pivot (index 0); fails on a zero or an opposite
/// one.
static enum hull_status gather(struct scan *scan, uint32_t count, uint32_t *list,
                               uint32_t *gathered) {
    uint32_t size = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (vec3_is_zero(scan->points[i])) {
            scan->result->bad_index = i;
            return HULL_ERROR_ZERO_VECTOR;
        }
    }
    for (uint32_t i = 1; i < count; i++) {
        if (!is_zero(vec3_cross(scan->pivot, scan->points[i]))) {
            list[size++] = i;
        } else if (i128_sign(vec3_dot(scan->pivot, scan->points[i])) < 0) {
            const uint32_t pair[2] = {0, i};
            return not_hemispherical(scan, pair, 2);
        }
    }
    *gathered = size;
    return HULL_OK;
}

enum hull_status hull_spherical(const struct vec3 *points, uint32_t count, void *workspace,
                                size_t workspace_bytes, struct hull_result *result) {
    *result = (struct hull_result){0};
    if (count == 0U) {
        return HULL_EMPTY;
    }
    if (workspace_bytes < HULL_WORKSPACE_BYTES(count)) {
        return HULL_ERROR_WORKSPACE;
    }
    uint32_t *buffer = workspace, *list = buffer + 2U * (size_t)count;
    struct scan scan = {points, points[0], points[0], result};
    uint32_t rays;
    const enum hull_status gathered = gather(&scan, count, buffer, &rays);
    if (gathered != HULL_OK) {
        return gathered;
    }
    uint32_t first = 0, last = 0;
    list[0] = 0;
    if (rays != 0U) {
        scan.first_ray = points[buffer[0]];
        uint32_t *order = sort_by_angle(&scan, buffer, buffer + count, rays);
        rays = keep_farthest(&scan, order, rays);
        const uint32_t start = ray_after_gap(&scan, order, rays);
        if (start != 0U) { // the pivot is extreme: begin behind the gap
            scan.first_ray = points[order[start]];
            uint32_t *spare = order == buffer ? buffer + count : buffer;
            for (uint32_t i = 0; i < rays; i++) {
                spare[i] = order[i + start < rays ? i + start : i + start - rays];
            }
            order = spare;
        }
        if (rays == 1U) {
            list[1] = order[0];
            last = 1;
        } else if (rays == 2U &&
                   vec3_det_sign(points[0], points[order[0]], points[order[1]]) == 0) {
            // All on one great circle, on both sides of the pivot: an arc shorter than a half turn,
            // or too long.
            const struct vec3_i64 span = vec3_cross(points[order[0]], points[order[1]]);
            if (is_zero(span) ||
                !witness_same_sense(span, vec3_cross(points[order[0]], points[0]))) {
                const uint32_t candidates[3] = {0, order[0], order[1]};
                return not_hemispherical(&scan, candidates, 3);
            }
            list[0] = order[0];
            list[1] = order[1];
            last = 1;
        } else {
            const enum hull_status scanned = scan_rays(&scan, order, rays, 0, list, &first, &last);
            if (scanned != HULL_OK) {
                return scanned;
            }
        }
    }
    finish(&scan, list, first, last, buffer);
    return HULL_OK;
}
