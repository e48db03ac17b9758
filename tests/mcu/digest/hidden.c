/// Hidden lines: solids and planes, also out of a tree, the planes between them, and pictures by
/// both methods; targets that they hide.
#include "mcu/digest/sets.h"

#include "scene/hidden.h"
#include "scene/tree_shape.h"
#include "target/occlusion.h"

#define ROOM 96U
static struct vec3 vertices[ROOM];
static uint32_t corners[8U * ROOM];
static struct shape_face faces[2U * ROOM];
static struct shape_plane planes[2U * ROOM];
static struct shape_edge edges[2U * ROOM];
static struct shape_object objects[8];
static uint64_t workspace[8000], more[400];

static struct vec3 draw_place(struct digest *d, uint32_t reach) {
    struct vec3 p;
    p.x = digest_within(d, reach);
    p.y = digest_within(d, reach);
    p.z = digest_within(d, reach);
    return p;
}

static const uint32_t box_faces[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                       2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};

static void draw_box(struct digest *d, struct shape_set *set) {
    static const uint32_t box_sizes[6] = {4, 4, 4, 4, 4, 4};
    const struct vec3 low = draw_place(d, 40000000);
    const struct vec3 a = draw_place(d, 30000000), b = draw_place(d, 30000000),
                      c = draw_place(d, 30000000);
    struct vec3 p[8];
    uint32_t fault;
    for (int i = 0; i < 8; i++) {
        const int x = i & 1, y = i >> 1 & 1, z = i >> 2;
        p[i] = vec3(low.x + x * a.x + y * b.x + z * c.x, low.y + x * a.y + y * b.y + z * c.y,
                    low.z + x * a.z + y * b.z + z * c.z);
    }
    digest_i64(d, shape_add_solid(set, p, 8, box_faces, box_sizes, 6, NULL, &fault));
    digest_u64(d, fault);
}

static void draw_plane(struct digest *d, struct shape_set *set) {
    const int32_t y = digest_within(d, 60000000);
    const struct vec3 notch = vec3(digest_within(d, 9000000), y, 5000000);
    const struct vec3 outline[4] = {vec3(-20000000, y, -20000000), notch,
                                    vec3(20000000, y, -20000000), vec3(0, y, 30000000)};
    digest_i64(d, shape_add_plane(set, outline, 4, false));
}

static void fold(void *context, const struct hidden_segment *segment) {
    struct digest *const d = context;
    digest_u64(d, segment->edge);
    digest_i64(d, fraction_q62(segment->part.from));
    digest_i128(d, segment->part.to.num);
    digest_i128(d, segment->part.to.den);
}

static struct shape_set empty_set(void) {
    return (struct shape_set){.vertices = vertices,
                              .corners = corners,
                              .faces = faces,
                              .planes = planes,
                              .edges = edges,
                              .objects = objects,
                              .vertex_room = ROOM,
                              .corner_room = 8U * ROOM,
                              .face_room = 2U * ROOM,
                              .edge_room = 2U * ROOM,
                              .object_room = 8};
}

static void pictures(void) {
    struct digest d = digest_start(61);
    const struct hidden_sink sink = {fold, &d};
    const int32_t one = INT32_C(1) << 30;
    for (int i = 0; i < 60; i++) {
        struct shape_set set = empty_set();
        static struct hidden hidden;
        struct separate separate;
        struct hidden_counters counters = {0};
        uint32_t fault[2];
        for (int k = 0; k < 6; k++) {
            draw_box(&d, &set);
        }
        draw_plane(&d, &set);
        const enum separate_status apart =
            separate_build(&separate, &set, 24, more, sizeof more, fault);
        digest_i64(&d, apart);
        digest_u64(&d, fault[1]);
        const struct hidden_camera camera = {
            draw_place(&d, 200000000), vec3(one, 0, 0), vec3(0, one, 0),
            vec3(0, 0, one),           1 << 16,         1 << 15};
        if (!CHECK_EQ(hidden_open(&hidden, &set, workspace, sizeof workspace), HIDDEN_OK)) {
            return;
        }
        hidden_look(&hidden, &camera);
        hidden_clip(&hidden, &sink);
        if (apart == SEPARATE_OK) {
            separate_look(&separate, camera.eye);
            hidden_levine(&hidden, &separate, &sink, &counters);
            digest_u64(&d, counters.line_actual);
        }
    }
    digest_finish(&d, "digest scene/hidden");
}

static struct shape_set boxes_of(struct digest *d) {
    struct shape_set set = empty_set();
    for (int k = 0; k < 6; k++) {
        draw_box(d, &set);
    }
    return set;
}

