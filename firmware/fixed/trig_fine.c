#include "fixed/trig_fine.h"

#include "fixed/trig.h"
#include "fixed/trig_series.h"
#include "fixed/wide.h"

struct sincos_q62 trig_fine_sincos(uint64_t turn64) {
    const unsigned quadrant = (unsigned)(turn64 >> 62);
    uint64_t x = turn64 & (TURN64_QUARTER - 1U);
    const bool upper_octant = x > TURN64_QUARTER / 2U;
    x = upper_octant ? TURN64_QUARTER - x : x;
    const uint64_t t = x << 2, t2 = trig_mul_q63(t, t);
    const int64_t small =
        (int64_t)((trig_mul_q63(t, trig_series(trig_sin_terms, TRIG_TERMS, t2)) + 1U) >> 1);
    const int64_t large = (int64_t)((trig_series(trig_cos_terms, TRIG_TERMS, t2) + 1U) >> 1);
    const int64_t s = upper_octant ? large : small, c = upper_octant ? small : large;
    switch (quadrant) {
    case 0:
        return (struct sincos_q62){s, c};
    case 1:
        return (struct sincos_q62){c, -s};
    case 2:
        return (struct sincos_q62){-s, -c};
    default:
        return (struct sincos_q62){-c, s};
    }
}

/// Of a vector (across, ahead): 0 to 2^63.
static uint64_t half_turn_angle(uint64_t across, int64_t ahead) {
    const uint64_t acute = trig_atan2_turn64(across, u64_abs(ahead));
    return ahead < 0 ? (UINT64_C(1) << 63) - acute : acute;
}

static unsigned bit_length(struct i128 a) {
    const struct i128 size = a.hi < 0 ? i128_neg(a) : a;
    return size.hi != 0 ? 128U - u64_leading_zeros((uint64_t)size.hi)
                        : 64U - u64_leading_zeros(size.lo);
}

static int64_t shift_right(struct i128 a, unsigned shift) {
    const struct i128 size = a.hi < 0 ? i128_neg(a) : a;
    uint64_t cut = size.lo;
    if (shift >= 64U) {
        cut = (uint64_t)size.hi >> (shift - 64U);
    } else if (shift != 0U) {
        cut = (size.lo >> shift) | ((uint64_t)size.hi << (64U - shift));
    }
    return a.hi < 0 ? -(int64_t)cut : (int64_t)cut;
}

uint64_t trig_fine_angle(struct vec3_i64 a, struct vec3_i64 b) {
    const struct vec3_i128 cross = vec3_i64_cross(a, b);
    const struct i128 dot = vec3_i64_dot(a, b);
    unsigned bits = bit_length(dot);
    const unsigned x = bit_length(cross.x), y = bit_length(cross.y), z = bit_length(cross.z);
    bits = x > bits ? x : bits;
    bits = y > bits ? y : bits;
    bits = z > bits ? z : bits;
    // The largest gets 62 bits: of a small angle the cross product keeps 2^-62 of the lengths.
    const unsigned shift = bits > 62U ? bits - 62U : 0U;
    const struct vec3_i64 scaled = {shift_right(cross.x, shift), shift_right(cross.y, shift),
                                    shift_right(cross.z, shift)};
    return half_turn_angle(vec3_i64_length(scaled), shift_right(dot, shift));
}

uint64_t trig_fine_angle_q30(struct vec3 a, struct vec3 b) {
    // At least one of the two has 50 bits or more for unit vectors; short vectors have no more
    // digits to lose.
    return half_turn_angle(vec3_i64_length(vec3_cross(a, b)), vec3_dot_unit(a, b));
}
