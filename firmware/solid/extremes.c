#include "solid/extremes.h"

#include "solid/side.h"

struct track {
    int64_t most[EXTREMES_DIRECTIONS], least[EXTREMES_DIRECTIONS];
};

static void heights(struct vec3 p, int64_t height[EXTREMES_DIRECTIONS]) {
    const int64_t sum = (int64_t)p.x + p.y, difference = (int64_t)p.y - p.x;
    height[0] = p.x;
    height[1] = p.y;
    height[2] = p.z;
    height[3] = sum + p.z;
    height[4] = difference + p.z;
    height[5] = sum - p.z;
    height[6] = difference - p.z;
}

/// A point that reaches a record: apart, since it is rare.
static void enter(const struct vec3 *points, uint32_t index, unsigned direction, int64_t height,
                  struct track *track, struct extremes *out) {
    if (height > track->most[direction] ||
        (height == track->most[direction] &&
         side_order(points[index], points[out->most[direction]]) > 0)) {
        track->most[direction] = height;
        out->most[direction] = index;
    }
    if (height < track->least[direction] ||
        (height == track->least[direction] &&
         side_order(points[index], points[out->least[direction]]) > 0)) {
        track->least[direction] = height;
        out->least[direction] = index;
    }
}

static void list(struct extremes *out) {
    out->count = 0;
    for (unsigned i = 0; i < 2U * EXTREMES_DIRECTIONS; i++) {
        const uint32_t index = (i & 1U) != 0U ? out->least[i / 2U] : out->most[i / 2U];
        bool known = false;
        for (uint32_t k = 0; k < out->count; k++) {
            known = known || out->list[k] == index;
        }
        if (!known) {
            out->list[out->count++] = index;
        }
    }
}

void extremes_find(const struct vec3 *points, uint32_t count, struct extremes *out) {
    struct track track;
    heights(points[0], track.most);
    heights(points[0], track.least);
    for (unsigned d = 0; d < EXTREMES_DIRECTIONS; d++) {
        out->most[d] = 0;
        out->least[d] = 0;
    }
    for (uint32_t i = 1; i < count; i++) {
        int64_t height[EXTREMES_DIRECTIONS];
        heights(points[i], height);
        for (unsigned d = 0; d < EXTREMES_DIRECTIONS; d++) {
            if (height[d] >= track.most[d] || height[d] <= track.least[d]) {
                enter(points, i, d, height[d], &track, out);
            }
        }
    }
    list(out);
    const struct vec3 low = vec3((int32_t)track.least[0], (int32_t)track.least[1],
                                 (int32_t)track.least[2]),
                      high = vec3((int32_t)track.most[0], (int32_t)track.most[1],
                                  (int32_t)track.most[2]);
    out->range = side_range_of(low, high);
}

static int32_t least_of(int32_t a, int32_t b, int32_t c, int32_t d) {
    const int32_t ab = a < b ? a : b, cd = c < d ? c : d;
    return ab < cd ? ab : cd;
}

static int32_t most_of(int32_t a, int32_t b, int32_t c, int32_t d) {
    const int32_t ab = a > b ? a : b, cd = c > d ? c : d;
    return ab > cd ? ab : cd;
}

struct extremes_box extremes_box(const struct vec3 *points, const struct extremes *extremes) {
    // By the signs of x, y, z: the directions 3 to 6 are +++ -++ ++- -+-, their opposites the rest.
    const struct vec3 ppp = points[extremes->most[3]], mmm = points[extremes->least[3]],
                      mpp = points[extremes->most[4]], pmm = points[extremes->least[4]],
                      ppm = points[extremes->most[5]], mmp = points[extremes->least[5]],
                      mpm = points[extremes->most[6]], pmp = points[extremes->least[6]];
    return (struct extremes_box){
        .low = vec3(most_of(mmm.x, mpp.x, mmp.x, mpm.x), most_of(mmm.y, pmm.y, mmp.y, pmp.y),
                    most_of(mmm.z, pmm.z, ppm.z, mpm.z)),
        .high = vec3(least_of(ppp.x, pmm.x, ppm.x, pmp.x), least_of(ppp.y, mpp.y, ppm.y, mpm.y),
                     least_of(ppp.z, mpp.z, mmp.z, pmp.z)),
    };
}

