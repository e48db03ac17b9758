/// firmware/target/target_set against a plain list that is searched from end to end.
#include "check.h"

#include "target/target_set.h"

static uint64_t seed;
static struct target_set set;
static uint8_t before[sizeof(struct target_set)];

static void fill(void *memory, size_t size, uint8_t value) {
    for (size_t i = 0; i < size; i++) {
        ((uint8_t *)memory)[i] = value;
    }
}

static void remember(void) {
    for (size_t i = 0; i < sizeof set; i++) {
        before[i] = ((const uint8_t *)&set)[i];
    }
}

static bool is_unchanged(void) {
    for (size_t i = 0; i < sizeof set; i++) {
        if (before[i] != ((const uint8_t *)&set)[i]) {
            return false;
        }
    }
    return true;
}

static void start(uint64_t expiry_us) {
    fill(&set, sizeof set, 0xA5);
    target_set_init(&set, (struct vec3_i64){0, 0, 0}, expiry_us);
}

static struct target_update at_direction(uint32_t id, int32_t x, int32_t y, int32_t z) {
    return (struct target_update){.kind = TARGET_DIRECTION,
                                  .id = id,
                                  .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                  .direction = {x, y, z}};
}

static struct target_update at_position(uint32_t id, int64_t x, int64_t y, int64_t z,
                                        uint32_t radius_um) {
    return (struct target_update){.kind = TARGET_POSITION,
                                  .id = id,
                                  .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                  .position_um = {x, y, z},
                                  .radius_um = radius_um};
}

static enum target_status apply(struct target_update update, uint64_t now_us) {
    return target_set_apply(&set, &update, now_us);
}

static enum target_status gone(uint32_t id) {
    return apply((struct target_update){.kind = TARGET_GONE, .id = id}, 0);
}

/// The one target in the set.
static struct target only(struct target_update update) {
    start(0);
    CHECK_EQ(apply(update, 0), TARGET_OK);
    CHECK_EQ(set.count, 1);
    return set.target[0];
}

static void starts_empty(void) {
    start(7);
    uint32_t place = 99;
    CHECK_EQ(set.count, 0);
    CHECK(!target_set_find(&set, 0, &place));
    CHECK_EQ(target_set_expire(&set, UINT64_MAX), 0);
    CHECK_EQ(gone(5), TARGET_OK);
    CHECK_EQ(set.version, 0);
}

static void keeps_what_it_is_told(void) {
    start(0);
    struct target_update update = at_direction(UINT32_MAX, 3, 4, 0);
    update.object = 65535;
    update.weight_q16 = 12345;
    update.radius_bam32 = BAM32_QUARTER - 1U;
    CHECK_EQ(apply(update, UINT64_C(1) << 40), TARGET_OK);
    uint32_t place = 99;
    CHECK(target_set_find(&set, UINT32_MAX, &place));
    CHECK_EQ(place, 0);
    CHECK(vec3_equal(set.direction_q30[0], vec3(644245094, 858993459, 0))); // 0.6, 0.8
    CHECK_EQ(set.target[0].id, UINT32_MAX);
    CHECK_EQ(set.target[0].object, 65535);
    CHECK_EQ(set.target[0].weight_q16, 12345);
    CHECK_EQ(set.target[0].radius_bam32, BAM32_QUARTER - 1U);
    CHECK_EQ(set.target[0].seen_us, INT64_C(1) << 40);
    CHECK(!target_set_find(&set, 0, &place));
}

