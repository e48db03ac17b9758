/// The smallest sphere that holds a set of points. Exact for all int32 points: the points that hold
/// it are decided by wide integers, and only the centre and the radius as reported are rounded.
#ifndef SOLID_SOLID_SPHERE_H
#define SOLID_SOLID_SPHERE_H

#include "fixed/must_check.h"
#include "solid/circumsphere.h"
#include "solid/solid_hull.h"

#include <stddef.h>
#include <stdint.h>

enum solid_sphere_status {
    SOLID_SPHERE_OK = 0,
    SOLID_SPHERE_EMPTY = -1, ///< no points
    SOLID_SPHERE_ERROR_WORKSPACE = -2,
    SOLID_SPHERE_ERROR_COUNT = -3, ///< more than SOLID_HULL_COUNT_MAX
    SOLID_SPHERE_NOT_FOUND = -4    ///< by the point where the search was told to stop
};

struct solid_sphere {
    /// In units of 2^-30 of the points' unit, rounded to nearest.
    struct vec3_i64 center_q30;
    /// About center_q30 it holds every point; at most 5 units of 2^-30 above the smallest radius.
    uint64_t radius_q30;
    /// One to four points whose own smallest sphere is this one, ascending. Of several such sets,
    /// one.
    uint8_t support_count;
    uint32_t support[4];
    /// Searches by trial: where the support stands in the order of the trials, from 0, ascending.
    uint32_t place[4];
    uint64_t spheres_created; ///< through two to four points
    uint64_t spheres_tested; ///< of these, with their centre among their points: tested with points
    uint64_t point_tests;    ///< of a point against a sphere
    uint64_t pivots;         ///< solid_sphere_find: how often a point entered the support
};

/// Bytes of workspace for count points, aligned to 4. At least 5 sqrt(count) indices.
#define SOLID_SPHERE_WORKSPACE_BYTES(count) (((size_t)(count) / 32U + 256U) * sizeof(uint32_t))

/// The default: farthest points enter a support of at most four, first from a sample of about
/// 3 sqrt(count) points or more, then from the points that lie outside the sphere so far.
/// points:   count, any int32; not modified.
/// Cost:     expected O(count): a random sample of r leaves 4 count / r points outside, and each
///           pass over all points but the last adds one of the support to those that are kept
///           (Clarkson 1995); measured 1.1 to 4 tests a point (tests/property/solid_sphere.c). Work
///           on the few kept is by pivots. Each enlarges the sphere, so no support of at most four
///           points comes twice: it ends after m^4 / 24 pivots of m points at the latest; measured
///           at most 42 pivots on any set (same test). No allocation, no recursion.
/// Accuracy: support exact (tests/property/solid_sphere.c: brute force in rationals, and the
///           optimality conditions on large sets).
enum solid_sphere_status solid_sphere_find(const struct vec3 *points, uint32_t count,
                                           void *workspace, size_t workspace_bytes,
                                           struct solid_sphere *result) MUST_CHECK;

enum solid_sphere_order {
    SOLID_SPHERE_SHARPEST_FIRST, ///< by the solid angle of the hull at its vertices: Levine's
    SOLID_SPHERE_AS_LISTED       ///< by index: without the heuristic
};

/// Bytes of workspace for the search by trial, aligned to 8: the hull's, and an order.
#define SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(count)                                                  \
    (SOLID_HULL_WORKSPACE_BYTES(count) + ((size_t)(count) + 4U) * 16U)

/// The same by Levine's trial of all spheres through two, three and four vertices of the hull, in
/// an order in which the right one should come early. For comparison.
/// place_most: give up once a sphere would need the vertex at this place (Levine: 26); 0: never.
/// Cost:       up to vertices^4 spheres. Flat sets: the angle of the polygon stands for the solid
///             one.
/// Accuracy:   as solid_sphere_find (the same tests).
/// Source:     Levine 1975, chapter V, with the loop corrected (docs/geometry.md): as printed, a
///             sphere held by three points of which one is the last is never found.
enum solid_sphere_status solid_sphere_by_trial(const struct vec3 *points, uint32_t count,
                                               enum solid_sphere_order order, uint32_t place_most,
                                               void *workspace, size_t workspace_bytes,
                                               struct solid_sphere *result) MUST_CHECK;

#endif
