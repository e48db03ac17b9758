/// Random sets of directions for the digests.
#ifndef TESTS_MCU_DIGEST_SETS_H
#define TESTS_MCU_DIGEST_SETS_H

#include "mcu/digest/digest.h"

#define DIGEST_POINTS_MAX 2000U

/// A number from -size to size.
static inline int32_t digest_within(struct digest *d, uint32_t size) {
    return (int32_t)digest_below(d, 2U * size + 1U) - (int32_t)size;
}

/// A cap of any width round any axis; or a few small integers, full of ties and great circles.
static inline void digest_draw_set(struct digest *d, struct vec3 *points, uint32_t count) {
    const struct vec3 axis = vec3_normalise(digest_any_direction(d));
    const bool small = digest_below(d, 4) == 0U;
    const uint32_t size = small ? 3U : UINT32_C(1) << (4U + digest_below(d, 26));
    for (uint32_t i = 0; i < count; i++) {
        do {
            points[i].x = digest_within(d, size);
            points[i].y = digest_within(d, size);
            points[i].z = digest_within(d, size);
            if (!small) {
                points[i].x += axis.x;
                points[i].y += axis.y;
                points[i].z += axis.z;
            }
        } while (vec3_is_zero(points[i]));
    }
}

#endif
