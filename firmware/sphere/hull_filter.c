#include "sphere/hull_filter.h"

#include <stdbool.h>

/// A normal scaled to 30 bits, rounded down: off by less than 1 a component.
static struct vec3 short_normal(struct vec3 a, struct vec3 b) {
    const struct vec3_i64 n = vec3_cross(a, b);
    const uint64_t size = u64_abs(n.x) | u64_abs(n.y) | u64_abs(n.z);
    const unsigned zeros = u64_leading_zeros(size);
    const unsigned shift = zeros < 34U ? 34U - zeros : 0U;
    const int64_t scale = zeros > 34U ? (int64_t)1 << (zeros - 34U) : 1;
    return vec3((int32_t)((n.x >> shift) * scale), (int32_t)((n.y >> shift) * scale),
                (int32_t)((n.z >> shift) * scale));
}

struct hull_filter hull_filter(const struct vec3 *points, const uint32_t *corners, uint32_t count) {
    struct hull_filter filter = {.corners = count, .has_inner = count > 4U};
    for (uint32_t i = 0; filter.has_inner && i < 4U; i++) {
        const uint32_t next = i < 3U ? count * (i + 1U) / 4U : 0U;
        filter.inner[i] = short_normal(points[corners[count * i / 4U]], points[corners[next]]);
    }
    for (uint32_t i = 1; i < count; i++) {
        const struct vec3 here = points[corners[i]],
                          next = points[corners[i + 1U < count ? i + 1U : 0U]];
        filter.spoke[i] = short_normal(points[corners[0]], here);
        filter.edge[i] = short_normal(here, next);
    }
    return filter;
}

/// Below 3 * 2^30 * 2^31 < 2^63; off by less than 3 * 2^31.
static inline int64_t dot(struct vec3 normal, struct vec3 point) {
    return (int64_t)normal.x * point.x + (int64_t)normal.y * point.y + (int64_t)normal.z * point.z;
}

#define DOT_ERROR ((int64_t)3 << 31)

/// All four are looked at whatever the first says: a branch that is taken at random costs more.
static inline bool is_surely_inner(const struct hull_filter *filter, struct vec3 point) {
    const struct vec3 *const edge = filter->inner;
    const int64_t a = dot(edge[0], point), b = dot(edge[1], point), c = dot(edge[2], point),
                  d = dot(edge[3], point);
    const int64_t ab = a > b ? a : b, cd = c > d ? c : d;
    return (ab > cd ? ab : cd) < -DOT_ERROR;
}

static bool is_surely_inside(const struct hull_filter *filter, struct vec3 point) {
    // The last spoke that the point is right of; clockwise, so the next one is right of this one.
    uint32_t low = 1, high = filter->corners - 1U;
    while (high - low > 1U) {
        const uint32_t middle = (low + high) / 2U;
        if (dot(filter->spoke[middle], point) < 0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return dot(filter->spoke[low], point) < -DOT_ERROR &&
           dot(filter->spoke[high], point) > DOT_ERROR &&
           dot(filter->edge[low], point) < -DOT_ERROR;
}

uint32_t hull_filter_apply(const struct hull_filter *filter, const struct vec3 *points,
                           uint32_t count, uint32_t *kept) {
    uint32_t size = 0;
    for (uint32_t i = 0; i < count; i++) {
        kept[size] = i;
        size += !((filter->has_inner && is_surely_inner(filter, points[i])) ||
                  is_surely_inside(filter, points[i]));
    }
    return size;
}
