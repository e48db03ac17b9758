/// Spherical convex hull: the extreme directions of a set, in order around it.
#ifndef SPHERE_HULL_H
#define SPHERE_HULL_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdbool.h>
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
/// the list, and the buckets.
#define HULL_WORKSPACE_BYTES(count) (((size_t)(count)*4U + 1U) * sizeof(uint32_t))

/// How the angles are sorted.
enum hull_order {
    HULL_ORDER_MERGE,  ///< count log2 count comparisons, whatever the angles
    HULL_ORDER_BUCKETS ///< expected O(count); at worst as many as merging
};

struct hull_options {
    enum hull_order order;
    /// First drop the points inside a polygon of a few extreme ones (sphere/hull_filter.h).
    bool filter;
};

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
    /// What it cost: points that the filter left, and exact comparisons of two angles in all.
    uint32_t kept;
    uint64_t comparisons;
};

/// The extreme directions. Of equal directions the first is taken; points on an edge are not
/// extreme.
/// points:   count directions, components any int32, any length; not modified.
/// Cost:     a filter of about 6 dot products a point, then a sort by exact angle of those that it
///           leaves, expected O(count) with buckets, at worst O(count log count), then one scan
///           (make bench-cone). No allocation, no recursion.
/// Accuracy: exact: every decision is the sign of a 96-bit determinant
///           (tests/property/hull_exact.c compares with brute force over all pairs).
/// Source:   Anderson 1985, section 3 (Graham's scan on the sphere), as corrected in
///           docs/geometry.md.
enum hull_status hull_spherical(const struct vec3 *points, uint32_t count, void *workspace,
                                size_t workspace_bytes, struct hull_result *result) MUST_CHECK;

/// The same with a choice of how. Accuracy and source: the same. Cost: without the filter all
/// points are sorted, in the order that is chosen (make bench-cone measures each).
enum hull_status hull_by(const struct vec3 *points, uint32_t count,
                         const struct hull_options *options, void *workspace,
                         size_t workspace_bytes, struct hull_result *result) MUST_CHECK;

#endif
