/// Independent certificate checker for narrowest cones and witnesses. Shares no code with firmware/
/// (only the declarations of the structs): exact integers are GMP's, angles are MPFR's with 256
/// bits.
///
/// What it proves of an answer:
/// - a witness: some of the named points, with positive weights, sum to zero; exact;
/// - a feasible claim: a vector of integers that has every point strictly in front; exact;
/// - the optimum: the narrowest cone of at most three points is a lower bound of the set's, and if
///   it holds all points, it is the set's. The named support is taken for those three; where a
///   point lies outside, even by 1e-60 rad, the checker pivots on with its own numbers;
/// - the printed cone: no point lies outside, and how much larger than need be it is.
#ifndef SUPPORT_CONE_CHECK_H
#define SUPPORT_CONE_CHECK_H

#include "sphere/cone.h"

#include <stdbool.h>
#include <stdint.h>

struct cone_report {
    /// The optimum.
    double half_angle_rad;
    /// The optimum, minus the half-angle of the narrowest cone of the named support.
    double support_gap_rad;
    /// How far a point lies outside that cone.
    double support_outside_rad;
    /// Largest true angle from the printed axis, minus the optimum.
    double excess_rad;
    /// Printed half-angle minus that largest angle, in units of 2^-64 turn: must not be negative.
    double slack_turn64;
    /// Largest true angle from the printed axis, minus 90 degrees; negative for nearly all sets.
    double beyond_quarter_rad;
};

/// What cone.h claims, and for which half-angles.
#define CONE_CLAIM_FROM_RAD   1e-6
#define CONE_CLAIM_TO_RAD     1.57077887350062736 // 89.999 degrees
#define CONE_EXCESS_RAD_MAX   3e-9
#define CONE_SLACK_TURN64_MAX 0x1p14 // 2^-50 turns

static inline bool cone_in_claimed_range(double half_angle_rad) {
    return half_angle_rad >= CONE_CLAIM_FROM_RAD && half_angle_rad <= CONE_CLAIM_TO_RAD;
}

/// The gap that is let pass. Within the claimed range it is that of the solver's Q2.61 directions,
/// and no point may lie farther outside. Narrower, their cosines tell angles below 1e-9 rad no more
/// apart; wider, any support whose axis sees all points may do.
static inline double cone_support_gap_max(double half_angle_rad) {
    return cone_in_claimed_range(half_angle_rad) ? 1e-12 : 1e-9;
}

/// NULL if the answer is right, or what is wrong with it. report is set for CONE_OK only.
const char *cone_check(const struct vec3 *points, uint32_t count, enum cone_status status,
                       const struct cone_result *result, struct cone_report *report);

/// Largest true angle from the axis to any point, in units of 2^-64 turn, rounded down.
uint64_t cone_largest_angle_turn64(const struct vec3 *points, uint32_t count, struct vec3 axis);

/// Gives back what MPFR and this file keep.
void cone_check_free(void);

#endif
