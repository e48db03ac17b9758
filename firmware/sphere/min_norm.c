#include "sphere/min_norm.h"

static bool is_zero_i128(struct vec3_i128 a) {
    return i128_sign(a.x) == 0 && i128_sign(a.y) == 0 && i128_sign(a.z) == 0;
}

static struct vec3_i128 add_i128(struct vec3_i128 a, struct vec3_i128 b) {
    return (struct vec3_i128){i128_add(a.x, b.x), i128_add(a.y, b.y), i128_add(a.z, b.z)};
}

static struct vec3_i128 negate_i128(struct vec3_i128 a) {
    return (struct vec3_i128){i128_neg(a.x), i128_neg(a.y), i128_neg(a.z)};
}

/// Sign of a . b for two 128-bit vectors of at most 2^124 a component.
static int dot_sign_i128(struct vec3_i128 a, struct vec3_i128 b) {
    return i256_sign(
        i256_add(i256_add(i256_mul(a.x, b.x), i256_mul(a.y, b.y)), i256_mul(a.z, b.z)));
}

static void hold_one(struct min_norm *support, uint32_t index, struct vec3_i64 a) {
    support->count = 1;
    support->index[0] = index;
    support->point[0] = a;
    support->against = vec3_i64_dot(a, a);
}

void min_norm_start(struct min_norm *support, uint32_t index, struct vec3_i64 point) {
    hold_one(support, index, point);
}

bool min_norm_violated_by(const struct min_norm *support, struct vec3_i64 point) {
    const struct vec3_i64 a = support->point[0], from_a = vec3_i64_sub(point, a);
    switch (support->count) {
    case 1: // nearest point a: a . (x - a) < 0
        return i128_cmp(vec3_i64_dot(a, point), support->against) < 0;
    case 2: { // nearest point (a (d.d) - d (a.d)) / (d.d), times (d.d): 2^123 * 2^124 each, below
              // 2^249
        const struct i256 along = i256_mul(vec3_i64_dot(a, from_a), support->chord2);
        const struct i256 across = i256_mul(vec3_i64_dot(support->chord, from_a), support->against);
        return i256_sign(i256_sub(along, across)) < 0;
    }
    default: // the plane's normal: 2^125 * 2^62, three times
        return i256_sign(vec3_i128_dot(support->normal, from_a)) < 0;
    }
}

/// Holds two points if the nearest point of their chord is strictly between them and not zero.
static bool hold_two(struct min_norm *support, uint32_t ia, struct vec3_i64 a, uint32_t ib,
                     struct vec3_i64 b) {
    const struct vec3_i64 chord = vec3_i64_sub(b, a);
    const struct i128 at_a = vec3_i64_dot(a, chord), at_b = vec3_i64_dot(b, chord);
    if (i128_sign(at_a) >= 0 || i128_sign(at_b) <= 0 || is_zero_i128(vec3_i64_cross(a, b))) {
        return false;
    }
    support->count = 2;
    support->index[0] = ia;
    support->index[1] = ib;
    support->point[0] = a;
    support->point[1] = b;
    support->chord = chord;
    support->chord2 = vec3_i64_dot(chord, chord);
    support->against = at_a;
    return true;
}

/// Holds three points if the foot of the perpendicular from zero to their plane is strictly inside
/// the triangle and not zero. The foot's barycentric weights are n.(b x c), n.(c x a), n.(a x b),
/// each below 2^247.
static bool hold_three(struct min_norm *support, const uint32_t index[3],
                       const struct vec3_i64 point[3]) {
    const struct vec3_i128 bc = vec3_i64_cross(point[1], point[2]);
    const struct vec3_i128 ca = vec3_i64_cross(point[2], point[0]);
    const struct vec3_i128 ab = vec3_i64_cross(point[0], point[1]);
    const struct vec3_i128 normal = add_i128(add_i128(bc, ca), ab); // (b - a) x (c - a)
    if (dot_sign_i128(normal, bc) <= 0 || dot_sign_i128(normal, ca) <= 0 ||
        dot_sign_i128(normal, ab) <= 0) {
        return false;
    }
    const int height = i256_sign(vec3_i128_dot(normal, point[0]));
    if (height == 0) {
        return false;
    }
    support->count = 3;
    for (unsigned i = 0; i < 3U; i++) {
        support->index[i] = index[i];
        support->point[i] = point[i];
    }
    support->normal = height > 0 ? normal : negate_i128(normal);
    return true;
}