static void version_grows_with_changes_only(void) {
    start(0);
    struct target_update update = at_direction(1, 0, 1, 0);
    uint32_t version = set.version;
    CHECK_EQ(apply(update, 1), TARGET_OK);
    CHECK_EQ(set.version, ++version);
    CHECK_EQ(apply(update, 2), TARGET_OK);
    CHECK_EQ(set.version, version); // said again: seen anew, nothing to solve
    CHECK_EQ(set.target[0].seen_us, 2);
    update.direction = vec3(0, 1000, 0);
    CHECK_EQ(apply(update, 2), TARGET_OK);
    CHECK_EQ(set.version, version); // the same direction
    update.direction = vec3(1, 1000, 0);
    CHECK_EQ(apply(update, 2), TARGET_OK);
    CHECK_EQ(set.version, ++version);
    update.radius_bam32 = 1;
    CHECK_EQ(apply(update, 2), TARGET_OK);
    CHECK_EQ(set.version, ++version);
    update.weight_q16 = 0;
    CHECK_EQ(apply(update, 2), TARGET_OK);
    CHECK_EQ(set.version, ++version);
    CHECK_EQ(gone(2), TARGET_OK);
    CHECK_EQ(set.version, version); // was not there
    CHECK_EQ(gone(1), TARGET_OK);
    CHECK_EQ(set.version, ++version);
    CHECK_EQ(apply((struct target_update){.kind = TARGET_CLEAR}, 3), TARGET_OK);
    CHECK_EQ(set.version, version); // was empty
    CHECK_EQ(apply(update, 4), TARGET_OK);
    CHECK_EQ(apply((struct target_update){.kind = TARGET_CLEAR}, 5), TARGET_OK);
    CHECK_EQ(set.version, version + 2U);
    CHECK_EQ(set.count, 0);
}

/// Reports that change nothing count while no target moves; a target moves from a report that
/// differs to one that does not.
static void rest_is_reported(void) {
    start(0);
    CHECK_EQ(set.rest_reports, 0);
    CHECK_EQ(apply(at_direction(1, 0, 1, 0), 0), TARGET_OK);
    CHECK_EQ(apply(at_direction(2, 0, 1, 0), 0), TARGET_OK);
    CHECK_EQ(set.rest_reports, 0); // new ones do not move
    CHECK_EQ(apply(at_direction(2, 0, 1, 0), 0), TARGET_OK);
    CHECK_EQ(set.rest_reports, 1);
    CHECK_EQ(apply(at_direction(1, 0, 1, 1), 0), TARGET_OK);
    CHECK_EQ(apply(at_direction(2, 0, 1, 0), 0), TARGET_OK); // 1 moves
    CHECK_EQ(set.rest_reports, 1);
    CHECK_EQ(set.moving_count, 1);
    CHECK_EQ(apply(at_direction(1, 0, 1, 2), 0), TARGET_OK);
    CHECK_EQ(set.moving_count, 1);
    CHECK_EQ(apply(at_direction(1, 0, 1, 2), 0), TARGET_OK); // it has stopped
    CHECK_EQ(set.rest_reports, 2);
    CHECK_EQ(set.moving_count, 0);
    CHECK_EQ(apply(at_direction(1, 0, 1, 3), 0), TARGET_OK);
    CHECK_EQ(gone(1), TARGET_OK); // it left while it moved
    CHECK_EQ(apply(at_direction(2, 0, 1, 0), 0), TARGET_OK);
    CHECK_EQ(set.rest_reports, 3);
    CHECK_EQ(apply(at_direction(2, 1, 0, 0), 0), TARGET_OK);
    CHECK_EQ(apply((struct target_update){.kind = TARGET_CLEAR}, 0), TARGET_OK);
    CHECK_EQ(apply(at_direction(2, 1, 0, 0), 0), TARGET_OK);
    CHECK_EQ(apply(at_direction(2, 1, 0, 0), 0), TARGET_OK);
    CHECK_EQ(set.rest_reports, 4);
}

static void directions_of_any_length(void) {
    start(0);
    CHECK_EQ(apply(at_direction(1, INT32_MIN, 0, 0), 0), TARGET_OK);
    CHECK(vec3_equal(set.direction_q30[0], vec3(-Q30_ONE, 0, 0)));
    CHECK_EQ(apply(at_direction(2, INT32_MIN, INT32_MIN, INT32_MIN), 0), TARGET_OK);
    CHECK(vec3_equal(set.direction_q30[1], vec3(-619925131, -619925131, -619925131)));
    CHECK_EQ(apply(at_direction(3, 0, 0, -1), 0), TARGET_OK);
    CHECK(vec3_equal(set.direction_q30[2], vec3(0, 0, -Q30_ONE)));
}

static void refuse(struct target_update update, enum target_status wanted) {
    remember();
    CHECK_EQ(apply(update, 1000), wanted);
    CHECK(is_unchanged());
}

