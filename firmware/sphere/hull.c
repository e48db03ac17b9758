#include "sphere/hull.h"

#include "fixed/root.h"
#include "sphere/hull_filter.h"
#include "sphere/hull_order.h"
#include "sphere/witness.h"

#include <stdbool.h>

/// The scan in progress. "Ray" is the half great circle from the pivot through a point: the points
/// are sorted by the angles of their rays, clockwise seen from outside.
struct scan {
    const struct vec3 *points;
    struct hull_pivot pivot;
    uint32_t pivot_index;
    struct hull_result *result;
};

static bool is_zero(struct vec3_i64 a) {
    return (a.x | a.y | a.z) == 0;
}

static bool same_ray(const struct scan *scan, struct vec3 a, struct vec3 b) {
    return hull_ray_equal(hull_ray(&scan->pivot, a), hull_ray(&scan->pivot, b));
}

/// Of points on one ray only the farthest from the pivot can be extreme. Keeps the first of equal
/// ones.
static uint32_t keep_farthest(const struct scan *scan, uint32_t *order, uint32_t count) {
    const struct vec3 pivot = scan->pivot.direction;
    uint32_t kept = 1;
    for (uint32_t i = 1; i < count; i++) {
        const struct vec3 last = scan->points[order[kept - 1U]], next = scan->points[order[i]];
        if (!same_ray(scan, last, next)) {
            order[kept++] = order[i];
            continue;
        }
        const struct vec3_i64 onward = vec3_cross(last, next);
        if (!is_zero(onward) && witness_same_sense(onward, vec3_cross(pivot, last))) {
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
        const int side = vec3_det_sign(scan->pivot.direction, a, b);
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
                                  uint32_t *list, uint32_t *first, uint32_t *last) {
    const struct vec3 *p = scan->points;
    uint32_t j = 0, k = 1;
    list[0] = scan->pivot_index;
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

/// Takes the points that are parallel to the pivot (the first of the list) off the list; fails on
/// an opposite one.
static enum hull_status gather(const struct scan *scan, uint32_t *list, uint32_t *count) {
    const struct vec3 pivot = scan->pivot.direction;
    uint32_t size = 0;
    for (uint32_t i = 1; i < *count; i++) {
        const struct vec3 point = scan->points[list[i]];
        if (!is_zero(vec3_cross(pivot, point))) {
            list[size++] = list[i];
        } else if (i128_sign(vec3_dot(pivot, point)) < 0) {
            const uint32_t pair[2] = {scan->pivot_index, list[i]};
            return not_hemispherical(scan, pair, 2);
        }
    }
    *count = size;
    return HULL_OK;
}

/// The workspace, cut up: four lists of `room` indices, one of room + 1.
struct lists {
    uint32_t *buffer, *spare, *list, *starts;
};

/// The rays' points in clockwise order, one a ray, behind the gap if there is one. *count becomes
/// the number of rays.
static uint32_t *order_rays(struct scan *scan, enum hull_order order, const struct lists *lists,
                            uint32_t *count) {
    uint32_t *sorted = lists->buffer, *turned = lists->spare;
    if (order == HULL_ORDER_MERGE) {
        hull_order_merge(&scan->pivot, sorted, turned, *count);
    } else {
        sorted = lists->spare;
        turned = lists->buffer;
        hull_order_buckets(&scan->pivot, turned, sorted, lists->list, lists->starts, *count);
    }
    const uint32_t rays = keep_farthest(scan, sorted, *count);
    const uint32_t start = ray_after_gap(scan, sorted, rays);
    *count = rays;
    if (start == 0U) {
        return sorted;
    }
    for (uint32_t i = 0; i < rays; i++) {
        turned[i] = sorted[i + start < rays ? i + start : i + start - rays];
    }
    return turned;
}

/// The hull of count >= 1 points, listed in lists->buffer, ascending.
static enum hull_status solve_list(const struct vec3 *points, uint32_t count, enum hull_order order,
                                   const struct lists *lists, struct hull_result *result) {
    struct scan scan = {points, hull_pivot(points, lists->buffer[0]), lists->buffer[0], result};
    uint32_t rays = count, first = 0, last = 0;
    result->vertices = NULL; // of the sample
    result->vertex_count = 0;
    const enum hull_status gathered = gather(&scan, lists->buffer, &rays);
    if (gathered != HULL_OK) {
        return gathered;
    }
    uint32_t *list = lists->list;
    uint32_t *sorted = lists->buffer;
    if (rays != 0U) {
        sorted = order_rays(&scan, order, lists, &rays);
        result->comparisons += scan.pivot.comparisons;
    }
    list[0] = scan.pivot_index;
    if (rays == 1U) {
        list[1] = sorted[0];
        last = 1;
    } else if (rays == 2U &&
               vec3_det_sign(scan.pivot.direction, points[sorted[0]], points[sorted[1]]) == 0) {
        // All on one great circle, on both sides of the pivot: an arc shorter than a half turn, or
        // too long.
        const struct vec3_i64 span = vec3_cross(points[sorted[0]], points[sorted[1]]);
        if (is_zero(span) ||
            !witness_same_sense(span, vec3_cross(points[sorted[0]], scan.pivot.direction))) {
            const uint32_t candidates[3] = {scan.pivot_index, sorted[0], sorted[1]};
            return not_hemispherical(&scan, candidates, 3);
        }
        list[0] = sorted[0];
        list[1] = sorted[1];
        last = 1;
    } else if (rays >= 2U) {
        const enum hull_status scanned = scan_rays(&scan, sorted, rays, list, &first, &last);
        if (scanned != HULL_OK) {
            return scanned;
        }
    }
    finish(&scan, list, first, last, lists->buffer);
    return HULL_OK;
}

// ---------------------------------------------------------------- the sample

/// Fewer points are not worth a sample.
#define FILTER_COUNT_MIN 64U

/// Solves about 3 sqrt(count) points, evenly strided, and lists the points that are not inside a
/// polygon of up to HULL_FILTER_CORNERS of their corners: all that can be corners of the hull.
static enum hull_status sift(const struct vec3 *points, uint32_t count, enum hull_order order,
                             const struct lists *lists, struct hull_result *result,
                             uint32_t *kept) {
    const uint32_t stride = count / (3U * root_u32(count));
    uint32_t sample = 0;
    for (uint32_t i = 0; i<count; i += stride> 0U ? stride : 1U) {
        lists->buffer[sample++] = i;
    }
    const enum hull_status status = solve_list(points, sample, order, lists, result);
    if (status != HULL_OK) {
        return status; // the witness is one of all points, too
    }
    uint32_t corners[HULL_FILTER_CORNERS];
    const uint32_t size = result->vertex_count;
    const uint32_t thinned = size < HULL_FILTER_CORNERS ? size : HULL_FILTER_CORNERS;
    for (uint32_t i = 0; i < thinned; i++) {
        corners[i] = result->vertices[(uint64_t)i * size / thinned];
    }
    if (size < 3U) { // no polygon to be inside of
        for (uint32_t i = 0; i < count; i++) {
            lists->buffer[i] = i;
        }
        *kept = count;
        return HULL_OK;
    }
    const struct hull_filter filter = hull_filter(points, corners, thinned);
    *kept = hull_filter_apply(&filter, points, count, lists->buffer);
    return HULL_OK;
}

enum hull_status hull_by(const struct vec3 *points, uint32_t count,
                         const struct hull_options *options, void *workspace,
                         size_t workspace_bytes, struct hull_result *result) {
    *result = (struct hull_result){0};
    if (count == 0U) {
        return HULL_EMPTY;
    }
    if (workspace_bytes < HULL_WORKSPACE_BYTES(count)) {
        return HULL_ERROR_WORKSPACE;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (vec3_is_zero(points[i])) {
            result->bad_index = i;
            return HULL_ERROR_ZERO_VECTOR;
        }
    }
    uint32_t *words = workspace;
    const struct lists lists = {words, words + count, words + 2U * (size_t)count,
                                words + 3U * (size_t)count};
    uint32_t kept = count;
    if (options->filter && count >= FILTER_COUNT_MIN) {
        const enum hull_status status = sift(points, count, options->order, &lists, result, &kept);
        if (status != HULL_OK) {
            return status;
        }
    } else {
        for (uint32_t i = 0; i < count; i++) {
            lists.buffer[i] = i;
        }
    }
    result->kept = kept;
    return solve_list(points, kept, options->order, &lists, result);
}

enum hull_status hull_spherical(const struct vec3 *points, uint32_t count, void *workspace,
                                size_t workspace_bytes, struct hull_result *result) {
    const struct hull_options options = {.order = HULL_ORDER_BUCKETS, .filter = true};
    return hull_by(points, count, &options, workspace, workspace_bytes, result);
}
