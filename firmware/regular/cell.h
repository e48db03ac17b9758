/// The largest disc in a cell between forbidden great circles. For the files of regular/ only.
#ifndef REGULAR_CELL_H
#define REGULAR_CELL_H

#include "regular/lone.h"

struct cell_circle {
    struct vec3_i64 normal; ///< primitive, below 2^43
    struct vec3_i64 unit_q61;
    struct vec3 unit_q30; ///< rounded down
};

/// A circle that bounds a cell, and on which side of it: 2 * index, and 1 if on that of -normal.
typedef uint32_t cell_side;

/// The best disc so far.
struct cell_best {
    bool any;
    struct disc disc;
    int64_t sine_q61;   ///< of its radius, within CELL_ERROR
    int64_t square_q60; ///< of that, rounded down
    struct lone *lone;  ///< points to keep away from; NULL: none
    bool beside_points; ///< the best place keeps away from such a point, too: it is `at`
    struct vec3_i64 at;
    uint64_t operations;
};
/// 2^-49.
#define CELL_ERROR ((int64_t)1 << 12)

struct cell_circle cell_circle_from(struct vec3_i64 normal);

/// Takes the disc of a cell if it is larger than the best: the narrowest cap of the normals toward
/// the cell has its centre. All bounding circles; others do no harm. At least one.
/// Cost:     a dot product for most cells, whose neighbouring sides alone leave too little room;
///           expected O(count) else (sphere/min_norm.h). Discs within 2 CELL_ERROR are compared
///           exactly.
void cell_consider(struct cell_best *best, const struct cell_circle *circles,
                   const cell_side *sides, uint32_t count);

#endif
