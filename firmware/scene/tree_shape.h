/// What a tree holds to be drawn, as shapes: from corners by point to corners by vertex.
#ifndef SCENE_TREE_SHAPE_H
#define SCENE_TREE_SHAPE_H

#include "fixed/must_check.h"
#include "scene/shape.h"
#include "scene/tree.h"

#include <stdint.h>

/// Memory while a shape is taken over: that of the caller, for one shape at a time.
struct tree_shape_memory {
    struct vec3 *points; ///< of the shape, each once
    uint32_t *source;    ///< of each of these: the point of the tree
    uint32_t *corners;   ///< by point of the shape
    uint32_t *counts;    ///< corners of each face
    uint32_t point_room, corner_room, face_room;
    /// For each point of the tree SHAPE_NONE, and so again afterwards; or NULL: then a shape's
    /// points are searched for each corner, fit for solids of some dozen faces.
    uint32_t *place;
};

/// Adds a TREE_SOLID. finer: its coordinates become so many powers of two larger.
/// Returns: as shape_add_solid; SHAPE_ERROR_CAPACITY also if the memory is too small for it.
enum shape_status tree_shape_add_solid(struct shape_set *set, const struct tree *tree,
                                       const struct tree_shape *shape, unsigned finer,
                                       const struct tree_shape_memory *memory) MUST_CHECK;

/// Adds a face of TREE_FACES. Returns: as shape_add_plane.
enum shape_status tree_shape_add_face(struct shape_set *set, const struct tree *tree,
                                      const struct tree_element *face, unsigned finer,
                                      const struct tree_shape_memory *memory) MUST_CHECK;

/// A point of a tree, so many powers of two larger; what is then too far away for a shape stays as
/// far away as int32 goes.
struct vec3 tree_shape_point(const struct tree *tree, uint32_t point, unsigned finer);

#endif
