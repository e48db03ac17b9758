/// The search for the support of a narrowest cone: what its two ways to read the points share.
///
/// For cone.c, cone_few.c (each pivot reads all of a few points) and cone_blocks.c (many points in
/// blocks, of which most are read once) only. `units` are the points in Q1.30 with a length within
/// 2^-29 of one: the points themselves, or copies in the workspace. Filters read units; decisions
/// are made on the points, normalised to Q2.61 (min_norm.h).
///
/// Cost: a few comparisons where none is stated. Accuracy: what is decided is exact for the points
/// normalised to Q2.61. Source: docs/geometry.md, "The pivot solver".
#ifndef SPHERE_CONE_SEARCH_H
#define SPHERE_CONE_SEARCH_H

#include "sphere/cone.h"
#include "sphere/cone_answer.h"
#include "sphere/min_norm.h"

#include <stdbool.h>
#include <stdint.h>

/// Notes on a block of points, from when it was last read: no point's measure from `axis_q30` was
/// below `least`, but for the support's own points, which are on the circle. With another axis the
/// block is read again only if a point in it could now lie outside.
struct cone_block {
    int64_t least;
    struct vec3 axis_q30;
    uint32_t pivots; // of the search by then, from 1; 0: not read yet
};

struct cone_search {
    const struct vec3 *points;
    const struct vec3 *units;
    uint32_t count;
    struct min_norm support;
    struct vec3 axis_q30;  // of the support, once turned
    uint32_t pivots;       // supports so far
    uint32_t given_pivots; // of them, those of the warm start
    uint64_t point_reads, read_limit;
    uint32_t surrounding; // the point that put zero into the hull of itself and the support

    /// Many points.
    struct cone_block *blocks;
    uint32_t block_room, block_step; // how many blocks at most; points from one to the next
    bool swept;                      // the notes are of all points
    bool all_ahead;                  // a pass has seen every point within 2^-7 rad of an axis

    /// Few points: a pass has seen no point near the circle but the support's own.
    bool alone;
};

#define CONE_NO_POINT UINT32_MAX

enum cone_outcome {
    CONE_FOUND, ///< no point of these violates the support
    CONE_SURROUNDED,
    CONE_OUT_OF_READS, ///< not before a pivot: a search that stops has come nearer
    CONE_GO_ON
};

/// A point as it may enter the support. Cost: its squared length. There its unit vector must be
/// one, or supports could come twice: a broken promise about the lengths is mended here. Returns:
/// whether it was kept.
bool cone_search_point(const struct cone_search *search, uint32_t index,
                       struct min_norm_point *point);

static inline bool cone_search_has(const struct cone_search *search, uint32_t index) {
    for (uint8_t i = 0; i < search->support.count; i++) {
        if (search->support.point[i].index == index) {
            return true;
        }
    }
    return false;
}

/// Does the point lie outside of the support's cone? Exact. Cost: min_norm_violated_by.
bool cone_search_violates(struct cone_search *search, uint32_t index);

/// A violating point enters: `worst`, which a filter found outside of the support's cone, if it is
/// not CONE_NO_POINT. The filter is wrong only where the promise about the lengths is broken; then
/// exact tests of from, from + stride, ... below `end` are the slow way round. Cost:
/// min_norm_enter.
enum cone_outcome cone_search_enter(struct cone_search *search, uint32_t worst, uint32_t from,
                                    uint32_t end, uint32_t stride);

static inline bool cone_search_is_over(const struct cone_search *search) {
    return search->read_limit != 0U && search->point_reads >= search->read_limit &&
           search->pivots > search->given_pivots;
}

/// Of the support's own points, the one at the largest true angle from the axis as rounded. Exact.
/// Cost: three cone_farthest_add.
void cone_search_own(const struct cone_search *search, struct cone_farthest *farthest);

/// Up to so many points it is cheaper to read all of them at each pivot than to work out an axis
/// there: half the instructions at 100 points, as many at 400.
#define CONE_FEW_POINTS 256U

/// Few points: the 64-bit filters of the support itself decide nearly all, and the axis is worked
/// out once, at the end. Cost: a pass for each pivot, 13 instructions a point. Accuracy: exact for
/// the points normalised to Q2.61. Source: docs/geometry.md, "The pivot solver".
enum cone_outcome cone_few_pivot(struct cone_search *search);

/// A point at the largest true angle from the axis as printed. Exact. Cost: nothing is read again
/// if the last pass saw no point near the circle but the support's own; else a pass.
uint32_t cone_few_farthest(struct cone_search *search);

/// The same for many points. Cost: about one pass in all, and again the blocks that reach to the
/// circle.
enum cone_outcome cone_blocks_pivot(struct cone_search *search);
uint32_t cone_blocks_farthest(struct cone_search *search);

#endif
