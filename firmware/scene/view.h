/// What a camera sees of a sphere: where it is to the view pyramid, and how large it appears.
#ifndef SCENE_VIEW_H
#define SCENE_VIEW_H

#include "scene/tree.h"

#include <stdbool.h>
#include <stdint.h>

struct view {
    struct vec3 eye;              ///< in the tree's units, |coordinate| <= TREE_COORDINATE_MAX
    struct vec3 right, ahead, up; ///< Q1.30, unit, at right angles
    uint32_t focal_px_q8;         ///< of the picture, in 1/256 pixel; 0 to 2^24
    struct vec3 inward[4];        ///< of the four sides, Q1.30, unit
};

/// width_px, height_px: of the picture, 1 to 2^15. focal_px_q8: 1 to 2^24.
void view_set(struct view *view, struct vec3 eye, struct vec3 right, struct vec3 ahead,
              struct vec3 up, uint32_t focal_px_q8, uint32_t width_px, uint32_t height_px);

enum view_place {
    VIEW_OUTSIDE,  ///< nothing of it can be seen
    VIEW_CROSSING, ///< perhaps
    VIEW_INSIDE    ///< all of it is in the pyramid, and in front of the eye
};

/// Where a sphere is. Conservative: outside and inside are certain, with 8 units to spare for the
/// rounding of the normals. A sphere is in front of the eye only if its depth is at least its
/// radius (the thesis compares the distance, which is wrong). Cost: five dot products.
/// Shown: tests/property/scene_walk.c.
enum view_place view_place(const struct view *view, struct vec3 center, uint32_t radius);

/// Largest radius of a sphere's picture, in 1/256 pixel, rounded up; UINT32_MAX where the sphere
/// reaches the plane of the eye. f r sqrt(D^2 - r^2) / (d^2 - r^2), with depth d and distance D:
/// the longer half-axis of the ellipse (the thesis' f r / d is less than that). Shown:
/// tests/property/scene_walk.c.
uint32_t view_radius_px_q8(const struct view *view, struct vec3 center, uint32_t radius);

/// The same for a camera that looks straight at the sphere.
uint32_t view_straight_px_q8(uint32_t focal_px_q8, struct vec3 eye, struct vec3 center,
                             uint32_t radius);

/// Distance of a sphere's centre from the eye in whole units, rounded up.
uint32_t view_distance(struct vec3 eye, struct vec3 center);

/// The description to choose at this projected radius, or at this distance, whichever the node goes
/// by: the last whose threshold is reached. UINT32_MAX and 0 give the finest.
const struct tree_description *view_choose(const struct tree *tree, const struct tree_node *node,
                                           uint32_t radius_px_q8, uint32_t distance);

#endif