static void an_error_changes_nothing(void) {
    const int64_t most = TARGET_POSITION_UM_MAX;
    start(10);
    CHECK_EQ(apply(at_direction(1, 1, 2, 3), 5), TARGET_OK);
    refuse(at_direction(1, 0, 0, 0), TARGET_ERROR_RANGE);
    refuse(at_position(1, most + 1, 0, 0, 0), TARGET_ERROR_RANGE);
    refuse(at_position(1, 0, -most - 1, 0, 0), TARGET_ERROR_RANGE);
    refuse(at_position(2, 0, 0, INT64_MIN, 0), TARGET_ERROR_RANGE);
    refuse(at_position(2, INT64_MAX, 0, 0, 0), TARGET_ERROR_RANGE);
    refuse(at_position(2, 0, 0, 0, 0), TARGET_ERROR_VIEWPOINT);
    refuse(at_position(1, 0, 0, 0, UINT32_MAX), TARGET_ERROR_VIEWPOINT);
    struct target_update wide = at_direction(1, 1, 0, 0);
    wide.radius_bam32 = BAM32_QUARTER;
    refuse(wide, TARGET_ERROR_RANGE);
    wide.radius_bam32 = UINT32_MAX;
    refuse(wide, TARGET_ERROR_RANGE);
    wide.kind = (enum target_kind)(TARGET_CLEAR + 1);
    refuse(wide, TARGET_ERROR_RANGE);
    wide.kind = (enum target_kind)250;
    refuse(wide, TARGET_ERROR_RANGE);
}

static void positions_reach_the_corners(void) {
    const int64_t most = TARGET_POSITION_UM_MAX;
    target_set_init(&set, (struct vec3_i64){-most, most, -most}, 0);
    CHECK_EQ(apply(at_position(1, most, -most, most, UINT32_MAX), 0), TARGET_OK);
    CHECK(vec3_equal(set.direction_q30[0], vec3(619925131, -619925131, 619925131)));
    CHECK_NEAR(set.target[0].radius_bam32, 189, 1); // 2^32 um at 1.56e16 um: 2.753e-7 rad, 188.2
    CHECK_EQ(apply(at_position(2, -most, most, 1 - most, 0), 0), TARGET_OK);
    CHECK(vec3_equal(set.direction_q30[1], vec3(0, 0, Q30_ONE)));
    CHECK_EQ(set.target[1].radius_bam32, 0);
    refuse(at_position(3, -most, most, -most, 0), TARGET_ERROR_VIEWPOINT);
    // Small differences of large coordinates are exact.
    CHECK_EQ(apply(at_position(4, 3 - most, most - 4, -most, 0), 0), TARGET_OK);
    CHECK(vec3_equal(set.direction_q30[2], vec3(644245094, -858993459, 0)));
}

/// The cone that touches the sphere; tests/property/target_radius.c has the random cases.
static void spheres(void) {
    CHECK_NEAR(only(at_position(1, 0, 2000000, 0, 1000000)).radius_bam32, 357913942, 200);
    CHECK_NEAR(only(at_position(1, 1000000, 1000000, 0, 1000000)).radius_bam32, 536870912, 200);
    CHECK_EQ(only(at_position(1, 5, 0, 0, 0)).radius_bam32, 0);
    CHECK(only(at_position(1, INT64_C(1) << 50, 0, 0, 1)).radius_bam32 >= 1U);
    const struct target almost_inside =
        only(at_position(1, UINT32_MAX + INT64_C(1), 0, 0, UINT32_MAX));
    CHECK_NEAR(almost_inside.radius_bam32, BAM32_QUARTER, 20000);
    CHECK(almost_inside.radius_bam32 < BAM32_QUARTER);
}

