#include "stage.h"

#include "detect/tags.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DISTANCE_M 10.0

/// A texture's cells.
#define CELLS_MAX (TAGS_CELLS_MAX * TAGS_CELLS_MAX)

// ---------------------------------------------------------------- the scene

/// Right and up of a plate that faces the gimbal, upright.
static void face(const double ahead[3], double right[3], double up[3]) {
    const double level = hypot(ahead[0], ahead[1]);
    right[0] = level > 0.0 ? ahead[1] / level : 1.0;
    right[1] = level > 0.0 ? -ahead[0] / level : 0.0;
    right[2] = 0.0;
    up[0] = right[1] * ahead[2];
    up[1] = -right[0] * ahead[2];
    up[2] = right[0] * ahead[1] - right[1] * ahead[0];
}

static void scale(double v[3], double factor) {
    for (unsigned i = 0; i < 3U; i++) {
        v[i] *= factor;
    }
}

/// What a target looks like. texture: room for CELLS_MAX cells.
static void dress(const struct stage *stage, uint32_t id, struct render_object *object,
                  uint8_t *texture) {
    const double half_m =
        DISTANCE_M * tan(stage->looks.size_deg * 0.5 * (3.14159265358979323846 / 180.0));
    if (stage->looks.kind == STAGE_LAMPS) {
        object->shape = RENDER_BALL;
        object->radius_m = half_m;
        object->luma = 245;
        return;
    }
    object->shape = RENDER_PLATE;
    object->texture = texture;
    scale(object->right_m, half_m);
    scale(object->up_m, half_m);
    if (stage->looks.kind == STAGE_PEOPLE) {
        scale(object->up_m, 3.0);
        object->columns = 1;
        object->rows = 3;
        for (uint32_t i = 0; i < 3U; i++) { // clothes of its own
            texture[i] = (uint8_t)(15U + 60U * ((id * 7U + i * 5U) % 4U));
        }
        return;
    }
    uint32_t cells = 0;
    if (tags_draw(stage->eye->detectors.tag_family, id, texture, &cells)) {
        object->columns = object->rows = cells;
        for (uint32_t i = 0; i < cells * cells; i++) {
            texture[i] = texture[i] == 0U ? 25U : 230U;
        }
    }
}

/// The targets as they really are at this moment.
static uint32_t place_targets(struct stage *stage, const struct target_set *world) {
    for (uint32_t i = 0; i < world->count; i++) {
        struct render_object *object = &stage->objects[i];
        const struct vec3 d = world->direction_q30[i];
        double ahead[3] = {ldexp(d.x, -30), ldexp(d.y, -30), ldexp(d.z, -30)};
        *object = (struct render_object){.luma = 0};
        face(ahead, object->right_m, object->up_m);
        scale(ahead, DISTANCE_M);
        memcpy(object->centre_m, ahead, sizeof ahead);
        dress(stage, world->target[i].id, object, stage->texture + (size_t)i * CELLS_MAX);
    }
    return world->count;
}

// ---------------------------------------------------------------- a frame

static bool ray(void *context, const double pixel[2], double direction[3]) {
    return camera_model_ray(context, pixel, direction);
}

/// The lens as the zoom really stands.
static bool focus(struct stage *stage, double zoom) {
    if (fabs(zoom - stage->rendered_zoom) <= 1e-4 * zoom) {
        return true;
    }
    const struct camera_model *base = &stage->eye->model;
    struct camera_model model = camera_model_zoomed(base, zoom);
    const uint64_t random = stage->render.random;
    render_destroy(&stage->render);
    if (!render_create(&stage->render, base->width_px, base->height_px, ray, &model, stage->seed)) {
        return false;
    }
    stage->render.random = random != 0U ? random : stage->render.random;
    stage->rendered_zoom = zoom;
    return true;
}

bool stage_draw(struct stage *stage, const struct camera_view *seen, double zoom,
                const struct target_set *world, uint8_t *picture, uint32_t stride_bytes) {
    struct render_view view = {.at_m = {0.0, 0.0, 0.0}};
    memcpy(view.right, seen->right, sizeof view.right);
    memcpy(view.ahead, seen->ahead, sizeof view.ahead);
    memcpy(view.up, seen->up, sizeof view.up);
    const struct render_backdrop backdrop = {(uint32_t)stage->seed, stage->looks.backdrop_luma,
                                             stage->looks.backdrop_contrast, 5.0};
    if (!focus(stage, zoom)) {
        return false;
    }
    const uint32_t count = place_targets(stage, world);
    render_frame(&stage->render, &view, &backdrop, stage->objects, count, &stage->looks.sensor,
                 picture, stride_bytes);
    return true;
}

// ---------------------------------------------------------------- opening

bool stage_open(struct stage *stage, const struct rig_eye *eye, const struct stage_looks *looks,
                uint64_t seed) {
    *stage = (struct stage){.eye = eye, .looks = *looks, .seed = seed};
    stage->objects = calloc(TARGET_CAPACITY, sizeof *stage->objects);
    stage->texture = calloc(TARGET_CAPACITY, CELLS_MAX);
    return stage->objects != NULL && stage->texture != NULL;
}

void stage_close(struct stage *stage) {
    render_destroy(&stage->render);
    free(stage->objects);
    free(stage->texture);
    *stage = (struct stage){0};
}
