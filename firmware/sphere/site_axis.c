#include "sphere/site_axis.h"

#include "fixed/huge.h"

/// Fractional bits of a length. A normal of three int32 directions, times their lengths, is at
/// least 2^-97 long (the sides are 2^-63.6 at least, the area a third of their product); with 63
/// bits of a cross product before it and 36 bits of accuracy behind, 196 suffice.
#define LENGTH_BITS 200U

/// A sum of products, positive and negative ones apart.
struct balance {
    struct huge plus, minus;
};

static void add_product(struct balance *balance, int64_t factor, const struct huge *length) {
    struct huge size, product;
    huge_from_u128(&size, (struct u128){u64_abs(factor), 0});
    huge_mul(&product, &size, length);
    struct huge *const side = factor < 0 ? &balance->minus : &balance->plus;
    huge_add(side, side, &product);
}

/// The vector sum of count vectors times lengths, scaled so that its largest component has 61 bits.
static struct vec3_i64 long_sum(const struct vec3_i64 *vector, const struct huge *length,
                                unsigned count) {
    int sign[3];
    struct huge size[3];
    unsigned bits = 0;
    for (unsigned axis = 0; axis < 3U; axis++) {
        struct balance balance;
        balance.plus.count = balance.minus.count = 0;
        for (unsigned i = 0; i < count; i++) {
            const struct vec3_i64 v = vector[i];
            add_product(&balance, axis == 0U ? v.x : (axis == 1U ? v.y : v.z), &length[i]);
        }
        sign[axis] = huge_difference(&size[axis], &balance.plus, &balance.minus);
        const unsigned length_bits = huge_bit_length(&size[axis]);
        bits = length_bits > bits ? length_bits : bits;
    }
    int64_t component[3];
    for (unsigned axis = 0; axis < 3U; axis++) {
        component[axis] =
            sign[axis] * (int64_t)huge_shift_right_u64(&size[axis], bits > 61U ? bits - 61U : 0U);
    }
    return (struct vec3_i64){component[0], component[1], component[2]};
}

static void take_length(struct huge *length, const struct site *site) {
    struct huge norm2;
    huge_from_u128(&norm2, (struct u128){vec3_norm2(site->vector), 0});
    huge_root(length, &norm2, LENGTH_BITS);
}

/// (a x b) |c| + (b x c) |a| + (c x a) |b|: the normal, times all three lengths.
static struct vec3_i64 long_normal(const struct site *a, const struct site *b,
                                   const struct site *c) {
    const struct vec3_i64 cross[3] = {vec3_cross(b->vector, c->vector),
                                      vec3_cross(c->vector, a->vector),
                                      vec3_cross(a->vector, b->vector)};
    struct huge length[3];
    take_length(&length[0], a);
    take_length(&length[1], b);
    take_length(&length[2], c);
    return long_sum(cross, length, 3);
}

/// a |b| + b |a|
static struct vec3_i64 long_middle(const struct site *a, const struct site *b) {
    const struct vec3_i64 vector[2] = {vec3_widen(b->vector), vec3_widen(a->vector)};
    struct huge length[2];
    take_length(&length[0], a);
    take_length(&length[1], b);
    return long_sum(vector, length, 2);
}

static uint64_t size_of(struct vec3_i64 a) {
    const uint64_t x = u64_abs(a.x), y = u64_abs(a.y), z = u64_abs(a.z);
    const uint64_t xy = x > y ? x : y;
    return xy > z ? xy : z;
}

/// Scaled so that the largest component has 61 bits at most; *bits: how many it had.
static struct vec3_i64 scale(struct vec3_i128 a, unsigned *bits) {
    const struct i256 x = i256_from_i128(a.x), y = i256_from_i128(a.y), z = i256_from_i128(a.z);
    const unsigned bx = i256_bit_length(x), by = i256_bit_length(y), bz = i256_bit_length(z);
    const unsigned xy = bx > by ? bx : by;
    *bits = xy > bz ? xy : bz;
    const unsigned shift = *bits > 61U ? *bits - 61U : 0U;
    return (struct vec3_i64){i256_shift_right_i64(x, shift), i256_shift_right_i64(y, shift),
                             i256_shift_right_i64(z, shift)};
}

struct vec3 site_circle_axis(const struct site *a, const struct site *b, const struct site *c) {
    const struct vec3_i64 ab = vec3_i64_sub(b->unit_q61, a->unit_q61),
                          ac = vec3_i64_sub(c->unit_q61, a->unit_q61);
    unsigned bits;
    struct vec3_i64 normal = scale(vec3_i64_cross(ab, ac), &bits);
    // A component of a difference is off by 1 at most, one of the normal by 4 m + 2, m the largest
    // difference.
    const uint64_t largest = size_of(ab) | size_of(ac) | 1U;
    const unsigned error_bits = 64U - u64_leading_zeros(largest) + 3U;
    if (bits < error_bits + 36U) {
        normal = long_normal(a, b, c);
    }
    return vec3_i64_normalise(normal);
}

struct vec3 site_middle(const struct site *a, const struct site *b) {
    const struct vec3_i64 sum = {a->unit_q61.x + b->unit_q61.x, a->unit_q61.y + b->unit_q61.y,
                                 a->unit_q61.z + b->unit_q61.z};
    return vec3_i64_normalise(size_of(sum) >> 36 != 0U ? sum : long_middle(a, b));
}

struct vec3 site_cone_axis(const struct site *support, uint32_t support_count) {
    if (support_count == 1U) {
        return vec3_i64_normalise(support[0].unit_q61);
    }
    if (support_count == 2U) {
        return site_middle(&support[0], &support[1]);
    }
    const bool outward = site_side(&support[0], &support[1], &support[2]) > 0;
    return outward ? site_circle_axis(&support[0], &support[1], &support[2])
                   : site_circle_axis(&support[0], &support[2], &support[1]);
}
