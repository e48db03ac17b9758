#include "property/support/hidden_scenes.h"

#include "check.h"
#include "property/support/solid_check.h"

#include "solid/solid_hull.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const hidden_scene_names[HIDDEN_KIND_COUNT] = {"lattice", "blocks", "mixed", "crystals",
                                                           "overlapped"};

void hidden_scene_open(struct hidden_scene *scene, uint32_t objects) {
    const uint32_t room = objects * 64U;
    *scene = (struct hidden_scene){.set = {.vertices = calloc(room, sizeof(struct vec3)),
                                           .corners = calloc(8U * room, sizeof(uint32_t)),
                                           .faces = calloc(2U * room, sizeof(struct shape_face)),
                                           .planes = calloc(2U * room, sizeof(struct shape_plane)),
                                           .edges = calloc(4U * room, sizeof(struct shape_edge)),
                                           .objects = calloc(objects, sizeof(struct shape_object)),
                                           .vertex_room = room,
                                           .corner_room = 8U * room,
                                           .face_room = 2U * room,
                                           .edge_room = 4U * room,
                                           .object_room = objects},
                                   .corners = calloc(room, sizeof *scene->corners),
                                   .faces = calloc(8U * room, sizeof *scene->faces),
                                   .first = calloc(3U * room, sizeof *scene->first)};
}

void hidden_scene_close(struct hidden_scene *scene) {
    free(scene->set.vertices);
    free(scene->set.corners);
    free(scene->set.faces);
    free(scene->set.planes);
    free(scene->set.edges);
    free(scene->set.objects);
    free(scene->corners);
    free(scene->faces);
    free(scene->first);
}

static void add_body(struct hidden_scene *s, const struct vec3 *points, uint32_t count,
                     const uint32_t *faces, const uint32_t *face_sizes, uint32_t face_count,
                     bool flat) {
    if (s->body_count == HIDDEN_BODIES_MAX) {
        return;
    }
    s->body[s->body_count++] = (struct ray_body){
        (const int32_t(*)[3])(s->corners + s->corner_count), s->faces + s->face_corner_count,
        s->first + s->first_count, face_count, flat};
    for (uint32_t i = 0; i < count; i++) {
        const int32_t place[3] = {points[i].x, points[i].y, points[i].z};
        memcpy(s->corners[s->corner_count++], place, sizeof place);
    }
    uint32_t used = 0;
    s->first[s->first_count++] = 0;
    for (uint32_t f = 0; f < face_count; f++) {
        for (uint32_t k = 0; k < face_sizes[f]; k++) {
            s->faces[s->face_corner_count++] = faces[used++];
        }
        s->first[s->first_count++] = used;
    }
}

enum shape_status hidden_scene_solid(struct hidden_scene *scene, const struct vec3 *points,
                                     uint32_t count, const uint32_t *faces,
                                     const uint32_t *face_sizes, uint32_t face_count) {
    uint32_t fault;
    const enum shape_status status =
        shape_add_solid(&scene->set, points, count, faces, face_sizes, face_count, NULL, &fault);
    if (status == SHAPE_OK) {
        add_body(scene, points, count, faces, face_sizes, face_count, false);
    }
    return status;
}

enum shape_status hidden_scene_box(struct hidden_scene *scene, struct vec3 corner, struct vec3 a,
                                   struct vec3 b, struct vec3 c) {
    static const uint32_t faces[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                       2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4};
    struct vec3 p[8];
    for (int i = 0; i < 8; i++) {
        const int x = i & 1, y = i >> 1 & 1, z = i >> 2;
        p[i] = vec3(corner.x + x * a.x + y * b.x + z * c.x, corner.y + x * a.y + y * b.y + z * c.y,
                    corner.z + x * a.z + y * b.z + z * c.z);
    }
    return hidden_scene_solid(scene, p, 8, faces, sizes, 6);
}

enum shape_status hidden_scene_plane(struct hidden_scene *scene, const struct vec3 *outline,
                                     uint32_t count) {
    const enum shape_status status = shape_add_plane(&scene->set, outline, count, false);
    uint32_t order[64];
    for (uint32_t i = 0; i < count; i++) {
        order[i] = i;
    }
    if (status == SHAPE_OK) {
        add_body(scene, outline, count, order, &count, 1, true);
    }
    return status;
}

static int32_t between(uint64_t *random, int32_t low, int32_t high) {
    return low + (int32_t)solid_below(random, (uint32_t)(high - low + 1));
}