/// Whether the sphere holds the viewpoint is decided exactly, also between whole micrometres.
static void spheres_round_the_viewpoint(void) {
    start(0);
    CHECK_EQ(apply(at_position(1, 3, 4, 0, 4), 0), TARGET_OK);
    refuse(at_position(2, 3, 4, 0, 5), TARGET_ERROR_VIEWPOINT);
    refuse(at_position(2, 3, 4, 0, 6), TARGET_ERROR_VIEWPOINT);
    CHECK_EQ(apply(at_position(2, 2, 1, 0, 2), 0), TARGET_OK); // at 2.236
    refuse(at_position(3, 2, 1, 0, 3), TARGET_ERROR_VIEWPOINT);
    CHECK_EQ(apply(at_position(3, -1, 1, 0, 1), 0), TARGET_OK);
    // 4294967295^2 + 1: farther than the radius by 2^-33 um.
    CHECK_EQ(apply(at_position(4, UINT32_MAX, 1, 0, UINT32_MAX), 0), TARGET_OK);
    refuse(at_position(5, UINT32_MAX, 0, 0, UINT32_MAX), TARGET_ERROR_VIEWPOINT);
}

static void holds_256(void) {
    start(0);
    for (uint32_t i = 0; i < TARGET_CAPACITY; i++) {
        CHECK_EQ(apply(at_direction(1000U * i, (int32_t)i, 1, 0), i), TARGET_OK);
    }
    CHECK_EQ(set.count, TARGET_CAPACITY);
    refuse(at_direction(7, 1, 1, 1), TARGET_ERROR_FULL);
    refuse(at_direction(7, 0, 0, 0), TARGET_ERROR_RANGE);
    CHECK_EQ(apply(at_direction(255000, -1, 0, 0), 9), TARGET_OK); // one that it holds
    CHECK_EQ(set.count, TARGET_CAPACITY);
    CHECK_EQ(gone(0), TARGET_OK);
    CHECK_EQ(apply(at_direction(7, 1, 1, 1), 9), TARGET_OK);
    refuse(at_direction(0, 1, 1, 1), TARGET_ERROR_FULL);
    uint32_t place = 0;
    CHECK(target_set_find(&set, 7, &place));
    CHECK(target_set_find(&set, 255000, &place));
    CHECK(!target_set_find(&set, 0, &place));
}

static void expires_after_the_time_not_at_it(void) {
    const uint64_t t = UINT64_C(0xFFFFFFFFF0);
    start(100);
    CHECK_EQ(apply(at_direction(1, 1, 0, 0), t), TARGET_OK);
    CHECK_EQ(apply(at_direction(2, 1, 0, 0), t + 1U), TARGET_OK);
    CHECK_EQ(target_set_expire(&set, t + 100U), 0);
    CHECK_EQ(set.count, 2);
    CHECK_EQ(target_set_expire(&set, t + 101U), 1);
    CHECK_EQ(set.target[0].id, 2);
    CHECK_EQ(apply(at_direction(2, 1, 0, 0), t + 101U), TARGET_OK); // heard of again
    CHECK_EQ(target_set_expire(&set, t + 201U), 0);
    CHECK_EQ(target_set_expire(&set, t + 202U), 1);
    CHECK_EQ(set.count, 0);
    // A set that was empty starts its clock anew.
    CHECK_EQ(apply(at_direction(3, 1, 0, 0), t + 1000U), TARGET_OK);
    CHECK_EQ(target_set_expire(&set, t + 1100U), 0);
    CHECK_EQ(target_set_expire(&set, t + 1101U), 1);

    start(0);
    CHECK_EQ(apply(at_direction(1, 1, 0, 0), 0), TARGET_OK);
    CHECK_EQ(target_set_expire(&set, UINT64_MAX), 0);
}

// ---------------------------------------------------------------- against a list

#define KNOWN_IDS 320U

static struct {
    bool present, moves;
    uint64_t seen_us;
    struct vec3 direction;
} model[KNOWN_IDS];
static uint32_t known_id[KNOWN_IDS];

static void check_against_model(bool all) {
    uint32_t count = 0, moving = 0;
    for (uint32_t i = 0; i < KNOWN_IDS; i++) {
        count += model[i].present;
        moving += model[i].present && model[i].moves;
    }
    CHECK_EQ(set.moving_count, moving);
    CHECK_EQ(set.count, count);
    const uint32_t step = all ? 1U : 37U;
    for (uint32_t i = (uint32_t)(check_random(&seed) % step); i < KNOWN_IDS && check_clean();
         i += step) {
        uint32_t place = 0;
        CHECK_EQ(target_set_find(&set, known_id[i], &place), model[i].present);
        if (model[i].present && CHECK(place < set.count)) {
            CHECK_EQ(set.target[place].id, known_id[i]);
            CHECK_EQ(set.target[place].seen_us, model[i].seen_us);
            CHECK(set.oldest_us <= model[i].seen_us);
            CHECK(vec3_equal(set.direction_q30[place], model[i].direction));
        }
    }
}

