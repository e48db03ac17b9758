/// Points in two to five dimensions, and hyperplanes through them, in exact integers.
#ifndef BENCH_LEVINE_PLACES_H
#define BENCH_LEVINE_PLACES_H

#include "bench/levine/caps.h"

__extension__ typedef __int128 wide;

struct places {
    const int32_t (*points)[CAPS_DIMENSIONS];
    uint32_t count, dimension;
};

/// The normal of the hyperplane through `dimension` points, by index; 0 if they don't span one.
void places_normal(const struct places *p, const uint32_t *vertex, wide normal[CAPS_DIMENSIONS]);

/// Height of a point above a hyperplane through another, times the length of the normal.
static inline wide places_height(const struct places *p, const wide normal[CAPS_DIMENSIONS],
                                 uint32_t through, uint32_t point) {
    wide sum = 0;
    for (uint32_t k = 0; k < p->dimension; k++) {
        sum += normal[k] * (p->points[point][k] - p->points[through][k]);
    }
    return sum;
}

/// Order by the coordinates, for ties: -1, 0, 1.
int places_order(const struct places *p, uint32_t a, uint32_t b);

/// The points that are extreme along the axes and the diagonals, each once. list: room for 64.
/// Returns: their number. Source: Levine 1975, chapter IV, step 1; for two and three dimensions his
/// four and seven directions.
uint32_t places_extremes(const struct places *p, uint32_t *list);

/// Of the listed points the first that are not in a space of fewer dimensions; then the point
/// farthest from their hyperplane, `dimension` + 1 in all. tests: counts one for each point.
/// False: there are too few.
bool places_corners(const struct places *p, const uint32_t *list, uint32_t listed, uint64_t *tests,
                    uint32_t corner[CAPS_DIMENSIONS + 1U]);

#endif
