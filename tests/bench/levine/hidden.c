/// Appendix III: the counters of the hidden lines, for every degree of yaw and of pitch.
#include "bench/levine/blocks.h"
#include "bench/levine/levine.h"
#include "bench/levine/sums.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/// The thesis does not say how far away the eye is, only that everything is in view.
#define DISTANCE 1.25
#define PLANES   64U ///< enough for each of the scenes

/// What is counted, in the order of the appendix, and how it is called there.
enum counter {
    FF,
    OC_I,
    OW_I,
    EEC_I,
    IC_I,
    ED,
    OC_HL,
    OW_HL,
    EEC_HL,
    IC_HL,
    AI_HL,
    CLIPPED,
    COUNTERS
};

struct frame {
    double counter[COUNTERS];
    /// By the pipeline with its counters, step 1 of that by itself, by the pipeline without
    /// counters (which asks for the order of those only whose windows meet), and by shadows.
    double seconds, depth_seconds, plain_seconds, clip_seconds;
    uint64_t parts, shadow_tests;
};

struct bench {
    struct blocks blocks;
    struct hidden hidden;
    struct separate separate;
    void *memory, *plane_memory;
    int repeats; ///< of the drawing by shadows, of which the quickest counts
};

static void open(struct bench *b, int repeats) {
    const struct shape_set *const set = &b->blocks.scene.set;
    const size_t bytes = hidden_workspace_bytes(set),
                 plane_bytes = SEPARATE_WORKSPACE_BYTES(set->object_count, PLANES);
    uint32_t fault[2];
    b->repeats = repeats;
    b->memory = malloc(bytes);
    b->plane_memory = malloc(plane_bytes);
    CHECK_EQ(hidden_open(&b->hidden, set, b->memory, bytes), HIDDEN_OK);
    CHECK_EQ(separate_build(&b->separate, set, PLANES, b->plane_memory, plane_bytes, fault),
             SEPARATE_OK);
}

static void close(struct bench *b) {
    free(b->memory);
    free(b->plane_memory);
    blocks_close(&b->blocks);
}

/// Step 1 by itself: the planes marked, and SO of every two objects.
static double depth_seconds(struct bench *b, struct vec3 eye) {
    const uint32_t count = b->blocks.scene.set.object_count;
    int64_t balance = 0;
    const double start = levine_seconds();
    separate_look(&b->separate, eye);
    for (uint32_t l = 0; l < count; l++) {
        for (uint32_t m = 0; m < count; m++) {
            balance += l != m ? separate_order(&b->separate, l, m) : 0;
        }
    }
    const double seconds = levine_seconds() - start;
    CHECK_EQ(balance, 0); // SO(l, m) = -SO(m, l)
    return seconds;
}

static struct frame draw(struct bench *b, const struct hidden_camera *camera) {
    struct hidden_counters n = {0};
    struct hidden_parts levine = {0, 0}, plain = {0, 0}, clip = {0, 0};
    const struct hidden_sink to_levine = {hidden_parts_add, &levine},
                             to_plain = {hidden_parts_add, &plain},
                             to_clip = {hidden_parts_add, &clip};
    struct frame frame = {.depth_seconds = depth_seconds(b, camera->eye)};
    const double start = levine_seconds();
    hidden_look(&b->hidden, camera);
    const double looked = levine_seconds();
    separate_look(&b->separate, camera->eye);
    hidden_levine(&b->hidden, &b->separate, &to_levine, &n);
    const double drawn = levine_seconds();
    separate_look(&b->separate, camera->eye);
    hidden_levine(&b->hidden, &b->separate, &to_plain, NULL);
    frame.plain_seconds = levine_seconds() - drawn + looked - start;
    frame.clip_seconds = INFINITY;
    for (int i = 0; i < b->repeats; i++) {
        clip = (struct hidden_parts){0, 0};
        const double again = levine_seconds();
        hidden_look(&b->hidden, camera);
        hidden_clip(&b->hidden, &to_clip);
        frame.clip_seconds = fmin(frame.clip_seconds, levine_seconds() - again);
    }
    frame.seconds = drawn - start;
    frame.parts = clip.count;
    frame.shadow_tests = b->hidden.shadow_tests;
    CHECK(clip.count == levine.count && clip.hash == levine.hash);
    CHECK(clip.count == plain.count && clip.hash == plain.hash);
    const uint64_t counts[COUNTERS] = {
        n.front_faces, n.start_objects, n.start_windows, n.start_edges, n.start_intersections,
        n.edges,       n.line_objects,  n.line_windows,  n.line_edges,  n.line_intersections,
        n.line_actual, n.clipped_pairs};
    for (int k = 0; k < COUNTERS; k++) {
        frame.counter[k] = (double)counts[k];
    }
    return frame;
}

