#include "sphere/cone_filter.h"

/// How far two dot products (Q2.60) of points on one circle can be apart. Each unit's length is
/// good to 2^-29 and its direction to 2^-30; the axis is good to 2^-30: together below 2^-27.4.
#define DOT_BAND ((int64_t)1 << 33)

/// Below this sine (Q2.60) of the half-angle, 2^-8, the band of dot products is too wide beside 1 -
/// cos.
#define NARROW_SINE_Q60 (UINT64_C(1) << 52)

static int64_t square(uint64_t a) {
    return (int64_t)(a * a);
}

struct cone_filter cone_filter(struct vec3 axis_q30, struct vec3 on_circle, bool all_ahead) {
    struct cone_filter filter = {.axis_q30 = axis_q30};
    const int64_t dot = cone_measure_wide(&filter, on_circle);
    const uint64_t sine_q60 = vec3_i64_length(vec3_cross(axis_q30, on_circle));
    const bool is_narrow = dot > 0 && sine_q60 < NARROW_SINE_Q60;
    filter.narrow = is_narrow && all_ahead;
    filter.decides = filter.narrow == is_narrow;
    if (!filter.narrow) {
        filter.surely_inside = dot + DOT_BAND;
        filter.surely_outside = dot - DOT_BAND;
        return filter;
    }
    // Directions are good to 2^-30 twice, lengths to 2^-29 twice; the truncated shift costs 2
    // units.
    const uint64_t margin = (UINT64_C(1) << 32) + (sine_q60 >> 25);
    const uint64_t low = sine_q60 > margin ? sine_q60 - margin : 0U, high = sine_q60 + margin;
    while ((high >> filter.shift) >= (UINT64_C(1) << 29)) {
        filter.shift++;
    }
    const uint64_t inside = low >> filter.shift, outside = (high >> filter.shift) + 3U;
    filter.surely_inside = inside > 2U ? -square(inside - 2U) : 1; // 1: nothing is
    filter.surely_outside = -square(outside);
    return filter;
}
