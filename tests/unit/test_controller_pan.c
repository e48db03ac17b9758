/// The controller's pans between objects, also when no direction sees both.
#include "rig.h"

static void object_target(uint32_t id, uint16_t object, int pan, int tilt) {
    rig_target(id, pan, tilt);
    rig.input.update[rig.input.update_count - 1U].object = object;
}

static void pan_to(uint16_t object, uint32_t duration_us, enum pan_path path) {
    rig.input.pan_set = true;
    rig.input.pan = (struct controller_pan){
        .choice = {.one_object = true, .object = object}, .duration_us = duration_us, .path = path};
    rig_tick();
    rig.input.pan_set = false;
}

/// Object 1 round pan 85 degrees, object 2 round -85: together they reach round the horizon.
static void two_objects(void) {
    rig_init();
    object_target(1, 1, 7900, 0);
    object_target(2, 1, 9100, 0);
    object_target(3, 2, -7900, 0);
    object_target(4, 2, -9100, 0);
    rig_arm();
    CHECK_EQ(rig_mode(), MODE_HOLDING); // all together: infeasible
    CHECK_EQ(rig.output.status.framing.status, FRAMING_INFEASIBLE);
    pan_to(1, 0, PAN_BY_SUM);
    rig_ticks(4000);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    CHECK(rig_is_at(AXIS_PAN, 8500));
    CHECK_EQ(rig.output.status.framing.framed_count, 2);
}

/// The aim itself goes at minimum jerk: how far after a part of the time, by angle.
static void a_pan_takes_its_time(void) {
    two_objects();
    const struct vec3 from = rig.output.status.framing.ahead_q30;
    pan_to(2, 4000000, PAN_BY_ANGLE);
    CHECK(rig.output.status.panning);
    uint64_t whole = 0, last = 0, fastest = 0;
    for (uint32_t i = 1; i < 4000U && check_clean(); i++) {
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_TRACKING);
        const struct vec3 ahead = rig.output.status.framing.ahead_q30;
        const uint64_t way = trig_atan2_turn64(vec3_i64_length(vec3_cross(from, ahead)),
                                               u64_abs(vec3_dot_unit(from, ahead)));
        const uint64_t gone = vec3_dot_unit(from, ahead) < 0 ? (UINT64_C(1) << 63) - way : way;
        CHECK(gone + (1U << 20) >= last);
        fastest = gone > last && gone - last > fastest ? gone - last : fastest;
        last = gone;
        whole = gone > whole ? gone : whole;
    }
    CHECK(rig.output.status.panning);
    rig_tick();
    CHECK(!rig.output.status.panning);
    // The fastest tick of 4,000 is 15/8 of the average.
    CHECK(whole > UINT64_C(1) << 61);
    CHECK_NEAR((fastest * 4000U / ((whole >> 10) + 1U) * 8U + 512U) >> 10, 15, 0);
    rig_ticks(3000);
    CHECK(rig_is_at(AXIS_PAN, -8500));
    CHECK(!rig.output.status.panning);
    CHECK_EQ(rig.output.status.framing.framed_count, 2);
}

/// Both objects move during the pan; it ends on the new one where that is then.
static void objects_move_meanwhile(void) {
    two_objects();
    pan_to(2, 2000000, PAN_BY_SUM);
    for (int i = 0; i < 2500 && check_clean(); i++) {
        object_target(1, 1, 7900 + i / 5, 0);
        object_target(3, 2, -7900 + i / 5, 0);
        object_target(4, 2, -9100 + i / 5, 0);
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_TRACKING);
    }
    rig_ticks(4000);
    CHECK(rig_is_at(AXIS_PAN, -8500 + 2499 / 5));
}

