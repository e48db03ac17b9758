/// `make bench-scene`: how many points aiming at a scene reads, beside the flat solver and CGAL on
/// the same points and from the same places. LARGE=N: the largest scene (10,000,000).
#include "bench/methods.h"
#include "check.h"
#include "property/support/scene_sets.h"

#include "scene/scene_aim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void peer_sphere_prepare(const struct vec3 *points, uint32_t count);
void peer_sphere_run(const struct vec3 *points, uint32_t count, struct bench_run *run);

/// FOCAL_PX: of a picture 640 px wide, 90 degrees.
enum { VIEWS = 32, FLAT_VIEWS = 3, FOCAL_PX = 320 };

/// What is bounded at a million points: parts of them that are read.
#define COLD_MOST     0.01
#define WARM_MOST     0.001
#define EXPONENT_MOST 0.6

static uint64_t seed;
static struct scene_aim_memory memory;

enum bench_scene { IN_A_BOX, IN_A_BALL, FILLED_CONE, BENCH_SCENES };
static const char *const names[BENCH_SCENES] = {"box", "ball", "filled cone"};

/// Means over the views.
struct row {
    double file_mb, build_s;
    double cold, cold_worst, warm, warm_worst; ///< reads
    double coarse, loss_px;
    double cold_us, warm_us, flat_ms, flat_reads, peer_ms;
    bool same;
};

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double uniform(void) {
    return (double)(check_random(&seed) >> 11) * 0x1p-53;
}

static const struct vec3 apex = {0, -(3 << 26), 0};

/// Fills a cone of 20 degrees from the apex on: every point of its surface may matter.
static void fill_cone(struct vec3 *points, uint32_t count) {
    const double pi = acos(-1.0), least = cos(20.0 * pi / 180.0);
    for (uint32_t i = 0; i < count; i++) {
        const double along = least + (1.0 - least) * uniform(), turn = 2.0 * pi * uniform();
        const double across = sqrt(1.0 - along * along), far = 0x1p28 * cbrt(uniform());
        points[i] =
            vec3((int32_t)(far * across * cos(turn)), (int32_t)(apex.y + far * along) + 1000,
                 (int32_t)(far * across * sin(turn)));
    }
}

static struct vec3 place(enum bench_scene scene, int view) {
    const double turn = view * 0.2;
    return scene == FILLED_CONE
               ? vec3(apex.x + 100 * view, apex.y - 100 * view, apex.z)
               : vec3((int32_t)(0x1.8p27 * cos(turn)), (int32_t)(0x1.8p27 * sin(turn)),
                      (int32_t)(0x1p25 * sin(3 * turn)));
}

static void aim_all(const struct tree *tree, enum bench_scene scene, struct row *row) {
    for (int k = 0; k < VIEWS; k++) {
        const struct vec3 eye = place(scene, k);
        const struct scene_aim_options cold = {.eye = eye},
                                       coarse = {.eye = eye, .focal_px_q8 = FOCAL_PX * 256U};
        struct scene_aim_result result, later;
        double start = seconds();
        CHECK_EQ(scene_aim(tree, &cold, &memory, &result), SCENE_AIM_OK);
        row->cold_us += (seconds() - start) * 1e6 / VIEWS;
        row->cold += (double)result.point_reads / VIEWS;
        row->cold_worst = fmax(row->cold_worst, (double)result.point_reads);
        // A ten-thousandth of the scene's size further on.
        const struct scene_aim_options warm = {.eye =
                                                   vec3(eye.x + 20000, eye.y - 10000, eye.z + 7000),
                                               .warm = result.reference,
                                               .warm_count = result.cone.support_count};
        start = seconds();
        CHECK_EQ(scene_aim(tree, &warm, &memory, &later), SCENE_AIM_OK);
        row->warm_us += (seconds() - start) * 1e6 / VIEWS;
        row->warm += (double)later.point_reads / VIEWS;
        row->warm_worst = fmax(row->warm_worst, (double)later.point_reads);
        CHECK_EQ(scene_aim(tree, &coarse, &memory, &result), SCENE_AIM_OK);
        row->coarse += (double)result.point_reads / VIEWS;
        row->loss_px = fmax(row->loss_px, result.loss_px_q8 / 256.0);
    }
}

