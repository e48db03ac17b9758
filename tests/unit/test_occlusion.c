/// firmware/target/occlusion: what comes out, besides who is in sight (tests/property/occlusion.c).
#include "check.h"

#include "target/occlusion.h"

#define METRE INT64_C(1000000)
#define FRAME 40000U

// ---------------------------------------------------------------- a wall

/// From the origin, 10 m north, it hides what is beyond it east of the middle.
static struct vec3 vertices[16];
static uint32_t corners[64];
static struct shape_face faces[12];
static struct shape_plane planes[12];
static struct shape_edge edges[32];
static struct shape_object objects[2];
static struct shape_set set;
static uint64_t workspace[4096];
static struct occlusion_config config;
static struct occlusion occlusion, slow;

static void build_wall(void) {
    static const uint32_t all[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                     2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4};
    struct vec3 corner[8];
    uint32_t fault;
    for (int i = 0; i < 8; i++) {
        corner[i] = vec3((i & 1) != 0 ? 20000 : 0, (i & 2) != 0 ? 10500 : 10000,
                         (i & 4) != 0 ? 9000 : -9000);
    }
    set = (struct shape_set){.vertices = vertices,
                             .corners = corners,
                             .faces = faces,
                             .planes = planes,
                             .edges = edges,
                             .objects = objects,
                             .vertex_room = 16,
                             .corner_room = 64,
                             .face_room = 12,
                             .edge_room = 32,
                             .object_room = 2};
    CHECK_EQ(shape_add_solid(&set, corner, 8, all, sizes, 6, NULL, &fault), SHAPE_OK);
}

static struct occlusion_settings settings(enum occlusion_policy policy) {
    return (struct occlusion_settings){.policy = policy,
                                       .frame_us = FRAME,
                                       .ahead_us = 2000000,
                                       .fade_us = 400000,
                                       .hidden_q16 = 16384};
}

static void open(enum occlusion_policy policy) {
    build_wall();
    config = (struct occlusion_config){
        .shapes = &set, .units = units_of_um(1000), .settings = settings(policy)};
    CHECK(occlusion_init(&occlusion, &config, workspace, sizeof workspace));
}

static struct target_update at(uint32_t id, int64_t x_um, int64_t y_um) {
    return (struct target_update){.kind = TARGET_POSITION,
                                  .id = id,
                                  .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                  .position_um = {x_um, y_um, 0}};
}

static void report(struct occlusion *o, struct target_update update, uint64_t now_us) {
    CHECK(occlusion_report(o, &update, now_us));
}

/// The update of an id in the frame that comes out; kind TARGET_CLEAR: there is none.
static struct target_update out[OCCLUSION_TARGETS_MAX];
static uint32_t out_count;

static void take_all(struct occlusion *o) {
    out_count = 0;
    while (out_count < OCCLUSION_TARGETS_MAX && occlusion_next(o, &out[out_count])) {
        out_count++;
    }
}

static struct target_update out_of(uint32_t id) {
    for (uint32_t i = 0; i < out_count; i++) {
        if (out[i].id == id) {
            return out[i];
        }
    }
    return (struct target_update){.kind = TARGET_CLEAR};
}

// ---------------------------------------------------------------- policies

/// Ann stands in sight, Bob behind the wall. After the fade.
static struct target_update bob_of(enum occlusion_policy policy) {
    open(policy);
    for (uint64_t now_us = 0; now_us <= 1000000U; now_us += FRAME) {
        report(&occlusion, at(1, -4 * METRE, 20 * METRE), now_us);
        report(&occlusion, at(2, 8 * METRE, 20 * METRE), now_us);
        occlusion_step(&occlusion, now_us, true);
        take_all(&occlusion);
    }
    const struct target_update ann = out_of(1);
    CHECK(ann.position_um.x == -4 * METRE && ann.weight_q16 == TARGET_WEIGHT_ONE_Q16);
    return out_of(2);
}

