/// Pans: from one direction to another in a chosen time, at minimum jerk.
#ifndef AIM_PAN_H
#define AIM_PAN_H

#include "fixed/must_check.h"
#include "fixed/q30.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Which f of equation 18 the two directions are weighed with.
enum pan_path {
    PAN_BY_SUM,  ///< 1 - cos: the weighted sum of the unit vectors
    PAN_BY_ANGLE ///< the angle squared: the weight is the part of the way
};

/// The weight of where the pan goes, 0 to 1: 10 s^3 - 15 s^4 + 6 s^5 of the part s of the time,
/// which begins and ends without speed and acceleration. 1 from duration_us on.
/// Accuracy: 2^-27 (tests/unit/test_pan.c).
/// Cost:     one division and five products of 64 bits.
/// Source:   Flash, Hogan 1985: the path of least jerk between two rests.
q30_t pan_weight_q30(uint64_t elapsed_us, uint32_t duration_us);

/// Equation 18 for two objects of weight 1 - w and w.
/// Returns:  false, and leaves out, where they are opposite to 2^-20 rad and it is undefined.
/// Accuracy: 3e-9 rad, divided by the sine of the angle between them (tests/unit/test_pan.c).
/// Cost:     one normalisation; by angle an arc tangent and three sines of 64 bits, too.
/// Source:   Anderson 1985, equation 18; docs/geometry.md, "Several objects".
bool pan_blend(struct vec3 from_q30, struct vec3 to_q30, q30_t weight_q30, enum pan_path path,
               struct vec3 *out_q30) MUST_CHECK;

#endif