static void add(struct frame *sum, const struct frame *frame, double share) {
    for (int k = 0; k < COUNTERS; k++) {
        sum->counter[k] += frame->counter[k] * share;
    }
    sum->seconds += frame->seconds * share;
    sum->depth_seconds += frame->depth_seconds * share;
    sum->plain_seconds += frame->plain_seconds * share;
    sum->clip_seconds += frame->clip_seconds * share;
    sum->parts += frame->parts;
    sum->shadow_tests += frame->shadow_tests;
}

/// The average of a turn of 360 degrees.
static struct frame turn_around(struct bench *b, enum block_turn turn, double distance) {
    struct frame sum = {.parts = 0};
    for (int degree = 0; degree < 360; degree++) {
        const struct hidden_camera camera = blocks_camera(&b->blocks, turn, degree, distance);
        const struct frame frame = draw(b, &camera);
        add(&sum, &frame, 1 / 360.0);
    }
    return sum;
}

static double ratio(const struct frame *f) {
    return f->counter[AI_HL] / f->counter[IC_HL];
}

static void print_row(const char *name, const char *turn, uint32_t objects, const struct frame *f) {
    printf("| %s | %s | %u |", name, turn, 12U * objects);
    for (int k = 0; k < COUNTERS; k++) {
        levine_cell(f->counter[k]);
    }
    levine_cell(ratio(f));
    printf("\n");
    fflush(stdout);
}

static void print_time(const char *name, uint32_t objects, const struct frame *f) {
    printf("| %s | %u | %.3f | %.1f | %.3f |\n", name, 12U * objects, 1e3 * f->seconds,
           100 * f->depth_seconds / f->seconds, 1e3 * f->clip_seconds);
}

/// AI/IC by where the eye is: what the thesis leaves open.
static void by_distance(void) {
    static const double distances[] = {1.1, 1.25, 1.5, 2, 3};
    static const enum block_scene scenes[] = {BLOCKS_16, BLOCKS_48, BLOCKS_CITY, BLOCKS_RANDOM};
    levine_table("hidden-distance");
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct bench b;
        blocks_open(&b.blocks, scenes[i]);
        open(&b, 1);
        printf("| %s |", blocks_name(scenes[i]));
        for (size_t d = 0; d < sizeof distances / sizeof *distances; d++) {
            const struct frame yaw = turn_around(&b, TURN_YAW, distances[d]),
                               pitch = turn_around(&b, TURN_PITCH, distances[d]);
            struct frame tilted = {.parts = 0};
            for (int k = 0; k < 360; k++) {
                const struct hidden_camera camera =
                    blocks_camera_tilted(&b.blocks, k + 0.5, 90 * sin(k), distances[d]);
                const struct frame frame = draw(&b, &camera);
                add(&tilted, &frame, 1 / 360.0);
            }
            levine_number(ratio(&yaw));
            printf(" /");
            levine_number(ratio(&pitch));
            printf(" /");
            levine_cell(ratio(&tilted));
        }
        printf("\n");
        close(&b);
    }
}

