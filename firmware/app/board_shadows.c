#include "app/board_shadows.h"

/// The set of one shape, empty.
static struct shape_set empty_set(struct board_shadows_memory *m) {
    return (struct shape_set){.vertices = m->vertices,
                              .corners = m->set_corners,
                              .faces = m->faces,
                              .planes = m->planes,
                              .edges = m->edges,
                              .objects = &m->object,
                              .vertex_room = BOARD_SHADOWS_POINTS,
                              .corner_room = BOARD_SHADOWS_CORNERS,
                              .face_room = BOARD_SHADOWS_FACES,
                              .edge_room = BOARD_SHADOWS_EDGES,
                              .object_room = 1};
}

static struct tree_shape_memory shape_memory(struct board_shadows_memory *m) {
    return (struct tree_shape_memory){.points = m->points,
                                      .source = m->source,
                                      .corners = m->corners,
                                      .counts = m->counts,
                                      .point_room = BOARD_SHADOWS_POINTS,
                                      .corner_room = BOARD_SHADOWS_CORNERS,
                                      .face_room = BOARD_SHADOWS_FACES};
}

static enum board_shadows_status told(enum shape_status status) {
    return status == SHAPE_OK               ? BOARD_SHADOWS_OK
           : status == SHAPE_ERROR_CAPACITY ? BOARD_SHADOWS_ROOM
           : status == SHAPE_ERROR_RANGE    ? BOARD_SHADOWS_FAR
                                            : BOARD_SHADOWS_SHAPE;
}

/// The shadow of the one object of a set.
static enum board_shadows_status cast_one(struct board_shadows *s, const struct shape_set *set) {
    uint32_t piece = s->sight.piece_count;
    const uint32_t pieces = sight_add(&s->sight, set, 0);
    if (pieces == UINT32_MAX) {
        return BOARD_SHADOWS_ROOM;
    }
    for (; piece < s->sight.piece_count; piece++) {
        if (s->sight.pieces[piece].count > BOARD_SHADOWS_PIECE_BOUNDS) {
            return BOARD_SHADOWS_ROOM;
        }
    }
    s->solids += pieces != 0U;
    return BOARD_SHADOWS_OK;
}

static enum board_shadows_status cast_shape(struct board_shadows *s, const struct tree *tree,
                                            const struct tree_shape *shape, unsigned finer,
                                            struct board_shadows_memory *memory) {
    const struct tree_shape_memory room = shape_memory(memory);
    enum board_shadows_status status = BOARD_SHADOWS_OK;
    if (shape->kind == TREE_SOLID) {
        struct shape_set set = empty_set(memory);
        status = told(tree_shape_add_solid(&set, tree, shape, finer, &room));
        return status == BOARD_SHADOWS_OK ? cast_one(s, &set) : status;
    }
    for (uint32_t i = 0; shape->kind == TREE_FACES && i < shape->element_count; i++) {
        const struct tree_element *const e = &tree->elements[shape->first_element + i];
        struct shape_set set = empty_set(memory);
        if (e->kind != TREE_FACE) {
            continue;
        }
        status = told(tree_shape_add_face(&set, tree, e, finer, &room));
        status = status == BOARD_SHADOWS_OK ? cast_one(s, &set) : status;
        if (status != BOARD_SHADOWS_OK) {
            return status;
        }
    }
    return status;
}

static bool is_near(int64_t units) {
    return units <= SHAPE_COORDINATE_MAX && units >= -SHAPE_COORDINATE_MAX;
}

static enum board_shadows_status cast_all(struct board_shadows *s, const struct tree *tree,
                                          unsigned finer, struct board_shadows_memory *memory) {
    struct walk_item item;
    struct walk *const walk = &memory->walk;
    enum board_shadows_status status = BOARD_SHADOWS_OK;
    walk_start(walk, tree, NULL, NULL);
    walk->shapes = true;
    while (status == BOARD_SHADOWS_OK && walk_next(walk, &item)) {
        if (item.shape != NULL) {
            status = cast_shape(s, tree, item.shape, finer, memory);
        }
    }
    return status == BOARD_SHADOWS_OK && s->solids == 0U ? BOARD_SHADOWS_NONE : status;
}

enum board_shadows_status board_shadows_cast(struct board_shadows *s, const struct tree *tree,
                                             struct vec3_i64 viewpoint_um, uint64_t expiry_us,
                                             const struct occlusion_settings *settings,
                                             struct board_shadows_memory *memory) {
    const unsigned finer = units_finer(tree);
    s->solids = 0;
    s->sight = (struct sight){.bounds = s->bounds,
                              .pieces = s->pieces,
                              .bound_room = BOARD_SHADOWS_BOUNDS,
                              .piece_room = BOARD_SHADOWS_PIECES};
    s->config = (struct occlusion_config){
        .viewpoint_um = viewpoint_um, .expiry_us = expiry_us, .settings = *settings};
    if (!units_of_tree(tree, finer, &s->config.units)) {
        return BOARD_SHADOWS_FAR;
    }
    const int64_t x = units_from_um(s->config.units, viewpoint_um.x),
                  y = units_from_um(s->config.units, viewpoint_um.y),
                  z = units_from_um(s->config.units, viewpoint_um.z);
    if (!is_near(x) || !is_near(y) || !is_near(z)) {
        return BOARD_SHADOWS_FAR;
    }
    s->sight.eye = vec3((int32_t)x, (int32_t)y, (int32_t)z);
    const enum board_shadows_status status = cast_all(s, tree, finer, memory);
    return status == BOARD_SHADOWS_OK &&
                   !occlusion_init_shadows(&s->occlusion, &s->config, &s->sight)
               ? BOARD_SHADOWS_FAR
               : status;
}
