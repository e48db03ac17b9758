/// A row of posts between the gimbal and the targets of tick.c, for that alone.
#ifndef TESTS_MCU_TICK_POSTS_H
#define TESTS_MCU_TICK_POSTS_H

#include "app/board_shadows.h"

#define POSTS 16U

static struct board_shadows posts;
static struct board_shadows_memory casting;

/// Posts halfway to the targets, in millimetres.
static bool posts_set_up(struct pump *pump, struct vec3_i64 viewpoint_um) {
    static const uint32_t faces[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                       2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4};
    posts.sight = (struct sight){.bounds = posts.bounds,
                                 .pieces = posts.pieces,
                                 .bound_room = BOARD_SHADOWS_BOUNDS,
                                 .piece_room = BOARD_SHADOWS_PIECES};
    posts.config = (struct occlusion_config){
        .units = units_of_um(1000),
        .viewpoint_um = viewpoint_um,
        .settings = {
            .policy = OCCLUSION_CALM, .frame_us = 40000, .ahead_us = 2000000, .fade_us = 400000}};
    for (uint32_t i = 0; i < POSTS; i++) {
        const int32_t x = 1000 * (int32_t)i - 8000;
        struct shape_set set = {.vertices = casting.vertices,
                                .corners = casting.set_corners,
                                .faces = casting.faces,
                                .planes = casting.planes,
                                .edges = casting.edges,
                                .objects = &casting.object,
                                .vertex_room = BOARD_SHADOWS_POINTS,
                                .corner_room = BOARD_SHADOWS_CORNERS,
                                .face_room = BOARD_SHADOWS_FACES,
                                .edge_room = BOARD_SHADOWS_EDGES,
                                .object_room = 1};
        struct vec3 corner[8];
        uint32_t fault;
        for (int k = 0; k < 8; k++) {
            corner[k] = vec3(x + ((k & 1) != 0 ? 400 : 0), (k & 2) != 0 ? -9000 : -9400,
                             (k & 4) != 0 ? 5000 : -5000);
        }
        if (shape_add_solid(&set, corner, 8, faces, sizes, 6, NULL, &fault) != SHAPE_OK ||
            sight_add(&posts.sight, &set, 0) != 1U) {
            return false;
        }
    }
    pump_occlusion_attach(&posts.stage, pump, &posts.occlusion, false);
    return occlusion_init_shadows(&posts.occlusion, &posts.config, &posts.sight);
}

#endif
