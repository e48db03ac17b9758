#include "solid/sharpness.h"
#include "solid/solid_sphere.h"

struct trial {
    const struct vec3 *points;
    const uint32_t *order;
    uint32_t count;
    struct solid_sphere *result;
};

/// Makes the sphere through the points at these places and tests it. True: it is the smallest one.
static bool try_sphere(struct trial *t, const uint32_t *place, uint8_t count) {
    struct vec3 point[4];
    for (unsigned i = 0; i < count; i++) {
        point[i] = t->points[t->order[place[i]]];
    }
    struct circumsphere sphere;
    t->result->spheres_created++;
    if (!circumsphere_through(point, count, &sphere) || !circumsphere_is_smallest(&sphere)) {
        return false;
    }
    t->result->spheres_tested++;
    for (uint32_t i = 0; i < t->count; i++) {
        t->result->point_tests++;
        if (circumsphere_side(&sphere, t->points[t->order[i]]) > 0) {
            return false;
        }
    }
    t->result->center_q30 = circumsphere_center_q30(&sphere);
    t->result->radius_q30 = circumsphere_radius_q30(&sphere, t->result->center_q30);
    t->result->support_count = count;
    for (unsigned i = 0; i < count; i++) {
        const uint32_t index = t->order[place[i]];
        unsigned at = i;
        t->result->place[i] = place[i];
        for (; at != 0U && t->result->support[at - 1U] > index; at--) {
            t->result->support[at] = t->result->support[at - 1U];
        }
        t->result->support[at] = index;
    }
    return true;
}

/// Step 2: the two points farthest apart; of equal pairs the first.
static bool try_pair(struct trial *t) {
    uint32_t best[2] = {0, 1};
    struct i128 distance = i128_from_i64(-1);
    for (uint32_t i = 0; i < t->count; i++) {
        for (uint32_t k = i + 1U; k < t->count; k++) {
            const struct vec3_i64 d = side_between(t->points[t->order[i]], t->points[t->order[k]]);
            const struct i128 square = vec3_i64_dot(d, d);
            if (i128_cmp(square, distance) > 0) {
                distance = square;
                best[0] = i;
                best[1] = k;
            }
        }
    }
    return try_sphere(t, best, 2);
}

/// Step 3, for the points before `last` and (if it is one) the point at `last`.
static bool try_with(struct trial *t, uint32_t last) {
    for (uint32_t i = 0; i + 2U < last; i++) {
        for (uint32_t j = i + 1U; j + 1U < last; j++) {
            for (uint32_t k = j + 1U; k < last; k++) {
                const uint32_t place[4] = {i, j, k, last};
                if ((k + 1U == last && try_sphere(t, place, 3)) ||
                    (last < t->count && try_sphere(t, place, 4))) {
                    return true;
                }
            }
        }
    }
    return false;
}

static enum solid_sphere_status search(struct trial *t, uint32_t place_most) {
    if (t->count == 1U) {
        const uint32_t only[1] = {0};
        return try_sphere(t, only, 1) ? SOLID_SPHERE_OK : SOLID_SPHERE_NOT_FOUND;
    }
    if (try_pair(t)) {
        return SOLID_SPHERE_OK;
    }
    // One past the end: the spheres of three with the last point come up there.
    for (uint32_t last = 3; last <= t->count; last++) {
        if (place_most != 0U && last >= place_most) {
            return SOLID_SPHERE_NOT_FOUND;
        }
        if (try_with(t, last)) {
            return SOLID_SPHERE_OK;
        }
    }
    return SOLID_SPHERE_NOT_FOUND;
}

enum solid_sphere_status solid_sphere_by_trial(const struct vec3 *points, uint32_t count,
                                               enum solid_sphere_order order, uint32_t place_most,
                                               void *workspace, size_t workspace_bytes,
                                               struct solid_sphere *result) {
    *result = (struct solid_sphere){0};
    if (count == 0U) {
        return SOLID_SPHERE_EMPTY;
    }
    if (count > SOLID_HULL_COUNT_MAX) {
        return SOLID_SPHERE_ERROR_COUNT;
    }
    if (workspace_bytes < SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(count)) {
        return SOLID_SPHERE_ERROR_WORKSPACE;
    }
    // The hull stays where it is; what follows goes in front of it.
    int64_t *const angle = workspace;
    uint32_t *const neighbour = (uint32_t *)(void *)(angle + count);
    uint32_t *const sharpest = neighbour + count;
    void *const rest = (unsigned char *)workspace + ((size_t)count + 4U) * 16U;
    struct solid_hull hull;
    if (solid_hull_find(points, count, SOLID_HULL_CAPS, rest, SOLID_HULL_WORKSPACE_BYTES(count),
                        &hull) != SOLID_HULL_OK) {
        return SOLID_SPHERE_ERROR_WORKSPACE;
    }
    struct trial trial = {points, hull.vertices, hull.vertex_count, result};
    if (order == SOLID_SPHERE_SHARPEST_FIRST) {
        sharpness_sort(points, count, &hull, angle, neighbour, sharpest);
        trial.order = sharpest;
    }
    return search(&trial, place_most);
}
