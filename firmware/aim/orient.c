#include "aim/orient.h"

#include "fixed/root.h"
#include "fixed/trig.h"
#include "fixed/wide.h"

// ---------------------------------------------------------------- axes

static struct i128 i128_abs(struct i128 a) {
    return a.hi < 0 ? i128_neg(a) : a;
}

/// a * factor for a >= 0; the product must stay below 2^255.
static struct i256 i256_mul_u64(struct i256 a, uint64_t factor) {
    struct i256 product;
    uint64_t carry = 0;
    for (unsigned i = 0; i < 4U; i++) {
        const struct u128 part = u128_add(u128_mul(a.word[i], factor), (struct u128){carry, 0});
        product.word[i] = part.lo;
        carry = part.hi;
    }
    return product;
}

/// Is size / sqrt(norm2) * 2^30 < candidate - 1/2, for size2 = size^2? Decided exactly:
/// size2 * 2^62 < (2 candidate - 1)^2 * norm2. Components are below 2^95, candidate is at most
/// 2^30 + 1: both sides stay below 2^254.
static bool rounds_below(struct i256 size2, struct i256 norm2, uint64_t candidate) {
    const uint64_t odd = 2U * candidate - 1U;
    return i256_sign(i256_sub(i256_mul_u64(size2, UINT64_C(1) << 62),
                              i256_mul_u64(norm2, odd * odd))) < 0;
}

/// The correctly rounded component, from an estimate that is off by a unit at most.
static q30_t round_component(struct i128 component, struct i256 norm2, q30_t estimate) {
    const struct i256 size2 = i256_mul(component, component);
    uint64_t size_q30 = u64_abs(estimate);
    while (!rounds_below(size2, norm2, size_q30 + 1U)) {
        size_q30++;
    }
    while (size_q30 != 0U && rounds_below(size2, norm2, size_q30)) {
        size_q30--;
    }
    return i128_sign(component) < 0 ? -(q30_t)size_q30 : (q30_t)size_q30;
}

/// a / 2^shift toward zero; it must fit 62 bits.
static int64_t cut(struct i128 a, unsigned shift) {
    const int64_t size = i256_shift_right_i64(i256_from_i128(i128_abs(a)), shift);
    return a.hi < 0 ? -size : size;
}

/// a / |a|, correctly rounded; components below 2^95 in size. Zero stays zero.
static struct vec3 normalise(struct vec3_i128 a) {
    const struct i256 norm2 =
        i256_add(i256_add(i256_mul(a.x, a.x), i256_mul(a.y, a.y)), i256_mul(a.z, a.z));
    if (i256_sign(norm2) == 0) {
        return vec3(0, 0, 0);
    }
    const unsigned bits = (i256_bit_length(norm2) + 1U) / 2U; // no component is longer
    const unsigned shift = bits > 62U ? bits - 62U : 0U;
    const struct vec3 estimate =
        vec3_i64_normalise((struct vec3_i64){cut(a.x, shift), cut(a.y, shift), cut(a.z, shift)});
    return vec3(round_component(a.x, norm2, estimate.x), round_component(a.y, norm2, estimate.y),
                round_component(a.z, norm2, estimate.z));
}

static struct vec3_i128 widen(struct vec3_i64 a) {
    return (struct vec3_i128){i128_from_i64(a.x), i128_from_i64(a.y), i128_from_i64(a.z)};
}

static bool are_parallel(struct vec3 ahead_q30, struct vec3 up, struct vec3_i64 cross) {
    const struct vec3 up_q30 = vec3_normalise(up);
    return (cross.x | cross.y | cross.z) == 0 || vec3_equal(ahead_q30, up_q30) ||
           vec3_equal(ahead_q30, vec3_neg(up_q30));
}

