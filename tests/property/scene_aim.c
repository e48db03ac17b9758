/// scene_aim against cone_narrowest on all points, and how little it reads. COUNT=N views a scene,
/// SEED=N, LARGE=N points of the largest scene (make bench-scene: 1,000,000).
#include "check.h"
#include "property/support/scene_sets.h"
#include "property/support/solid_check.h"

#include "scene/scene_aim.h"
#include "scene/view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static uint64_t seed;
static unsigned long view_count = 40UL;
static uint32_t large = 100000U;
static struct scene_aim_memory memory;

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// distance: of the eye in units of the scene's half-width.
static struct vec3 draw_eye(double distance) {
    struct vec3 p;
    do {
        p = vec3((int32_t)solid_below(&seed, 1U << 27) - (1 << 26),
                 (int32_t)solid_below(&seed, 1U << 27) - (1 << 26),
                 (int32_t)solid_below(&seed, 1U << 27) - (1 << 26));
    } while (p.x == 0 && p.y == 0 && p.z == 0);
    const double scale = distance * 0x1p26 / sqrt((double)vec3_norm2(p));
    return vec3((int32_t)(p.x * scale), (int32_t)(p.y * scale), (int32_t)(p.z * scale));
}

static enum cone_status solve_flat(const struct vec3 *points, uint32_t count,
                                   struct cone_result *cone) {
    void *const workspace = malloc(CONE_WORKSPACE_BYTES(count));
    const struct cone_options options = {.workspace = workspace,
                                         .workspace_bytes = CONE_WORKSPACE_BYTES(count)};
    const enum cone_status status = cone_narrowest(points, count, &options, cone);
    free(workspace);
    return status;
}

static void compare(const struct tree *tree, struct vec3 eye, const struct scene_aim_result *warm) {
    const uint32_t most = tree->header->point_count;
    struct vec3 *const points = malloc(most * sizeof *points);
    uint32_t *const reference = malloc(most * sizeof *reference);
    const uint32_t count = scene_set_finest(tree, eye, points, reference);
    struct cone_result flat;
    struct scene_aim_result result;
    struct scene_aim_options options = {.eye = eye};
    if (warm != NULL) {
        options.warm = warm->reference;
        options.warm_count = warm->cone.support_count;
    }
    const enum cone_status wanted = solve_flat(points, count, &flat);
    const enum scene_aim_status status = scene_aim(tree, &options, &memory, &result);
    CHECK_EQ(status, wanted == CONE_OK                  ? SCENE_AIM_OK
                     : wanted == CONE_ERROR_ZERO_VECTOR ? SCENE_AIM_AT_VIEWPOINT
                                                        : SCENE_AIM_INFEASIBLE);
    if (status == SCENE_AIM_OK) {
        CHECK(vec3_equal(result.cone.axis_q30, flat.axis_q30));
        CHECK_EQ(result.cone.half_angle_turn64, flat.half_angle_turn64);
    }
    // In pieces: the same, bit for bit.
    static struct scene_aim_memory other_memory;
    struct scene_aim_run run;
    struct scene_aim_result pieces;
    enum scene_aim_status piecewise = SCENE_AIM_MORE;
    scene_aim_start(&run, tree, &options, &other_memory, &pieces);
    while (piecewise == SCENE_AIM_MORE) {
        piecewise = scene_aim_go(&run, 1U + solid_below(&seed, 5));
    }
    CHECK_EQ(piecewise, status);
    CHECK(vec3_equal(pieces.cone.axis_q30, result.cone.axis_q30));
    CHECK_EQ(pieces.point_reads, result.point_reads);
    CHECK_EQ(pieces.nodes_opened, result.nodes_opened);
    free(points);
    free(reference);
}

