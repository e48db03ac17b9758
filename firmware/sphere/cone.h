/// Narrowest circular cone from the viewpoint that holds a set of directions.
///
/// A direction is any int32 vector but zero; its length does not matter. The cone's axis is where a
/// camera at the viewpoint should look: it minimises the largest distortion of perspective, and
/// sees every point whenever some direction does (Anderson 1982, 1985).
#ifndef SPHERE_CONE_H
#define SPHERE_CONE_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stddef.h>
#include <stdint.h>

enum cone_status {
    CONE_OK = 0,
    /// No direction has all points strictly in front of it: the viewpoint lies in the closed convex
    /// hull of the points. result->witness tells which ones. Exact: decided on the integers as
    /// given.
    CONE_INFEASIBLE = -1,
    /// No points.
    CONE_EMPTY = -2,
    /// A zero vector has no direction; result->bad_index is the first one.
    CONE_ERROR_ZERO_VECTOR = -3,
    /// The workspace is smaller than CONE_WORKSPACE_BYTES(count).
    CONE_ERROR_WORKSPACE = -4
};

/// What the caller knows of the points' lengths.
enum cone_lengths {
    /// Nothing. A normalised copy of every point is made in the workspace first.
    CONE_LENGTHS_ANY,
    /// Each is a unit vector in Q1.30, its length within 2^-29 of one (what vec3_normalise gives).
    /// No workspace
    /// is needed. A broken promise costs accuracy, never a crash; debug builds check it.
    CONE_LENGTHS_UNIT
};

/// Bytes of workspace for count points of any length.
#define CONE_WORKSPACE_BYTES(count) ((size_t)(count) * sizeof(struct vec3))

struct cone_result {
    /// Unit, Q1.30: where to look.
    struct vec3 axis_q30;
    /// The largest true angle from axis_q30 to any point, rounded up: the cone holds every point.
    /// half_angle_turn64 has 2^64 units a turn (at most 2^63), half_angle_bam32 is the same rounded
    /// up to BAM.
    uint64_t half_angle_turn64;
    bam32_t half_angle_bam32;
    /// A point at that angle.
    uint32_t farthest_index;
    /// One to three points whose own narrowest cone is this one, ascending. Of several such sets,
    /// one. Their half-angle is the set's within 1e-12 rad from 1e-6 rad to 89.999 degrees, and
    /// within 1e-9 rad elsewhere (tests/property/cone_random.c).
    uint8_t support_count;
    uint32_t support[3];
    /// CONE_INFEASIBLE: one to four points, ascending, whose non-negative combinations contain
    /// zero.
    uint8_t witness_count;
    uint32_t witness[4];
    /// CONE_ERROR_ZERO_VECTOR.
    uint32_t bad_index;
    /// How many times a point was read in search of the answer.
    uint64_t point_reads;
};

/// The narrowest cone, by pivoting: the farthest point enters a support set of at most three.
/// points:   count directions, components any int32; not modified.
/// Returns:  a status; result is set as far as the status says.
/// Cost:     expected O(count); a handful of passes. No allocation, no recursion.
///           (tests/property/cone_random.c prints reads a point; a bench follows with the Anderson
///           issue)
/// Accuracy: the largest true angle from axis_q30 exceeds the optimum by at most 3 nrad at
/// half-angles from
///           1e-6 rad to 89.999 degrees, and half_angle_turn64 exceeds that angle by at most 2^-50
///           turns (tests/property/cone_random.c, tests/unit/test_cone_vectors.c). Nearer to 90
///           degrees feasibility is still exact, and the axis within 3 nrad of one that sees all
///           points. Scaling, permuting or repeating points changes no bit of the axis.
/// Source:   Anderson 1985, section 4.3, Lawson 1965; docs/geometry.md, "The pivot solver".
enum cone_status cone_narrowest(const struct vec3 *points, uint32_t count,
                                enum cone_lengths lengths, void *workspace, size_t workspace_bytes,
                                struct cone_result *result) MUST_CHECK;

#endif
