#include "regular/turn.h"

#include "fixed/trig_fine.h"
#include "regular/disc.h"
#include "regular/primitive.h"

/// Components of at most 2^9: rows of at most 2^20, with a length of w^2 + x^2 + y^2 + z^2.
struct quaternion {
    int32_t w, x, y, z;
};
#define LARGEST 512

static void rows_of(struct quaternion q, struct vec3 rows[3]) {
    const int32_t w = q.w, x = q.x, y = q.y, z = q.z;
    rows[0] = vec3(w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y));
    rows[1] = vec3(2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x));
    rows[2] = vec3(2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z);
}

static unsigned axes_of(const struct regular_input *input) {
    return input->problem == REGULAR_POINTS3_XY ? 2U : 3U;
}

/// The smallest square of a sine of the angle between an axis and the plane that two points share,
/// in units of 2^-62; stops early below `enough`.
static uint64_t margin_of(const struct regular_input *input, struct quaternion q, uint64_t enough,
                          uint64_t *operations) {
    struct vec3 rows[3];
    rows_of(q, rows);
    const uint64_t norm2 = vec3_norm2(rows[0]);
    uint64_t least = UINT64_MAX;
    for (uint32_t i = 0; i < input->count && least > enough; i++) {
        for (uint32_t j = i + 1U; j < input->count && least > enough; j++) {
            const struct vec3 d = primitive_between(input->points[i], input->points[j]);
            const uint64_t length2 = vec3_norm2(d);
            *operations += axes_of(input);
            for (unsigned k = 0; k < axes_of(input); k++) {
                // Below 2^43; the square, over two numbers below 2^44 each, is at most 1.
                const uint64_t along = u64_abs(vec3_dot_unit(rows[k], d));
                const struct u128 square = u128_mul(along, along);
                const struct u128 scaled = {square.lo << 40, square.hi << 40 | square.lo >> 24};
                const struct u128 over = primitive_quotient(scaled, length2);
                const struct u128 more = {over.lo << 22, over.hi << 22 | over.lo >> 42};
                const uint64_t sine2 = primitive_quotient(more, norm2).lo;
                least = sine2 < least ? sine2 : least;
            }
        }
    }
    return least;
}

static int32_t draw(uint32_t *state, int32_t within) {
    *state = *state * 1664525U + 1013904223U;
    return (int32_t)((*state >> 8) % (2U * (uint32_t)within + 1U)) - within;
}

static int32_t near(uint32_t *state, int32_t value, int32_t within) {
    const int32_t moved = value + draw(state, within);
    return moved > LARGEST ? LARGEST : (moved < -LARGEST ? -LARGEST : moved);
}

static bool is_rotation(struct quaternion q) {
    return (q.w | q.x | q.y | q.z) != 0;
}

/// A vector of up to 120 bits a component, shifted down to 61.
static struct vec3_i64 leading(const struct vec3_i128 *a) {
    unsigned bits = 0;
    const struct i256 wide[3] = {i256_from_i128(a->x), i256_from_i128(a->y), i256_from_i128(a->z)};
    for (unsigned k = 0; k < 3U; k++) {
        const unsigned here = i256_bit_length(wide[k]);
        bits = here > bits ? here : bits;
    }
    const unsigned drop = bits > 60U ? bits - 60U : 0U;
    return (struct vec3_i64){i256_shift_right_i64(wide[0], drop),
                             i256_shift_right_i64(wide[1], drop),
                             i256_shift_right_i64(wide[2], drop)};
}

static void tell(const struct regular_input *input, struct regular_result *result) {
    uint64_t least = TURN64_QUARTER;
    for (uint32_t i = 0; i < input->count; i++) {
        for (uint32_t j = i + 1U; j < input->count; j++) {
            const struct vec3 d = primitive_between(input->points[i], input->points[j]);
            for (unsigned k = 0; k < axes_of(input); k++) {
                // Rows of compute have up to 95 bits: the leading ones tell the angle.
                const struct vec3_i64 axis = leading(&result->rotation[k]);
                const uint64_t across = TURN64_QUARTER - disc_line_angle(axis, vec3_widen(d));
                least = across < least ? across : least;
            }
        }
    }
    result->tolerance_turn64 = least > DISC_ANGLE_ERROR ? least - DISC_ANGLE_ERROR : 0U;
    result->tolerance_is_bound = input->count > 1U;
}

void turn_search(const struct regular_input *input, struct regular_result *result) {
    uint32_t state = 7;
    struct quaternion best = {1, 0, 0, 0};
    uint64_t margin = 0;
    for (uint32_t trial = 0; input->count > 1U && trial < TURN_TRIALS; trial++) {
        const bool wide = trial < TURN_TRIALS / 2U;
        const int32_t step =
            wide ? LARGEST : LARGEST >> (1U + 8U * (trial - TURN_TRIALS / 2U) / (TURN_TRIALS / 2U));
        struct quaternion q = wide ? (struct quaternion){0, 0, 0, 0} : best;
        q.w = near(&state, q.w, step);
        q.x = near(&state, q.x, step);
        q.y = near(&state, q.y, step);
        q.z = near(&state, q.z, step);
        if (is_rotation(q)) {
            const uint64_t here = margin_of(input, q, margin, &result->operations);
            if (here > margin) {
                margin = here;
                best = q;
            }
        }
    }
    if (margin > 0U) {
        struct vec3 rows[3];
        rows_of(best, rows);
        for (unsigned k = 0; k < 3U; k++) {
            result->rotation[k] = (struct vec3_i128){
                i128_from_i64(rows[k].x), i128_from_i64(rows[k].y), i128_from_i64(rows[k].z)};
        }
    }
    tell(input, result);
}
