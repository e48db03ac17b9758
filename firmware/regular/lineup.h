/// Which three targets are on one line in the picture, however many there are.
///
/// For each target the slopes of the lines to all later ones are sorted, and equal ones counted.
/// That takes O(n^2 log n) time and O(n) space, and needs general position: no target in the
/// viewer's own plane, and no two with the same x in the picture, whose line has no slope. It gets
/// it from an exact turn (regular/rotation.h) that is tested to be regular, as section 2 of the
/// paper does: sort, and look for two with the same x. Which targets line up is the same before and
/// after; the normal of their plane is turned back, exactly.
#ifndef REGULAR_LINEUP_H
#define REGULAR_LINEUP_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum lineup_status {
    LINEUP_OK = 0,
    LINEUP_ERROR_ZERO_VECTOR = -1, ///< result->first[0] has no direction
    LINEUP_ERROR_WORKSPACE = -2,
    /// No turn of the sequence that keeps the directions within int32 gives general position. Not
    /// seen below 2^24 (tests/property/lineup.c: lattices, near and far).
    LINEUP_ERROR_POSITION = -3
};

/// Bytes of workspace for count directions, aligned to 8.
#define LINEUP_WORKSPACE_BYTES(count)                                                              \
    ((size_t)(count) * (2U * sizeof(int64_t) + sizeof(struct vec3) + 3U * sizeof(uint32_t)))

struct lineup_result {
    /// Triples of directions in one plane with the viewpoint: on one line in the picture, or with
    /// two in the same or in opposite directions.
    uint64_t triples;
    uint64_t pairs;    ///< in the same or in opposite directions
    uint32_t first[3]; ///< the first triple, ascending, if there is one
    /// Of the plane of the first triple: the cross product of the first two of its directions that
    /// are not parallel, each divided by its common divisor and turned so that its first component
    /// that is not 0 is above 0. The viewpoint leaves the plane along it. Zero if there are no such
    /// two.
    struct vec3_i64 normal;
    uint32_t turns; ///< turns that were tried; 0: it was in general position as it stood
};

/// directions: count, from the viewpoint, none zero, each shorter than 2^31; not modified.
/// turn:     false: takes them as they stand, which is wrong unless they are in general position.
/// Cost:     count^2 / 2 slopes and log2 count comparisons each: 0.3 s for 2,000 on a PC.
/// Accuracy: exact in general position (tests/property/lineup.c: all triples; on lattices the
///           answer without the turn is wrong).
/// Source:   Gomez, Ramaswami, Toussaint 1996, sections 2 and 5.1; rational rotations: Canny,
///           Donald, Ressler 1992; docs/regular.md.
enum lineup_status lineup_find(const struct vec3 *directions, uint32_t count, bool turn,
                               void *workspace, size_t workspace_bytes,
                               struct lineup_result *result) MUST_CHECK;

#endif
