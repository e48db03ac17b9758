/// The narrowest cone that holds moving caps, from tick to tick.
///
/// A cap is all directions within its radius of its centre: a target with its size; a point is a
/// cap of radius zero. Unlike cone.h, which decides exactly and takes the time that it needs, this
/// solver decides with 64-bit products, to a few nanoradians, and its work per call is bounded: it
/// begins with the caps that held the last cone, and where those don't hold this one, it goes on in
/// the next call from where it is, also if the caps have moved on meanwhile.
#ifndef SPHERE_FOLLOW_H
#define SPHERE_FOLLOW_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"
#include "fixed/q30.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// The radius of a cap, below a quarter turn, with what the solver needs of it.
struct follow_radius {
    bam32_t angle;
    q30_t sin_q30, cos_q30; ///< trig_sincos of the angle
};

enum follow_status {
    FOLLOW_OK = 0,
    FOLLOW_EMPTY = -1, ///< no caps
    /// No cone narrower than 90 degrees less FOLLOW_CLEARANCE holds them. For points at the very
    /// edge cone.h decides exactly.
    FOLLOW_INFEASIBLE = -2,
    /// The work limit is reached. The result holds every cap all the same, but a narrower cone may
    /// hold them: call again with result->support, pending and pending_step. half_angle may be a
    /// half turn; then there is no axis yet.
    FOLLOW_UNFINISHED = -3
};

/// 2^-20 rad.
#define FOLLOW_CLEARANCE_TURN64 UINT64_C(0x28BE60DB939)

struct follow_input {
    const struct vec3 *centre_q30;      ///< unit, as vec3_normalise gives
    const struct follow_radius *radius; ///< NULL: points
    const uint16_t *member;             ///< indices of the caps that count; NULL: the first `count`
    uint32_t count;                     ///< of those
    /// The last support, and behind it the pending cap if there was one: indices of caps that
    /// count. At most 4; 0: begin from scratch.
    const uint32_t *warm;
    uint8_t warm_count;
    bool pending;         ///< the last of them is a pending one
    uint8_t pending_step; ///< the last result's
    /// About how much work is allowed, in units of one cap read (20 instructions of a Cortex-M4).
    /// It is tested after each pass, so that a call takes at least one step. 0: no limit.
    uint32_t work_limit;
};

struct follow_result {
    struct vec3 axis_q30;
    bam32_t half_angle; ///< the cone holds every cap; at most a half turn
    uint8_t support_count;
    uint32_t support[4]; ///< caps whose own narrowest cone this is; and behind them, if pending,
    bool pending;        ///< the cap that the next call takes in first (FOLLOW_UNFINISHED)
    uint8_t pending_step;
    uint32_t work; ///< done, in units of one cap read
};

/// The narrowest cone.
/// Returns:  a status; result is set for FOLLOW_OK and FOLLOW_UNFINISHED, the support also for
///           FOLLOW_INFEASIBLE.
/// Cost:     count reads for a support that still holds, and count more for each change of it;
///           work_limit bounds a call but for the first (tests/unit/test_follow.c prints the work
///           of random and of hard sets).
/// Accuracy: the largest reach from the axis (angle to a centre, plus radius) exceeds the optimum
///           by at most 10 nrad, and half_angle that reach by at most 9 BAM
///           (tests/property/follow_exact.c).
/// Source:   docs/geometry.md, "From tick to tick".
enum follow_status follow_narrowest(const struct follow_input *input,
                                    struct follow_result *result) MUST_CHECK;

#endif
