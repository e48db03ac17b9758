/// firmware/aim/framing: which targets are framed, and what their radii do. The cone itself has its
/// own tests; the widening at random radii is in tests/property/framing_radii.c.
#include "check.h"

#include "aim/framing.h"

#define DEGREES_45 UINT32_C(0x20000000)

static struct target_set set;
static struct framing_workspace workspace;
static struct framing framing;

static void start(void) {
    target_set_init(&set, (struct vec3_i64){0, 0, 0}, 0);
    workspace.memory.count = 0;
    framing = (struct framing){.status = FRAMING_OK, .framed_count = 77};
}

static void add(uint32_t id, int32_t x, int32_t y, int32_t z, uint32_t weight_q16,
                uint32_t radius_bam32) {
    const struct target_update update = {.kind = TARGET_DIRECTION,
                                         .id = id,
                                         .weight_q16 = weight_q16,
                                         .direction = {x, y, z},
                                         .radius_bam32 = radius_bam32};
    CHECK_EQ(target_set_apply(&set, &update, 0), TARGET_OK);
}

/// Solves; the status is told twice.
static enum framing_status solve(void) {
    const enum framing_status status = framing_solve(&set, &workspace, &framing);
    CHECK_EQ(framing.status, status);
    return status;
}

static void nothing_to_frame(void) {
    start();
    CHECK_EQ(solve(), FRAMING_EMPTY);
    CHECK_EQ(framing.framed_count, 0);
    add(1, 1, 0, 0, 0, 0);
    add(2, -1, 0, 0, 0, 500);
    CHECK_EQ(solve(), FRAMING_EMPTY);
    CHECK_EQ(framing.framed_count, 0);
}

static void one_target(void) {
    start();
    add(1, 0, 5, 0, 1, 0);
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK(vec3_equal(framing.ahead_q30, vec3(0, Q30_ONE, 0)));
    CHECK_NEAR(framing.half_angle_bam32.bam, 1, 1);
    CHECK_EQ(framing.framed_count, 1);
    add(1, 0, 5, 0, 1, DEGREES_45);
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK_NEAR(framing.half_angle_bam32.bam, DEGREES_45 + 1U, 1);
    CHECK(framing.half_angle_bam32.bam >= DEGREES_45);
}

static void two_targets(void) {
    start();
    add(1, 1, 0, 0, 1, 0);
    add(2, 0, 1, 0, UINT32_MAX, 0); // any positive weight counts alike
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK_NEAR(framing.ahead_q30.x, 759250125, 1);
    CHECK_NEAR(framing.ahead_q30.y, 759250125, 1);
    CHECK_EQ(framing.ahead_q30.z, 0);
    CHECK_NEAR(framing.half_angle_bam32.bam, DEGREES_45 + 1U, 1);
    CHECK(framing.half_angle_bam32.bam >= DEGREES_45);
}

/// The axis moves toward the larger radius by half the difference.
static void radii_widen_and_turn(void) {
    start();
    add(1, 1, 0, 0, 1, 0);
    add(2, 0, 1, 0, 1, 1000000);
    add(3, 1, 1, 0, 1, DEGREES_45 + 2000000U); // in the middle, reaching farther than the others
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK_NEAR(framing.ahead_q30.x, framing.ahead_q30.y, 1);
    CHECK_NEAR(framing.half_angle_bam32.bam, DEGREES_45 + 2000000U, 8);
    add(3, 1, 1, 0, 1, DEGREES_45 - 600000U); // held by the others' cone
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK_NEAR(framing.half_angle_bam32.bam, DEGREES_45 + 500000U, 8);
    // 500,000 BAM are 731.5 microradians.
    CHECK_NEAR(framing.ahead_q30.y - framing.ahead_q30.x, 1110720, 40);
}

static void weight_0_is_kept_but_not_framed(void) {
    start();
    add(1, 0, 0, -1, 0, BAM32_QUARTER - 1U);
    add(2, 1, 0, 0, 1, 0);
    add(3, 0, 0, 1, 0, 0);
    add(4, 0, 1, 0, 1, 0);
    CHECK_EQ(solve(), FRAMING_OK); // with the others it would be infeasible
    CHECK_EQ(framing.framed_count, 2);
    CHECK_NEAR(framing.half_angle_bam32.bam, DEGREES_45 + 1U, 1);
    CHECK_EQ(set.count, 4);
    add(1, 0, 0, -1, 1, 0);
    add(3, 0, 0, 1, 1, 0);
    CHECK_EQ(solve(), FRAMING_INFEASIBLE);
    CHECK_EQ(framing.framed_count, 4);
    add(3, 0, 0, 1, 0, 0);
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK_EQ(framing.framed_count, 3);
}

