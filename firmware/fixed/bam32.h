/// Binary angle: 2^32 units are one turn (1.46 nrad each). Wraps as the circle does.
///
/// In a struct, so that an angle can't be added to a count by mistake. Angles that count turns, and
/// all rates, are `int64_t` with 2^48 units a turn (`_q48`, motion/limiter.h): an int32 of BAM a
/// second would overflow at 180 degrees a second.
#ifndef FIXED_BAM32_H
#define FIXED_BAM32_H

#include <stdint.h>

typedef struct {
    uint32_t bam;
} bam32_t;

#define BAM32_QUARTER UINT32_C(0x40000000)
#define BAM32_HALF    UINT32_C(0x80000000)

static inline bam32_t bam32(uint32_t bam) {
    return (bam32_t){bam};
}

static inline bam32_t bam32_add(bam32_t a, bam32_t b) {
    return bam32(a.bam + b.bam);
}

static inline bam32_t bam32_neg(bam32_t a) {
    return bam32(0U - a.bam);
}

/// a - b the short way round, in BAM: [-2^31, 2^31).
static inline int32_t bam32_diff(bam32_t a, bam32_t b) {
    const uint32_t d = a.bam - b.bam;
    return d < BAM32_HALF ? (int32_t)d : -(int32_t)(UINT32_MAX - d) - 1;
}

/// The angle as a signed number of BAM: [-2^31, 2^31).
static inline int32_t bam32_signed(bam32_t a) {
    return bam32_diff(a, bam32(0));
}

#endif