struct orient_axes orient_axes(struct vec3 ahead_q30, struct vec3 up) {
    const struct vec3_i64 ahead = vec3_widen(ahead_q30);
    // No product is divided by its length, so all stay exact: below 2^63 and 2^95.
    const struct vec3_i64 right = vec3_cross(ahead_q30, up);
    if (!are_parallel(ahead_q30, up, right)) {
        return (struct orient_axes){normalise(widen(right)),
                                    normalise(vec3_i64_cross(right, ahead))};
    }
    const bool along_x = ahead_q30.y == 0 && ahead_q30.z == 0;
    const struct vec3 aside = along_x ? vec3(0, 1, 0) : vec3(1, 0, 0);
    // What is left of `aside` beside A has the same cross product with A as `aside` itself.
    const struct vec3_i64 new_up = vec3_cross(aside, ahead_q30);
    return (struct orient_axes){normalise(vec3_i64_cross(ahead, new_up)), normalise(widen(new_up))};
}

// ---------------------------------------------------------------- angles

struct orient_angles orient_pan_tilt(struct vec3 ahead_q30) {
    const int64_t x = ahead_q30.x, y = ahead_q30.y, z = ahead_q30.z;
    const uint64_t horizontal2 = (uint64_t)(x * x + y * y);
    const uint64_t horizontal_q32 = root_u128((struct u128){0, horizontal2}); // below 2^63
    return (struct orient_angles){.pan_bam32 = trig_atan2(x, y),
                                  .tilt_bam32 =
                                      trig_atan2(z * ((int64_t)1 << 32), (int64_t)horizontal_q32)};
}

// ---------------------------------------------------------------- picture

/// (hi * 2^64 + lo) / divisor to the nearest; the quotient must fit.
static uint64_t divide_rounded(struct u128 dividend, uint64_t divisor) {
    uint64_t rest;
    const uint64_t quotient = u128_div_u64(dividend, divisor, &rest);
    return quotient + (rest >= divisor - rest ? 1U : 0U);
}

/// a * 2^shift, shift 1 to 63.
static struct u128 shifted(uint64_t a, unsigned shift) {
    return (struct u128){a << shift, a >> (64U - shift)};
}

enum orient_image_status orient_image_of_cone(bam32_t half_angle_bam32, struct orient_image *out) {
    if (half_angle_bam32.bam >= BAM32_QUARTER) {
        *out = (struct orient_image){UINT64_MAX, UINT64_MAX};
        return ORIENT_IMAGE_UNBOUNDED;
    }
    // Beyond 45 degrees by the rest to 90, whose sine keeps all its digits: it is left as the
    // product x * s, x BAM of 2^29 in 45 degrees.
    const bool steep = half_angle_bam32.bam > BAM32_QUARTER / 2U;
    const uint32_t x = steep ? BAM32_QUARTER - half_angle_bam32.bam : half_angle_bam32.bam;
    const struct trig_octant octant = trig_octant(x);
    const uint64_t cos_q63 = octant.cos_q63;
    const struct u128 sin_q92 = u128_mul(x, octant.sin_by_t_q63); // sin = x s / 2^29
    if (!steep) {
        // sin / cos in Q32 is (sin_q92 * 2^3) / cos_q63.
        const struct u128 dividend = {sin_q92.lo << 3, (sin_q92.hi << 3) | (sin_q92.lo >> 61)};
        out->radius_q32 = divide_rounded(dividend, cos_q63);
        out->distortion_q32 = divide_rounded((struct u128){0, UINT64_C(1) << 31}, cos_q63);
        return ORIENT_IMAGE_OK;
    }
    // cos / sin in Q32 is cos_q63 * 2^61 / sin_q92; the divisor's 64 leading bits will do.
    const unsigned shift = sin_q92.hi == 0U ? 0U : 64U - u64_leading_zeros(sin_q92.hi);
    const uint64_t divisor =
        shift == 0U ? sin_q92.lo : (sin_q92.hi << (64U - shift)) | (sin_q92.lo >> shift);
    out->radius_q32 = divide_rounded(shifted(cos_q63, 61U - shift), divisor);
    out->distortion_q32 = divide_rounded(shifted(UINT64_C(1) << 63, 61U - shift), divisor);
    return ORIENT_IMAGE_OK;
}
