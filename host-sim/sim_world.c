/// What stands and moves between the camera and its targets.
#include "sim_private.h"

#include <stdlib.h>

bool sim_world_init(struct sim *sim) {
    const struct sim_obstacles *const obstacles = sim->config.obstacles;
    if (obstacles == NULL || obstacles->occlusion.settings.policy == OCCLUSION_IGNORE) {
        return true;
    }
    const size_t bytes = occlusion_workspace_bytes(obstacles->occlusion.shapes);
    sim->occlusion_workspace = malloc(bytes + 8U);
    if (sim->occlusion_workspace == NULL ||
        !occlusion_init(&sim->occlusion, &obstacles->occlusion, sim->occlusion_workspace, bytes)) {
        return false;
    }
    if (sim->config.board == NULL) {
        pump_occlusion_attach(&sim->hiding, &sim->pump, &sim->occlusion, true);
    }
    return true;
}

/// To whole micrometres, half away from zero.
static int64_t to_um(double metres) {
    const double um = metres * 1e6;
    return um >= 0.0 ? (int64_t)(um + 0.5) : -(int64_t)(0.5 - um);
}

struct vec3_i64 sim_group_offset_um(const struct sim_obstacles *obstacles, uint32_t group,
                                    uint64_t at_us) {
    const double t = (double)at_us * 1e-6;
    const double *const start = obstacles->group[group].start_m, *const v = obstacles->group[group]
                                                                                .velocity_mps;
    return (struct vec3_i64){to_um(start[0] + v[0] * t), to_um(start[1] + v[1] * t),
                             to_um(start[2] + v[2] * t)};
}

bool sim_world_take(struct sim *sim, const struct target_update *update) {
    return sim->occlusion_workspace != NULL && sim->config.board != NULL &&
           occlusion_report(&sim->occlusion, update, sim->time_us);
}

void sim_world_step(struct sim *sim) {
    struct target_update update;
    const struct sim_board *const board = sim->config.board;
    if (sim->occlusion_workspace == NULL) {
        return;
    }
    const struct sim_obstacles *const obstacles = sim->config.obstacles;
    for (uint32_t g = 0; g < obstacles->group_count; g++) {
        const double *const v = obstacles->group[g].velocity_mps;
        occlusion_move(&sim->occlusion, g, sim_group_offset_um(obstacles, g, sim->time_us),
                       (struct vec3_i64){to_um(v[0]), to_um(v[1]), to_um(v[2])}, sim->time_us);
    }
    if (board == NULL) {
        pump_occlusion_step(&sim->hiding, &sim->pump);
        return;
    }
    occlusion_step(&sim->occlusion, sim->time_us, true);
    while (occlusion_next(&sim->occlusion, &update)) {
        (void)board->push(board->context, &update); // a full queue is counted by the pump
        (void)!target_set_apply(&sim->measure.truth, &update, sim->time_us);
    }
}

void sim_world_heard(struct sim *sim) {
    const struct controller_input *const input = &sim->pump.input;
    if (sim->occlusion_workspace == NULL || sim->config.board != NULL) {
        return;
    }
    for (uint32_t i = 0; i < input->update_count; i++) {
        (void)!target_set_apply(&sim->measure.truth, &input->update[i], sim->time_us);
    }
}
