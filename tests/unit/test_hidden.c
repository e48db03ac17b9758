/// Hidden lines in small scenes with answers by hand; the thesis' own example.
#include "check.h"

#include "scene/hidden.h"

// ---------------------------------------------------------------- a scene

#define ROOM 64U
static struct vec3 vertices[ROOM];
static uint32_t corners[8U * ROOM];
static struct shape_face faces[ROOM];
static struct shape_plane planes[ROOM];
static struct shape_edge edges[2U * ROOM];
static struct shape_object objects[8];
static uint64_t workspace[20000], more[200];

static struct shape_set empty_set(void) {
    return (struct shape_set){.vertices = vertices,
                              .corners = corners,
                              .faces = faces,
                              .planes = planes,
                              .edges = edges,
                              .objects = objects,
                              .vertex_room = ROOM,
                              .corner_room = 8U * ROOM,
                              .face_room = ROOM,
                              .edge_room = 2U * ROOM,
                              .object_room = 8};
}

static const uint32_t box_faces[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                       2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
static const uint32_t box_sizes[6] = {4, 4, 4, 4, 4, 4};

static enum shape_status add_box(struct shape_set *set, struct vec3 low, struct vec3 high) {
    struct vec3 p[8];
    uint32_t fault;
    for (int i = 0; i < 8; i++) {
        p[i] = vec3((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                    (i & 4) != 0 ? high.z : low.z);
    }
    return shape_add_solid(set, p, 8, box_faces, box_sizes, 6, NULL, &fault);
}

struct picture {
    struct hidden_segment segment[64];
    uint32_t count;
};

static void keep(void *context, const struct hidden_segment *segment) {
    struct picture *const p = context;
    if (p->count < 64U) {
        p->segment[p->count] = *segment;
    }
    p->count++;
}

/// Looks along +y.
static struct hidden_camera camera_at(int32_t x, int32_t y, int32_t z) {
    const int32_t one = INT32_C(1) << 30;
    return (struct hidden_camera){
        vec3(x, y, z), vec3(one, 0, 0), vec3(0, one, 0), vec3(0, 0, one), 0, 0};
}

static void look(const struct shape_set *set, const struct hidden_camera *camera,
                 struct picture *clip, struct picture *levine, struct hidden_counters *counters) {
    struct hidden hidden;
    struct separate separate;
    uint32_t fault[2];
    clip->count = levine->count = 0;
    const struct hidden_sink to_clip = {keep, clip}, to_levine = {keep, levine};
    if (!CHECK_EQ(hidden_open(&hidden, set, workspace, sizeof workspace), HIDDEN_OK) ||
        !CHECK_EQ(separate_build(&separate, set, 8, more, sizeof more, fault), SEPARATE_OK)) {
        return;
    }
    hidden_look(&hidden, camera);
    hidden_clip(&hidden, &to_clip);
    separate_look(&separate, camera->eye);
    *counters = (struct hidden_counters){0};
    hidden_levine(&hidden, &separate, &to_levine, counters);
}

static bool is_part(const struct hidden_segment *s, int32_t from, int32_t to, int32_t of) {
    const struct fraction a = {i128_from_i64(from), i128_from_i64(of)},
                          b = {i128_from_i64(to), i128_from_i64(of)};
    return fraction_cmp(s->part.from, a) == 0 && fraction_cmp(s->part.to, b) == 0;
}

// ---------------------------------------------------------------- tests

/// Chapter VI, figure 6.1: sides of the planes A to D, and the eye's.
static void sepl_of_the_thesis(void) {
    // Bit j is plane j: + is 1. The eye is on the minus side of A, B, C, the plus side of D.
    static uint32_t side[5] = {0x6, 0x2, 0x3, 0xA, 0x0}, both[5] = {0xE, 0xF, 0xF, 0xF, 0xB};
    static uint32_t eye[1] = {0x8}, level[1] = {0};
    static const int8_t so[5][5] = {{0, -1, -1, -1, -1},
                                    {1, 0, 1, -1, -1},
                                    {1, -1, 0, -1, -1},
                                    {1, 1, 1, 0, 0},
                                    {1, 1, 1, 0, 0}};
    const struct separate s = {
        .side = side, .both = both, .eye = eye, .level = level, .plane_count = 4, .row_words = 1};
    for (uint32_t l = 0; l < 5U; l++) {
        for (uint32_t m = 0; m < 5U; m++) {
            if (l != m) {
                CHECK_EQ(separate_order(&s, l, m), so[l][m]);
            }
        }
    }
    // Seen from on plane A, the only one between 2 and 3 besides C: they can't hide each other.
    level[0] = 0x1;
    CHECK_EQ(separate_order(&s, 1, 2), SEPARATE_NEITHER);
    level[0] = 0;
}

/// An edge from -2 to 2 behind a diamond with corners at 1: hidden exactly between -1 and 1,
/// through two corners.
static void diamond(void) {
    static const uint32_t ends[2] = {0, 1};
    struct shape_set set = empty_set();
    static struct picture clip, levine;
    struct hidden_counters counters;
    const struct vec3 outline[4] = {vec3(-1, 10, 0), vec3(0, 10, -1), vec3(1, 10, 0),
                                    vec3(0, 10, 1)};
    const struct vec3 line[2] = {vec3(-4, 20, 0), vec3(4, 20, 0)};
    CHECK_EQ(shape_add_plane(&set, outline, 4, false), SHAPE_OK);
    CHECK_EQ(shape_add_wire(&set, line, 2, ends, 1), SHAPE_OK);
    const struct hidden_camera camera = camera_at(0, 0, 0);
    look(&set, &camera, &clip, &levine, &counters);
    CHECK_EQ(clip.count, 6);
    CHECK_EQ(levine.count, 6);
    CHECK(is_part(&clip.segment[4], 0, 1, 4) && is_part(&clip.segment[5], 3, 4, 4));
    CHECK(is_part(&levine.segment[4], 0, 1, 4) && is_part(&levine.segment[5], 3, 4, 4));
}

/// An arrow is cut along the line from its notch to its tip; an edge behind it that runs along just
/// that line is hidden there, too.
static void along_a_cut(void) {
    static const uint32_t ends[2] = {0, 1};
    struct shape_set set = empty_set();
    static struct picture clip, levine;
    struct hidden_counters counters;
    const struct vec3 arrow[4] = {vec3(0, 10, 0), vec3(2, 10, 1), vec3(4, 10, 0), vec3(2, 10, 4)};
    const struct vec3 line[2] = {vec3(4, 20, -2), vec3(4, 20, 12)};
    CHECK_EQ(shape_add_plane(&set, arrow, 4, false), SHAPE_OK);
    CHECK_EQ(shape_add_wire(&set, line, 2, ends, 1), SHAPE_OK);
    const struct hidden_camera camera = camera_at(0, 0, 0);
    look(&set, &camera, &clip, &levine, &counters);
    CHECK_EQ(clip.count, 6);
    CHECK(is_part(&clip.segment[4], 0, 4, 14) && is_part(&clip.segment[5], 10, 14, 14));
    CHECK_EQ(levine.count, 6);
    CHECK(is_part(&levine.segment[4], 0, 4, 14) && is_part(&levine.segment[5], 10, 14, 14));
}

/// A box whose front face lies in the plane of an arrow, partly in the arrow: what is in the plane
/// is not beyond it.
static void in_one_plane(void) {
    struct shape_set set = empty_set();
    static struct picture clip, levine;
    struct hidden_counters counters;
    const struct vec3 arrow[4] = {vec3(0, 100, 0), vec3(20, 100, 10), vec3(40, 100, 0),
                                  vec3(20, 100, 40)};
    CHECK_EQ(shape_add_plane(&set, arrow, 4, false), SHAPE_OK);
    CHECK_EQ(add_box(&set, vec3(15, 100, 15), vec3(35, 120, 25)), SHAPE_OK);
    const struct hidden_camera camera = camera_at(20, 0, 20);
    look(&set, &camera, &clip, &levine, &counters);
    CHECK_EQ(clip.count, 8);
    CHECK_EQ(levine.count, 8);
}

/// A small box in front of a large one, both straight ahead: counters by hand.
static void counters_of_two_boxes(void) {
    struct shape_set set = empty_set();
    static struct picture clip, levine;
    struct hidden_counters c;
    // In the picture the small one takes -0.3 to 0.1 across and -0.1 to 0.1 up, the large one -0.2
    // to 0.2 each way: its left upright edge is hidden in the middle.
    CHECK_EQ(add_box(&set, vec3(-30, 100, -10), vec3(10, 120, 10)), SHAPE_OK);
    CHECK_EQ(add_box(&set, vec3(-40, 200, -40), vec3(40, 210, 40)), SHAPE_OK);
    const struct hidden_camera camera = camera_at(0, 0, 0);
    look(&set, &camera, &clip, &levine, &c);
    CHECK_EQ(clip.count, 9); // four edges of each front; the left one of the large in two parts
    CHECK_EQ(levine.count, 9);
    CHECK_EQ(c.front_faces, 2);
    CHECK_EQ(c.edges, 8);
    CHECK_EQ(c.start_objects, 1); // of the large one; nothing can hide the small one
    CHECK_EQ(c.start_windows, 0); // its first corner is beside the small one's window
    CHECK_EQ(c.line_objects, 4);
    CHECK_EQ(c.line_windows, 1); // only the left edge passes it
    CHECK_EQ(c.line_edges, 4);
    CHECK_EQ(c.line_intersections, 2);
    CHECK_EQ(c.line_actual, 2);
    CHECK_EQ(c.clipped_pairs, 0);
}

/// An edge that runs from behind the viewer to the front: what is behind is cut off.
static void behind_the_viewer(void) {
    static const uint32_t ends[2] = {0, 1};
    struct shape_set set = empty_set();
    static struct picture clip, levine;
    struct hidden_counters counters;
    const struct vec3 line[2] = {vec3(-5, -10, 1), vec3(-5, 30, 1)};
    CHECK_EQ(shape_add_wire(&set, line, 2, ends, 1), SHAPE_OK);
    const struct hidden_camera camera = camera_at(0, 0, 0);
    look(&set, &camera, &clip, &levine, &counters);
    CHECK_EQ(clip.count, 1);
    CHECK(is_part(&clip.segment[0], 1, 4, 4));
    CHECK(levine.count == 1U && is_part(&levine.segment[0], 1, 4, 4));
}

static void bad_shapes(void) {
    struct shape_set set = empty_set();
    struct vec3 p[8];
    uint32_t fault;
    for (int i = 0; i < 8; i++) {
        p[i] = vec3(10 * (i & 1), 10 * (i >> 1 & 1), 10 * (i >> 2));
    }
    p[7].z = 11; // three faces bend
    CHECK_EQ(shape_add_solid(&set, p, 8, box_faces, box_sizes, 6, NULL, &fault), SHAPE_ERROR_FLAT);
    CHECK_EQ(fault, 1);
    p[7].z = 10;
    CHECK_EQ(shape_add_solid(&set, p, 8, box_faces, box_sizes, 5, NULL, &fault),
             SHAPE_ERROR_CLOSED);
    uint32_t inward[24];
    for (uint32_t i = 0; i < 24U; i++) {
        inward[i] = box_faces[i / 4U * 4U + 3U - i % 4U];
    }
    CHECK_EQ(shape_add_solid(&set, p, 8, inward, box_sizes, 6, NULL, &fault), SHAPE_ERROR_CONVEX);
    p[0].x = SHAPE_COORDINATE_MAX + 1;
    CHECK_EQ(shape_add_solid(&set, p, 8, box_faces, box_sizes, 6, NULL, &fault), SHAPE_ERROR_RANGE);
    const struct vec3 bow[4] = {vec3(0, 0, 0), vec3(9, 9, 0), vec3(9, 0, 0), vec3(0, 9, 0)};
    CHECK_EQ(shape_add_plane(&set, bow, 4, false), SHAPE_ERROR_OUTLINE);
    const struct vec3 bent[4] = {vec3(0, 0, 0), vec3(9, 0, 0), vec3(9, 9, 1), vec3(0, 9, 0)};
    CHECK_EQ(shape_add_plane(&set, bent, 4, false), SHAPE_ERROR_FLAT);
    CHECK_EQ(shape_add_plane(&set, bent, 4, true), SHAPE_OK);
    CHECK_EQ(set.object_count, 1);
    set.object_room = 1;
    CHECK_EQ(add_box(&set, vec3(0, 0, 0), vec3(1, 1, 1)), SHAPE_ERROR_CAPACITY);
}

/// Two boxes, one in the other by a unit: no plane is between them, and they are told.
static void not_apart(void) {
    struct shape_set set = empty_set();
    struct separate separate;
    uint32_t fault[2];
    CHECK_EQ(add_box(&set, vec3(0, 0, 0), vec3(10, 10, 10)), SHAPE_OK);
    CHECK_EQ(add_box(&set, vec3(10, 0, 0), vec3(20, 10, 10)), SHAPE_OK); // touching is apart
    CHECK_EQ(separate_build(&separate, &set, 8, more, sizeof more, fault), SEPARATE_OK);
    CHECK_EQ(add_box(&set, vec3(19, 9, 9), vec3(30, 30, 30)), SHAPE_OK);
    CHECK_EQ(separate_build(&separate, &set, 8, more, sizeof more, fault), SEPARATE_ERROR_PAIR);
    CHECK_EQ(fault[0], 1);
    CHECK_EQ(fault[1], 2);
}

int main(void) {
    TEST(sepl_of_the_thesis);
    TEST(diamond);
    TEST(along_a_cut);
    TEST(in_one_plane);
    TEST(counters_of_two_boxes);
    TEST(behind_the_viewer);
    TEST(bad_shapes);
    TEST(not_apart);
    return check_finish();
}
