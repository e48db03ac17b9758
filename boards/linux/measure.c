#include "measure.h"

#include "u128.h"

#include <float.h>
#include <math.h>

static const long double deg_per_rad = 57.295779513082320876798154814105170L;

/// The exact cross and dot product of the axis and a direction, below 2^95.
struct products {
    struct vec3_i128 cross;
    struct i128 dot;
};

static struct products multiply(struct vec3 axis_q30, struct vec3_i64 direction) {
    const struct vec3_i64 axis = vec3_widen(axis_q30);
    return (struct products){vec3_i64_cross(axis, direction), vec3_i64_dot(axis, direction)};
}

static long double to_long_double(struct i128 a) {
    const long double size = u128_value(u128_abs(a));
    return a.hi < 0 ? -size : size;
}

/// Each product is exact before it is rounded, so the angle is right to a few units of its own last
/// place, however small it is.
static long double angle_rad(struct products p) {
    const long double x = to_long_double(p.cross.x), y = to_long_double(p.cross.y),
                      z = to_long_double(p.cross.z);
    return atan2l(sqrtl(x * x + y * y + z * z), to_long_double(p.dot));
}

/// weight * (a^2 [+ b^2 + c^2]), weight 0 to 3: at most 192 bits.
static struct i256 weighted(struct i256 square, unsigned weight) {
    struct i256 sum = i256_from_i128(i128_from_i64(0));
    for (; weight != 0U; weight--) {
        sum = i256_add(sum, square);
    }
    return sum;
}

/// The only rational numbers of degrees whose squared tangent is a fraction, so the only ones that
/// integer vectors enclose exactly: tan^2 = dot_weight / cross_weight (Niven's theorem).
static const struct round_angle {
    unsigned degrees, cross_weight, dot_weight;
} round_angles[] = {{0, 1, 0}, {30, 3, 1}, {45, 1, 1}, {60, 1, 3}, {90, 0, 1}};

static bool is_beyond(struct products p, const struct round_angle *angle) {
    if (i128_sign(p.dot) < 0) {
        return true;
    }
    const struct i256 cross2 =
        i256_add(i256_add(i256_mul(p.cross.x, p.cross.x), i256_mul(p.cross.y, p.cross.y)),
                 i256_mul(p.cross.z, p.cross.z));
    const struct i256 dot2 = i256_mul(p.dot, p.dot);
    return i256_sign(i256_sub(weighted(cross2, angle->cross_weight),
                              weighted(dot2, angle->dot_weight))) > 0;
}

/// True if the largest angle is near a round one and no point is beyond that.
static bool find_round_angle(struct vec3 axis_q30, const struct points *points,
                             long double largest_deg, uint64_t *pdeg) {
    for (size_t i = 0; points->fine_exact && i < sizeof round_angles / sizeof *round_angles; i++) {
        if (fabsl(largest_deg - round_angles[i].degrees) > 1e-13L) {
            continue;
        }
        for (uint32_t j = 0; j < points->count; j++) {
            if (is_beyond(multiply(axis_q30, points->fine[j]), &round_angles[i])) {
                return false;
            }
        }
        *pdeg = round_angles[i].degrees * MEASURE_DEGREE;
        return true;
    }
    return false;
}

struct measured_cone measure_cone(struct vec3 axis_q30, const struct points *points) {
    long double largest_rad = 0;
    for (uint32_t i = 0; i < points->count; i++) {
        const long double rad = angle_rad(multiply(axis_q30, points->fine[i]));
        largest_rad = rad > largest_rad ? rad : largest_rad;
    }
    struct measured_cone cone;
    if (!find_round_angle(axis_q30, points, largest_rad * deg_per_rad, &cone.half_angle_pdeg)) {
        // Ten roundings of the computation, then one of the reader who takes the number as a
        // double.
        const long double slack = 16 * LDBL_EPSILON + DBL_EPSILON;
        const long double deg = (largest_rad + points->fine_error_rad) * deg_per_rad;
        cone.half_angle_pdeg = (uint64_t)ceill(deg * (1 + slack) * MEASURE_DEGREE);
    }
    const uint64_t turn = 360 * MEASURE_DEGREE;
    const struct u128 scaled = u128_shift_left(u128_of(cone.half_angle_pdeg), 32);
    cone.half_angle_bam32 =
        bam32((uint32_t)u128_divide(u128_add(scaled, u128_of(turn - 1U)), u128_of(turn), NULL).lo);
    return cone;
}

uint64_t measure_pdeg(uint64_t angle_turn64) {
    const struct u128 whole = u128_mul(angle_turn64, 360U * MEASURE_DEGREE);
    return whole.hi + (whole.lo != 0U ? 1U : 0U);
}

static long double rad_from_pdeg(uint64_t angle_pdeg) {
    return (long double)angle_pdeg / MEASURE_DEGREE / deg_per_rad;
}

// Beyond 45 degrees by the angle that is left to 90, which is exact in the given unit.

double measure_tangent(uint64_t angle_pdeg) {
    if (angle_pdeg <= 45U * MEASURE_DEGREE) {
        return (double)tanl(rad_from_pdeg(angle_pdeg));
    }
    return (double)(1 / tanl(rad_from_pdeg(90U * MEASURE_DEGREE - angle_pdeg)));
}

double measure_secant(uint64_t angle_pdeg) {
    if (angle_pdeg <= 45U * MEASURE_DEGREE) {
        return (double)(1 / cosl(rad_from_pdeg(angle_pdeg)));
    }
    return (double)(1 / sinl(rad_from_pdeg(90U * MEASURE_DEGREE - angle_pdeg)));
}

double measure_pan_deg(struct vec3 ahead_q30) {
    return (double)(atan2l(ahead_q30.x, ahead_q30.y) * deg_per_rad);
}

double measure_tilt_deg(struct vec3 ahead_q30) {
    return (double)(atan2l(ahead_q30.z, hypotl(ahead_q30.x, ahead_q30.y)) * deg_per_rad);
}
