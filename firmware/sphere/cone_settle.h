/// From a support that was found combinatorially, or a witness, to the answer of a method.
#ifndef SPHERE_CONE_SETTLE_H
#define SPHERE_CONE_SETTLE_H

#include "fixed/must_check.h"
#include "sphere/cone.h"

#include <stdint.h>

/// Looks for zero vectors before a method begins; every point is read once.
/// Returns:   CONE_OK, CONE_EMPTY, or CONE_ERROR_ZERO_VECTOR with result->bad_index. Clears the
///            result.
/// Cost:      three comparisons a point.
/// Accuracy:  exact.
/// Source:    a zero vector has no direction.
enum cone_status cone_settle_start(const struct vec3 *points, uint32_t count,
                                   struct cone_result *result) MUST_CHECK;

/// The answer from one to three points whose own narrowest cone holds all others; the set is
/// known to be feasible. result->point_reads counts on.
/// Returns:   CONE_OK.
/// Cost:      one pass.
/// Accuracy:  the axis is that of the true directions, within 1 unit a component: the largest
///            true angle exceeds the optimum by at most 3 nrad, for cones of any width
///            (tests/property/methods.c).
/// Source:    docs/geometry.md, "True directions".
enum cone_status cone_settle_support(const struct vec3 *points, uint32_t count,
                                     const uint32_t *support, uint8_t support_count,
                                     struct cone_result *result) MUST_CHECK;

/// The answer from a witness.
/// Returns:   CONE_INFEASIBLE.
/// Cost:      a copy; the debug build proves it (sphere/certify.h).
/// Accuracy:  exact.
/// Source:    docs/geometry.md, "Feasibility".
enum cone_status cone_settle_witness(const struct vec3 *points, const uint32_t *witness,
                                     uint8_t witness_count, struct cone_result *result) MUST_CHECK;

#endif
