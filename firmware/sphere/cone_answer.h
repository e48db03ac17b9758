/// From the support of a cone to the answer: axis, half-angle, farthest point. Shared by all
/// methods.
#ifndef SPHERE_CONE_ANSWER_H
#define SPHERE_CONE_ANSWER_H

#include "sphere/cone.h"
#include "sphere/min_norm.h"

#include <stdbool.h>
#include <stdint.h>

/// Is point a at a larger true angle from the axis than b? Any int32 directions.
/// Cost:     two dot products and norms of 64 bits; where they can't tell, two products of 256.
/// Accuracy: exact.
/// Source:   docs/geometry.md, "Exact decisions": cosines compared by their signed squares.
bool cone_is_farther(struct vec3 axis_q30, struct vec3 a, struct vec3 b);

/// The point at the largest true angle from an axis, of those that are added; of several at one
/// angle the first. Any int32 directions.
/// Cost:     seven products of 64 bits a point; two points within 2^-54 of cosine, and those
///           that are no unit vectors, cost a cone_is_farther.
/// Accuracy: exact.
/// Source:   as cone_is_farther.
struct cone_farthest {
    const struct vec3 *points;
    struct vec3 axis_q30;
    uint32_t index;     ///< of the farthest
    bool cosine_known;  ///< it is a unit vector
    int64_t cosine_q60; ///< of its angle, within 2^5 units
};

/// Cosine of the angle between the axis and a point, within 2^5 units. False: the point is no unit
/// vector in Q1.30 (but for 2^-30 of its length).
/// Cost: seven products of 64 bits. Accuracy: as said. Source: docs/geometry.md, "Exact decisions".
static inline bool cone_cosine(struct vec3 axis_q30, struct vec3 point, int64_t *cosine_q60) {
    const int64_t excess = (int64_t)(vec3_norm2(point) - (UINT64_C(1) << 60));
    const int64_t dot = vec3_dot_unit(axis_q30, point);
    *cosine_q60 = dot;
    if (excess >= (int64_t)1 << 31 || excess <= -((int64_t)1 << 31)) {
        return false;
    }
    *cosine_q60 -= ((dot >> 31) * excess) >> 30; // corrected for the length
    return true;
}

/// Begins with a point. Cost, accuracy, source: those of cone_cosine.
static inline void cone_farthest_start(struct cone_farthest *farthest, const struct vec3 *points,
                                       struct vec3 axis_q30, uint32_t index) {
    farthest->points = points;
    farthest->axis_q30 = axis_q30;
    farthest->index = index;
    farthest->cosine_known = cone_cosine(axis_q30, points[index], &farthest->cosine_q60);
}

/// Adds a point. Cost, accuracy, source: see struct cone_farthest.
static inline void cone_farthest_add(struct cone_farthest *farthest, uint32_t index) {
    const struct vec3 point = farthest->points[index];
    int64_t cosine_q60;
    const bool known = cone_cosine(farthest->axis_q30, point, &cosine_q60);
    const int64_t apart = cosine_q60 - farthest->cosine_q60; // both below 2^62 in size
    const bool sure = known && farthest->cosine_known && (apart > 64 || apart < -64);
    if (sure ? apart < 0
             : cone_is_farther(farthest->axis_q30, point, farthest->points[farthest->index])) {
        farthest->index = index;
        farthest->cosine_known = known;
        farthest->cosine_q60 = cosine_q60;
    }
}

/// True angle between the axis and a point, rounded up; 2^64 units a turn.
/// Cost:     a cross product, a root of 128 bits and an arc tangent of 64.
/// Accuracy: at most 2^9 + 2^6 units too large, never too small (tests/property/cone_random.c).
/// Source:   the arc tangent of the lengths of cross and dot product.
uint64_t cone_angle_rounded_up(struct vec3 axis_q30, struct vec3 point);

/// A point of a list as the solvers take it.
/// Cost:     vec3_normalise. Accuracy: correctly rounded. Source: docs/geometry.md, "Narrow
///           cones".
struct min_norm_point cone_point(const struct vec3 *points, uint32_t index);

/// Fills axis, half-angle and support; the caller knows the farthest point.
/// Cost, accuracy and source: those of cone_angle_rounded_up.
void cone_report(const struct vec3 *points, struct vec3 axis_q30, const struct min_norm *support,
                 uint32_t farthest_index, struct cone_result *result);

#endif
