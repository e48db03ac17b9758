/// `boresight scene measure`: what the thesis' pipeline counts as the eye goes around a scene.
#ifndef LINUX_SCENE_MEASURE_H
#define LINUX_SCENE_MEASURE_H

#include "scene_drawn.h"

/// The eye goes around the middle of the scene's box and looks at it; at 0 degrees from the south
/// (-y) to the north. Yaw: on a level circle, and it looks the way that pan counts. Pitch: on the
/// upright circle, and it looks the way that tilt counts, on over the zenith and around.
enum scene_turn { SCENE_YAW, SCENE_PITCH, SCENE_TURNS };
#define SCENE_TURN_VIEWS 360U

struct scene_count {
    struct hidden_counters counters;
    uint64_t segments; ///< visible parts of edges
};

struct scene_measure {
    struct scene_count view[SCENE_TURNS][SCENE_TURN_VIEWS]; ///< every degree
    uint32_t objects, planes;                               ///< planes that separate the objects
};

/// distance: of the eye from the middle, in radii of the sphere around the box of everything; 0: at
/// the middle. Each object counts in the description that an eye in the middle takes: the finest,
/// unless it has `detail within`. file: the scene's name, for messages.
/// Cost: for each of 720 views every two objects, as the thesis has it, and its picture.
/// Test: tests/cli/scene_measure.sh.
enum exit_status scene_measure(const struct tree *tree, const char *file, double distance,
                               struct scene_measure *out);

#endif
