/// Scenes of solids, planes and wire frames, kept twice: as a shape_set and as bodies of ray.h.
#ifndef TESTS_PROPERTY_SUPPORT_HIDDEN_SCENES_H
#define TESTS_PROPERTY_SUPPORT_HIDDEN_SCENES_H

#include "property/support/ray.h"

#include "scene/hidden.h"

enum hidden_scene_kind {
    HIDDEN_LATTICE,    ///< unit cubes, 2 apart
    HIDDEN_BLOCKS,     ///< boxes on a small grid: they touch, and edges and planes coincide
    HIDDEN_MIXED,      ///< the same with concave planes and wire frames between
    HIDDEN_CRYSTALS,   ///< hulls and slanted boxes with large coordinates
    HIDDEN_OVERLAPPED, ///< boxes on a small grid that may overlap
    HIDDEN_KIND_COUNT
};

extern const char *const hidden_scene_names[HIDDEN_KIND_COUNT];

#define HIDDEN_BODIES_MAX 128U

struct hidden_scene {
    struct shape_set set;
    struct ray_body body[HIDDEN_BODIES_MAX]; ///< of each object; face_count 0: a wire frame
    uint32_t body_count;
    int32_t (*corners)[3];
    uint32_t *faces, *first;
    uint32_t corner_count, face_corner_count, first_count;
};

/// An empty scene with room for so many objects of up to 64 vertices.
void hidden_scene_open(struct hidden_scene *scene, uint32_t objects);
void hidden_scene_close(struct hidden_scene *scene);

/// A solid; faces: face_count lists in one, each as long as face_sizes says.
enum shape_status hidden_scene_solid(struct hidden_scene *scene, const struct vec3 *points,
                                     uint32_t count, const uint32_t *faces,
                                     const uint32_t *face_sizes, uint32_t face_count);
/// A box spanned by three ways from a corner; det > 0.
enum shape_status hidden_scene_box(struct hidden_scene *scene, struct vec3 corner, struct vec3 a,
                                   struct vec3 b, struct vec3 c);
enum shape_status hidden_scene_plane(struct hidden_scene *scene, const struct vec3 *outline,
                                     uint32_t count);

/// A random scene; only HIDDEN_OVERLAPPED has objects that are not apart.
void hidden_scene_draw(struct hidden_scene *scene, enum hidden_scene_kind kind, uint64_t *random);

/// An eye for it, often in a special place, and a way to look.
struct hidden_camera hidden_scene_camera(enum hidden_scene_kind kind, uint64_t *random);
/// Right and up, for any way to look.
struct hidden_camera hidden_camera_towards(struct vec3 eye, const double ahead[3]);

/// The parts of a picture, in any order: two methods draw the same if these are equal.
struct hidden_parts {
    uint64_t count, hash;
};

/// For hidden_sink; context: struct hidden_parts.
void hidden_parts_add(void *context, const struct hidden_segment *segment);

#endif