static void aim_flat(const struct tree *tree, const struct vec3 *points, uint32_t count,
                     enum bench_scene scene, struct row *row) {
    struct vec3 *const direction = malloc(count * sizeof *direction);
    void *const workspace = malloc(CONE_WORKSPACE_BYTES(count));
    row->same = true;
    for (int k = 0; k < FLAT_VIEWS; k++) {
        const struct vec3 eye = place(scene, k);
        for (uint32_t i = 0; i < count; i++) {
            direction[i] = vec3(points[i].x - eye.x, points[i].y - eye.y, points[i].z - eye.z);
        }
        const struct cone_options options = {.workspace = workspace,
                                             .workspace_bytes = CONE_WORKSPACE_BYTES(count)};
        struct cone_result flat;
        double start = seconds();
        CHECK_EQ(cone_narrowest(direction, count, &options, &flat), CONE_OK);
        row->flat_ms += (seconds() - start) * 1e3 / FLAT_VIEWS;
        row->flat_reads += (double)flat.point_reads / FLAT_VIEWS;
        const struct scene_aim_options by_tree = {.eye = eye};
        struct scene_aim_result result;
        CHECK_EQ(scene_aim(tree, &by_tree, &memory, &result), SCENE_AIM_OK);
        row->same = row->same && vec3_equal(flat.axis_q30, result.cone.axis_q30) &&
                    flat.half_angle_turn64 == result.cone.half_angle_turn64;
        for (uint32_t i = 0; i < count; i++) { // not measured: CGAL takes unit vectors
            direction[i] = vec3_normalise(direction[i]);
        }
        struct bench_run run = {0};
        peer_sphere_prepare(direction, count);
        start = seconds();
        peer_sphere_run(direction, count, &run);
        row->peer_ms += (seconds() - start) * 1e3 / FLAT_VIEWS;
    }
    CHECK(row->same);
    free(direction);
    free(workspace);
}

static struct row measure(enum bench_scene scene, uint32_t count) {
    const struct scene_set set = {scene == IN_A_BOX    ? SCENE_BOX
                                  : scene == IN_A_BALL ? SCENE_BALL
                                                       : SCENE_CLOUD,
                                  count, scene == FILLED_CONE ? 1U : count / 100U, false};
    seed = UINT64_C(19750608) + 1000000007U * (uint64_t)scene + count; // whatever ran before
    struct scene_text text = scene_set_draw(&set, &seed);
    struct row row = {0};
    if (scene == FILLED_CONE) {
        fill_cone(text.vertices.directions, count);
    }
    const double start = seconds();
    void *block;
    struct tree tree;
    row.file_mb = (double)scene_set_open(&text, &scene_build_default, &block, &tree) * 1e-6;
    row.build_s = seconds() - start;
    aim_all(&tree, scene, &row);
    aim_flat(&tree, text.vertices.directions, count, scene, &row);
    free(block);
    scene_text_free(&text);
    return row;
}

static void print(enum bench_scene scene, uint32_t count, const struct row *r) {
    const double part = 100.0 / count;
    printf("%-11s %9u %7.1f %7.2f | %7.1f %8.4f %6.0f %8.1f | %7.1f %8.4f %6.0f %7.1f | %7.1f "
           "%5.2f | %9.0f %9.2f %9.2f %s\n",
           names[scene], count, r->file_mb, r->build_s, r->cold, r->cold * part, r->cold_worst,
           r->cold_us, r->warm, r->warm * part, r->warm_worst, r->warm_us, r->coarse, r->loss_px,
           r->flat_reads, r->flat_ms, r->peer_ms, r->same ? "same" : "OTHER");
    fflush(stdout);
}

// ---------------------------------------------------------------- growth and verdicts

enum { SIZES_MOST = 7 };

/// The slope of log y over log n by least squares; n = 1000, 10,000, ...
static double exponent(const double *y, int count) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int i = 0; i < count; i++) {
        const double x = i * log(10.0), l = log(y[i]);
        sx += x;
        sy += l;
        sxx += x * x;
        sxy += x * l;
    }
    return count < 2 ? 0.0 : (count * sxy - sx * sy) / (count * sxx - sx * sx);
}

