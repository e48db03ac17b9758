/// The parts of `boresight scene` that share its options.
/// Shown: tests/cli/scene.sh.
#ifndef LINUX_SCENE_COMMAND_H
#define LINUX_SCENE_COMMAND_H

#include "command.h"
#include "points.h"

#include "scene/tree.h"

struct scene_settings {
    struct triple viewpoint, up, aim;
    const char *output, *focal_px, *coarse_px, *fov, *size, *targets, *changes, *distance;
    int method; ///< of render
    bool points, json;
};

/// A number of pixels as 1/256: 0 to 65,536 (below 2^24). False: told why not.
bool scene_command_px(const struct command *command, const char *name, const char *text,
                      uint32_t *px_q8);

/// A unit of the tree in that of the scene's file.
double scene_command_unit(const struct tree *tree);

/// `scene aim FILE`, with its tree open.
enum exit_status scene_command_aim(const struct command *command,
                                   const struct scene_settings *settings, const struct tree *tree,
                                   const char *file);

/// `scene measure FILE`, with its tree open.
enum exit_status scene_command_measure(const struct command *command,
                                       const struct scene_settings *settings,
                                       const struct tree *tree, const char *file);

#endif
