/// What is not as the file of a scene has it, read from text into an overlay (scene/overlay.h).
///
/// A change a line, in order: `away NAME` takes an object away, `back NAME` puts it back, `move X Y
/// Z NAME` takes it to its place moved by that (from its place in the file, each time), `copy X Y Z
/// NAME` puts one more of it there, `point X Y Z` adds a point. `#` begins a comment.
/// Shown: tests/cli/scene.sh.
#ifndef LINUX_SCENE_CHANGES_H
#define LINUX_SCENE_CHANGES_H

#include "message.h"

#include "scene/overlay.h"

struct scene_changes {
    struct overlay overlay;
    void *workspace;
    struct tree_point *points; ///< of `point`; their sources count on from the scene's
    uint32_t point_count;
    uint64_t count; ///< points of the finest descriptions, all in all
};

/// Reads the file. tree must outlive the changes. A fault is told in one line on stderr. Free with
/// scene_changes_free in any case.
/// count: points of the finest descriptions without the changes.
enum exit_status scene_changes_read(const char *path, const struct tree *tree, uint64_t count,
                                    struct scene_changes *out);

void scene_changes_free(struct scene_changes *changes);

#endif
