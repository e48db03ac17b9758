/// From a point as written to the integers that the geometry works on.
///
/// The vector from the viewpoint to the point is formed in exact decimal arithmetic. Divided by
/// their greatest common divisor, its three components become integers that depend on nothing but
/// the direction: not on the unit, nor on the distance. Those are used as they are where they fit
/// int32, so that coplanar and antipodal points stay so. Longer ones are scaled by a power of two
/// until the largest has 31 bits, and rounded half away from zero: opposite directions stay
/// opposite, equal ones equal.
/// Shown: tests/cli/decimals.c.
#ifndef LINUX_DIRECTION_H
#define LINUX_DIRECTION_H

#include "decimal.h"

#include "fixed/vec3.h"

struct direction {
    /// What the solvers take. Not zero.
    struct vec3 coarse;
    /// The same direction for measuring: components below 2^62 in size. Either exact, or the
    /// largest one has 62 bits (or has been rounded up to 2^62) and each is off by half a unit.
    struct vec3_i64 fine;
    bool coarse_exact, fine_exact;
};

/// The direction from the viewpoint to the point. False: there is none, they are equal.
/// Cost: about 0.1 us where both fit 37 digits between the highest and the lowest, else
///       O(digits^2).
bool direction_from_decimals(const struct decimal point[3], const struct decimal viewpoint[3],
                             struct direction *out);

/// Places after the point to which direction_from_degrees takes an angle; digits beyond are cut.
enum { DIRECTION_DEGREE_PLACES = 27 };

/// Right ascension and declination in units of 10^-27 degrees; |declination| at most 90 degrees.
/// The angles are reduced exactly to at most 45 degrees, then sines and cosines are taken in long
/// double: opposite stars get opposite vectors, and quarter turns are exact.
void direction_from_degrees(struct i128 right_ascension, struct i128 declination,
                            struct direction *out);

/// How far `fine` can be from the true direction, in radians, where fine_exact is false: of a
/// direction from decimals, and from degrees.
extern const long double direction_decimals_error_rad, direction_degrees_error_rad;

#endif
