/// A lattice of 16 x 16 x 16 cubes by both methods: memory, time, and how many of what; the same
/// parts by both.
#include "check.h"
#include "property/support/hidden_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void add_lattice(struct shape_set *set, int32_t side) {
    static const uint32_t faces[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                       2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4};
    for (int32_t i = 0; i < side * side * side; i++) {
        struct vec3 p[8];
        uint32_t fault;
        for (int k = 0; k < 8; k++) {
            p[k] = vec3(1000 * (3 * (i % side) + (k & 1)),
                        1000 * (3 * (i / side % side) + (k >> 1 & 1)),
                        1000 * (3 * (i / side / side) + (k >> 2)));
        }
        if (!CHECK_EQ(shape_add_solid(set, p, 8, faces, sizes, 6, NULL, &fault), SHAPE_OK)) {
            return;
        }
    }
}

static void measure(int32_t side) {
    const uint32_t n = (uint32_t)(side * side * side);
    struct hidden_scene scene;
    struct hidden hidden;
    struct separate separate;
    uint32_t fault[2];
    struct hidden_parts clip = {0, 0}, levine = {0, 0};
    const struct hidden_sink to_clip = {hidden_parts_add, &clip},
                             to_levine = {hidden_parts_add, &levine};
    hidden_scene_open(&scene, n);
    add_lattice(&scene.set, side);
    const size_t bytes = hidden_workspace_bytes(&scene.set),
                 planes = SEPARATE_WORKSPACE_BYTES(n, 64);
    void *const workspace = malloc(bytes), *const more = malloc(planes);
    CHECK_EQ(hidden_open(&hidden, &scene.set, workspace, bytes), HIDDEN_OK);
    const double start = now_s();
    CHECK_EQ(separate_build(&separate, &scene.set, 64, more, planes, fault), SEPARATE_OK);
    const double built = now_s();
    const double middle = 1500.0 * side, ahead[3] = {0.35, 0.9, -0.25};
    const double away = 1.3 * middle * sqrt(3.0) / sqrt(0.35 * 0.35 + 0.81 + 0.0625);
    const struct hidden_camera camera = hidden_camera_towards(
        vec3((int32_t)(middle - away * ahead[0]), (int32_t)(middle - away * ahead[1]),
             (int32_t)(middle - away * ahead[2])),
        ahead);
    hidden_look(&hidden, &camera);
    const double looked = now_s();
    hidden_clip(&hidden, &to_clip);
    const double clipped = now_s();
    separate_look(&separate, camera.eye);
    hidden_levine(&hidden, &separate, &to_levine, NULL);
    const double drawn = now_s();
    CHECK_EQ(clip.count, levine.count);
    CHECK(clip.hash == levine.hash && clip.count > n / 2U);
    printf("MEASURED %u cubes: %.1f MB for a view, %.0f KB for %u planes; planes %.0f ms, look "
           "%.0f ms, clip %.0f ms, levine %.0f ms; %llu parts\n",
           n, (double)bytes / 1e6, (double)planes / 1e3, separate.plane_count,
           1e3 * (built - start), 1e3 * (looked - built), 1e3 * (clipped - looked),
           1e3 * (drawn - clipped), (unsigned long long)clip.count);
    CHECK_EQ(separate.plane_count, 3 * (side - 1));
    CHECK(bytes < 4000U * (size_t)n);
    free(workspace);
    free(more);
    hidden_scene_close(&scene);
}

static void lattice_512(void) {
    measure(8);
}

static void lattice_4096(void) {
    measure(16);
}

int main(void) {
    TEST(lattice_512);
    TEST(lattice_4096);
    return check_finish();
}
