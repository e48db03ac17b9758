/// What of a scene is drawn from a view: its shapes as firmware/scene/shape.h has them, its points,
/// and the memory of the methods.
/// Shown: tests/cli/render.sh.
#ifndef LINUX_SCENE_DRAWN_H
#define LINUX_SCENE_DRAWN_H

#include "message.h"

#include "scene/hidden.h"
#include "scene/tree_shape.h"
#include "scene/walk.h"

struct scene_drawn {
    struct shape_set set;
    uint32_t *part; ///< of the tree, for each object of the set; TREE_NONE: none
    struct vec3 *points;
    uint32_t point_count, point_room;
    void *workspace, *planes; ///< of hidden and separate
    struct hidden hidden;
    struct separate separate;
    size_t bytes; ///< all of these
    // To be set before:
    unsigned finer;       ///< the set's units are so many powers of two finer than the tree's
    uint32_t extra_boxes; ///< room in the set for so many boxes more
    struct tree_shape_memory shape; ///< while it is filled
};

/// Room for everything that the tree (NULL: none) has shapes for, and the boxes. False: no memory.
bool scene_drawn_room(struct scene_drawn *drawn, const struct tree *tree);

/// Everything that the view may see, each object in the description it deserves; view NULL:
/// everything, in the finest one. file: the tree's
/// name, for messages. drawn: zero but for what is to be set. Free in any case.
enum exit_status scene_drawn_gather(struct scene_drawn *drawn, const struct tree *tree,
                                    const struct view *view, const char *file);

/// Solids and planes of different objects must have a plane between them. Two that have none are
/// named in one line, with the line of the scene.
/// Cost: pairs whose boxes meet.
enum exit_status scene_drawn_check(const struct scene_drawn *drawn, const struct tree *tree,
                                   const char *file);

/// levine: also the planes between the objects.
enum exit_status scene_drawn_open(struct scene_drawn *drawn, const struct tree *tree,
                                  const char *file, bool levine);

void scene_drawn_free(struct scene_drawn *drawn);

#endif
