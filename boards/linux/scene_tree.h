/// From a scene as text to a tree in memory, with all that can be wrong with it told.
/// Shown: tests/cli/scene.sh.
#ifndef LINUX_SCENE_TREE_H
#define LINUX_SCENE_TREE_H

#include "scene_build.h"

#include "scene/tree.h"

struct scene_tree {
    struct tree tree;
    void *block; ///< NULL: none
    size_t size_bytes;
};

/// shapes: faces and lines, too, which must be sound; else only points. A fault is one line on
/// stderr, with the line of the file. Free in any case.
enum exit_status scene_tree_read(const char *path, bool shapes,
                                 const struct scene_build_options *options, struct scene_tree *out);

/// Is there a plane between each two solids or faces of different objects, in their finest
/// descriptions? Two that have none are told.
enum exit_status scene_tree_check(const struct scene_tree *scene, const char *path);

void scene_tree_free(struct scene_tree *scene);

#endif