/// One kind of reads over all sizes: how it grows from each size to the next, and over all. most:
/// of the exponent; 0: it is reported only.
static void judge_growth(const char *what, const double *reads, int count, double most) {
    const double slope = exponent(reads, count);
    printf("  %-22s grows as n^%.2f (from size to size:", what, slope);
    for (int i = 1; i < count; i++) {
        printf(" %.2f", log10(reads[i] / reads[i - 1]));
    }
    printf(")%s\n", most <= 0.0            ? "; reported, not bounded"
                    : CHECK(slope <= most) ? "; at most 0.60: kept"
                                           : "; at most 0.60: BROKEN");
}

static void judge_part(const char *what, double reads, uint32_t count, double most) {
    printf("  %-22s %.4f %% of %u points; at most %.1f %%: %s\n", what, 100.0 * reads / count,
           (unsigned)count, 100.0 * most, CHECK(reads <= most * count) ? "kept" : "BROKEN");
}

static void measure_sizes(enum bench_scene scene, uint32_t large) {
    double cold[SIZES_MOST] = {1}, worst[SIZES_MOST] = {1}, warm[SIZES_MOST] = {1},
           coarse[SIZES_MOST] = {1};
    struct row million = {0};
    const bool bounded = scene != FILLED_CONE;
    int sizes = 0;
    for (uint64_t count = 1000; count <= large && sizes < SIZES_MOST; count *= 10U, sizes++) {
        const struct row last = measure(scene, (uint32_t)count);
        print(scene, (uint32_t)count, &last);
        million = count == 1000000U ? last : million;
        cold[sizes] = last.cold;
        worst[sizes] = last.cold_worst;
        warm[sizes] = last.warm;
        coarse[sizes] = last.coarse;
        CHECK(!bounded || last.file_mb <= 40e-6 * (double)count + 0.01);
    }
    printf("%s:\n", names[scene]);
    judge_growth("reads cold", cold, sizes, bounded ? EXPONENT_MOST : 0.0);
    judge_growth("reads cold, worst view", worst, sizes, bounded ? EXPONENT_MOST : 0.0);
    judge_growth("reads warm", warm, sizes, bounded ? EXPONENT_MOST : 0.0);
    judge_growth("reads at 640 px", coarse, sizes, bounded ? EXPONENT_MOST : 0.0);
    if (bounded && million.cold > 0.0) {
        judge_part("read cold", million.cold, 1000000, COLD_MOST);
        judge_part("read warm", million.warm, 1000000, WARM_MOST);
        printf("  %-22s %.1f MB, at most 40: %s\n", "file of 1000000 points", million.file_mb,
               CHECK(million.file_mb <= 40.0) ? "kept" : "BROKEN");
    }
}

int main(void) {
    const char *const large_text = getenv("LARGE");
    const uint32_t large = large_text != NULL && *large_text != '\0'
                               ? (uint32_t)strtoul(large_text, NULL, 0)
                               : 10000000U;
    printf(
        "Objects of 100 points, 4 points a leaf; %d views, warm ones a step of 24,000 units from "
        "the last (the scene is 2^27 wide); coarse: for a picture 640 px wide, 90 degrees, with "
        "the largest "
        "loss;\nflat: cone_narrowest, CGAL: Min_sphere_of_spheres_d, over all points, %d views. "
        "RAM of an aim: %zu bytes.\n",
        VIEWS, FLAT_VIEWS, sizeof memory);
    printf("%-11s %9s %7s %7s | %7s %8s %6s %8s | %7s %8s %6s %7s | %7s %5s | %9s %9s %9s cone\n",
           "scene", "points", "MB", "build s", "cold", "%", "worst", "us", "warm", "%", "worst",
           "us", "coarse", "px", "flat", "ms", "CGAL ms");
    for (int scene = IN_A_BOX; scene < BENCH_SCENES; scene++) {
        measure_sizes((enum bench_scene)scene, large);
    }
    printf("RAM of an aim: %zu bytes, at most 65536: %s\n", sizeof memory,
           CHECK(sizeof memory <= 65536U) ? "kept" : "BROKEN");
    printf("%s\n", check_clean() ? "every bound is kept" : "A BOUND IS BROKEN");
    return check_clean() ? 0 : 1;
}
