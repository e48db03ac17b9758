/// The obstacles of a scenario: a scene file, boxes that move, the camera's own flight. For
/// scenario.c only.
/// Shown: tests/cli/obstacle.sh.
#ifndef LINUX_SCENARIO_WORLD_H
#define LINUX_SCENARIO_WORLD_H

#include "occlusion_file.h"

#include "sim.h"

enum { OBSTACLES_MOST = OCCLUSION_GROUPS_MAX - 1 };

struct scenario_obstacle {
    const char *label;
    struct ini_numbers size_um, start_um, velocity_umps;
};

struct scenario_scene {
    const char *file;
};

struct scenario_flight {
    struct ini_numbers velocity_umps;
};

/// What the sections say.
struct scenario_world_file {
    struct scenario_obstacle obstacle[OBSTACLES_MOST];
    uint32_t obstacle_count;
    struct occlusion_file occlusion;
    bool has_scene, has_flight;
    struct scenario_scene scene;
    struct scenario_flight flight;
};

extern const struct ini_key scenario_obstacle_keys[3], scenario_scene_keys[1],
    scenario_flight_keys[1];

struct scenario_world; ///< memory of the shapes

/// Builds the obstacles. scene_path: of the scene file, or NULL. *out: NULL if there are none.
/// settings: what hidden targets count. Movers of the schedule are seen from the flying camera from
/// then on.
enum exit_status scenario_world_read(const struct scenario_world_file *file, struct ini *ini,
                                     const char *scene_path,
                                     const struct occlusion_settings *settings,
                                     struct vec3_i64 viewpoint_um, struct schedule *schedule,
                                     struct scenario_world **out);
const struct sim_obstacles *scenario_world_obstacles(const struct scenario_world *world);
void scenario_world_free(struct scenario_world *world);

#endif