/// A box whose corners stand among other points of a tree, taken over with a table of places and
/// by searching.
static void out_of_a_tree(void) {
    struct digest d = digest_start(71);
    static struct tree_point points[64];
    static struct tree_element elements[6];
    static uint32_t tree_corners[24], source[8], listed[24], counts[6], place[64];
    static struct vec3 found[8];
    static const struct tree_shape shape = {.kind = TREE_SOLID, .element_count = 6};
    const struct tree tree = {.points = points, .elements = elements, .corners = tree_corners};
    struct tree_shape_memory memory = {.points = found,
                                       .source = source,
                                       .corners = listed,
                                       .counts = counts,
                                       .point_room = 8,
                                       .corner_room = 24,
                                       .face_room = 6};
    for (unsigned i = 0; i < 64U; i++) {
        place[i] = SHAPE_NONE;
    }
    for (unsigned i = 0; i < 200U; i++) {
        struct shape_set set = empty_set();
        const uint32_t stride = 2U * digest_below(&d, 4) + 1U, first = digest_below(&d, 64);
        const int32_t side = 1 + (int32_t)digest_below(&d, 1000000);
        for (uint32_t k = 0; k < 8U; k++) {
            points[(first + k * stride) % 64U] =
                (struct tree_point){side * (int32_t)(k & 1U), side * (int32_t)(k >> 1 & 1U),
                                    side * (int32_t)(k >> 2), k};
        }
        for (uint32_t k = 0; k < 24U; k++) {
            tree_corners[k] = (first + box_faces[k] * stride) % 64U;
            elements[k / 4U] = (struct tree_element){TREE_FACE, k / 4U * 4U, 4};
        }
        memory.place = i % 2U == 0U ? place : NULL;
        const unsigned finer = digest_below(&d, 9);
        digest_i64(&d, tree_shape_add_solid(&set, &tree, &shape, finer, &memory));
        digest_i64(&d, tree_shape_add_face(&set, &tree, &elements[i % 6U], finer, &memory));
        digest_u64(&d, set.corner_count);
        for (uint32_t v = 0; v < set.vertex_count; v++) {
            digest_vec3(&d, set.vertices[v]);
        }
    }
    digest_finish(&d, "digest scene/tree_shape");
}

static void report_all(struct digest *d, struct occlusion *occlusion, uint64_t now_us) {
    for (uint32_t id = 0; id < 8U; id++) {
        struct target_update update = {
            .kind = TARGET_POSITION, .id = id, .weight_q16 = TARGET_WEIGHT_ONE_Q16};
        update.position_um.x = (int64_t)digest_within(d, 90000000) * 10;
        update.position_um.y = (int64_t)digest_within(d, 90000000) * 10;
        update.position_um.z = (int64_t)digest_within(d, 90000000) * 10;
        update.radius_um = id % 2U == 0U ? 0U : digest_below(d, 50000000);
        digest_u64(d, occlusion_report(occlusion, &update, now_us));
    }
}

static void hidden_targets(void) {
    struct digest d = digest_start(67);
    static struct occlusion occlusion;
    for (int i = 0; i < 20; i++) {
        const struct shape_set set = boxes_of(&d);
        static const enum occlusion_policy policies[] = {OCCLUSION_CALM, OCCLUSION_DROP,
                                                         OCCLUSION_WEIGH};
        const struct occlusion_config config = {.shapes = &set,
                                                .units = units_of_um(10),
                                                .settings = {.policy = policies[i % 3],
                                                             .frame_us = 40000,
                                                             .ahead_us = 400000,
                                                             .fade_us = 200000,
                                                             .hidden_q16 = 20000}};
        struct target_update update;
        CHECK(occlusion_init(&occlusion, &config, workspace, sizeof workspace));
        for (uint64_t now_us = 0; now_us < 200000U; now_us += 40000U) {
            // Every other world stands still: that is looked at in another way.
            const int64_t moves = i / 3 % 2;
            const struct vec3_i64 offset = {(int64_t)now_us * 100 * moves, 0, 0},
                                  velocity = {100000000 * moves, 0, -5000000 * moves};
            occlusion_move(&occlusion, 0, offset, velocity, now_us);
            report_all(&d, &occlusion, now_us);
            occlusion_step(&occlusion, now_us, true);
            while (occlusion_next(&occlusion, &update)) {
                digest_vec3_i64(&d, update.position_um);
                digest_u64(&d, update.radius_um);
                digest_u64(&d, update.weight_q16);
            }
        }
    }
    digest_finish(&d, "digest target/occlusion");
}

int main(void) {
    TEST(pictures);
    TEST(out_of_a_tree);
    TEST(hidden_targets);
    return check_finish();
}
