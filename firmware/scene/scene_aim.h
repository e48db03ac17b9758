/// Where to look to see everything a scene holds: the narrowest cone by branch and bound.
///
/// A set of a few points is solved; a search through the tree then looks for the point farthest
/// from the axis and leaves out each sphere that lies inside the cone as a whole; what it finds
/// enters the set. So only points that can matter are read.
#ifndef SCENE_SCENE_AIM_H
#define SCENE_SCENE_AIM_H

#include "fixed/must_check.h"
#include "scene/overlay.h"
#include "scene/tree.h"
#include "sphere/cone.h"

#include <stdbool.h>
#include <stdint.h>

enum scene_aim_status {
    SCENE_AIM_MORE = 1, ///< scene_aim_go has work left
    SCENE_AIM_OK = 0,
    SCENE_AIM_INFEASIBLE = -1, ///< no direction sees every point; result->reference: the witness
    SCENE_AIM_EMPTY = -2,
    SCENE_AIM_AT_VIEWPOINT = -3,    ///< a point is at the viewpoint: result->reference[0]
    SCENE_AIM_ERROR_VIEWPOINT = -4, ///< the viewpoint is beyond TREE_COORDINATE_MAX
    SCENE_AIM_UNFINISHED = -5 ///< more than 1000 searches: not seen; the result is a lower bound
};

/// A point of a tree: an index into its points, or with SCENE_AIM_CENTER the node whose centre it
/// is.
#define SCENE_AIM_CENTER UINT32_C(0x80000000)

#define SCENE_AIM_SET   256U ///< points kept at a time
#define SCENE_AIM_STACK 640U ///< (TREE_LEVELS_MAX + OVERLAY_LEVELS_MAX) * 8, and some

/// The memory of a search: about 24 KB, the caller's. Nothing in it is kept between calls.
struct scene_aim_memory {
    struct vec3 direction[SCENE_AIM_SET];
    uint32_t reference[SCENE_AIM_SET];
    uint32_t item[SCENE_AIM_SET];
    uint64_t cone[CONE_WORKSPACE_BYTES(SCENE_AIM_SET) / sizeof(uint64_t) + 1U];
    struct scene_aim_entry {
        uint64_t bound_turn64; ///< no point in it is farther from the axis
        uint32_t next, end;    ///< nodes
        uint32_t item;         ///< whose nodes these are
    } stack[SCENE_AIM_STACK];
};

struct scene_aim_options {
    struct vec3 eye;
    /// 0: every point, exactly. Else of a camera with that focal length in 1/256 pixel: each node
    /// in the description that it deserves in the middle of the picture.
    uint32_t focal_px_q8;
    /// The references of an earlier result with the same focal_px_q8, for a similar eye, to begin
    /// with; warm_count at most 4.
    const uint32_t *warm;
    uint8_t warm_count;
    /// What is not in its place; NULL: everything is. Then `warm` is not looked at: objects may
    /// have moved since.
    const struct overlay *overlay;
    /// With an overlay: where to look first, Q1.30, such as the last axis; 0: anywhere.
    struct vec3 toward_q30;
};

struct scene_aim_result {
    struct cone_result cone; ///< its indices mean `reference`
    /// Of cone.support or cone.witness, in the same order.
    uint32_t reference[4];
    /// The item of the overlay that each belongs to, OVERLAY_NONE: in its place. Of the caller's
    /// points the reference is the index among these.
    uint32_t item[4];
    /// No point of the scene is farther outside the cone than so, in 1/256 pixel; 0 if exact.
    uint32_t loss_px_q8;
    uint32_t nodes_opened; ///< nodes whose children or points were looked at
    uint64_t point_reads;  ///< of points (and centres) in the tree, and in solving the few
    uint32_t searches;
};

/// Cost:     of 10^6 points in 10,000 compact objects about 0.1 % are read
///           (tests/property/scene_aim.c prints the numbers). No allocation, no recursion.
/// Accuracy: the axis and the half-angle are those of cone_narrowest on all points, bit for bit
///           (tests/property/scene_aim.c), unless more than 190 points are within 7 nrad of the
///           cone's surface: then the cone is within 1 nrad of that.
enum scene_aim_status scene_aim(const struct tree *tree, const struct scene_aim_options *options,
                                struct scene_aim_memory *memory,
                                struct scene_aim_result *result) MUST_CHECK;

/// The same in pieces, for who has other things to do. The members are scene_aim.c's own.
struct scene_aim_run {
    const struct tree *tree;
    struct scene_aim_options options;
    struct scene_aim_memory *memory;
    struct scene_aim_result *result;
    uint32_t phase;
    uint32_t set_count, set_before;
    uint32_t stack_count;
    struct vec3 axis_q30;
    // One search:
    uint64_t least_turn64; ///< what is nearer to the axis does not matter
    uint64_t cone_turn64;  ///< beyond this a point is outside
    uint64_t best_turn64;  ///< the farthest point outside so far
    uint32_t best;         ///< its reference
    uint32_t best_item;
    struct vec3 best_direction;
};

/// tree, memory and result must stay; so must the overlay, without a change, until it is done.
void scene_aim_start(struct scene_aim_run *run, const struct tree *tree,
                     const struct scene_aim_options *options, struct scene_aim_memory *memory,
                     struct scene_aim_result *result);

/// Takes so many steps at most. A step looks at one node: its children, eight at most, or its
/// points; or it solves the set.
/// Returns: SCENE_AIM_MORE, or what scene_aim returns; then the run is over.
enum scene_aim_status scene_aim_go(struct scene_aim_run *run, uint32_t steps) MUST_CHECK;

#endif