static void what_a_hidden_target_counts(void) {
    CHECK_EQ(bob_of(OCCLUSION_DROP).weight_q16, 0);
    CHECK_EQ(bob_of(OCCLUSION_CALM).weight_q16, 0);
    // A quarter of the way from Ann, the middle of those in sight, to his own place.
    const struct target_update bob = bob_of(OCCLUSION_WEIGH);
    CHECK_EQ(bob.weight_q16, TARGET_WEIGHT_ONE_Q16);
    CHECK_NEAR(bob.position_um.x, -1 * METRE, 2000);
    CHECK_NEAR(bob.position_um.y, 20 * METRE, 2000);
    open(OCCLUSION_IGNORE);
    const struct target_update any = at(2, 8 * METRE, 20 * METRE);
    CHECK(!occlusion_report(&occlusion, &any, 0));
    occlusion_step(&occlusion, 0, true);
    take_all(&occlusion);
    CHECK_EQ(out_count, 0);
}

/// The same with stars: a direction turns from the one in sight.
static void directions_turn(void) {
    open(OCCLUSION_WEIGH);
    const struct target_update east = {.kind = TARGET_DIRECTION,
                                       .id = 2,
                                       .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                       .direction = {100, 1000, 0}},
                               north = {.kind = TARGET_DIRECTION,
                                        .id = 1,
                                        .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                        .direction = {-1, 1000, 0}};
    for (uint64_t now_us = 0; now_us <= 1000000U; now_us += FRAME) {
        report(&occlusion, north, now_us);
        report(&occlusion, east, now_us);
        occlusion_step(&occlusion, now_us, true);
        take_all(&occlusion);
    }
    const struct vec3 d = out_of(2).direction;
    // A quarter of the way from -1 to 100 milliradians.
    CHECK_NEAR((int64_t)d.x * 1000 / d.y, 24, 1);
    CHECK_EQ(out_of(1).direction.x, -1);
}

/// In every frame of a fade a target moves by little: its level is smooth.
static void no_jumps(void) {
    open(OCCLUSION_CALM);
    int64_t last = 0, most = 0;
    for (uint64_t now_us = 0; now_us <= 6000000U; now_us += FRAME) {
        // Bob walks from sight behind the wall, at 1 m/s, and stays in there.
        const int64_t bob = -2 * METRE + (int64_t)(now_us < 4000000U ? now_us : 4000000U);
        report(&occlusion, at(1, -4 * METRE, 20 * METRE), now_us);
        report(&occlusion, at(2, bob, 20 * METRE), now_us);
        occlusion_step(&occlusion, now_us, true);
        take_all(&occlusion);
        const struct target_update update = out_of(2);
        if (update.weight_q16 == 0U) {
            continue; // the last place was Ann's, near enough
        }
        const int64_t way = update.position_um.x - last;
        most = now_us > 0U && way * way > most * most ? way : most;
        last = update.position_um.x;
    }
    CHECK_EQ(out_of(2).weight_q16, 0);
    // 40 mm of his own; 3.6 m in 10 frames, at up to 1.5 times the mean, and the middle goes, too.
    check_note("the largest step of a frame, in mm", most / 1000);
    CHECK(most > -800000 && most < 100000);
    CHECK_NEAR(last, -4 * METRE, 400000);
}

// ---------------------------------------------------------------- units of work

static bool same(const struct target_update *a, const struct target_update *b) {
    return a->kind == b->kind && a->id == b->id && a->weight_q16 == b->weight_q16 &&
           a->position_um.x == b->position_um.x && a->position_um.y == b->position_um.y &&
           a->position_um.z == b->position_um.z && a->radius_um == b->radius_um;
}

