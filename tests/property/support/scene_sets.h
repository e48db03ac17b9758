/// Scenes for tests, and their points as a flat list.
#ifndef SUPPORT_SCENE_SETS_H
#define SUPPORT_SCENE_SETS_H

#include "scene_build.h"

enum scene_shape {
    SCENE_BOX,    ///< compact objects spread in a box
    SCENE_BALL,   ///< in a ball
    SCENE_CLOUD,  ///< single points, uniform in a box
    SCENE_DETAIL, ///< objects with two descriptions, in nested groups
    SCENE_SHAPE_COUNT
};

extern const char *const scene_shape_names[SCENE_SHAPE_COUNT];

/// count points in `objects` objects, coordinates up to 2^26. own_groups: the generator's true
/// clusters as groups (all points of an object are in one anyway unless loose); loose: all points
/// in one object, so that the clusters have to be found.
struct scene_set {
    enum scene_shape shape;
    uint32_t count, objects;
    bool loose;
};

/// Free with scene_text_free.
struct scene_text scene_set_draw(const struct scene_set *set, uint64_t *random);

/// The block of the scene's tree, opened; its size. Free *block.
size_t scene_set_open(const struct scene_text *scene, const struct scene_build_options *options,
                      void **block, struct tree *tree);

/// The points of the finest descriptions relative to an eye, and their references; the number.
uint32_t scene_set_finest(const struct tree *tree, struct vec3 eye, struct vec3 *out,
                          uint32_t *reference);

#endif