/// Takes the last object back unless it is apart from all others.
static void keep_if_apart(struct hidden_scene *s, const struct shape_set *before,
                          const struct hidden_scene *body_before) {
    struct shape_plane plane;
    const uint32_t last = s->set.object_count - 1U;
    for (uint32_t i = 0; i < last; i++) {
        if (!separate_pair(&s->set, i, last, &plane)) {
            const struct hidden_scene old = *body_before;
            s->set = *before;
            s->body_count = old.body_count;
            s->corner_count = old.corner_count;
            s->face_corner_count = old.face_corner_count;
            s->first_count = old.first_count;
            return;
        }
    }
}

#define GRID_UNIT 4

static void draw_block(struct hidden_scene *s, uint64_t *random) {
    const struct vec3 at =
        vec3(GRID_UNIT * between(random, 0, 7), GRID_UNIT * between(random, 0, 7),
             GRID_UNIT * between(random, 0, 7));
    (void)hidden_scene_box(s, at, vec3(GRID_UNIT * between(random, 1, 3), 0, 0),
                           vec3(0, GRID_UNIT * between(random, 1, 3), 0),
                           vec3(0, 0, GRID_UNIT * between(random, 1, 3)));
}

/// A letter in a plane of the grid: L, U or an arrow.
static void draw_letter(struct hidden_scene *s, uint64_t *random) {
    static const int8_t letters[4][9][2] = {
        {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}, {-1, -1}},
        {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}, {-1, -1}},
        {{0, 0}, {2, 1}, {4, 0}, {2, 4}, {-1, -1}},
        {{0, 0}, {2, 0}, {3, 0}, {3, 2}, {0, 2}, {-1, -1}},
    };
    const int8_t(*const letter)[2] = letters[solid_below(random, 4)];
    const int32_t x = between(random, 0, 8), y = between(random, 0, 8), z = between(random, 0, 8);
    const uint32_t plane = solid_below(random, 4);
    struct vec3 outline[9];
    uint32_t count = 0;
    for (; letter[count][0] >= 0; count++) {
        const int32_t u = letter[count][0], v = letter[count][1];
        const int32_t p[4][3] = {{u, v, 0}, {u, 0, v}, {0, u, v}, {u, v, u}};
        outline[count] = vec3(GRID_UNIT * (x + p[plane][0]), GRID_UNIT * (y + p[plane][1]),
                              GRID_UNIT * (z + p[plane][2]));
    }
    if (solid_below(random, 2) != 0U) { // the other way round
        for (uint32_t i = 0; i < count / 2U; i++) {
            const struct vec3 swap = outline[i];
            outline[i] = outline[count - 1U - i];
            outline[count - 1U - i] = swap;
        }
    }
    (void)hidden_scene_plane(s, outline, count);
}

static void draw_wire(struct hidden_scene *s, uint64_t *random) {
    static const uint32_t ends[8] = {0, 1, 1, 2, 3, 4, 5, 4};
    struct vec3 p[6];
    for (int i = 0; i < 6; i++) {
        p[i] = vec3(between(random, -4, 40), between(random, -4, 40), between(random, -4, 40));
    }
    if (shape_add_wire(&s->set, p, 6, ends, 4) == SHAPE_OK) {
        s->body[s->body_count++] = (struct ray_body){NULL, NULL, NULL, 0, true};
    }
}

static struct vec3 big(uint64_t *random, int32_t reach) {
    return vec3(between(random, -reach, reach), between(random, -reach, reach),
                between(random, -reach, reach));
}

