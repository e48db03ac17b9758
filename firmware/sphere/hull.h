/// Spherical convex hull: the extreme directions of a set, in order around it.
#ifndef SPHERE_HULL_H
#define SPHERE_HULL_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stddef.h>
#include <stdint.h>

enum hull_status {
    HULL_OK = 0,
    /// No open half-sphere holds all points; result->witness tells which ones.
    HULL_NOT_HEMISPHERICAL = -1,
    HULL_EMPTY = -2,
    /// A zero vector has no direction; result->bad_index is the first one.
    HULL_ERROR_ZERO_VECTOR = -3,
    HULL_ERROR_WORKSPACE = -4
};

/// Bytes of workspace for count points, 4-byte aligned: the angular order, a spare for the sort,
/// and the list.
#define HULL_WORKSPACE_BYTES(count) ((size_t)(count)*3U * sizeof(uint32_t))

struct hull_result {
    /// HULL_OK: indices of the extreme directions, in the workspace; strictly convex, clockwise as
    /// seen from outside the sphere, starting at the smallest index. One index: all points are
    /// parallel. Two: an arc.
    const uint32_t *vertices;
    uint32_t vertex_count;
    /// HULL_NOT_HEMISPHERICAL: one to four points, ascending, whose non-negative combinations
    /// contain zero.
    uint8_t witness_count;
    uint32_t witness[4];
    /// HULL_ERROR_ZERO_VECTOR.
    uint32_t bad_index;
};

/// The extreme directions. Of equal directions the first is taken; points on an edge are not
/// extreme. points:   count directions, components any int32, any length; not modified. Cost:
/// O(count log count): a merge sort by exact angle, then one scan. No allocation, no recursion.
/// Accuracy: exact: every decision is the sign of a 96-bit determinant
///           (tests/property/hull_exact.c compares with brute force over all pairs).
/// Source:   Anderson 1985, section 3 (Graham's scan on the sphere), as corrected in
/// docs/geometry.md.
enum hull_status hull_spherical(const struct vec3 *points, uint32_t count, void *workspace,
                                size_t workspace_bytes, struct hull_result *result) MUST_CHECK;

#endif
