#include "scenario_world.h"

#include <stdlib.h>

#define OBSTACLE(member) .offset = offsetof(struct scenario_obstacle, member)
const struct ini_key scenario_obstacle_keys[3] = {
    {.name = "size_m",
     .type = INI_DECIMAL_LIST,
     .min = "0.001",
     .max = "100000",
     .numerator = 1000000,
     OBSTACLE(size_um),
     .help = "of the box: east, north, up"},
    {.name = "start_m",
     .type = INI_DECIMAL_LIST,
     .min = "-100000",
     .max = "100000",
     .numerator = 1000000,
     OBSTACLE(start_um),
     .help = "its middle when the scenario begins"},
    {.name = "velocity_mps",
     .type = INI_DECIMAL_LIST,
     .fallback = "0, 0, 0",
     .min = "-1000",
     .max = "1000",
     .numerator = 1000000,
     OBSTACLE(velocity_umps),
     .help = "straight motion"},
};

const struct ini_key scenario_scene_keys[1] = {
    {.name = "file",
     .type = INI_TEXT,
     .offset = offsetof(struct scenario_scene, file),
     .help = "a scene, in metres; its solids and faces hide what is behind them"},
};

const struct ini_key scenario_flight_keys[1] = {
    {.name = "velocity_mps",
     .type = INI_DECIMAL_LIST,
     .min = "-1000",
     .max = "1000",
     .numerator = 1000000,
     .offset = offsetof(struct scenario_flight, velocity_umps),
     .help = "of the camera itself; it begins where the rig says"},
};

struct scenario_world {
    struct scene_drawn drawn;
    struct units units;
    uint8_t *group;
    struct sim_obstacles obstacles;
};

const struct sim_obstacles *scenario_world_obstacles(const struct scenario_world *world) {
    return world != NULL ? &world->obstacles : NULL;
}

void scenario_world_free(struct scenario_world *world) {
    if (world != NULL) {
        scene_drawn_free(&world->drawn);
        free(world->group);
        free(world);
    }
}

static bool complete(struct ini *ini, const char *section, const char *label, const char *key,
                     const struct ini_numbers *numbers) {
    if (numbers->count != 3U) {
        ini_complain(ini, section, label, key, "needs three values: east, north, up");
    }
    return numbers->count == 3U;
}

/// A box round the origin, no smaller than it is said to be.
static bool add_box(struct shape_set *set, struct units units, const int64_t size_um[3]) {
    static const uint32_t faces[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                       2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4};
    struct vec3 corner[8];
    uint32_t fault;
    for (int i = 0; i < 8; i++) {
        int32_t at[3];
        for (int k = 0; k < 3; k++) {
            const int64_t half = units_from_um(units, (size_um[k] + 1) / 2 - 1) + 1;
            const int32_t within = half < INT32_MAX ? (int32_t)half : INT32_MAX;
            at[k] = (i >> k & 1) != 0 ? within : -within;
        }
        corner[i] = vec3(at[0], at[1], at[2]);
    }
    return shape_add_solid(set, corner, 8, faces, sizes, 6, NULL, &fault) == SHAPE_OK;
}

static enum exit_status add_obstacles(const struct scenario_world_file *file, struct ini *ini,
                                      struct scenario_world *world) {
    for (uint32_t i = 0; i < file->obstacle_count; i++) {
        const struct scenario_obstacle *const from = &file->obstacle[i];
        if (!complete(ini, "obstacle", from->label, "size_m", &from->size_um) ||
            !complete(ini, "obstacle", from->label, "start_m", &from->start_um) ||
            !complete(ini, "obstacle", from->label, "velocity_mps", &from->velocity_umps)) {
            return EXIT_STATUS_USAGE;
        }
        if (!add_box(&world->drawn.set, world->units, from->size_um.item)) {
            ini_complain(ini, "obstacle", from->label, "size_m", "this box is too large");
            return EXIT_STATUS_USAGE;
        }
        for (unsigned k = 0; k < 3U; k++) {
            world->obstacles.group[1U + i].start_m[k] = (double)from->start_um.item[k] * 1e-6;
            world->obstacles.group[1U + i].velocity_mps[k] =
                (double)from->velocity_umps.item[k] * 1e-6;
        }
    }
    world->obstacles.group_count = 1U + file->obstacle_count;
    return EXIT_STATUS_OK;
}

/// Everything as the flying camera sees it: it rests, and the world comes past.
static void fly(const struct scenario_world_file *file, struct scenario_world *world,
                struct schedule *schedule) {
    for (unsigned k = 0; k < 3U; k++) {
        const double v = (double)file->flight.velocity_umps.item[k] * 1e-6;
        for (uint32_t g = 0; g < world->obstacles.group_count; g++) {
            world->obstacles.group[g].velocity_mps[k] -= v;
        }
        for (size_t i = 0; i < schedule->mover_count; i++) {
            struct schedule_mover *const mover = &schedule->movers[i];
            mover->start_m[k] -= v * (double)mover->from_us * 1e-6;
            mover->velocity_mps[k] -= v;
        }
    }
}

static enum exit_status build(const struct scenario_world_file *file, struct ini *ini,
                              const char *scene_path, const struct occlusion_settings *settings,
                              struct vec3_i64 viewpoint_um, struct schedule *schedule,
                              struct scenario_world *world) {
    enum exit_status status =
        occlusion_solids_read(scene_path, file->obstacle_count, &world->drawn, &world->units);
    const uint32_t still = world->drawn.set.object_count;
    if (status == EXIT_STATUS_OK) {
        status = add_obstacles(file, ini, world);
    }
    world->group = status == EXIT_STATUS_OK ? calloc(world->drawn.set.object_count + 1U, 1) : NULL;
    if (world->group == NULL) {
        return status == EXIT_STATUS_OK ? EXIT_STATUS_FAILURE : status;
    }
    for (uint32_t i = still; i < world->drawn.set.object_count; i++) {
        world->group[i] = (uint8_t)(1U + i - still);
    }
    if (file->has_flight) {
        if (!complete(ini, "flight", "", "velocity_mps", &file->flight.velocity_umps)) {
            return EXIT_STATUS_USAGE;
        }
        fly(file, world, schedule);
    }
    world->obstacles.occlusion = (struct occlusion_config){.shapes = &world->drawn.set,
                                                           .group = world->group,
                                                           .units = world->units,
                                                           .viewpoint_um = viewpoint_um,
                                                           .settings = *settings};
    return EXIT_STATUS_OK;
}

enum exit_status scenario_world_read(const struct scenario_world_file *file, struct ini *ini,
                                     const char *scene_path,
                                     const struct occlusion_settings *settings,
                                     struct vec3_i64 viewpoint_um, struct schedule *schedule,
                                     struct scenario_world **out) {
    *out = NULL;
    if (scene_path == NULL && !file->has_flight && file->obstacle_count == 0U) {
        return EXIT_STATUS_OK;
    }
    *out = calloc(1, sizeof **out);
    return *out == NULL ? EXIT_STATUS_FAILURE
                        : build(file, ini, scene_path, settings, viewpoint_um, schedule, *out);
}
