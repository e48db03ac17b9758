/// Where to look for several objects of different weight: equation 18 of Anderson 1985.
#ifndef LINUX_WEIGH_H
#define LINUX_WEIGH_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// What an object costs at an angle t from where one looks; all grow with it.
enum weigh_cost {
    WEIGH_ONE_MINUS_COS, ///< the weighted sum of the unit vectors: one minimum, everywhere
    WEIGH_ANGLE_SQUARED, ///< constant angular speed between two objects; one minimum in half a
                         ///< sphere
    WEIGH_ONE_OVER_COS   ///< the distortion of 1982: a barrier at 90 degrees
};

enum weigh_status {
    WEIGH_OK = 0,
    WEIGH_UNDEFINED = -1, ///< every direction is as good as another, to 1e-9; or no positive weight
    WEIGH_INFEASIBLE = -2 ///< WEIGH_ONE_OVER_COS: no direction sees every object of positive weight
};

/// The direction v that minimises the sum of weight_i f(angle between v and direction_i).
/// directions_q30: unit, at least one; weights: not negative.
/// near_q30:  unit; of several minima that are equally good (angle squared, beyond half a sphere)
///            the one that the search meets first, from there.
/// Accuracy:  1e-9 rad where the minimum is unique (tests/property/weigh_global.c: against a search
///            of the sphere).
/// Source:    docs/geometry.md, "Several objects".
enum weigh_status weigh_directions(const struct vec3 *directions_q30, const double *weights,
                                   uint32_t count, enum weigh_cost cost, struct vec3 near_q30,
                                   struct vec3 *out_q30);

#endif
