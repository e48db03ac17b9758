/// view_place, view_radius_px_q8 and walk_next against sampled points and every point of a scene.
/// SEED=N, COUNT=N views.
#include "check.h"
#include "property/support/scene_sets.h"
#include "property/support/solid_check.h"

#include "scene/walk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static unsigned long view_count = 300UL;

static double uniform(void) {
    return (double)(check_random(&seed) >> 11) * 0x1p-52 - 1.0;
}

static struct vec3 to_q30(const double v[3]) {
    return vec3((int32_t)lrint(v[0] * 0x1p30), (int32_t)lrint(v[1] * 0x1p30),
                (int32_t)lrint(v[2] * 0x1p30));
}

struct camera {
    struct view view;
    double half_width, half_height, focal; ///< pixels
};

/// Somewhere around the scene or in it, turned anyhow.
static struct camera draw_camera(double distance) {
    double ahead[3], right[3], up[3], length = 0;
    do {
        for (int i = 0; i < 3; i++) {
            ahead[i] = uniform();
        }
        length = sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1] + ahead[2] * ahead[2]);
    } while (length < 0.1 || length > 1.0);
    for (int i = 0; i < 3; i++) {
        ahead[i] /= length;
    }
    const double flat = sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1]) + 1e-300;
    right[0] = ahead[1] / flat;
    right[1] = -ahead[0] / flat;
    right[2] = 0;
    up[0] = right[1] * ahead[2] - right[2] * ahead[1];
    up[1] = right[2] * ahead[0] - right[0] * ahead[2];
    up[2] = right[0] * ahead[1] - right[1] * ahead[0];
    double component[3];
    for (int i = 0; i < 3; i++) {
        component[i] = 0x1p26 * (uniform() - distance * ahead[i]);
    }
    const struct vec3 eye =
        vec3((int32_t)component[0], (int32_t)component[1], (int32_t)component[2]);
    struct camera camera = {.half_width = 40 + solid_below(&seed, 900),
                            .half_height = 30 + solid_below(&seed, 600),
                            .focal = 50 + solid_below(&seed, 3000)};
    view_set(&camera.view, eye, to_q30(right), to_q30(ahead), to_q30(up),
             (uint32_t)(camera.focal * 256.0), (uint32_t)(2 * camera.half_width),
             (uint32_t)(2 * camera.half_height));
    return camera;
}

struct seen {
    double depth, x_px, y_px;
};

static struct seen project(const struct camera *c, double x, double y, double z) {
    const struct view *const v = &c->view;
    const double d[3] = {x - v->eye.x, y - v->eye.y, z - v->eye.z};
    const double depth = (v->ahead.x * d[0] + v->ahead.y * d[1] + v->ahead.z * d[2]) * 0x1p-30;
    const double right = (v->right.x * d[0] + v->right.y * d[1] + v->right.z * d[2]) * 0x1p-30;
    const double up = (v->up.x * d[0] + v->up.y * d[1] + v->up.z * d[2]) * 0x1p-30;
    return (struct seen){depth, c->focal * right / depth, c->focal * up / depth};
}

/// Pixels from the border of the picture; above 0 inside.
static double margin(const struct camera *c, struct seen s) {
    return s.depth <= 0 ? -1e9 : fmin(c->half_width - fabs(s.x_px), c->half_height - fabs(s.y_px));
}

/// Points on random spheres: outside means none is seen, inside that all are; and no picture is
/// wider than told.
static void spheres_and_samples(void) {
    unsigned long places[3] = {0};
    double tightest = 1e9;
    for (unsigned long i = 0; i < 40U * view_count && check_clean(); i++) {
        const struct camera c = draw_camera(2.0);
        const struct vec3 center =
            vec3((int32_t)(uniform() * 0x1p26), (int32_t)(uniform() * 0x1p26),
                 (int32_t)(uniform() * 0x1p26));
        const uint32_t radius = 1U << (10U + solid_below(&seed, 17));
        const enum view_place place = view_place(&c.view, center, radius);
        const uint32_t px_q8 = view_radius_px_q8(&c.view, center, radius);
        const struct seen middle = project(&c, center.x, center.y, center.z);
        places[place]++;
        double widest = 0;
        for (int k = 0; k < 60; k++) {
            double d[3], length;
            do {
                d[0] = uniform();
                d[1] = uniform();
                d[2] = uniform();
                length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            } while (length < 0.1);
            const double scale = radius / length;
            const struct seen s = project(&c, center.x + d[0] * scale, center.y + d[1] * scale,
                                          center.z + d[2] * scale);
            CHECK(place != VIEW_OUTSIDE || margin(&c, s) < 0);
            CHECK(place != VIEW_INSIDE || margin(&c, s) > 0);
            const struct seen t = project(&c, center.x - d[0] * scale, center.y - d[1] * scale,
                                          center.z - d[2] * scale);
            if (middle.depth > radius) { // half the distance of opposite points' pictures
                widest = fmax(widest, hypot(s.x_px - t.x_px, s.y_px - t.y_px) / 2);
            }
        }
        CHECK(px_q8 == UINT32_MAX || widest <= px_q8 / 256.0);
        if (px_q8 < 100000U && px_q8 > 2560U) {
            tightest = fmin(tightest, px_q8 / 256.0 / widest);
        }
    }
    printf("# outside %lu, crossing %lu, inside %lu; told / seen at best %.4f\n",
           places[VIEW_OUTSIDE], places[VIEW_CROSSING], places[VIEW_INSIDE], tightest);
    CHECK(places[0] > 100U && places[1] > 100U && places[2] > 100U);
    CHECK(tightest < 1.1);
}

