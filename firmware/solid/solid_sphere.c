#include "solid/solid_sphere.h"

/// The support, its sphere, and the same in rounded units for the filter.
struct pivot {
    const struct vec3 *points;
    struct solid_sphere *result;
    uint8_t count;
    uint32_t index[4];
    struct circumsphere sphere;
    /// The filter's units: the set's box has its low corner at 0 and is below 2^30 on each axis.
    struct vec3 low;
    uint8_t up, down;        ///< shifts from the points' unit to the filter's; one of them is 0
    int64_t x, y, z;         ///< centre, within 1 unit
    int64_t inside, outside; ///< squared distances below, above: surely so
    /// The same in units of 2^-30, for the points that the rounded units can't tell.
    struct vec3_i64 center_q30;
    struct i128 inside_q60, outside_q60;
};

/// Squares of distances are off by less than this: a point by 1 unit on each axis, the centre by 1,
/// each at most 2^30 away; and the square of the radius by 8 of its units.
#define BAND ((int64_t)1 << 35)

static void set_units(struct pivot *s, uint32_t count) {
    struct vec3 low = s->points[0], high = low;
    for (uint32_t i = 1; i < count; i++) {
        const struct vec3 p = s->points[i];
        low = vec3(p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z);
        high = vec3(p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y,
                    p.z > high.z ? p.z : high.z);
    }
    const unsigned bits = side_range_of(low, high).bits;
    s->low = low;
    s->up = (uint8_t)(bits < 30U ? 30U - bits : 0U);
    s->down = (uint8_t)(bits > 30U ? bits - 30U : 0U);
}

static int64_t to_units(const struct pivot *s, int32_t value, int32_t low) {
    return (((int64_t)value - low) << s->up) >> s->down;
}

/// From 2^-30 of the points' units.
static int64_t from_q30(const struct pivot *s, int64_t value) {
    return value >> (30U + s->down - s->up);
}

static void set_sphere(struct pivot *s, const struct circumsphere *sphere) {
    const int64_t one = (int64_t)1 << 30;
    s->sphere = *sphere;
    const struct vec3_i64 c = circumsphere_center_q30(sphere);
    s->x = from_q30(s, c.x - s->low.x * one);
    s->y = from_q30(s, c.y - s->low.y * one);
    s->z = from_q30(s, c.z - s->low.z * one);
    const int64_t radius_q30 = (int64_t)circumsphere_radius_q30(sphere, c);
    const int64_t radius = from_q30(s, radius_q30);
    s->inside = radius * radius - BAND;
    s->outside = radius * radius + BAND;
    // The radius is 1 to 4 units too large, and the centre off by less than 1.
    const int64_t surely_q30 = radius_q30 > 5 ? radius_q30 - 5 : 0;
    s->center_q30 = c;
    s->inside_q60 = i128_mul(surely_q30, surely_q30);
    s->outside_q60 = i128_mul(radius_q30, radius_q30);
}

static int64_t squared_distance(const struct pivot *s, struct vec3 p) {
    const int64_t x = to_units(s, p.x, s->low.x) - s->x, y = to_units(s, p.y, s->low.y) - s->y,
                  z = to_units(s, p.z, s->low.z) - s->z;
    return x * x + y * y + z * z;
}

/// Is the point outside? Its rounded squared distance is known.
static bool is_outside(const struct pivot *s, struct vec3 p, int64_t distance) {
    if (distance > s->outside || distance < s->inside) {
        return distance > s->outside;
    }
    const int64_t one = (int64_t)1 << 30;
    const struct vec3_i64 d =
        vec3_i64_sub((struct vec3_i64){p.x * one, p.y * one, p.z * one}, s->center_q30);
    const struct i128 square = vec3_i64_dot(d, d);
    if (i128_cmp(square, s->inside_q60) < 0 || i128_cmp(square, s->outside_q60) > 0) {
        return i128_cmp(square, s->outside_q60) > 0;
    }
    return circumsphere_side(&s->sphere, p) > 0;
}

/// Tries the subset `mask` of the candidates (the last one is always in it) as the new support.
static bool try_subset(struct pivot *s, const uint32_t *candidate, unsigned count, unsigned mask) {
    struct vec3 point[4];
    uint32_t index[4];
    uint8_t size = 0;
    for (unsigned i = 0; i < count; i++) {
        if ((mask >> i & 1U) != 0U) {
            index[size] = candidate[i];
            point[size++] = s->points[candidate[i]];
        }
    }
    struct circumsphere sphere;
    s->result->spheres_created++;
    if (!circumsphere_through(point, size, &sphere) || !circumsphere_is_smallest(&sphere)) {
        return false;
    }
    s->result->spheres_tested++;
    for (unsigned i = 0; i < count; i++) {
        if ((mask >> i & 1U) == 0U && circumsphere_side(&sphere, s->points[candidate[i]]) > 0) {
            return false;
        }
    }
    s->count = size;
    for (unsigned i = 0; i < size; i++) {
        s->index[i] = index[i];
    }
    set_sphere(s, &sphere);
    return true;
}

