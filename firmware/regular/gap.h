/// The widest gap between forbidden directions of the plane. For the files of regular/ only.
#ifndef REGULAR_GAP_H
#define REGULAR_GAP_H

#include "fixed/vec3.h"
#include "regular/arena.h"

#include <stdbool.h>

struct gap {
    const struct vec3 *lines; ///< primitive (regular/primitive.h), z is 0
    uint32_t count;
    uint32_t *list, *spare; ///< of lines; by buckets: of 2 count + 1 buckets
    uint64_t *start;        ///< of weighted lines
    struct vec3 from, to;   ///< the widest: to is counter-clockwise of from
    uint64_t operations;
};

/// What the widest gap of count lines needs.
void gap_open(struct gap *gap, uint32_t count, bool buckets, bool weighted, struct arena *arena);

/// Both sides of the widest gap, exactly. Of one different line: from and to are opposite. At least
/// one line.
/// Cost:     count log count comparisons; by buckets O(count) (Gonzalez 1975): 2 count of them are
///           each narrower than the mean gap, so the widest one lies between two.
void gap_widest(struct gap *gap, bool buckets);

/// Weighted: a direction whose angle to each line, over its weight, is as large as can be, within
/// 2^-50 rad. weights: of lines, 1 to 2^20.
/// Cost:     62 times count log count.
void gap_weighted(struct gap *gap, const uint32_t *weights, struct vec3_i64 *direction);

#endif