/// The thesis takes a sphere for in front of the eye if its centre is farther than its radius.
static void depth_not_distance(void) {
    struct view view;
    view_set(&view, vec3(0, 0, 0), vec3(Q30_ONE, 0, 0), vec3(0, 0, Q30_ONE), vec3(0, Q30_ONE, 0),
             100U * 256U, 200, 200);
    CHECK_EQ(view_place(&view, vec3(3000, 0, 1000), 2900), VIEW_CROSSING);
    CHECK_EQ(view_radius_px_q8(&view, vec3(3000, 0, 1000), 2900), UINT32_MAX);
    CHECK_EQ(view_place(&view, vec3(0, 0, 3000), 1000), VIEW_INSIDE);
    CHECK_EQ(view_place(&view, vec3(0, 0, -3000), 1000), VIEW_OUTSIDE);
}

/// Every point in the picture comes up once if its object's finest description is chosen, and none
/// of a node below a chosen coarser one does.
static void nothing_is_missing(void) {
    for (int shape = 0; shape < SCENE_SHAPE_COUNT && check_clean(); shape++) {
        const struct scene_set set = {(enum scene_shape)shape, 4000, 40, false};
        struct scene_text scene = scene_set_draw(&set, &seed);
        struct scene_build_options options = scene_build_default;
        options.coarse_px_q8 = shape == SCENE_BALL ? 256U : 0U;
        void *block;
        struct tree tree;
        scene_set_open(&scene, &options, &block, &tree);
        unsigned char *const shown = malloc(set.count);
        uint64_t opened = 0, tested = 0, pictures = 0, centers = 0;
        for (unsigned long k = 0; k < view_count && check_clean(); k++) {
            const struct camera c = draw_camera(0.2 * (double)(k % 15U));
            for (uint32_t i = 0; i < set.count; i++) {
                shown[i] = 0;
            }
            struct walk walk;
            struct walk_item item;
            walk_start(&walk, &tree, NULL, &c.view);
            while (walk_next(&walk, &item)) {
                pictures++;
                if (tree_kind(item.description) == TREE_CENTER) {
                    centers++;
                    CHECK(item.radius_px_q8 < options.coarse_px_q8);
                    // What the centre stands for counts as shown.
                    for (uint32_t i = 0; i < set.count; i++) {
                        const struct vec3 p = scene.vertices.directions[i];
                        const double x = (double)p.x - item.node->x, y = (double)p.y - item.node->y,
                                     z = (double)p.z - item.node->z;
                        shown[i] |= sqrt(x * x + y * y + z * z) <= item.node->radius ? 2U : 0U;
                    }
                    continue;
                }
                for (uint32_t i = 0; i < item.description->count; i++) {
                    const uint32_t source = tree.points[item.description->first + i].source;
                    CHECK(shown[source] != 1U);
                    shown[source] |= 1U;
                }
            }
            opened += walk.nodes_opened;
            tested += walk.sphere_tests;
            for (uint32_t i = 0; i < set.count && shape != SCENE_DETAIL; i++) {
                const struct vec3 p = scene.vertices.directions[i];
                CHECK(shown[i] != 0U || margin(&c, project(&c, p.x, p.y, p.z)) < 1e-3);
            }
        }
        printf("# %-7s %.0f nodes opened a view of %u, %.0f tested, %.1f items (%.1f centres)\n",
               scene_shape_names[shape], (double)opened / (double)view_count,
               tree.header->node_count, (double)tested / (double)view_count,
               (double)pictures / (double)view_count, (double)centers / (double)view_count);
        CHECK(tested <= opened);
        free(shown);
        free(block);
        scene_text_free(&scene);
    }
}

/// Objects with two descriptions: never both, and the finer one exactly from its threshold on.
static void one_description_each(void) {
    const struct scene_set set = {SCENE_DETAIL, 2000, 20, false};
    struct scene_text scene = scene_set_draw(&set, &seed);
    struct scene_build_options options = scene_build_default;
    options.coarse_px_q8 = 0;
    void *block;
    struct tree tree;
    scene_set_open(&scene, &options, &block, &tree);
    unsigned long coarse = 0, fine = 0;
    for (unsigned long k = 0; k < view_count && check_clean(); k++) {
        const struct camera c = draw_camera(3.0);
        unsigned char seen[20] = {0};
        struct walk walk;
        struct walk_item item;
        walk_start(&walk, &tree, NULL, &c.view);
        while (walk_next(&walk, &item)) {
            const uint32_t source = tree.points[item.description->first].source;
            const uint32_t object = source / 100U;
            seen[object] |= source % 100U < 25U ? 1U : 2U;
        }
        for (uint32_t i = 0; i < 20U; i++) {
            CHECK(seen[i] != 3U);
            coarse += seen[i] == 1U;
            fine += seen[i] == 2U;
        }
    }
    CHECK(coarse > 10U && fine > 10U);
    free(block);
    scene_text_free(&scene);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19750605U;
    view_count = count_text != NULL ? strtoul(count_text, NULL, 0) : view_count;
    printf("# seed %llu, %lu views\n", (unsigned long long)seed, view_count);
    TEST(spheres_and_samples);
    TEST(depth_not_distance);
    TEST(nothing_is_missing);
    TEST(one_description_each);
    return check_finish();
}
