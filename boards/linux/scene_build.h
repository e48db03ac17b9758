/// From a scene as text to the block of a sphere tree (firmware/scene/tree.h).
///
/// The user's groups and objects are nodes. What is below or between them is clustered
/// automatically: sorted along the longest axis of the box of their points or centres and cut where
/// n1 * a1 + n2 * a2 is least, with a the surface of each part's box and n its points (the surface
/// area heuristic of ray tracing: a1 is how likely a view meets a part, n1 what it then costs).
/// Each node's sphere is the smallest one of the points below, so that a parent's need not hold its
/// children's.
///
/// Each cluster gets a coarser description: its centre, chosen while the sphere's projected radius
/// is below `coarse_px_q8`. No point of the cluster is farther from the centre than the radius, so
/// that number bounds the error of the picture. An object with details of its own keeps these.
#ifndef LINUX_SCENE_BUILD_H
#define LINUX_SCENE_BUILD_H

#include "scene_text.h"

#include "scene/tree.h"

struct scene_build_options {
    uint32_t points_a_leaf;    ///< 1 to 64
    uint32_t coarse_px_q8;     ///< 0: no coarser descriptions
    bool flat;                 ///< without clustering below the user's: for comparison
    unsigned long *fault_line; ///< where a tree that is too deep is: the line of an object; or NULL
};

/// The default options: 4 points a leaf, half a pixel; fault_line NULL.
extern const struct scene_build_options scene_build_default;

/// Why a scene has no tree.
enum scene_build_status {
    SCENE_BUILD_OK = 0,
    SCENE_BUILD_NO_MEMORY = -1,
    SCENE_BUILD_TOO_DEEP = -2, ///< more than TREE_LEVELS_MAX levels
    SCENE_BUILD_TOO_LARGE = -3 ///< more than 2^32 - 1 bytes
};

/// The block, to be freed by the caller, and its size.
/// Cost: O(count log^2 count); about 3 us a point (tests/property/scene_aim.c prints it).
enum scene_build_status scene_build(const struct scene_text *scene,
                                    const struct scene_build_options *options, void **block,
                                    size_t *size_bytes);

#endif
