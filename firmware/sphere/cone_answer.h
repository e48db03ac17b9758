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

/// The whole answer from one to three indices whose narrowest cone holds all points: works out the
/// axis, and finds the farthest point by an exact pass. For methods that find a support
/// combinatorially.
/// Returns:  CONE_OK; CONE_INFEASIBLE if rounding left the support's cone at 90 degrees: the caller
///           decides on the integers.
/// Cost:     at most two pivots, and one pass of cone_is_farther.
/// Accuracy: as cone_narrowest.
/// Source:   as cone_narrowest.
enum cone_status cone_answer(const struct vec3 *points, uint32_t count, const uint32_t *support,
                             uint8_t support_count, struct cone_result *result) MUST_CHECK;

#endif
