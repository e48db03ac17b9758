/// Positions of an axis that count turns: int64_t with 2^48 units a turn (`_q48`), +-32,768 turns.
///
/// For the zoom axis the same numbers mean the travel of the lens: 0 is wide, 2^48 is tele, and
/// what follows (limits, limiter, drives) is the same code. Rates are per tick, so that the limiter
/// needs no division by time.
#ifndef MOTION_AXIS_H
#define MOTION_AXIS_H

#include "fixed/bam32.h"

#include <stdint.h>

#define AXIS_TURN_Q48 ((int64_t)1 << 48)

/// Drops the turns; rounded to nearest, half a BAM upward. Any position.
static inline bam32_t axis_to_bam32(int64_t position_q48) {
    return bam32((uint32_t)(((uint64_t)position_q48 + (1U << 15)) >> 16));
}

static inline int64_t axis_from_bam(int32_t bam) {
    return (int64_t)bam * (1 << 16);
}

/// The position that shows `angle` and is reached from `from_q48` by the shortest way inside [min,
/// max]; if the angle is not inside at any turn, the limit that is nearer to it round the circle.
/// So a pan keeps counting through the seam at a half turn, and takes the long way round only where
/// the cable asks for it. min <= max, both within 32,767 turns of 0; from_q48: any. Shown:
/// tests/unit/test_axis.c (against a search of all turns).
int64_t axis_unwrap(bam32_t angle, int64_t from_q48, int64_t min_q48, int64_t max_q48);

#endif
