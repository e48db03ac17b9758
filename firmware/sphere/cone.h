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
    /// CONE_LENGTHS_ANY: the workspace is smaller than CONE_WORKSPACE_BYTES(count).
    CONE_ERROR_WORKSPACE = -4,
    /// read_limit is used up. result->support is a lower bound: the best support so far; give it as
    /// the warm start of the next call, also if the points have moved on, and go on from there.
    CONE_UNFINISHED = -5
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

/// Bytes of workspace, aligned to 8: notes on blocks of 16 points or more, which save reading them
/// again; and for points of any length a normalised copy of each. Unit vectors are solved without
/// any workspace, too, with more reads.
#define CONE_BLOCK_POINTS 16U
#define CONE_WORKSPACE_UNIT_BYTES(count)                                                           \
    (((size_t)(count) / CONE_BLOCK_POINTS + 1U) * 3U * sizeof(int64_t))
#define CONE_WORKSPACE_BYTES(count)                                                                \
    (CONE_WORKSPACE_UNIT_BYTES(count) + (size_t)(count) * sizeof(struct vec3))

struct cone_options {
    enum cone_lengths lengths;
    void *workspace;
    size_t workspace_bytes;
    /// Where to begin: the support of a similar set (of the last tick, say), indices into points;
    /// none: from scratch.
    const uint32_t *warm;
    uint8_t warm_count; ///< at most 3
    /// Stop with CONE_UNFINISHED after so many reads of a point; 0: never. An exact test counts as
    /// 16. Each call either finishes or improves the support, so repeated calls arrive on any
    /// input; for that, one may overshoot by up to 60 reads a point, on sets all of whose points
    /// lie on one circle (tests/property/cone_resume.c, which also searches for the worst sets).
    uint64_t read_limit;
};

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
/// Cost:     expected O(count): each point is read about once, whatever the order (make
///           bench-cone); with a warm start once. Ten unit vectors take 2,900 instructions on
///           x86-64, 3,500 on a Cortex-M4 (tests/gate/cone.sh). No allocation, no recursion.
/// Accuracy: the largest true angle from axis_q30 exceeds the optimum by at most 1 nrad, and
///           half_angle_turn64 exceeds that angle by at most 2^-50 turns
///           (tests/property/cone_random.c, tests/unit/test_cone_vectors.c). Feasibility is exact.
///           Scaling, permuting or repeating points changes no bit of the axis.
/// Source:   Anderson 1985, section 4.3, Lawson 1965; docs/geometry.md, "The pivot solver".
enum cone_status cone_narrowest(const struct vec3 *points, uint32_t count,
                                const struct cone_options *options,
                                struct cone_result *result) MUST_CHECK;

#endif
