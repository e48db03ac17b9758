/// From the support of a cone to the answer: axis, half-angle, farthest point. Shared by all
/// methods.
#ifndef SPHERE_CONE_ANSWER_H
#define SPHERE_CONE_ANSWER_H

#include "sphere/cone.h"
#include "sphere/min_norm.h"

#include <stdbool.h>
#include <stdint.h>

/// Is point a at a larger true angle from the axis than b? Exact. Any int32 directions.
bool cone_is_farther(struct vec3 axis_q30, struct vec3 a, struct vec3 b);

/// True angle between the axis and a point, rounded up; 2^64 units a turn, at most 2^9 + 2^6 too
/// large.
uint64_t cone_angle_rounded_up(struct vec3 axis_q30, struct vec3 point);

/// A point of a list as the solvers take it.
struct min_norm_point cone_point(const struct vec3 *points, uint32_t index);

/// Fills axis, half-angle and support; the caller knows the farthest point.
void cone_report(const struct vec3 *points, struct vec3 axis_q30, const struct min_norm *support,
                 uint32_t farthest_index, struct cone_result *result);

/// The whole answer from one to three indices whose narrowest cone holds all points: works out the
/// axis, and finds the farthest point by an exact pass. For methods that find a support
/// combinatorially. Returns: CONE_OK; CONE_INFEASIBLE if rounding left the support's cone at 90
/// degrees: the caller decides on the integers.
enum cone_status cone_answer(const struct vec3 *points, uint32_t count, const uint32_t *support,
                             uint8_t support_count, struct cone_result *result) MUST_CHECK;

#endif
