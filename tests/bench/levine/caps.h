/// Levine's convex hull, by extreme directions and convex caps, in two to five dimensions.
///
/// The thesis had it in n dimensions and reports three; the firmware has three. Every decision is
/// the sign of an exact determinant of at most 124 bits. Points on a facet's hyperplane are not
/// above it, as in firmware/solid.
#ifndef BENCH_LEVINE_CAPS_H
#define BENCH_LEVINE_CAPS_H

#include <stdbool.h>
#include <stdint.h>

#define CAPS_DIMENSIONS 5U

/// No coordinate is larger in size: 2^22 in five dimensions, else 2^29.
static inline int32_t caps_coordinate_max(uint32_t dimension) {
    return (INT32_C(1) << (dimension == 5U ? 22 : 29)) - 1;
}

struct caps_hull {
    uint32_t vertex_count, facet_count;
    uint64_t tests;       ///< of a point against a facet, as the thesis counts them
    uint32_t facets_made; ///< in all, of which many are gone again
    uint32_t rounds;      ///< of step 5
};

/// points: count times CAPS_DIMENSIONS coordinates, of which the first `dimension` count. They must
/// span space.
/// verify: each point is tested against each facet in the end, and each facet's neighbours share
/// its vertices but one; a breach is a failed check.
/// Returns: false if the points don't span space.
bool caps_hull_find(const int32_t (*points)[CAPS_DIMENSIONS], uint32_t count, uint32_t dimension,
                    bool verify, struct caps_hull *out);

#endif
