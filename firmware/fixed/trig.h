/// Sine, cosine and arc tangent of binary angles.
#ifndef FIXED_TRIG_H
#define FIXED_TRIG_H

#include "fixed/bam32.h"
#include "fixed/q30.h"

#include <stdint.h>

struct sincos {
    q30_t sin_q30, cos_q30;
};

/// Sine and cosine. Exact at the quarter turns; sin(-a) = -sin(a) and cos(-a) = cos(a) bit for bit.
/// Accuracy: 0.5001 ulp of 2^-30, every one of the 2^29 arguments of the first octant and the
/// reduction of
///           the others (tests/property/fixed_exhaustive.c).
/// Cost:     15 products of 64 x 64 bits, no division, no table.
/// Source:   Taylor series in pi/4 units, terms to the 14th power; the first one left out is below
/// 2^-45.
struct sincos trig_sincos(bam32_t angle);

struct trig_octant {
    uint64_t sin_by_t_q63; ///< sin(x) / t, where t is x in units of 1/8 turn
    uint64_t cos_q63;
};

/// The series behind trig_sincos, before they are rounded: for quotients that need more digits.
/// x_bam: 0 to 2^29, 1/8 turn. The sine is left as a factor of t, so that small angles keep theirs.
/// Accuracy: the first terms left out are 2^-45 t^14 and 2^-49 t^16, and rounding adds 2^-60: a
///           tangent near 90 degrees keeps 58 bits (tests/property/orient_reference.c).
struct trig_octant trig_octant(uint32_t x_bam);

/// Angle of the vector (x, y) from the x axis toward the y axis; 0 for the zero vector.
/// x, y: any int64. trig_atan2(-y, x) = -trig_atan2(y, x) bit for bit, save for the half turn.
/// Accuracy: 0.5001 BAM (tests/property/fixed_exhaustive.c).
/// Cost:     one 128-by-64-bit division and five 64-bit products.
bam32_t trig_atan2(int64_t y, int64_t x);

/// The same for y, x >= 0 with 2^64 units a turn: 0 to 2^62. 0 for the zero vector.
/// Accuracy: 2^-55 rad, 83 units (tests/property/fixed_exhaustive.c).
/// Source:   nearest of 65 tabulated tangents k/64, then four terms of the series of the remainder.
uint64_t trig_atan2_turn64(uint64_t y, uint64_t x);

#endif