/// The same picture, rolled: only the rectangles of the edges change.
static struct hidden_camera rolled(struct hidden_camera camera, double degrees) {
    const double c = cos(degrees * 0.017453292519943295), s = sin(degrees * 0.017453292519943295);
    const struct vec3 r = camera.right, u = camera.up;
    camera.right = vec3((int32_t)lrint(c * r.x + s * u.x), (int32_t)lrint(c * r.y + s * u.y),
                        (int32_t)lrint(c * r.z + s * u.z));
    camera.up = vec3((int32_t)lrint(c * u.x - s * r.x), (int32_t)lrint(c * u.y - s * r.y),
                     (int32_t)lrint(c * u.z - s * r.z));
    return camera;
}

static void by_roll(void) {
    static const double rolls[] = {0, 5, 15, 45};
    static const enum block_scene scenes[] = {BLOCKS_16, BLOCKS_48, BLOCKS_CITY, BLOCKS_RANDOM};
    levine_table("hidden-roll");
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct bench b;
        blocks_open(&b.blocks, scenes[i]);
        open(&b, 1);
        printf("| %s |", blocks_name(scenes[i]));
        for (size_t k = 0; k < sizeof rolls / sizeof *rolls; k++) {
            struct frame sum = {.parts = 0};
            for (int degree = 0; degree < 360; degree++) {
                const struct hidden_camera camera =
                    rolled(blocks_camera(&b.blocks, TURN_YAW, degree, DISTANCE), rolls[k]);
                const struct frame frame = draw(&b, &camera);
                add(&sum, &frame, 1 / 360.0);
            }
            levine_cell(ratio(&sum));
        }
        printf("\n");
        close(&b);
    }
}

void levine_hidden(bool few) {
    static struct frame both[BLOCKS_COUNT];
    uint32_t objects[BLOCKS_COUNT];
    double least = 1, most = 0, x[6], y[6], depth_most = 0;
    levine_table("hidden");
    for (int k = 0; k < BLOCKS_COUNT; k++) {
        struct bench b;
        if (few && k != BLOCKS_4 && k != BLOCKS_8 && k != BLOCKS_CITY) {
            continue;
        }
        blocks_open(&b.blocks, (enum block_scene)k);
        open(&b, 1);
        objects[k] = b.blocks.scene.set.object_count;
        const struct frame yaw = turn_around(&b, TURN_YAW, DISTANCE),
                           pitch = turn_around(&b, TURN_PITCH, DISTANCE);
        both[k] = (struct frame){.parts = 0};
        add(&both[k], &yaw, 0.5);
        add(&both[k], &pitch, 0.5);
        print_row(blocks_name((enum block_scene)k), "yaw", objects[k], &yaw);
        print_row(blocks_name((enum block_scene)k), "pitch", objects[k], &pitch);
        print_row(blocks_name((enum block_scene)k), "both", objects[k], &both[k]);
        close(&b);
    }
    if (few) {
        return;
    }
    levine_table("hidden-time");
    for (int k = 0; k < BLOCKS_COUNT; k++) {
        print_time(blocks_name((enum block_scene)k), objects[k], &both[k]);
        least = k == BLOCKS_4 ? least : fmin(least, ratio(&both[k]));
        most = k == BLOCKS_4 ? most : fmax(most, ratio(&both[k]));
        depth_most = fmax(depth_most, 100 * both[k].depth_seconds / both[k].seconds);
        if (k <= BLOCKS_48) {
            x[k] = 12.0 * objects[k];
            y[k] = both[k].seconds;
        }
    }
    levine_value("distance", DISTANCE);
    levine_value("ai_ic_least", least);
    levine_value("ai_ic_most", most);
    levine_value("hidden_time", sums_exponent(x, y, 6));
    levine_value("time_48", 1e3 * both[BLOCKS_48].seconds);
    levine_value("time_city", 1e3 * both[BLOCKS_CITY].seconds);
    levine_value("depth_most", depth_most);
    by_distance();
    by_roll();
}