/// How wide the picture is goes from the one to the other as the way does: a half of it after a
/// half of the time, 10/64 - 15/256 + 6/1024 after a quarter.
static void the_picture_changes_on_the_way(void) {
    for (unsigned frame = CONTROLLER_FRAME_CONE; frame <= CONTROLLER_FRAME_RECT; frame++) {
        const bool rect = frame == CONTROLLER_FRAME_RECT;
        rig_configure();
        rig.config.frame = (enum controller_frame)frame;
        rig_start(0, 0x55);
        object_target(1, 1, 7900, 0);
        object_target(2, 1, 9100, 0);
        object_target(3, 2, -8300, 0);
        object_target(4, 2, -8700, 0);
        rig_arm();
        pan_to(1, 0, PAN_BY_SUM);
        rig_ticks(100);
        struct framing seen[4]; // before, after a quarter, a half and all of the time
        seen[0] = rig.output.status.framing;
        pan_to(2, 4000000, PAN_BY_ANGLE);
        for (unsigned i = 1; i < 4U; i++) {
            rig_ticks(i == 3U ? 2001 : 1000); // it may begin a tick later
            seen[i] = rig.output.status.framing;
            CHECK_EQ(seen[i].is_picture, rect && i == 3U);
        }
        for (unsigned size = 0; size < (rect ? 3U : 1U); size++) {
            int64_t at[4];
            for (unsigned i = 0; i < 4U; i++) {
                at[i] = size == 0U   ? seen[i].half_angle_bam32.bam
                        : size == 1U ? seen[i].half_width_bam32.bam
                                     : seen[i].half_height_bam32.bam;
            }
            CHECK(at[0] > 2 * at[3]);
            CHECK_NEAR(at[1], at[0] + (at[3] - at[0]) * 106 / 1024, (at[0] - at[3]) / 2000);
            CHECK_NEAR(at[2], (at[0] + at[3]) / 2, (at[0] - at[3]) / 2000);
        }
    }
}

/// Without a time it is done in the same tick, whichever that is.
static void at_once(void) {
    two_objects();
    for (unsigned i = 0; i < 4U; i++) {
        const bool left = i % 2U == 0U;
        pan_to(left ? 2 : 1, 0, PAN_BY_SUM);
        CHECK(!rig.output.status.panning);
        CHECK_EQ(rig.output.status.framing.ahead_q30.x < 0, left);
        rig_ticks(i == 1U ? 2 : 1);
    }
}

/// What it comes from goes on counting where it is.
static void the_first_object_moves_meanwhile(void) {
    two_objects();
    pan_to(2, 4000000, PAN_BY_SUM);
    object_target(1, 1, 7400, 0);
    object_target(2, 1, 8600, 0);
    rig_ticks(3); // the two views take turns, and the pan has hardly begun
    const struct sincos wanted = trig_sincos(BAM_OF(8000));
    CHECK_NEAR(rig.output.status.framing.ahead_q30.x, wanted.sin_q30, 1000);
    CHECK_NEAR(rig.output.status.framing.ahead_q30.y, wanted.cos_q30, 1000);
}

/// Another pan before the first has ended goes on from there, without a jump.
static void a_pan_is_broken_off(void) {
    two_objects();
    pan_to(2, 2000000, PAN_BY_ANGLE);
    rig_ticks(900);
    const struct vec3 before = rig.output.status.framing.ahead_q30;
    pan_to(1, 1000000, PAN_BY_ANGLE);
    const struct vec3 after = rig.output.status.framing.ahead_q30;
    CHECK_NEAR(before.x, after.x, Q30_ONE / 1000);
    CHECK_NEAR(before.y, after.y, Q30_ONE / 1000);
    // What was aimed at before counts as it was then, wherever it goes now.
    object_target(3, 2, -4900, 3000);
    rig_ticks(4);
    const struct vec3 later = rig.output.status.framing.ahead_q30;
    CHECK_NEAR(after.x, later.x, Q30_ONE / 1000);
    CHECK_NEAR(after.z, later.z, Q30_ONE / 1000);
    rig_ticks(6000);
    CHECK(rig_is_at(AXIS_PAN, 8500));
}

/// What is not there yet is waited for; what goes away is left from where it was.
static void objects_come_and_go(void) {
    two_objects();
    pan_to(3, 1000000, PAN_BY_SUM);
    rig_ticks(2000);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    CHECK(rig_is_at(AXIS_PAN, 8500));
    object_target(9, 3, 4500, 0);
    rig_gone(1);
    rig_gone(2);
    rig_ticks(5000);
    CHECK(rig_is_at(AXIS_PAN, 4500));
    rig_gone(9);
    rig_ticks(500);
    CHECK_EQ(rig_mode(), MODE_HOLDING);
    // Back to everything.
    rig_gone(3);
    rig_gone(4);
    rig_target(20, 3000, 0);
    rig.input.pan_set = true;
    rig.input.pan = (struct controller_pan){.duration_us = 500000};
    rig_tick();
    rig.input.pan_set = false;
    rig_ticks(4000);
    CHECK(rig_is_at(AXIS_PAN, 3000));
}

int main(void) {
    TEST(a_pan_takes_its_time);
    TEST(objects_move_meanwhile);
    TEST(the_picture_changes_on_the_way);
    TEST(at_once);
    TEST(the_first_object_moves_meanwhile);
    TEST(a_pan_is_broken_off);
    TEST(objects_come_and_go);
    return check_finish();
}
