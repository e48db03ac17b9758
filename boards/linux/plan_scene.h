/// What stands between mounts and targets: the solids and faces of a scene, in the plan's grid.
/// Shown: tests/cli/plan.sh.
#ifndef LINUX_PLAN_SCENE_H
#define LINUX_PLAN_SCENE_H

#include "scene_text.h"

#include "scene/sight.h"

#include <stdbool.h>

struct plan_scene {
    struct shape_set shapes;
    uint32_t *object;   ///< by shape: the object of the scene
    struct sight sight; ///< scratch: the shadow of one shape
};

/// Builds the shapes of the finest descriptions. vertices: of the scene, in the grid. exact: they
/// are as written; else faces may be bent a little, but solids must not.
/// Returns: EXIT_STATUS_OK, or another after a line on stderr that names the file. Free with
/// plan_scene_free in any case.
enum exit_status plan_scene_set(struct plan_scene *scene, const struct scene_text *text,
                                const char *file, const struct vec3 *vertices, bool exact);
void plan_scene_free(struct plan_scene *scene);

/// Which targets can't be seen from a place because a solid or a face is in the way. Touching it
/// hides nothing: a target on a wall is seen from its side. hidden: gets their indices, ascending;
/// by: of each the object of the scene. Returns: how many.
/// Exact in the grid (scene/sight.h).
uint32_t plan_scene_hidden(struct plan_scene *scene, struct vec3 from, const struct vec3 *targets,
                           uint32_t count, uint32_t *hidden, uint32_t *by);

#endif