static unsigned bits_in(unsigned mask) {
    unsigned bits = 0;
    for (; mask != 0U; mask &= mask - 1U) {
        bits++;
    }
    return bits;
}

/// A point outside enters: the smallest sphere of the support and it becomes the sphere, which is
/// so larger than before. False: none of the subsets is it, which exact arithmetic rules out; the
/// loops end all the same.
static bool enter(struct pivot *s, uint32_t index) {
    uint32_t candidate[5];
    const unsigned count = s->count + 1U;
    for (unsigned i = 0; i < s->count; i++) {
        candidate[i] = s->index[i];
    }
    candidate[s->count] = index;
    const unsigned last = 1U << s->count;
    for (unsigned size = 2; size <= 4U; size++) {
        for (unsigned mask = 1; mask < last; mask++) {
            if (bits_in(mask) + 1U == size && try_subset(s, candidate, count, mask | last)) {
                s->result->pivots++;
                return true;
            }
        }
    }
    return false;
}

/// Pivots until no point of the list is outside. It ends: each pivot enlarges the sphere, and a
/// support has only one smallest sphere, so none of the subsets of at most four points comes twice.
static void solve_list(struct pivot *s, const uint32_t *list, uint32_t count) {
    for (;;) {
        int64_t farthest = -1;
        uint32_t entering = 0;
        for (uint32_t i = 0; i < count; i++) {
            const struct vec3 p = s->points[list[i]];
            const int64_t distance = squared_distance(s, p);
            if (distance > farthest && is_outside(s, p, distance)) {
                farthest = distance;
                entering = list[i];
            }
        }
        s->result->point_tests += count;
        if (farthest < 0 || !enter(s, entering)) {
            return;
        }
    }
}

/// Adds the points outside to the list as far as there is room. Returns: their number.
static uint32_t list_outside(struct pivot *s, uint32_t count, uint32_t *list, uint32_t *listed,
                             uint32_t room) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 p = s->points[i];
        const int64_t distance = squared_distance(s, p);
        if (distance >= s->inside && is_outside(s, p, distance)) {
            found++;
            if (*listed < room) {
                list[(*listed)++] = i;
            }
        }
    }
    s->result->point_tests += count;
    return found;
}

static void report(struct pivot *s) {
    struct solid_sphere *const r = s->result;
    r->center_q30 = circumsphere_center_q30(&s->sphere);
    r->radius_q30 = circumsphere_radius_q30(&s->sphere, r->center_q30);
    r->support_count = s->count;
    for (unsigned i = 0; i < s->count; i++) {
        unsigned at = i;
        for (; at != 0U && r->support[at - 1U] > s->index[i]; at--) {
            r->support[at] = r->support[at - 1U];
        }
        r->support[at] = s->index[i];
    }
}

enum solid_sphere_status solid_sphere_find(const struct vec3 *points, uint32_t count,
                                           void *workspace, size_t workspace_bytes,
                                           struct solid_sphere *result) {
    *result = (struct solid_sphere){0};
    if (count == 0U) {
        return SOLID_SPHERE_EMPTY;
    }
    if (count > SOLID_HULL_COUNT_MAX) {
        return SOLID_SPHERE_ERROR_COUNT;
    }
    if (workspace_bytes < SOLID_SPHERE_WORKSPACE_BYTES(count)) {
        return SOLID_SPHERE_ERROR_WORKSPACE;
    }
    uint32_t *const list = workspace;
    const uint32_t room = count / 32U + 256U;
    struct pivot s = {.points = points, .result = result, .count = 1};
    set_units(&s, count);
    struct circumsphere first;
    (void)circumsphere_through(points, 1, &first); // one point always has a sphere
    set_sphere(&s, &first);
    // The sample: all points where they fit, else a random half of the room, with repetitions.
    uint32_t listed = 0;
    uint64_t random = UINT64_C(0x9E3779B97F4A7C15);
    const uint32_t sample = count <= room ? count : room / 2U;
    for (; listed < sample; listed++) {
        random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        list[listed] = count <= room ? listed : (uint32_t)((random >> 32) * count >> 32);
    }
    solve_list(&s, list, listed);
    listed = 0;
    // At least one of those outside enters each time, and enlarges the sphere: this ends, too.
    for (uint64_t before = UINT64_MAX;
         before != result->pivots && list_outside(&s, count, list, &listed, room) != 0U;) {
        before = result->pivots;
        solve_list(&s, list, listed);
        listed = listed == room ? 0U : listed;
    }
    report(&s);
    return SOLID_SPHERE_OK;
}
