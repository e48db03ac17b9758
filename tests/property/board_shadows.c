/// firmware/app/board_shadows: the shadows that a board casts from a tree in its flash are those
/// that the host casts from the same scene, and what does not fit is refused as a whole.
#include "check.h"

#include "scene_drawn.h"
#include "scene_tree.h"

#include "app/board_shadows.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static struct board_shadows shadows;
static struct board_shadows_memory memory;
static const struct occlusion_settings settings = {
    .policy = OCCLUSION_DROP, .frame_us = 40000, .ahead_us = 400000};

static bool open_scene(const char *path, struct scene_tree *out) {
    return CHECK_EQ(scene_tree_read(path, true, &scene_build_default, out), EXIT_STATUS_OK);
}

static enum board_shadows_status cast(const struct scene_tree *scene, struct vec3_i64 eye_um) {
    return board_shadows_cast(&shadows, &scene->tree, eye_um, 0, &settings, &memory);
}

static bool same_bound(const struct sight_bound *a, const struct sight_bound *b) {
    return a->normal.x == b->normal.x && a->normal.y == b->normal.y && a->normal.z == b->normal.z &&
           i128_cmp(a->offset, b->offset) == 0 && a->closed == b->closed;
}

static void compare(const char *path, struct vec3_i64 eye_um) {
    struct scene_tree scene;
    struct scene_drawn drawn = {.bytes = 0};
    struct units units;
    if (!open_scene(path, &scene)) {
        return;
    }
    drawn.finer = units_finer(&scene.tree);
    CHECK(units_of_tree(&scene.tree, drawn.finer, &units));
    CHECK_EQ(scene_drawn_gather(&drawn, &scene.tree, NULL, path), EXIT_STATUS_OK);
    const size_t bounds =
        SIGHT_BOUNDS_MAX(drawn.set.face_count, drawn.set.edge_count, drawn.set.corner_count);
    struct sight sight = {.eye = vec3((int32_t)units_from_um(units, eye_um.x),
                                      (int32_t)units_from_um(units, eye_um.y),
                                      (int32_t)units_from_um(units, eye_um.z)),
                          .bounds = calloc(bounds + 1U, sizeof *sight.bounds),
                          .pieces = calloc(drawn.set.face_count + 1U, sizeof *sight.pieces),
                          .bound_room = (uint32_t)bounds,
                          .piece_room = drawn.set.face_count};
    for (uint32_t i = 0; i < drawn.set.object_count; i++) {
        CHECK(sight_add(&sight, &drawn.set, i) != UINT32_MAX);
    }
    CHECK_EQ(cast(&scene, eye_um), BOARD_SHADOWS_OK);
    CHECK(sight.piece_count > 2U);
    if (CHECK_EQ(shadows.sight.piece_count, sight.piece_count) &&
        CHECK_EQ(shadows.sight.bound_count, sight.bound_count)) {
        for (uint32_t i = 0; i < sight.bound_count && check_clean(); i++) {
            CHECK(same_bound(&sight.bounds[i], &shadows.bounds[i]));
        }
    }
    printf("# %s: %u things, %u planes\n", path, (unsigned)shadows.solids,
           (unsigned)sight.bound_count);
    free(sight.bounds);
    free(sight.pieces);
    scene_drawn_free(&drawn);
    scene_tree_free(&scene);
}

static void as_the_host_casts_them(void) {
    compare("host-sim/scenarios/city.scene", (struct vec3_i64){0, 0, 0});
    compare("host-sim/scenarios/city.scene", (struct vec3_i64){-40000000, 123456789, 5000001});
    compare("tests/mcu/cpu/hidden/yard.scene", (struct vec3_i64){0, 0, 0});
    compare("tests/mcu/cpu/hidden/yard.scene", (struct vec3_i64){-36000000, -20000000, 900000});
}

/// A row of boxes, or one prism of so many sides; its lines as text.
static void write_boxes(FILE *to, unsigned boxes) {
    static const char *const faces[] = {"1 3 4 2", "5 6 8 7", "1 2 6 5",
                                        "3 7 8 4", "1 5 7 3", "2 4 8 6"};
    for (unsigned i = 0; i < boxes; i++) {
        fprintf(to, "o box%u\n", i);
        for (unsigned k = 0; k < 8U; k++) {
            fprintf(to, "v %u %u %u\n", 3U * i + (k & 1U), 10U + (k >> 1 & 1U), k >> 2);
        }
        for (unsigned f = 0; f < 6U; f++) {
            unsigned c[4];
            CHECK_EQ(sscanf(faces[f], "%u %u %u %u", &c[0], &c[1], &c[2], &c[3]), 4);
            fprintf(to, "f %u %u %u %u\n", c[0] + 8U * i, c[1] + 8U * i, c[2] + 8U * i,
                    c[3] + 8U * i);
        }
    }
}

/// A pyramid over a polygon of so many corners on a parabola: convex, exact in integers.
static void write_pyramid(FILE *to, unsigned sides) {
    fprintf(to, "o pyramid\n");
    for (unsigned k = 0; k < sides; k++) {
        fprintf(to, "v %u %u 0\n", k, 10U + k * k);
    }
    fprintf(to, "v 1 12 -9\nf");
    for (unsigned k = 0; k < sides; k++) {
        fprintf(to, " %u", k + 1U);
    }
    fprintf(to, "\n");
    for (unsigned k = 0; k < sides; k++) {
        fprintf(to, "f %u %u %u\n", (k + 1U) % sides + 1U, k + 1U, sides + 1U);
    }
}

static enum board_shadows_status cast_written(void write(FILE *to, unsigned count), unsigned count,
                                              struct vec3_i64 eye_um) {
    char path[] = "build/shadows-XXXXXX";
    const int handle = mkstemp(path);
    FILE *const to = handle < 0 ? NULL : fdopen(handle, "w");
    struct scene_tree scene = {.block = NULL};
    enum board_shadows_status status = BOARD_SHADOWS_OK;
    if (CHECK(to != NULL)) {
        write(to, count);
        CHECK(fclose(to) == 0);
        if (open_scene(path, &scene)) {
            status = cast(&scene, eye_um);
        }
        unlink(path);
    }
    scene_tree_free(&scene);
    return status;
}

static void write_points(FILE *to, unsigned count) {
    fprintf(to, "o dots\n");
    for (unsigned i = 0; i < count; i++) {
        fprintf(to, "v %u 10 0\n", i);
    }
}

static void what_does_not_fit(void) {
    const struct vec3_i64 here = {0, 0, 0}, far = {INT64_C(1) << 50, 0, 0};
    CHECK_EQ(cast_written(write_boxes, 50, here), BOARD_SHADOWS_OK);
    CHECK_EQ(shadows.solids, 50);
    CHECK_EQ(cast_written(write_boxes, 150, here), BOARD_SHADOWS_ROOM);
    CHECK_EQ(cast_written(write_pyramid, 20, here), BOARD_SHADOWS_OK);
    CHECK_EQ(cast_written(write_pyramid, 60, here), BOARD_SHADOWS_ROOM); // its corners
    CHECK_EQ(cast_written(write_pyramid, 40, (struct vec3_i64){0, 0, INT64_C(-2000000000)}),
             BOARD_SHADOWS_ROOM); // planes of its shadow: all sides are seen
    CHECK_EQ(cast_written(write_points, 5, here), BOARD_SHADOWS_NONE);
    CHECK_EQ(cast_written(write_boxes, 3, far), BOARD_SHADOWS_FAR);
}

int main(void) {
    TEST(as_the_host_casts_them);
    TEST(what_does_not_fit);
    return check_finish();
}
