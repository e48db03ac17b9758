/// 64-bit filters of the narrowest cone's search: which points are surely inside the cone of the
/// support, and which surely outside. Only the points in between are worth an exact test.
///
/// Accuracy: a filter's limits leave room for the rounding of points and axis, so that what it is
///           sure of is so (tests/property/cone_random.c).
/// Source:   docs/geometry.md, "The pivot solver", for all of it.
#ifndef SPHERE_CONE_FILTER_H
#define SPHERE_CONE_FILTER_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// A filter of one support. Its measure of a point falls as the angle from the axis grows.
struct cone_filter {
    struct vec3 axis_q30;
    bool narrow;
    bool decides; // whether points in its band are worth an exact test: not before the narrow one
                  // is in force
    unsigned shift;
    int64_t surely_inside;  // measure at or above
    int64_t surely_outside; // measure below
};

/// The wide filter: the dot product with the axis, Q2.60. Cost: three products of 64 bits.
static inline int64_t cone_measure_wide(const struct cone_filter *filter, struct vec3 unit) {
    return vec3_dot_unit(filter->axis_q30, unit);
}

/// The narrow filter: minus the squared cross product with the axis, scaled so that the circle lies
/// near 2^57. Unlike the cosine, a small sine is not drowned by the rounding of the lengths. Only
/// right for points ahead. Cost: nine products of 64 bits.
static inline int64_t cone_measure_narrow(const struct cone_filter *filter, struct vec3 unit) {
    const struct vec3_i64 cross = vec3_cross(filter->axis_q30, unit);
    const int64_t x = cross.x >> filter->shift, y = cross.y >> filter->shift,
                  z = cross.z >> filter->shift;
    const int64_t far = (int64_t)1 << 30;
    if (x >= far || x < -far || y >= far || y < -far || z >= far || z < -far) {
        return INT64_MIN;
    }
    return -(x * x + y * y + z * z);
}

/// The one that is in force. Cost: that one's.
static inline int64_t cone_measure(const struct cone_filter *filter, struct vec3 unit) {
    return filter->narrow ? cone_measure_narrow(filter, unit) : cone_measure_wide(filter, unit);
}

/// The filter for the cone about axis_q30 through on_circle: wide, or narrow where the cone is and
/// all_ahead tells that every point is known to be ahead of an axis within 2^-7 rad. Cost: one
/// measure.
struct cone_filter cone_filter(struct vec3 axis_q30, struct vec3 on_circle, bool all_ahead);

#endif