static void infeasible(void) {
    start();
    add(1, 1, 0, 0, 1, 0);
    add(2, -1, 0, 0, 1, 0);
    CHECK_EQ(solve(), FRAMING_INFEASIBLE);
    CHECK_EQ(framing.framed_count, 2);
    start();
    add(1, 2, 0, 1, 1, 0);
    add(2, -1, 2, 1, 1, 0);
    add(3, -1, -2, 1, 1, 0);
    CHECK_EQ(solve(), FRAMING_OK);
    add(4, 0, 0, -1, 1, 0);
    CHECK_EQ(solve(), FRAMING_INFEASIBLE);
    start(); // 0.9 and 1.1 microradians below 90 degrees
    add(1, 1000000000, 900, 0, 1, 0);
    add(2, -1000000000, 900, 0, 1, 0);
    CHECK_EQ(solve(), FRAMING_INFEASIBLE);
    add(1, 1000000000, 1100, 0, 1, 0);
    add(2, -1000000000, 1100, 0, 1, 0);
    CHECK_EQ(solve(), FRAMING_OK);
}

/// Radii never make a set infeasible: where no cone below 90 degrees holds them, it is that of the
/// centres.
static void wide_radii(void) {
    start();
    add(1, 1000, 0, 1, 1, BAM32_QUARTER - 1U);
    add(2, -1000, 0, 1, 1, BAM32_QUARTER - 1U);
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK(vec3_equal(framing.ahead_q30, vec3(0, 0, Q30_ONE)));
    CHECK_EQ(framing.half_angle_bam32.bam, BAM32_HALF);
    start();
    const struct target_update inside = {.kind = TARGET_POSITION,
                                         .id = 1,
                                         .weight_q16 = 1,
                                         .position_um = {UINT32_MAX, 1, 0},
                                         .radius_um = UINT32_MAX};
    CHECK_EQ(target_set_apply(&set, &inside, 0), TARGET_OK);
    CHECK(set.target[0].radius_bam32 > BAM32_QUARTER);
    add(2, -INT32_MAX, 100000, 0, 1, 0);
    add(3, -INT32_MAX, 200000, 0, 1, 0);
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK_EQ(framing.half_angle_bam32.bam, BAM32_HALF);
}

static void a_full_set(void) {
    start();
    for (uint32_t i = 0; i < TARGET_CAPACITY; i++) { // every second one off to the side, weight 0
        add(i, i % 2U == 0U ? (int32_t)i - 100 : 100000, 1000, 0, i % 2U == 0U ? 1U : 0U, 0);
    }
    CHECK_EQ(solve(), FRAMING_OK);
    CHECK_EQ(framing.framed_count, 128);
    // From atan(-0.1) to atan(0.154): half of 14.4653 degrees.
    CHECK_NEAR(framing.half_angle_bam32.bam, 86289000, 1000);
}

// ---------------------------------------------------------------- pictures

static const struct framing_picture wide_picture = {
    .width = 400, .height = 300, .base = {{Q30_ONE, 0, 0}, {0, Q30_ONE, 0}, {0, 0, Q30_ONE}}};

/// In calls of this work, to the end. Returns how many.
static int follow_picture(uint32_t work_limit) {
    const struct framing_choice all = {0};
    int calls = 0;
    do {
        (void)framing_follow(&set, all, &wide_picture, &workspace.memory, work_limit, &workspace,
                             &framing);
        calls++;
    } while (framing.refining && calls < 5000);
    CHECK(calls < 5000);
    return calls;
}

static void start_picture(void) {
    start();
    workspace.memory = (struct framing_memory){0};
}

/// Two targets 45 degrees to either side, at the height of the eye: the picture's width.
static void a_picture_of_two(void) {
    start_picture();
    add(1, 1, 1, 0, 1, 0);
    add(2, -1, 1, 0, 1, 0);
    (void)follow_picture(0);
    CHECK_EQ(framing.status, FRAMING_OK);
    CHECK(framing.is_picture);
    CHECK_NEAR(bam32_signed(framing.pan_bam32), 0, 30);
    CHECK_NEAR(bam32_signed(framing.tilt_bam32), 0, 50000);
    CHECK_NEAR(framing.half_width_bam32.bam, DEGREES_45, 30);
    CHECK(framing.half_width_bam32.bam >= DEGREES_45);
    CHECK_NEAR(framing.half_height_bam32.bam, 439875000, 100000); // atan(3 / 4)
    CHECK_NEAR(framing.half_angle_bam32.bam, 612871000, 1000000); // atan(5 / 4)
}

/// High targets decide by the height, and a radius counts like an angle.
static void a_picture_of_two_heights(void) {
    start_picture();
    add(1, 0, 1, 1, 1, 0);
    add(2, 0, 1, 0, 1, 2000000);
    (void)follow_picture(0);
    CHECK_EQ(framing.status, FRAMING_OK);
    CHECK_NEAR(bam32_signed(framing.pan_bam32), 0, 100000000); // anything that keeps them inside
    CHECK_NEAR(framing.tilt_bam32.bam, DEGREES_45 / 2U - 1000000U, 1000);
    CHECK_NEAR(framing.half_height_bam32.bam, DEGREES_45 / 2U + 1000000U, 40);
    CHECK(framing.half_height_bam32.bam >= DEGREES_45 / 2U + 1000000U);
}

