#include "sphere/shrink.h"

#include "sphere/cone_settle.h"

/// The corner strictly between lo and hi that the circle through both meets first as it shrinks; lo
/// if all lie inside the circle on the diameter lo hi. The smaller the circle, the farther its
/// centre moves past the corners: x is met before w if it lies outside the circle through lo, hi
/// and w.
static uint32_t first_met(const struct site *corner, uint32_t lo, uint32_t hi) {
    uint32_t met = lo;
    for (uint32_t i = lo + 1U; i < hi; i++) {
        if (site_cap_sign(&corner[hi], &corner[lo], &corner[i]) > 0 &&
            (met == lo ||
             site_plane_sign(&corner[lo], &corner[hi], &corner[met], &corner[i]) < 0)) {
            met = i;
        }
    }
    return met;
}

/// Shrinks the circle through the corners lo and hi, which at first is the great circle of a hull's
/// edge. Returns how many of `contact` hold the last circle.
static uint8_t shrink(const struct site *corner, uint32_t size, struct shrink_result *result,
                      uint32_t contact[3]) {
    uint32_t lo = 0, hi = size - 1U;
    for (;;) {
        result->iterations++;
        result->corner_reads += hi - lo - 1U;
        const uint32_t met = first_met(corner, lo, hi);
        contact[0] = lo;
        contact[1] = hi;
        contact[2] = met;
        if (met == lo) {
            return 2; // the two ends of a diameter
        }
        // Without an obtuse angle the contacts lie on no half of the circle (Lemma 2). The corner
        // at an obtuse angle lies within the arc of the other two, and does not hold the next
        // circle.
        if (site_cap_sign(&corner[lo], &corner[met], &corner[hi]) < 0) {
            hi = met;
        } else if (site_cap_sign(&corner[hi], &corner[met], &corner[lo]) < 0) {
            lo = met;
        } else {
            return 3;
        }
    }
}

enum cone_status shrink_narrowest(const struct vec3 *points, uint32_t count, void *workspace,
                                  size_t workspace_bytes, struct shrink_result *result) {
    *result = (struct shrink_result){0};
    const enum cone_status start = cone_settle_start(points, count, &result->cone);
    if (start != CONE_OK) {
        return start;
    }
    if (workspace_bytes < SHRINK_WORKSPACE_BYTES(count)) {
        return CONE_ERROR_WORKSPACE;
    }
    struct site *corner = workspace;
    struct hull_result hull;
    if (hull_spherical(points, count, corner + count, HULL_WORKSPACE_BYTES(count), &hull) !=
        HULL_OK) {
        return cone_settle_witness(points, hull.witness, hull.witness_count, &result->cone);
    }
    const uint32_t size = hull.vertex_count;
    result->cone.point_reads += count;
    result->hull_size = size;
    for (uint32_t i = 0; i < size; i++) {
        corner[i] = site_from(points[hull.vertices[i]]);
    }
    uint32_t support[3] = {0, 1, 0};
    const uint8_t contacts = size < 3U ? (uint8_t)size : shrink(corner, size, result, support);
    for (uint8_t i = 0; i < contacts; i++) {
        support[i] = hull.vertices[support[i]];
    }
    result->cone.point_reads += result->corner_reads;
    return cone_settle_support(points, count, support, contacts, &result->cone);
}
