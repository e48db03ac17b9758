/// Orders points by their coordinates, by sorting or by buckets. For the files of regular/ only.
#ifndef REGULAR_ORDER_H
#define REGULAR_ORDER_H

#include "fixed/vec3.h"
#include "regular/arena.h"

#include <stdbool.h>
#include <stdint.h>

struct order {
    const struct vec3 *points;
    uint32_t count;
    uint32_t *list; ///< the indices in order
    uint32_t *spare;
    uint32_t *starts; ///< of buckets: count + 1
    bool buckets;
    uint64_t operations;
};

void order_open(struct order *order, const struct vec3 *points, uint32_t count, bool buckets,
                struct arena *arena);

/// By the axis `first` (0: x, 1: y, 2: z), then the next ones in turn, then the index.
/// Cost:     n log n comparisons; with buckets expected O(n) for coordinates that are spread
///           evenly, n log n for any (Devroye and Klincsek 1981: each bucket is sorted).
void order_by(struct order *order, unsigned first);

int32_t order_coordinate(struct vec3 point, unsigned axis);

/// Widths and gaps of the points along an axis.
struct spread {
    uint32_t width; ///< largest difference
    uint32_t gap;   ///< smallest difference that is not 0; 0: there is none
};

/// Orders the points by this axis first.
struct spread order_spread(struct order *order, unsigned axis);

#endif
