#include "regular/rotation.h"

struct rotation rotation_from(const int32_t q[4]) {
    const int32_t a = q[0], b = q[1], c = q[2], d = q[3];
    return (struct rotation){
        {{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
         {2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)},
         {2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d}},
        a * a + b * b + c * c + d * d};
}

struct rotation rotation_try(uint32_t number) {
    if (number == 0U) {
        const int32_t identity[4] = {1, 0, 0, 0};
        return rotation_from(identity);
    }
    // Four draws from a linear congruence; small numbers first, so that little room is used.
    const uint32_t size =
        2U + number / 16U < ROTATION_QUATERNION_MAX ? 2U + number / 16U : ROTATION_QUATERNION_MAX;
    uint32_t state = number * UINT32_C(2654435769);
    int32_t q[4];
    for (unsigned i = 0; i < 4U; i++) {
        state = state * UINT32_C(1664525) + UINT32_C(1013904223);
        q[i] = (int32_t)((state >> 16) % (2U * size + 1U)) - (int32_t)size;
    }
    q[0] += q[0] == 0 ? 1 : 0; // never all zero
    return rotation_from(q);
}

bool rotation_fits(const struct rotation *rotation, struct vec3 a) {
    const uint64_t scale2 = (uint64_t)((int64_t)rotation->scale * rotation->scale);
    return u128_cmp(u128_mul(scale2, vec3_norm2(a)), u128_mul(INT32_MAX, INT32_MAX)) <= 0;
}

struct vec3 rotation_apply(const struct rotation *rotation, struct vec3 a) {
    return vec3((int32_t)vec3_dot(rotation->row[0], a).lo,
                (int32_t)vec3_dot(rotation->row[1], a).lo,
                (int32_t)vec3_dot(rotation->row[2], a).lo);
}

/// (row . cross) / scale^3: the turned cross product is longer by scale^2, its image by scale.
static int64_t component_back(struct vec3 column, struct vec3_i64 cross, uint64_t scale3) {
    const struct i128 sum = vec3_i64_dot_vec3(cross, column);
    const bool negative = i128_sign(sum) < 0;
    const struct i128 size = negative ? i128_neg(sum) : sum;
    uint64_t rest;
    const uint64_t quotient =
        u128_div_u64((struct u128){size.lo, (uint64_t)size.hi}, scale3, &rest);
    return negative ? -(int64_t)quotient : (int64_t)quotient;
}

struct vec3_i64 rotation_back(const struct rotation *rotation, struct vec3_i64 cross) {
    const struct vec3 *const r = rotation->row;
    const uint64_t scale = (uint64_t)rotation->scale, scale3 = scale * scale * scale;
    return (struct vec3_i64){component_back(vec3(r[0].x, r[1].x, r[2].x), cross, scale3),
                             component_back(vec3(r[0].y, r[1].y, r[2].y), cross, scale3),
                             component_back(vec3(r[0].z, r[1].z, r[2].z), cross, scale3)};
}
