/// `boresight scene render`: a picture of a scene without its hidden lines.
/// Shown: tests/cli/render.sh.
#ifndef LINUX_SCENE_RENDER_H
#define LINUX_SCENE_RENDER_H

#include "drawing.h"
#include "points.h"
#include "scene_drawn.h"

struct scene_render_options {
    double viewpoint[3], aim[3], up[3]; ///< aim: a place to look at
    bool aim_given;                     ///< else at the cone of the targets in sight
    double fov_deg;                     ///< of the width, 0.001 to 170
    uint32_t width, height;             ///< pixels
    const char *targets;                ///< a file of places; NULL: none but the scene's points
    bool levine;                        ///< by the thesis' pipeline
};

struct scene_render_result {
    uint32_t objects, edges, segments, targets, targets_seen;
    uint64_t memory_bytes;
    bool cone; ///< the cone of the targets in sight, below 90 degrees:
    double cone_axis[3], cone_half_angle_deg;
    struct hidden_counters counters;
};

/// Draws the tree. file: its name, for messages. Free the drawing in any case.
enum exit_status scene_render(const struct tree *tree, const char *file,
                              const struct scene_render_options *options, struct drawing *drawing,
                              struct scene_render_result *result);

#endif