/// In units of work, with enough of them for a look between two frames, what comes out is what a
/// computer would have given out, a frame later for what was decided.
static void in_units(void) {
    open(OCCLUSION_CALM);
    CHECK(occlusion_init(&slow, &config, workspace + 2048, sizeof workspace / 2));
    uint32_t units_most = 0, differences = 0, compared = 0;
    for (uint64_t now_us = 0; now_us <= 4000000U; now_us += FRAME) {
        for (uint32_t id = 1; id <= 20U; id++) {
            const int64_t x = (int64_t)id * METRE - 12 * METRE + (int64_t)(now_us / 2U) * (id % 3U);
            struct target_update update = at(id, x, (12 + (int64_t)id % 5) * METRE);
            update.radius_um = id % 2U * 400000U;
            report(&occlusion, update, now_us);
            report(&slow, update, now_us);
        }
        // The frame, with what is known; then the look of this moment.
        occlusion_step(&slow, now_us, false);
        uint32_t units = 0;
        while (occlusion_work(&slow, now_us)) {
            units++;
        }
        units_most = units > units_most ? units : units_most;
        occlusion_step(&occlusion, now_us, true);
        take_all(&occlusion);
        struct target_update update;
        CHECK(!occlusion_work(&slow, now_us));
        for (uint32_t i = 0; occlusion_next(&slow, &update); i++) {
            const struct occlusion_target *const a = &occlusion.target[i], *const b =
                                                                               &slow.target[i];
            CHECK(update.id == out[i].id);
            CHECK(a->samples == b->samples && a->counts == b->counts);
            CHECK(a->hides_us == b->hides_us && a->shows_us == b->shows_us);
            compared++;
            differences += !same(&update, &out[i]);
        }
    }
    CHECK_EQ(compared, 101 * 20);
    CHECK(differences > 0U && differences < compared / 2U); // while someone fades
    check_note("units of a frame and a look at 20 targets, at most", units_most);
    CHECK(units_most > 60U);
}

/// Targets come and go between the units: nothing is lost or taken for another.
static void come_and_go(void) {
    uint64_t random = 72;
    open(OCCLUSION_CALM);
    bool there[16] = {false};
    for (uint64_t now_us = 0; now_us < 8000000U && check_clean(); now_us += 1000U) {
        const uint32_t id = (uint32_t)(check_random(&random) >> 60);
        if (check_random(&random) % 8U == 0U) {
            const struct target_update gone = {.kind = TARGET_GONE, .id = id};
            CHECK(!occlusion_report(&occlusion, &gone, now_us));
            there[id] = false;
        } else {
            report(&occlusion, at(id, (int64_t)id * METRE - 8 * METRE, 20 * METRE), now_us);
            there[id] = true;
        }
        occlusion_step(&occlusion, now_us, false);
        (void)occlusion_work(&occlusion, now_us);
        take_all(&occlusion);
        for (uint32_t i = 0; i < out_count; i++) {
            CHECK(there[out[i].id] && out[i].kind == TARGET_POSITION);
        }
    }
    uint32_t count = 0;
    for (unsigned i = 0; i < 16U; i++) {
        count += there[i];
    }
    CHECK_EQ(occlusion.target_count, count);
    for (uint32_t i = 0; i < count; i++) {
        CHECK(there[occlusion.target[i].last.id]);
    }
}

// ---------------------------------------------------------------- who leaves

static void cleared_and_told_again(void) {
    const struct target_update clear = {.kind = TARGET_CLEAR};
    open(OCCLUSION_DROP);
    report(&occlusion, at(1, 0, 5 * METRE), 0);
    report(&occlusion, at(2, METRE, 5 * METRE), 0);
    occlusion_step(&occlusion, 0, true);
    take_all(&occlusion);
    CHECK_EQ(out_count, 2);
    CHECK(occlusion_report(&occlusion, &clear, FRAME));
    report(&occlusion, at(1, 0, 5 * METRE), FRAME);
    occlusion_step(&occlusion, FRAME, true); // a frame of the source may still be on its way
    take_all(&occlusion);
    CHECK(out_count == 2U && out_of(2).kind == TARGET_POSITION);
    occlusion_step(&occlusion, 2U * FRAME, true);
    take_all(&occlusion);
    CHECK(out_of(1).kind == TARGET_POSITION && out_of(2).kind == TARGET_GONE);
    CHECK_EQ(occlusion.target_count, 1);
}

