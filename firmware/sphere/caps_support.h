/// The narrowest cap of a sphere that holds at most four caps, and the one to three of them that
/// determine it.
///
/// A cap is all directions within an angle, its radius, of its centre. For caps.c only: the
/// counterpart of min_norm.h, which does the same for points and decides exactly. Radii are angles,
/// their sines are no fractions, so nothing can be exact here: the candidates are worked out to
/// about 2^-56 rad, and the one that reaches least far wins.
/// Shown: tests/property/follow_exact.c, tests/unit/test_follow.c.
#ifndef SPHERE_CAPS_SUPPORT_H
#define SPHERE_CAPS_SUPPORT_H

#include "fixed/must_check.h"
#include "fixed/trig_fine.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

struct caps_point {
    uint32_t index;
    struct vec3_i64 centre_q61; ///< unit
    uint64_t radius_turn64;     ///< below a quarter turn
    struct sincos_q62 radius;
};

struct caps_support {
    uint8_t count;
    struct caps_point point[3];
    struct vec3_i64 axis_q61; ///< of their narrowest cap, unit
    uint64_t reach_turn64;    ///< the radius of that cap: no smaller one holds them
};

/// One cap: it is its own narrowest. Cost: none. Accuracy: exact. Source: the definition.
void caps_support_start(struct caps_support *support, const struct caps_point *point);

/// How far a cap reaches from an axis: angle to its centre, and its radius.
/// Cost:     trig_fine_angle: a cross product, a root and an arc tangent.
/// Accuracy: trig_fine_angle's.
/// Source:   docs/geometry.md, "Spheres".
uint64_t caps_reach(struct vec3_i64 axis_q61, const struct caps_point *point);

/// One to three caps at once. False: not all of them are needed for their narrowest cap.
/// Cost, accuracy and source: those of one subset of caps_support_enter.
bool caps_support_hold(struct caps_support *support, const struct caps_point *points,
                       uint8_t count) MUST_CHECK;

/// Writes down one to three caps without solving them: for caps_support_enter alone.
/// Cost: none but a copy. Accuracy and source: nothing is worked out.
void caps_support_recall(struct caps_support *support, const struct caps_point *points,
                         uint8_t count);

enum caps_entry {
    CAPS_ENTERED = 0,
    /// Entered, but none of the caps hold the cone of all to 2^-40 turns: rounding, or the new cap
    /// did not reach beyond the support. The cone is wide enough.
    CAPS_LOOSE = 1,
    CAPS_SURROUNDED = -1, ///< no cap of less than a quarter turn, less 2^-30 rad, holds them
    CAPS_GO_ON = -2       ///< the bound is reached: call again with the same support and cap
};

/// Takes in a cap that reaches beyond the support's; the support becomes that of the narrowest cap
/// of the (at most four) caps. It is left if the result is negative.
/// step:     0 to begin with; updated. NULL: without a bound.
/// Cost:     at most seven subsets: one angle, three arcs and three axes of equal reach, each with
///           the angles of the others to it. With a bound, less than half of that: 50,000
///           instructions of a Cortex-M4 (tests/unit/test_follow.c).
/// Accuracy: of the reach, 2^-40 turns for caps whose centres are 1e-6 rad apart or more
///           (tests/property/follow_exact.c).
/// Source:   Fischer and Gaertner 2003 (balls: the pivot needs the whole basis); Apollonius.
enum caps_entry caps_support_enter(struct caps_support *support, const struct caps_point *point,
                                   uint8_t *step) MUST_CHECK;

#endif
