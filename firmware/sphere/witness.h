/// Does a handful of directions surround the viewpoint? The exact certificate of infeasibility.
#ifndef SPHERE_WITNESS_H
#define SPHERE_WITNESS_H

#include "fixed/vec3.h"

#include <stdint.h>

/// Finds the smallest subset of the candidates whose combinations with positive weights contain
/// zero.
/// points:     directions, any int32 but zero.
/// candidates: count (at most 4) distinct indices into points.
/// witness:    gets the subset's indices, ascending.
/// Returns:    its size, 2 to 4; 0 if zero is not in the closed convex hull of the candidates.
/// Cost:       at most 11 subsets, each with at most four determinants of 96 bits.
/// Accuracy:   exact (tests/property/hull_exact.c, cone_random.c check each witness in rationals).
/// Source:     Caratheodory: in space, four points suffice if any number does.
uint8_t witness_find(const struct vec3 *points, const uint32_t *candidates, uint8_t count,
                     uint32_t witness[4]);

/// For parallel non-zero vectors: do they point the same way? Their dot product would need 128
/// bits. Cost: a few comparisons. Accuracy: exact. Source: the definition.
bool witness_same_sense(struct vec3_i64 a, struct vec3_i64 b);

#endif