static void not_heard_of(void) {
    open(OCCLUSION_CALM);
    config.expiry_us = 500000;
    uint32_t gone = 0;
    report(&occlusion, at(1, 0, 5 * METRE), 0);
    for (uint64_t now_us = 0; now_us <= 1000000U; now_us += FRAME) {
        report(&occlusion, at(2, METRE, 5 * METRE), now_us);
        occlusion_step(&occlusion, now_us, true);
        take_all(&occlusion);
        gone += out_of(1).kind == TARGET_GONE;
        CHECK(now_us <= 500000U || now_us > 520000U || out_of(1).kind == TARGET_GONE);
    }
    CHECK(gone == 1U && occlusion.target_count == 1U);
}

/// What is told while a frame is being made, in units of work, is not older than the frame.
static void told_within_a_frame(void) {
    const struct target_update clear = {.kind = TARGET_CLEAR};
    open(OCCLUSION_CALM);
    config.expiry_us = 500000;
    report(&occlusion, at(1, 0, 5 * METRE), 0);
    for (uint64_t now_us = 0; now_us <= 400000U; now_us += FRAME) {
        occlusion_step(&occlusion, now_us, false);
        report(&occlusion, at(1, 0, 5 * METRE), now_us + 1000U);
        CHECK(now_us != 200000U || occlusion_report(&occlusion, &clear, now_us + 1000U));
        while (occlusion_work(&occlusion, now_us + 2000U)) {
        }
        take_all(&occlusion);
        CHECK_EQ(out_of(1).kind, TARGET_POSITION);
    }
}

/// However often it is told of: a new target in sight counts in full from its first frame on, and
/// one that was told of once and comes into sight does not jump in.
static void new_ones(void) {
    open(OCCLUSION_CALM);
    report(&occlusion, at(1, -4 * METRE, 20 * METRE), 0);
    occlusion_step(&occlusion, 0, true);
    take_all(&occlusion);
    for (uint64_t now_us = 1000; now_us < 40000U; now_us += 1000U) {
        report(&occlusion, at(2, -8 * METRE, 20 * METRE), now_us);
    }
    report(&occlusion, at(3, 8 * METRE, 20 * METRE), 39000U);
    occlusion_step(&occlusion, FRAME, true);
    take_all(&occlusion);
    CHECK_EQ(out_of(2).position_um.x, -8 * METRE);
    CHECK_EQ(out_of(3).weight_q16, 0);
    occlusion_move(&occlusion, 0, (struct vec3_i64){1000 * METRE, 0, 0}, (struct vec3_i64){0, 0, 0},
                   FRAME);
    occlusion_step(&occlusion, 2U * FRAME, true); // the wall is gone
    take_all(&occlusion);
    CHECK(out_of(3).position_um.x < 0);
}

/// One that falls silent goes on for as long as we look ahead, and then stands.
static void silent(void) {
    open(OCCLUSION_CALM);
    for (uint64_t now_us = 0; now_us <= 10000000U; now_us += FRAME) {
        if (now_us <= 1000000U) {
            report(&occlusion, at(1, -30 * METRE + (int64_t)now_us, 5 * METRE), now_us);
        }
        occlusion_step(&occlusion, now_us, true);
        take_all(&occlusion);
    }
    CHECK_NEAR(out_of(1).position_um.x, -27 * METRE, 50000); // a second, and two more
}

static void more_than_there_is_room_for(void) {
    const struct target_update clear = {.kind = TARGET_CLEAR};
    open(OCCLUSION_DROP);
    for (uint32_t id = 0; id < OCCLUSION_TARGETS_MAX; id++) {
        report(&occlusion, at(id, 0, 5 * METRE), 0);
    }
    const struct target_update more = at(1000, 0, 5 * METRE);
    CHECK(!occlusion_report(&occlusion, &more, 0));
    CHECK(!occlusion_report(&occlusion, &clear, 0)); // the controller has to hear of it
    CHECK_EQ(occlusion.target_count, 0);
    CHECK(occlusion_report(&occlusion, &more, 0));
}

// ---------------------------------------------------------------- objects

static struct target_update of_object(struct target_update update, uint16_t object) {
    update.object = object;
    return update;
}

