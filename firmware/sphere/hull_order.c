#include "sphere/hull_order.h"

#include "fixed/sort.h"

struct hull_pivot hull_pivot(const struct vec3 *points, uint32_t index) {
    struct hull_pivot pivot = {.points = points, .direction = points[index]};
    const uint64_t x = u64_abs(pivot.direction.x), y = u64_abs(pivot.direction.y),
                   z = u64_abs(pivot.direction.z);
    pivot.along = x >= y && x >= z ? 0 : (y >= z ? 1 : 2);
    return pivot;
}

struct hull_ray hull_ray(const struct hull_pivot *pivot, struct vec3 point) {
    // With the pivot along z: u = x pz - z px, v = y pz - z py, which are components of the cross
    // product. Seen from outside, v is to the left of u if pz is positive.
    const struct vec3 p = pivot->direction;
    const struct vec3_i64 cross = vec3_cross(point, p);
    struct hull_ray ray;
    int32_t largest;
    switch (pivot->along) {
    case 0:
        ray = (struct hull_ray){-cross.z, cross.y};
        largest = p.x;
        break;
    case 1:
        ray = (struct hull_ray){-cross.x, cross.z};
        largest = p.y;
        break;
    default:
        ray = (struct hull_ray){-cross.y, cross.x};
        largest = p.z;
        break;
    }
    if (largest > 0) {
        ray.v = -ray.v;
    }
    return ray;
}

/// 0 from the ray (1, 0) on, 1 from (-1, 0) on.
static int half_turn(struct hull_ray a) {
    return a.v < 0 || (a.v == 0 && a.u < 0);
}

static int turn_sign(struct hull_ray a, struct hull_ray b) {
    return i128_cmp(i128_mul(a.u, b.v), i128_mul(a.v, b.u));
}

bool hull_ray_before(struct hull_ray a, struct hull_ray b) {
    const int half_a = half_turn(a), half_b = half_turn(b);
    return half_a != half_b ? half_a < half_b : turn_sign(a, b) > 0;
}

bool hull_ray_equal(struct hull_ray a, struct hull_ray b) {
    return half_turn(a) == half_turn(b) && turn_sign(a, b) == 0;
}

static bool before(struct hull_pivot *pivot, uint32_t a, uint32_t b) {
    pivot->comparisons++;
    return hull_ray_before(hull_ray(pivot, pivot->points[a]), hull_ray(pivot, pivot->points[b]));
}

static bool before_in(const void *context, uint32_t a, uint32_t b) {
    return before(*(struct hull_pivot *const *)context, a, b);
}

void hull_order_merge(struct hull_pivot *pivot, uint32_t *list, uint32_t *spare, uint32_t count) {
    sort_indices(list, spare, count, before_in, &pivot);
}

// ---------------------------------------------------------------- buckets

/// A number that grows with the angle of the ray, but for rounding: 2^30 a quadrant.
static uint32_t angle_key(struct hull_ray ray) {
    const uint64_t u = u64_abs(ray.u), v = u64_abs(ray.v);
    const unsigned zeros = u64_leading_zeros(u + v);
    const uint32_t divisor = (uint32_t)((u + v) << zeros >> 32);
    const uint64_t ratio = (v << zeros >> 2) / divisor, one = UINT64_C(1) << 30;
    const uint64_t part = ratio > one ? one : ratio;
    uint64_t key;
    if (ray.v >= 0) {
        key = ray.u >= 0 ? part : 2U * one - part;
    } else {
        key = ray.u < 0 ? 2U * one + part : 4U * one - part;
    }
    return key > UINT32_MAX ? UINT32_MAX : (uint32_t)key;
}

/// Sorts a bucket in place; spare has room for it.
static void sort_bucket(struct hull_pivot *pivot, uint32_t *bucket, uint32_t *spare,
                        uint32_t count) {
    if (count > 8U) {
        hull_order_merge(pivot, bucket, spare, count);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        const uint32_t value = bucket[i];
        uint32_t at = i;
        for (; at > 0U && before(pivot, value, bucket[at - 1U]); at--) {
            bucket[at] = bucket[at - 1U];
        }
        bucket[at] = value;
    }
}

void hull_order_buckets(struct hull_pivot *pivot, uint32_t *list, uint32_t *sorted, uint32_t *keys,
                        uint32_t *starts, uint32_t count) {
    for (uint32_t i = 0; i <= count; i++) {
        starts[i] = 0;
    }
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t key = angle_key(hull_ray(pivot, pivot->points[list[i]]));
        keys[i] = (uint32_t)((uint64_t)key * count >> 32); // the bucket
        starts[keys[i] + 1U]++;
    }
    for (uint32_t i = 0; i < count; i++) {
        starts[i + 1U] += starts[i];
    }
    for (uint32_t i = 0; i < count; i++) {
        sorted[starts[keys[i]]++] = list[i];
    }
    // Each start has moved on to its bucket's end.
    for (uint32_t i = 0, from = 0; i < count; from = starts[i++]) {
        sort_bucket(pivot, sorted + from, list, starts[i] - from);
    }
    for (uint32_t i = 1; i < count; i++) {
        if (before(pivot, sorted[i], sorted[i - 1U])) {
            hull_order_merge(pivot, sorted, list, count);
            break;
        }
    }
}
