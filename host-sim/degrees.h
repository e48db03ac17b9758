/// Positions for people and reports: the controller counts turns of 2^48 and has no floating point.
#ifndef SIM_DEGREES_H
#define SIM_DEGREES_H

#include <stdint.h>

/// Also of speeds and accelerations, whatever they are counted by. Exact but for the rounding of
/// the argument, if that is beyond 2^53.
static inline double degrees(int64_t position_q48) {
    return (double)position_q48 * (360.0 / 281474976710656.0);
}

#endif