/// Differences by a quarter, so that products of two fit 62 bits.
static struct vec3_i64 rough(struct vec3 from, struct vec3 to) {
    const struct vec3_i64 d = side_between(from, to);
    return (struct vec3_i64){d.x / 4, d.y / 4, d.z / 4};
}

static uint64_t rough_distance(struct vec3 a, struct vec3 b) {
    const struct vec3_i64 d = rough(a, b);
    return (uint64_t)(d.x * d.x) + (uint64_t)(d.y * d.y) + (uint64_t)(d.z * d.z);
}

/// About twice the area of a triangle.
static uint64_t rough_area(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3_i64 u = rough(a, b), v = rough(a, c);
    const uint64_t x = u64_abs(u.y * v.z - u.z * v.y), y = u64_abs(u.z * v.x - u.x * v.z),
                   z = u64_abs(u.x * v.y - u.y * v.x);
    return x / 4U + y / 4U + z / 4U;
}

/// The pair of the list that is farthest apart. False: all points are equal.
static bool pick_pair(const struct vec3 *points, const struct extremes *e, uint32_t corner[4]) {
    uint64_t best = 0;
    bool found = false;
    for (uint32_t i = 0; i < e->count; i++) {
        for (uint32_t k = i + 1U; k < e->count; k++) {
            const struct vec3 a = points[e->list[i]], b = points[e->list[k]];
            const uint64_t distance = rough_distance(a, b);
            if (!vec3_equal(a, b) && (!found || distance > best)) {
                best = distance;
                corner[0] = e->list[i];
                corner[1] = e->list[k];
                found = true;
            }
        }
    }
    return found;
}

/// A third corner, off the line of the first two: the best of the list, or else of the whole set.
static bool pick_third(const struct vec3 *points, uint32_t count, const struct extremes *e,
                       uint32_t corner[4]) {
    const struct vec3 a = points[corner[0]], b = points[corner[1]];
    bool found = false;
    uint64_t best = 0;
    for (uint32_t i = 0; i < e->count; i++) {
        const struct vec3 c = points[e->list[i]];
        const uint64_t area = rough_area(a, b, c);
        if ((!found || area > best) && !side_collinear(a, b, c)) {
            best = area;
            corner[2] = e->list[i];
            found = true;
        }
    }
    for (uint32_t i = 0; i < count && !found; i++) {
        found = !side_collinear(a, b, points[i]);
        corner[2] = i;
    }
    return found;
}

static bool pick_fourth(const struct vec3 *points, uint32_t count, const struct extremes *e,
                        uint32_t corner[4]) {
    const struct vec3 a = points[corner[0]], b = points[corner[1]], c = points[corner[2]];
    const struct side_plane plane = side_plane_through(e->range, a, b, c);
    bool found = false;
    uint64_t best = 0;
    for (uint32_t i = 0; i < e->count; i++) {
        const struct vec3 d = points[e->list[i]];
        const uint64_t height = u64_abs(side_value(&plane, d));
        if ((!found || height > best) && side_exact(a, b, c, d) != 0) {
            best = height;
            corner[3] = e->list[i];
            found = true;
        }
    }
    for (uint32_t i = 0; i < count && !found; i++) {
        found = side_exact(a, b, c, points[i]) != 0;
        corner[3] = i;
    }
    return found;
}

uint8_t extremes_span(const struct vec3 *points, uint32_t count, const struct extremes *extremes,
                      uint32_t corner[4]) {
    corner[0] = extremes->list[0];
    if (!pick_pair(points, extremes, corner)) {
        return 0;
    }
    if (!pick_third(points, count, extremes, corner)) {
        return 1;
    }
    return pick_fourth(points, count, extremes, corner) ? 3 : 2;
}
