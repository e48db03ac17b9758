/// Sine, cosine and angles to the last digits of 64 bits, where trig.h's Q1.30 are too few.
#ifndef FIXED_TRIG_FINE_H
#define FIXED_TRIG_FINE_H

#include "fixed/vec3.h"

#include <stdint.h>

/// 2^64 units a turn: a quarter turn, and 2^-30 rad.
#define TURN64_QUARTER (UINT64_C(1) << 62)

struct sincos_q62 {
    int64_t sin_q62, cos_q62;
};

/// Sine and cosine of an angle with 2^64 units a turn. Exact at the quarter turns.
/// Accuracy: 2^-59 (tests/property/trig_fine.c).
/// Cost:     20 products of 64 x 64 bits.
/// Source:   Taylor series in pi/4 units; the first terms left out are below 2^-63.
struct sincos_q62 trig_fine_sincos(uint64_t turn64);

/// The angle between two vectors, 2^64 units a turn: 0 to 2^63. 0 if either is zero.
/// a, b:     components at most 2^62 in size; lengths of at least 2^50, or digits are lost.
/// Accuracy: 2^-54 rad (tests/property/trig_fine.c).
/// Cost:     nine products of 64 x 64 bits, a root and two divisions of 128 bits.
uint64_t trig_fine_angle(struct vec3_i64 a, struct vec3_i64 b);

/// The same for near-unit vectors in Q1.30 (shorter ones lose digits).
uint64_t trig_fine_angle_q30(struct vec3 a, struct vec3 b);

#endif