/// The end is the same in small steps, each of which holds all; and after a rest nothing is done.
static void a_picture_in_steps(void) {
    start_picture();
    for (uint32_t i = 0; i < 100U; i++) {
        add(i, (int32_t)(i * 7919U % 601U) - 300, (int32_t)(i * 104729U % 401U) - 200, 500, 1,
            i % 5U * 1000000U);
    }
    const int calls = follow_picture(2500);
    check_note("calls", calls);
    CHECK(calls > 3);
    const struct framing small = framing;
    start_picture();
    for (uint32_t i = 0; i < 100U; i++) {
        add(i, (int32_t)(i * 7919U % 601U) - 300, (int32_t)(i * 104729U % 401U) - 200, 500, 1,
            i % 5U * 1000000U);
    }
    CHECK_EQ(follow_picture(0), 1);
    CHECK_NEAR(small.half_width_bam32.bam, framing.half_width_bam32.bam, 20);
    CHECK_NEAR(small.half_height_bam32.bam, framing.half_height_bam32.bam, 20);
}

/// Targets that leave take their places in the search with them.
static void a_picture_of_some_that_leave(void) {
    start_picture();
    for (uint32_t i = 0; i < 40U; i++) {
        add(i, (int32_t)i * 20 - 400, 1000, (int32_t)(i % 7U) * 50, 1, 0);
    }
    (void)follow_picture(2500);
    for (uint32_t i = 0; i < 40U; i++) {
        if (i != 17U && i != 21U) {
            const struct target_update gone = {.kind = TARGET_GONE, .id = i};
            CHECK_EQ(target_set_apply(&set, &gone, 0), TARGET_OK);
        }
    }
    (void)follow_picture(2500);
    CHECK_EQ(framing.framed_count, 2);
    const bam32_t both = framing.half_width_bam32;
    start_picture();
    add(17, -60, 1000, 150, 1, 0);
    add(21, 20, 1000, 0, 1, 0);
    (void)follow_picture(0);
    CHECK_NEAR(framing.half_width_bam32.bam, both.bam, 20);
}

/// What no direction sees has no picture, also after one that had; at the very edge neither.
static void no_picture(void) {
    start_picture();
    (void)follow_picture(2500);
    CHECK_EQ(framing.status, FRAMING_EMPTY);
    add(1, 1, 0, 0, 1, 0);
    (void)follow_picture(2500);
    CHECK_EQ(framing.status, FRAMING_OK);
    CHECK(framing.half_height_bam32.bam < 40U);
    add(2, -1, 0, 0, 1, 0);
    (void)follow_picture(2500);
    CHECK_EQ(framing.status, FRAMING_INFEASIBLE);
    add(2, 0, 1, 0, 1, 0);
    (void)follow_picture(2500);
    CHECK_EQ(framing.status, FRAMING_OK);
    CHECK_NEAR(framing.half_width_bam32.bam, DEGREES_45, 30);
    start_picture();
    add(1, 1000000000, 900, 0, 1, 0);
    add(2, -1000000000, 900, 0, 1, 0);
    (void)follow_picture(2500);
    CHECK_EQ(framing.status, FRAMING_INFEASIBLE);
}

/// Rims that no picture holds: it is that of the centres, until they can be held.
static void a_picture_of_centres(void) {
    start_picture();
    add(1, 1, 1, 0, 1, BAM32_QUARTER - 1U);
    add(2, -1, 1, 0, 1, BAM32_QUARTER - 1U);
    (void)follow_picture(2500);
    CHECK_EQ(framing.status, FRAMING_OK);
    CHECK_EQ(framing.half_angle_bam32.bam, BAM32_HALF);
    CHECK_EQ(framing.half_width_bam32.bam, BAM32_QUARTER);
    CHECK_NEAR(bam32_signed(framing.pan_bam32), 0, 30);
    add(1, 1, 1, 0, 1, 1000);
    add(2, -1, 1, 0, 1, 1000);
    (void)follow_picture(2500);
    CHECK_NEAR(framing.half_width_bam32.bam, DEGREES_45 + 1000U, 30);
}

int main(void) {
    TEST(nothing_to_frame);
    TEST(one_target);
    TEST(two_targets);
    TEST(radii_widen_and_turn);
    TEST(weight_0_is_kept_but_not_framed);
    TEST(infeasible);
    TEST(wide_radii);
    TEST(a_full_set);
    TEST(a_picture_of_two);
    TEST(a_picture_of_two_heights);
    TEST(a_picture_in_steps);
    TEST(a_picture_of_some_that_leave);
    TEST(no_picture);
    TEST(a_picture_of_centres);
    return check_finish();
}