/// Object 1: Ann in sight, Bob hidden. Object 2: hidden as a whole.
static void tell_objects(bool by_object) {
    open(OCCLUSION_WEIGH);
    occlusion_by_object(&occlusion, by_object);
    for (uint64_t now_us = 0; now_us <= 1000000U; now_us += FRAME) {
        report(&occlusion, of_object(at(1, -4 * METRE, 20 * METRE), 1), now_us);
        report(&occlusion, of_object(at(2, 8 * METRE, 20 * METRE), 1), now_us);
        report(&occlusion, of_object(at(3, 12 * METRE, 20 * METRE), 2), now_us);
        report(&occlusion, of_object(at(4, -20 * METRE, 20 * METRE), 3), now_us);
        occlusion_step(&occlusion, now_us, true);
        take_all(&occlusion);
    }
}

static void objects_by_themselves(void) {
    tell_objects(true);
    CHECK_NEAR(out_of(2).position_um.x, -1 * METRE, 2000); // from Ann
    CHECK_NEAR(out_of(3).position_um.x, 12 * METRE, 0);    // nobody of it is in sight: as it was
    tell_objects(false);
    CHECK_NEAR(out_of(2).position_um.x, -7 * METRE, 2000); // from -12, the middle of ids 1 and 4
    CHECK_NEAR(out_of(3).position_um.x, -6 * METRE, 2000);
}

// ---------------------------------------------------------------- shadows that are given

static void given_shadows(void) {
    open(OCCLUSION_DROP);
    static struct sight_bound bounds[32];
    static struct sight_piece pieces[4];
    struct sight sight = {.bounds = bounds, .pieces = pieces, .bound_room = 32, .piece_room = 4};
    CHECK_EQ(sight_add(&sight, &set, 0), 1);
    const struct occlusion_config of_shadows = {.units = units_of_um(1000),
                                                .settings = settings(OCCLUSION_DROP)};
    CHECK(occlusion_init_shadows(&slow, &of_shadows, &sight));
    report(&slow, at(1, -4 * METRE, 20 * METRE), 0);
    report(&slow, at(2, 8 * METRE, 20 * METRE), 0);
    occlusion_step(&slow, 0, true);
    take_all(&slow);
    CHECK(out_of(1).weight_q16 != 0U && out_of(2).weight_q16 == 0U);
    CHECK(!occlusion_init_shadows(&slow, &config, &sight)); // it has shapes
}

static void settings_out_of_range(void) {
    static const struct occlusion_settings bad[] = {
        {OCCLUSION_CALM, 999, 2000000, 400000, 0},  {OCCLUSION_CALM, 1000001, 2000000, 0, 0},
        {OCCLUSION_CALM, 40000, 400000, 400001, 0}, {OCCLUSION_CALM, 40000, 10000001, 0, 0},
        {OCCLUSION_CALM, 1000, 129000, 0, 0},       {OCCLUSION_WEIGH, 40000, 400000, 0, 65537},
    };
    open(OCCLUSION_CALM);
    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        config.settings = bad[i];
        CHECK(!occlusion_init(&slow, &config, workspace, sizeof workspace));
    }
    open(OCCLUSION_CALM);
    CHECK(!occlusion_init(&slow, &config, workspace, occlusion_workspace_bytes(&set) - 1U));
    config.viewpoint_um.y = METRE * SHAPE_COORDINATE_MAX; // in millimetres too far
    CHECK(!occlusion_init(&slow, &config, workspace, sizeof workspace));
}

int main(void) {
    TEST(what_a_hidden_target_counts);
    TEST(directions_turn);
    TEST(no_jumps);
    TEST(in_units);
    TEST(come_and_go);
    TEST(cleared_and_told_again);
    TEST(not_heard_of);
    TEST(told_within_a_frame);
    TEST(new_ones);
    TEST(silent);
    TEST(more_than_there_is_room_for);
    TEST(objects_by_themselves);
    TEST(given_shadows);
    TEST(settings_out_of_range);
    return check_finish();
}
