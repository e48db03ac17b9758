/// Forbidden directions inside of a cell: of segments that lie in a plane with no other one. A disc
/// must keep away from them, too. For the files of regular/ only.
///
/// Only those inside matter: to any other one a side of the cell is nearer. The best place is as
/// far from three sides or points, or from two of them where it can't be moved along.
/// Accuracy: of the places, 2^-50 rad in general position; which one is best is not decided
///           exactly, but within 2^-50 rad (tests/property/regular_optimize.c).
#ifndef REGULAR_LONE_H
#define REGULAR_LONE_H

#include "regular/disc.h"

struct lone {
    const struct vec3 *lines; ///< each is two opposite points
    uint32_t count;
    struct vec3_i64 *inside; ///< scratch: 2 count units, Q2.61
    uint32_t inside_count;
};

/// Does a normal hold it, so that its circle is nearer than the point to any place?
bool lone_is_on(struct vec3 line, struct vec3_i64 normal);

/// Lists the points that are inside of all these sides: inward(context, i) is the i-th one's
/// normal, as a unit vector in Q2.61 (any length for `exact`).
typedef struct vec3_i64 lone_side(const void *context, uint32_t i, bool exact);
void lone_list(struct lone *lone, lone_side *inward, const void *context, uint32_t side_count);

/// The angle from a place to the nearest point inside, 2^64 a turn; a quarter without any.
uint64_t lone_distance(const struct lone *lone, struct vec3_i64 at);

/// The place in the cell that is farthest from its sides and the points inside. Returns: how far,
/// 2^64 a turn; 0: there is none.
/// Cost:     (sides + points)^3 points for each point inside.
uint64_t lone_best(struct lone *lone, lone_side *inward, const void *context, uint32_t side_count,
                   struct vec3_i64 *at);

#endif