/// Every shape, from far away to inside, cold and warm.
static void same_as_flat(void) {
    static const double distance[6] = {7.5, 3.0, 1.8, 1.2, 0.6, 0.05};
    for (unsigned i = 0; i < 24U && check_clean(); i++) {
        const struct scene_set set = {(enum scene_shape)(i % SCENE_SHAPE_COUNT),
                                      1U + solid_below(&seed, i < 12U ? 40U : 5000U),
                                      1U + solid_below(&seed, 30), i % 8U == 1U};
        const struct scene_set fitting = {set.shape, set.count + set.objects * 4U, set.objects,
                                          set.loose};
        struct scene_text scene = scene_set_draw(&fitting, &seed);
        struct scene_build_options options = scene_build_default;
        options.points_a_leaf = 1U + i % 5U;
        void *block;
        struct tree tree;
        scene_set_open(&scene, &options, &block, &tree);
        for (unsigned long k = 0; k < view_count && check_clean(); k++) {
            const struct vec3 eye = draw_eye(distance[k % 6U]);
            compare(&tree, eye, NULL);
            struct scene_aim_result before;
            const struct scene_aim_options first = {.eye = eye};
            if (scene_aim(&tree, &first, &memory, &before) == SCENE_AIM_OK) {
                compare(&tree, vec3(eye.x + 1000, eye.y - 3000, eye.z + 500), &before);
            }
        }
        // From the place of a point.
        const struct tree_point *const p =
            &tree.points[solid_below(&seed, tree.header->point_count)];
        if (set.shape != SCENE_DETAIL) {
            compare(&tree, vec3(p->x, p->y, p->z), NULL);
        }
        free(block);
        scene_text_free(&scene);
    }
}

/// At a camera's resolution: the cone misses no point by more than the loss says.
static void loss_is_kept(void) {
    const struct scene_set set = {SCENE_BOX, 20000, 300, false};
    struct scene_text scene = scene_set_draw(&set, &seed);
    void *block;
    struct tree tree;
    scene_set_open(&scene, &scene_build_default, &block, &tree);
    struct vec3 *const points = malloc(set.count * sizeof *points);
    uint32_t *const reference = malloc(set.count * sizeof *reference);
    uint64_t fine_reads = 0, coarse_reads = 0;
    double worst = 0;
    for (unsigned long k = 0; k < view_count && check_clean(); k++) {
        const struct vec3 eye = draw_eye(3.0 + (double)(k % 4U));
        const struct scene_aim_options fine = {.eye = eye},
                                       coarse = {.eye = eye, .focal_px_q8 = 60U * 256U};
        struct scene_aim_result result;
        CHECK_EQ(scene_aim(&tree, &fine, &memory, &result), SCENE_AIM_OK);
        fine_reads += result.point_reads;
        CHECK_EQ(scene_aim(&tree, &coarse, &memory, &result), SCENE_AIM_OK);
        coarse_reads += result.point_reads;
        CHECK(result.loss_px_q8 <= 128U);
        const uint32_t count = scene_set_finest(&tree, eye, points, reference);
        const struct vec3 a = result.cone.axis_q30;
        for (uint32_t i = 0; i < count; i++) {
            const struct vec3 p = points[i];
            const double along = (double)a.x * p.x + (double)a.y * p.y + (double)a.z * p.z;
            const double x = (double)a.y * p.z - (double)a.z * p.y,
                         y = (double)a.z * p.x - (double)a.x * p.z,
                         z = (double)a.x * p.y - (double)a.y * p.x;
            const double angle = atan2(sqrt(x * x + y * y + z * z), along);
            const double cone =
                ldexp((double)result.cone.half_angle_turn64, -64) * 2.0 * acos(-1.0);
            worst = fmax(worst, (angle - cone) * 60.0 - result.loss_px_q8 / 256.0);
        }
    }
    CHECK(worst < 1e-6);
    CHECK(coarse_reads < fine_reads);
    printf("# reads at 60 px focal length: %llu, exact %llu\n", (unsigned long long)coarse_reads,
           (unsigned long long)fine_reads);
    free(points);
    free(reference);
    free(block);
    scene_text_free(&scene);
}

struct reach {
    double cold, warm; ///< reads a view
};