/// The counters of each degree, for the pictures: not a table of the text.
void levine_sweep(bool few) {
    static const enum block_scene scenes[] = {BLOCKS_CITY, BLOCKS_RANDOM, BLOCKS_48};
    for (size_t i = 0; i < (few ? 1U : sizeof scenes / sizeof *scenes); i++) {
        struct bench b;
        blocks_open(&b.blocks, scenes[i]);
        open(&b, 1);
        for (int degree = 0; degree < 720; degree++) {
            const struct hidden_camera camera = blocks_camera(
                &b.blocks, degree < 360 ? TURN_YAW : TURN_PITCH, degree % 360, DISTANCE);
            const struct frame frame = draw(&b, &camera);
            printf("@sweep %s;%s;%d", blocks_name(scenes[i]), degree < 360 ? "yaw" : "pitch",
                   degree % 360);
            for (int k = 0; k < COUNTERS; k++) {
                printf(";%.0f", frame.counter[k]);
            }
            printf("\n");
        }
        close(&b);
    }
}

/// Lattices up to 16 x 16 x 16, from all around at 20 views along no axis.
#define LARGE_VIEWS      20
#define LARGE_SIDES      5
#define LARGE_QUANTITIES 7
#define EXPONENT_MOST    1.3 ///< of the work and the time by shadows, the method for use

void levine_large(bool few) {
    static const uint32_t sides[LARGE_SIDES] = {4, 6, 8, 12, 16};
    struct frame mean[LARGE_SIDES];
    double x[LARGE_SIDES], y[LARGE_QUANTITIES][LARGE_SIDES];
    levine_table("large");
    for (int i = 0; i < (few ? 1 : LARGE_SIDES); i++) {
        struct bench b;
        blocks_open_lattice(&b.blocks, sides[i]);
        open(&b, few ? 1 : 5);
        mean[i] = (struct frame){.parts = 0};
        for (int v = 0; v < LARGE_VIEWS; v++) {
            const struct hidden_camera camera =
                blocks_camera_tilted(&b.blocks, 18.0 * v + 7, 60 * sin(v), DISTANCE);
            const struct frame frame = draw(&b, &camera);
            add(&mean[i], &frame, 1.0 / LARGE_VIEWS);
        }
        x[i] = sides[i] * sides[i] * sides[i];
        y[0][i] = mean[i].counter[IC_HL];
        y[1][i] = (double)mean[i].parts / LARGE_VIEWS;
        y[2][i] = mean[i].clip_seconds;
        y[3][i] = mean[i].seconds;
        y[4][i] = mean[i].plain_seconds;
        y[5][i] = mean[i].counter[IC_HL] / mean[i].counter[ED];
        y[6][i] = (double)mean[i].shadow_tests / LARGE_VIEWS;
        printf("| %.0f | %.0f | %.0f |", x[i], 12 * x[i],
               (double)(b.hidden.workspace_bytes + b.separate.workspace_bytes) / 1024);
        for (int k = ED; k < COUNTERS; k++) {
            levine_cell(mean[i].counter[k]);
        }
        levine_cell(y[6][i]);
        levine_cell(y[1][i]);
        printf("\n");
        fflush(stdout);
        close(&b);
    }
    if (few) {
        return;
    }
    levine_table("large-time");
    for (int i = 0; i < LARGE_SIDES; i++) {
        printf("| %.0f | %.2f | %.2f | %.2f | %.1f |\n", x[i], 1e3 * y[2][i], 1e3 * y[4][i],
               1e3 * y[3][i], 100 * mean[i].depth_seconds / mean[i].seconds);
    }
    static const char *const names[LARGE_QUANTITIES] = {
        "large_ic",         "large_parts", "large_clip_time", "large_time",
        "large_plain_time", "large_each",  "large_shadows"};
    for (int q = 0; q < LARGE_QUANTITIES; q++) {
        levine_value(names[q], sums_exponent(x, y[q], LARGE_SIDES));
    }
    const double work = sums_exponent(x, y[6], LARGE_SIDES),
                 time = sums_exponent(x, y[2], LARGE_SIDES);
    const bool kept = work <= EXPONENT_MOST && time <= EXPONENT_MOST;
    fprintf(stderr,
            "64 to 4,096 cubes: edges clipped grow as n^%.2f, time as n^%.2f, at most %.1f: %s\n",
            work, time, EXPONENT_MOST, kept ? "the bound is kept" : "THE BOUND IS BROKEN");
    CHECK(kept);
}
