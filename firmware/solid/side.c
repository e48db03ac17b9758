#include "solid/side.h"

static unsigned bits_of(uint64_t a) {
    return 64U - u64_leading_zeros(a);
}

struct side_range side_range_of(struct vec3 low, struct vec3 high) {
    const struct vec3_i64 size = side_between(low, high);
    const unsigned bits = bits_of((uint64_t)size.x | (uint64_t)size.y | (uint64_t)size.z);
    return (struct side_range){(uint8_t)(bits == 0U ? 1U : bits)};
}

/// The cross product, with each component cut to 60 - range.bits bits where it is longer.
static struct vec3_i64 cut_128(struct vec3_i128 wide, unsigned bits, bool *exact) {
    const struct i128 part[3] = {wide.x, wide.y, wide.z};
    unsigned longest = 0;
    bool negative[3];
    struct i128 size[3];
    for (unsigned i = 0; i < 3U; i++) {
        negative[i] = part[i].hi < 0;
        size[i] = negative[i] ? i128_neg(part[i]) : part[i];
        const unsigned length =
            size[i].hi != 0 ? 64U + bits_of((uint64_t)size[i].hi) : bits_of(size[i].lo);
        longest = length > longest ? length : longest;
    }
    const unsigned shift = longest > bits ? longest - bits : 0U;
    int64_t cut[3];
    for (unsigned i = 0; i < 3U; i++) {
        const uint64_t hi = (uint64_t)size[i].hi;
        uint64_t value = size[i].lo;
        if (shift >= 64U) {
            value = hi >> (shift - 64U);
        } else if (shift != 0U) {
            value = (value >> shift) | (hi << (64U - shift));
        }
        cut[i] = negative[i] ? -(int64_t)value : (int64_t)value;
    }
    *exact = shift == 0U;
    return (struct vec3_i64){cut[0], cut[1], cut[2]};
}

static int64_t cut_i64(int64_t value, unsigned shift) {
    return value < 0 ? -(-value >> shift) : value >> shift;
}

struct side_plane side_plane_through(struct side_range range, struct vec3 a, struct vec3 b,
                                     struct vec3 c) {
    const struct vec3_i64 u = side_between(a, b), v = side_between(a, c);
    const unsigned bits = 60U - range.bits;
    struct side_plane plane;
    const uint64_t largest =
        u64_abs(u.x) | u64_abs(u.y) | u64_abs(u.z) | u64_abs(v.x) | u64_abs(v.y) | u64_abs(v.z);
    if (bits_of(largest) <= 30U) { // products below 2^60
        const struct vec3_i64 n = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z,
                                   u.x * v.y - u.y * v.x};
        const unsigned longest = bits_of(u64_abs(n.x) | u64_abs(n.y) | u64_abs(n.z));
        const unsigned shift = longest > bits ? longest - bits : 0U;
        plane.normal =
            (struct vec3_i64){cut_i64(n.x, shift), cut_i64(n.y, shift), cut_i64(n.z, shift)};
        plane.exact = shift == 0U;
    } else {
        plane.normal = cut_128(vec3_i64_cross(u, v), bits, &plane.exact);
    }
    plane.offset = 0;
    plane.offset = (uint64_t)side_value(&plane, a);
    return plane;
}

int side_exact(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 p) {
    // Differences of 33 bits with sign: the cross product has 67 bits, the sum of products 102.
    return i256_sign(
        vec3_i128_dot(vec3_i64_cross(side_between(a, b), side_between(a, c)), side_between(a, p)));
}

int side_compare(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 p, struct vec3 q) {
    return i256_sign(
        vec3_i128_dot(vec3_i64_cross(side_between(a, b), side_between(a, c)), side_between(q, p)));
}

bool side_collinear(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3_i128 n = vec3_i64_cross(side_between(a, b), side_between(a, c));
    return i128_sign(n.x) == 0 && i128_sign(n.y) == 0 && i128_sign(n.z) == 0;
}