/// Reads over some views of a scene in a circle around it.
static struct reach measure(const struct scene_set *set, bool print) {
    const double start = seconds();
    struct scene_text scene = scene_set_draw(set, &seed);
    const double drawn = seconds();
    void *block;
    struct tree tree;
    const size_t size = scene_set_open(&scene, &scene_build_default, &block, &tree);
    const double built = seconds();
    struct reach reach = {0, 0};
    struct scene_aim_result result = {0};
    double worst_cold = 0, worst_warm = 0, taken = 0;
    for (int k = 0; k < 32; k++) {
        const double turn = k * 0.1;
        const struct vec3 eye =
            vec3((int32_t)(0x1.8p27 * cos(turn)), (int32_t)(0x1.8p27 * sin(turn)),
                 (int32_t)(0x1p25 * sin(3 * turn)));
        const struct scene_aim_options cold = {.eye = eye};
        const double before = seconds();
        CHECK_EQ(scene_aim(&tree, &cold, &memory, &result), SCENE_AIM_OK);
        taken += seconds() - before;
        worst_cold = fmax(worst_cold, (double)result.point_reads);
        reach.cold += (double)result.point_reads / 32.0;
        const struct scene_aim_result earlier = result;
        const struct scene_aim_options warm = {.eye =
                                                   vec3(eye.x + 20000, eye.y - 10000, eye.z + 7000),
                                               .warm = earlier.reference,
                                               .warm_count = earlier.cone.support_count};
        CHECK_EQ(scene_aim(&tree, &warm, &memory, &result), SCENE_AIM_OK);
        worst_warm = fmax(worst_warm, (double)result.point_reads);
        reach.warm += (double)result.point_reads / 32.0;
    }
    if (print) {
        printf(
            "# %-6s %8u points %6u objects%s: %7.1f MB, built in %5.2f s; cold %8.1f reads (%.4f "
            "%%, worst %.0f), warm %7.1f (%.4f %%, worst %.0f); %.1f us\n",
            scene_shape_names[set->shape], set->count, set->objects, set->loose ? " (loose)" : "",
            (double)size * 1e-6, built - drawn, reach.cold, 100.0 * reach.cold / set->count,
            worst_cold, reach.warm, 100.0 * reach.warm / set->count, worst_warm,
            taken / 32.0 * 1e6);
    }
    (void)start;
    CHECK(size <= 40U * (size_t)set->count + 4096U);
    free(block);
    scene_text_free(&scene);
    return reach;
}

/// A hundred points an object, in a box and in a ball; the bounds are for the largest.
static void reads_little(void) {
    for (int shape = SCENE_BOX; shape <= SCENE_BALL; shape++) {
        double first = 0, last = 0;
        for (uint32_t count = 1000; count <= large; count *= 10U) {
            const struct scene_set set = {(enum scene_shape)shape, count, count / 100U, false};
            const struct reach reach = measure(&set, true);
            first = count == 1000U ? reach.cold : first;
            last = reach.cold;
            if (count == 1000000U) {
                CHECK(reach.cold <= 0.01 * count);
                CHECK(reach.warm <= 0.001 * count);
            }
        }
        const double exponent = log(last / first) / log(large / 1000.0);
        printf("# growth exponent %.2f\n", exponent);
        CHECK(exponent <= 0.6);
    }
    const struct scene_set cloud = {SCENE_CLOUD, 100000, 1, false};
    measure(&cloud, true);
}

/// Clusters that have to be found against the generator's own.
static void finds_the_clusters(void) {
    double found = 0, known = 0;
    for (int k = 0; k < 6; k++) {
        const uint64_t before = seed;
        const struct scene_set own = {k % 2 == 0 ? SCENE_BOX : SCENE_BALL, 50000, 500, false};
        known += measure(&own, false).cold;
        seed = before;
        const struct scene_set loose = {own.shape, 50000, 500, true};
        found += measure(&loose, false).cold;
    }
    printf("# reads without the clusters / with them: %.3f\n", found / known);
    CHECK(found <= 1.2 * known);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT"),
               *large_text = getenv("LARGE");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19750603U;
    view_count = count_text != NULL ? strtoul(count_text, NULL, 0) : view_count;
    large = large_text != NULL ? (uint32_t)strtoul(large_text, NULL, 0) : large;
    printf("# seed %llu, %lu views a scene\n", (unsigned long long)seed, view_count);
    TEST(same_as_flat);
    TEST(loss_is_kept);
    TEST(reads_little);
    TEST(finds_the_clusters);
    return check_finish();
}