static void step_both(uint32_t i, uint64_t now_us, uint32_t count) {
    const uint64_t dice = check_random(&seed) % 100U;
    const struct vec3 axes[3] = {{Q30_ONE, 0, 0}, {0, -Q30_ONE, 0}, {0, 0, Q30_ONE}};
    if (dice < 60U) {
        const struct vec3 d = axes[check_random(&seed) % 3U];
        const bool fits = model[i].present || count < TARGET_CAPACITY;
        CHECK_EQ(apply(at_direction(known_id[i], d.x, d.y, d.z), now_us),
                 fits ? TARGET_OK : TARGET_ERROR_FULL);
        if (fits) {
            model[i].moves = model[i].present && !vec3_equal(model[i].direction, d);
            model[i].present = true;
            model[i].seen_us = now_us;
            model[i].direction = d;
        }
    } else if (dice < 99U) {
        CHECK_EQ(gone(known_id[i]), TARGET_OK);
        model[i].present = false;
    } else {
        uint32_t due = 0;
        for (uint32_t k = 0; k < KNOWN_IDS; k++) {
            if (set.expiry_us != 0U && model[k].present &&
                now_us - model[k].seen_us > set.expiry_us) {
                model[k].present = false;
                due++;
            }
        }
        CHECK_EQ(target_set_expire(&set, now_us), due);
    }
}

/// expiry_us 0 to 3000 at 1 to 8 us a step: from an almost empty set to a full one.
static void run_model(uint64_t first_seed, uint64_t expiry_us, uint32_t steps) {
    seed = first_seed;
    check_note("seed", (int64_t)seed);
    start(expiry_us);
    uint64_t now_us = UINT64_C(0xFFFFF000);
    for (uint32_t i = 0; i < KNOWN_IDS; i++) {
        model[i].present = false;
    }
    for (uint32_t step = 0; step < steps && check_clean(); step++) {
        now_us += check_random(&seed) % 8U;
        const uint32_t version = set.version, count = set.count;
        step_both((uint32_t)(check_random(&seed) % KNOWN_IDS), now_us, count);
        CHECK(set.version != version || set.count == count);
        check_against_model(step % 512U == 0U);
    }
    check_against_model(true);
}

static void random_against_a_list(void) {
    for (uint32_t i = 0; i < KNOWN_IDS; i++) {
        known_id[i] = (uint32_t)check_random(&seed);
    }
    known_id[0] = 0;
    known_id[1] = UINT32_MAX;
    run_model(1, 0, 20000);
    run_model(2, 800, 20000);
    run_model(3, 3000, 20000);
    run_model(4, 0, 20000);
}

/// Ids that all want the slots round the end of the index: the worst runs, and they wrap.
static void collisions_against_a_list(void) {
    uint32_t inverse = UINT32_C(2654435761); // Newton: each round doubles the right bits
    for (int i = 0; i < 5; i++) {
        inverse *= 2U - UINT32_C(2654435761) * inverse;
    }
    for (uint32_t i = 0; i < KNOWN_IDS; i++) {
        known_id[i] = inverse * (((500U + i % 3U * 5U) << 23) + i);
    }
    run_model(5, 0, 20000);
    run_model(6, 2000, 20000);
}

int main(void) {
    seed = 0x7A26;
    TEST(starts_empty);
    TEST(keeps_what_it_is_told);
    TEST(version_grows_with_changes_only);
    TEST(rest_is_reported);
    TEST(directions_of_any_length);
    TEST(an_error_changes_nothing);
    TEST(positions_reach_the_corners);
    TEST(spheres);
    TEST(spheres_round_the_viewpoint);
    TEST(holds_256);
    TEST(expires_after_the_time_not_at_it);
    TEST(random_against_a_list);
    TEST(collisions_against_a_list);
    return check_finish();
}
