/// Exact certificates of a narrowest cone: does the named support, or the named witness, prove the
/// answer?
///
/// Where BORESIGHT_DEBUG is defined (the sanitizers' build), every method checks its own answers
/// with these, and traps if one fails.
#ifndef SPHERE_CERTIFY_H
#define SPHERE_CERTIFY_H

#include "fixed/vec3.h"
#include "sphere/min_norm.h"

#include <stdbool.h>
#include <stdint.h>

/// Are these one to three points on a circle smaller than a great one that has all points
/// inside or on it, and that no smaller one around these points could replace: one direction,
/// the ends of a diameter, or a triangle without an obtuse angle?
/// Cost:      count exact tests (sphere/site.h).
/// Accuracy:  exact: it is the definition of the narrowest cone's support.
/// Source:    Anderson 1985, Lemma 2.
/// Shown:     tests/property/methods.c, also that it refuses wrong supports.
bool certify_support(const struct vec3 *points, uint32_t count, const uint32_t *support,
                     uint32_t support_count);

/// The same for what the pivot solver finds: no point, normalised to Q2.61, lies beyond the plane
/// of its support.
/// Cost:      count tests of min_norm_violated_by.
/// Accuracy:  exact for the normalised points.
/// Source:    docs/geometry.md, "The pivot solver".
bool certify_held(const struct vec3 *points, uint32_t count, const struct min_norm *support);

/// Do these two to four points surround the viewpoint, each with a positive weight?
/// Cost:      at most four determinants of 96 bits.
/// Accuracy:  exact.
/// Source:    Caratheodory; sphere/witness.h.
bool certify_witness(const struct vec3 *points, const uint32_t *witness, uint8_t witness_count);

/// For debug builds: ends the program where an own answer is not proved.
#ifdef BORESIGHT_DEBUG
#define CERTIFY(proved) ((proved) ? (void)0 : __builtin_trap())
#else
#define CERTIFY(proved) ((void)0)
#endif

#endif