/// Tries the subset of the `count` points that `mask` names.
static bool hold_subset(struct min_norm *support, const uint32_t *index,
                        const struct vec3_i64 *point, unsigned count, unsigned mask) {
    uint32_t chosen_index[3];
    struct vec3_i64 chosen[3];
    unsigned size = 0;
    for (unsigned i = 0; i < count; i++) {
        if ((mask >> i & 1U) != 0U) {
            chosen_index[size] = index[i];
            chosen[size++] = point[i];
        }
    }
    bool held = true;
    if (size == 1U) {
        hold_one(support, chosen_index[0], chosen[0]);
        held = i128_sign(support->against) != 0;
    } else if (size == 2U) {
        held = hold_two(support, chosen_index[0], chosen[0], chosen_index[1], chosen[1]);
    } else {
        held = hold_three(support, chosen_index, chosen);
    }
    for (unsigned i = 0; held && i < count; i++) {
        held = (mask >> i & 1U) != 0U || !min_norm_violated_by(support, point[i]);
    }
    return held;
}

bool min_norm_enter(struct min_norm *support, uint32_t index, struct vec3_i64 point) {
    uint32_t indices[4];
    struct vec3_i64 points[4];
    const unsigned old = support->count, count = old + 1U;
    for (unsigned i = 0; i < old; i++) {
        indices[i] = support->index[i];
        points[i] = support->point[i];
    }
    indices[old] = index;
    points[old] = point;
    // The new point is in every answer, since it violates the old one: subsets of the others beside
    // it. Pairs first: they are the cheapest to refuse. Bit k of an entry is old point k.
    static const uint8_t beside[] = {1, 2, 4, 3, 5, 6, 0};
    struct min_norm candidate = *support;
    for (unsigned i = 0; i < sizeof beside; i++) {
        if (beside[i] < (1U << old) &&
            hold_subset(&candidate, indices, points, count, beside[i] | (1U << old))) {
            *support = candidate;
            return true;
        }
    }
    return false;
}

struct vec3_i256 {
    struct i256 x, y, z;
};

/// Scaled by one power of two so that the largest component has 61 bits.
static struct vec3_i64 scale_to_i64(struct vec3_i256 a) {
    unsigned bits = i256_bit_length(a.x);
    const unsigned bits_y = i256_bit_length(a.y), bits_z = i256_bit_length(a.z);
    bits = bits > bits_y ? bits : bits_y;
    bits = bits > bits_z ? bits : bits_z;
    if (bits <= 61U) {
        return (struct vec3_i64){(int64_t)a.x.word[0], (int64_t)a.y.word[0], (int64_t)a.z.word[0]};
    }
    const unsigned shift = bits - 61U;
    return (struct vec3_i64){i256_shift_right_i64(a.x, shift), i256_shift_right_i64(a.y, shift),
                             i256_shift_right_i64(a.z, shift)};
}

/// a * from_b - b * from_a, one component: the nearest point of the chord, times chord . chord.
static struct i256 blend(int64_t a, struct i128 at_b, int64_t b, struct i128 at_a) {
    return i256_sub(i256_mul(i128_from_i64(a), at_b), i256_mul(i128_from_i64(b), at_a));
}

struct vec3_i64 min_norm_direction(const struct min_norm *support) {
    const struct vec3_i64 a = support->point[0], b = support->point[1];
    if (support->count == 1U) {
        return a;
    }
    if (support->count == 2U) {
        const struct i128 at_b = vec3_i64_dot(b, support->chord), at_a = support->against;
        return scale_to_i64((struct vec3_i256){
            blend(a.x, at_b, b.x, at_a), blend(a.y, at_b, b.y, at_a), blend(a.z, at_b, b.z, at_a)});
    }
    return scale_to_i64((struct vec3_i256){i256_from_i128(support->normal.x),
                                           i256_from_i128(support->normal.y),
                                           i256_from_i128(support->normal.z)});
}
