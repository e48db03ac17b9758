/// The largest disc between great circles in space proportional to their number: as the thinnest
/// anchored cylinder that holds their normals. For the files of regular/ only.
///
/// Of each circle in turn it is decided whether a disc larger than the best so far can touch it:
/// the points at that distance from it are a small circle, of which each other great circle takes
/// two arcs. What is left leads into a better cell. In a random order few circles do that.
/// Source: the paper's section 4.3; Chan 1999 (an optimum by random decisions), instead of
/// Follert's
///         envelopes.
#ifndef REGULAR_CYLINDER_H
#define REGULAR_CYLINDER_H

#include "regular/arena.h"
#include "regular/cell.h"

struct cylinder {
    cell_side *sides;
    uint64_t *start, *length; ///< of arcs, two a circle; 2^64 a turn
    uint32_t *list, *spare;
};

/// 56 bytes a circle.
void cylinder_open(struct cylinder *cylinder, uint32_t count, struct arena *arena);

/// circles: different, not all through one point, in random order.
/// Cost:     m^2 log m expected: m arcs and a sort for each circle.
/// Accuracy: a disc that is larger by less than 2^-45 in the sine may be passed over.
void cylinder_search(struct cylinder *cylinder, const struct cell_circle *circles, uint32_t count,
                     struct cell_best *best);

#endif
