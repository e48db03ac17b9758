/// Is there a direction that has every point strictly in front of it? Decided exactly, on the
/// integers as given.
#ifndef SPHERE_FEASIBLE_H
#define SPHERE_FEASIBLE_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"
#include "sphere/min_norm.h"

#include <stdbool.h>
#include <stdint.h>

/// points:     count >= 1 directions, any int32 but zero; only their directions count.
/// support:    if feasible: its direction has every point strictly in front of it.
/// witness:    if not: the smallest subset of at most four points found whose positive combinations
///             contain zero.
/// Returns:    whether it is feasible, i.e. zero is not in the closed convex hull of the points.
/// Cost:       a few passes of exact tests: for sets near a half-space, where rounded unit vectors
///             can't tell.
/// Accuracy:   exact (tests/property/cone_random.c, also one unit beside the boundary).
/// Source:     docs/geometry.md, "Feasibility".
bool feasible_decide(const struct vec3 *points, uint32_t count, struct min_norm *support,
                     uint32_t witness[4], uint8_t *witness_count, uint64_t *point_reads) MUST_CHECK;

/// A witness among the points of a support and one more; its size, 0 if they do not surround the
/// viewpoint. Cost, accuracy and source: those of witness_find.
uint8_t feasible_witness(const struct vec3 *points, const struct min_norm *support, uint32_t last,
                         uint32_t witness[4]);

#endif