static struct vec3 sum(struct vec3 a, struct vec3 b) {
    return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static void draw_crystal(struct hidden_scene *s, uint64_t *random) {
    const struct vec3 center = big(random, 200000000);
    if (solid_below(random, 2) != 0U) {
        const struct vec3 a = big(random, 20000000), b = big(random, 20000000),
                          c = big(random, 20000000);
        const bool right = vec3_det_sign(a, b, c) > 0;
        (void)hidden_scene_box(s, center, a, right ? b : c, right ? c : b);
        return;
    }
    struct vec3 points[12], corners[12];
    uint32_t faces[60], sizes[20], place[12] = {0};
    static uint64_t workspace[SOLID_HULL_WORKSPACE_BYTES(12) / 8U + 1U];
    struct solid_hull hull;
    for (int i = 0; i < 12; i++) {
        points[i] = sum(center, big(random, 30000000));
    }
    if (solid_hull_find(points, 12, SOLID_HULL_CAPS, workspace, sizeof workspace, &hull) !=
            SOLID_HULL_OK ||
        hull.dimension != 3) {
        return;
    }
    for (uint32_t i = 0; i < hull.vertex_count; i++) {
        corners[i] = points[hull.vertices[i]];
        place[hull.vertices[i]] = i;
    }
    for (uint32_t f = 0; f < hull.face_count; f++) {
        sizes[f] = 3;
        for (uint32_t k = 0; k < 3U; k++) {
            faces[3U * f + k] = place[hull.faces[f].vertex[k]];
        }
    }
    (void)hidden_scene_solid(s, corners, hull.vertex_count, faces, sizes, hull.face_count);
}

static void draw_lattice(struct hidden_scene *s, uint64_t *random) {
    const int32_t nx = between(random, 1, 4), ny = between(random, 1, 2),
                  nz = between(random, 1, 4);
    for (int32_t i = 0; i < nx * ny * nz; i++) {
        (void)hidden_scene_box(s, vec3(12 * (i % nx), 12 * (i / nx % ny), 12 * (i / nx / ny)),
                               vec3(4, 0, 0), vec3(0, 4, 0), vec3(0, 0, 4));
    }
}

void hidden_scene_draw(struct hidden_scene *scene, enum hidden_scene_kind kind, uint64_t *random) {
    if (kind == HIDDEN_LATTICE) {
        draw_lattice(scene, random);
        return;
    }
    for (uint32_t tries = 12U + solid_below(random, 24); tries != 0U; tries--) {
        const struct shape_set before = scene->set;
        const struct hidden_scene bodies = *scene;
        const uint32_t what = kind == HIDDEN_MIXED ? solid_below(random, 3) : 0U;
        if (kind == HIDDEN_CRYSTALS) {
            draw_crystal(scene, random);
        } else if (what == 0U) {
            draw_block(scene, random);
        } else if (what == 1U) {
            draw_letter(scene, random);
        } else {
            draw_wire(scene, random);
        }
        if (kind != HIDDEN_OVERLAPPED && what != 2U &&
            scene->set.object_count != before.object_count) {
            keep_if_apart(scene, &before, &bodies);
        }
    }
}

struct hidden_camera hidden_camera_towards(struct vec3 eye, const double ahead[3]) {
    const double length = sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1] + ahead[2] * ahead[2]);
    const double a[3] = {ahead[0] / length, ahead[1] / length, ahead[2] / length};
    const double flat = hypot(a[0], a[1]);
    const double right[3] = {flat > 0 ? a[1] / flat : 1, flat > 0 ? -a[0] / flat : 0, 0};
    const double up[3] = {right[1] * a[2] - right[2] * a[1], right[2] * a[0] - right[0] * a[2],
                          right[0] * a[1] - right[1] * a[0]};
    const double *const axes[3] = {right, a, up};
    struct vec3 q30[3];
    for (int i = 0; i < 3; i++) {
        q30[i] = vec3((int32_t)lrint(axes[i][0] * 0x1p30), (int32_t)lrint(axes[i][1] * 0x1p30),
                      (int32_t)lrint(axes[i][2] * 0x1p30));
    }
    return (struct hidden_camera){eye, q30[0], q30[1], q30[2], 0, 0};
}

struct hidden_camera hidden_scene_camera(enum hidden_scene_kind kind, uint64_t *random) {
    double ahead[3];
    do {
        for (int i = 0; i < 3; i++) {
            ahead[i] = between(random, -2, 2) +
                       (solid_below(random, 2) != 0U ? 0.37 : 0.0) * between(random, -3, 3);
        }
    } while (ahead[0] == 0 && ahead[1] == 0 && ahead[2] == 0);
    const bool far_away = solid_below(random, 2) != 0U; // with everything in front
    if (kind == HIDDEN_CRYSTALS) {
        return hidden_camera_towards(far_away ? vec3((int32_t)(-2e8 * ahead[0]),
                                                     (int32_t)(-2e8 * ahead[1]),
                                                     (int32_t)(-2e8 * ahead[2]))
                                              : big(random, 200000000),
                                     ahead);
    }
    const int32_t step = solid_below(random, 2) != 0U ? GRID_UNIT : 1;
    struct vec3 eye = vec3(step * between(random, -12 / step, 48 / step),
                           step * between(random, -12 / step, 48 / step),
                           step * between(random, -12 / step, 48 / step));
    if (far_away) {
        eye = vec3(18 - (int32_t)(60 * ahead[0]), 18 - (int32_t)(60 * ahead[1]),
                   18 - (int32_t)(60 * ahead[2]));
    }
    return hidden_camera_towards(eye, ahead);
}

void hidden_parts_add(void *context, const struct hidden_segment *segment) {
    struct hidden_parts *const s = context;
    uint64_t h = segment->edge * UINT64_C(0x9E3779B97F4A7C15);
    h ^= (uint64_t)fraction_q62(segment->part.from) * UINT64_C(0xD6E8FEB86659FD93);
    h ^= (uint64_t)fraction_q62(segment->part.to) * UINT64_C(0xC2B2AE3D27D4EB4F);
    s->hash += h ^ h >> 29;
    s->count++;
}
