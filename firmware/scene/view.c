#include "scene/view.h"

#include "fixed/root.h"

/// Half a unit of each of three components of a normal, 2^31 units from the eye at most.
#define SLACK_Q30 ((int64_t)1 << 33)

static struct vec3_i64 from_eye(struct vec3 eye, struct vec3 p) {
    return (struct vec3_i64){(int64_t)p.x - eye.x, (int64_t)p.y - eye.y, (int64_t)p.z - eye.z};
}

/// With a unit vector: at most 2^62 for differences below 2^31.
static int64_t along(struct vec3 unit, struct vec3_i64 d) {
    return unit.x * d.x + unit.y * d.y + unit.z * d.z;
}

/// Normal of a side: a * half + b * focal, both in 1/512 pixel.
static struct vec3 side_normal(struct vec3 a, int64_t half, struct vec3 b, int64_t focal) {
    return vec3_i64_normalise((struct vec3_i64){a.x * half + b.x * focal, a.y * half + b.y * focal,
                                                a.z * half + b.z * focal});
}

void view_set(struct view *view, struct vec3 eye, struct vec3 right, struct vec3 ahead,
              struct vec3 up, uint32_t focal_px_q8, uint32_t width_px, uint32_t height_px) {
    const int64_t focal = 2 * (int64_t)focal_px_q8, width = 256 * (int64_t)width_px,
                  height = 256 * (int64_t)height_px;
    *view = (struct view){eye, right, ahead, up, focal_px_q8, {{0, 0, 0}}};
    view->inward[0] = side_normal(ahead, width, right, focal);
    view->inward[1] = side_normal(ahead, width, right, -focal);
    view->inward[2] = side_normal(ahead, height, up, focal);
    view->inward[3] = side_normal(ahead, height, up, -focal);
}

enum view_place view_place(const struct view *view, struct vec3 center, uint32_t radius) {
    const struct vec3_i64 d = from_eye(view->eye, center);
    const int64_t reach = (int64_t)radius << 30;
    const int64_t depth = along(view->ahead, d);
    if (depth < -reach - SLACK_Q30) {
        return VIEW_OUTSIDE;
    }
    bool inside = depth > reach + SLACK_Q30;
    for (unsigned i = 0; i < 4U; i++) {
        const int64_t distance = along(view->inward[i], d);
        if (distance < -reach - SLACK_Q30) {
            return VIEW_OUTSIDE;
        }
        inside = inside && distance > reach + SLACK_Q30;
    }
    return inside ? VIEW_INSIDE : VIEW_CROSSING;
}

/// focal * radius * sqrt(distance2 - radius2) / (depth2 - radius2), rounded up.
static uint32_t projected(uint32_t focal_px_q8, uint64_t radius, uint64_t distance2,
                          uint64_t depth2) {
    const uint64_t radius2 = radius * radius;
    if (depth2 <= radius2 || distance2 <= radius2) {
        return UINT32_MAX;
    }
    const uint64_t divisor = depth2 - radius2;
    // radius < 2^31, the root below 2^32: their product fits 63 bits.
    const uint64_t product = radius * ((uint64_t)root_u64(distance2 - radius2) + 1U);
    const struct u128 numerator = u128_mul(product, focal_px_q8);
    if (numerator.hi >= divisor) {
        return UINT32_MAX;
    }
    uint64_t rest;
    const uint64_t quotient = u128_div_u64(numerator, divisor, &rest);
    return quotient < UINT32_MAX ? (uint32_t)quotient + 1U : UINT32_MAX;
}

/// Squared length of a difference below 2^31 on each axis: below 2^64.
static uint64_t squared(struct vec3_i64 d) {
    return (uint64_t)(d.x * d.x) + (uint64_t)(d.y * d.y) + (uint64_t)(d.z * d.z);
}

uint32_t view_radius_px_q8(const struct view *view, struct vec3 center, uint32_t radius) {
    const struct vec3_i64 d = from_eye(view->eye, center);
    // 9 units less than rounded: `ahead` is off by half a unit of 2^-30 on each axis.
    const int64_t depth = (along(view->ahead, d) >> 30) - 9;
    if (depth <= 0) {
        return UINT32_MAX;
    }
    return projected(view->focal_px_q8, radius, squared(d), (uint64_t)depth * (uint64_t)depth);
}

uint32_t view_straight_px_q8(uint32_t focal_px_q8, struct vec3 eye, struct vec3 center,
                             uint32_t radius) {
    const uint64_t distance2 = squared(from_eye(eye, center));
    return projected(focal_px_q8, radius, distance2, distance2);
}

uint32_t view_distance(struct vec3 eye, struct vec3 center) {
    const uint64_t distance2 = squared(from_eye(eye, center));
    const uint32_t root = root_u64(distance2);
    return root < UINT32_MAX && (uint64_t)root * root < distance2 ? root + 1U : root;
}

const struct tree_description *view_choose(const struct tree *tree, const struct tree_node *node,
                                           uint32_t radius_px_q8, uint32_t distance) {
    const struct tree_description *d = &tree->descriptions[node->first_description];
    const bool by_distance = (d->kind & TREE_BY_DISTANCE) != 0U;
    for (uint32_t k = 1;
         k < node->description_count &&
         (by_distance ? d[1].threshold >= distance : d[1].threshold <= radius_px_q8);
         k++) {
        d++;
    }
    return d;
}
