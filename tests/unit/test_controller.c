/// firmware/control: modes, aim and motion of a rig that works. What the rig checks at every tick
/// is in rig.h; faults: test_controller_faults.c, settings and determinism:
/// test_controller_inputs.c.
#include "rig.h"

static void asks_and_moves_nothing_until_armed(void) {
    rig_init();
    rig.drive[0].angle_cdeg = 4500;
    rig.drive[1].angle_cdeg = -1000;
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_STARTING);
    CHECK_EQ(rig.output.status.time_us, 0);
    CHECK(rig_until(MODE_READY, 40));
    CHECK_EQ(rig.output.status.faults, 0);
    for (int i = 0; i < 3000; i++) {
        rig_target(1, 10 * i, 0); // an aim alone moves nothing
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_READY);
        CHECK(rig.output.frame_count <= 1U); // the axes take turns
    }
    CHECK_EQ(rig.drive[0].positions + rig.drive[1].positions, 0);
    CHECK_EQ(rig.output.pulse_set[AXIS_ZOOM], true);
    CHECK_EQ(rig.output.pulse_ns[AXIS_ZOOM], 0);
    CHECK_EQ(rig.output.pulse_channel[AXIS_ZOOM], RIG_ZOOM_CHANNEL);
    CHECK(!rig.output.pulse_set[AXIS_PAN] && !rig.output.pulse_set[AXIS_TILT]);
    CHECK_EQ(rig.drive[0].watchdog_ms, 50);
    // What is measured is shown.
    rig_is_at(AXIS_PAN, 4500);
    rig_is_at(AXIS_TILT, -1000);
    CHECK(rig.output.status.axis[AXIS_PAN].measured_known);
    CHECK_EQ(rig.output.status.axis[AXIS_PAN].restarts, 0);
}

static void arms_where_it_is(void) {
    rig_init();
    rig.drive[0].angle_cdeg = 4567;
    rig.drive[1].angle_cdeg = -1011;
    CHECK(rig_until(MODE_READY, 40));
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_SETTLING);
    uint32_t ticks = 0;
    for (; rig_mode() == MODE_SETTLING && ticks < 100U; ticks++) {
        rig_tick();
        CHECK_EQ(rig.output.pulse_ns[AXIS_ZOOM], 1000000); // the lens goes home, to wide
    }
    CHECK_EQ(ticks, 30); // settle_us
    CHECK_EQ(rig_mode(), MODE_HOLDING);
    for (int i = 0; i < 100; i++) {
        rig_tick();
        CHECK_EQ(rig.output.frame_count, 1); // four frames each in four ticks, spread evenly
    }
    CHECK_EQ(rig_mode(), MODE_HOLDING);
    CHECK_EQ(rig.drive[0].angle_cdeg, 4567);
    CHECK_EQ(rig.drive[1].angle_cdeg, -1011);
    CHECK_NEAR(rig.drive[0].positions, 32, 2); // one in four ticks
    CHECK_EQ(rig.output.status.axis[AXIS_PAN].restarts, 1);
}

static void an_early_arm_command_waits_for_the_drives(void) {
    rig_init();
    rig.drive[0].silent = rig.drive[1].silent = true;
    rig_command(COMMAND_ARM);
    rig_ticks(200);
    CHECK_EQ(rig_mode(), MODE_STARTING);
    rig.drive[0].silent = rig.drive[1].silent = false;
    CHECK(rig_until(MODE_SETTLING, 60));

    rig_init(); // unless a stop takes it back
    rig_command(COMMAND_ARM);
    rig_command(COMMAND_STOP);
    rig_ticks(200);
    CHECK_EQ(rig_mode(), MODE_READY);
    rig_command(COMMAND_ARM | COMMAND_STOP); // stop wins
    rig_ticks(10);
    CHECK_EQ(rig_mode(), MODE_READY);

    rig_configure();
    rig.config.arm_on_start = true;
    rig_start(0, 0);
    CHECK(rig_until(MODE_HOLDING, 120));
}

static void goes_to_the_target_and_zooms(void) {
    rig_init();
    rig_arm();
    rig_target(1, 2000, 1000);
    rig_target(2, 2400, 1000);
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    CHECK_EQ(rig.output.status.target_count, 2);
    CHECK_EQ(rig.output.status.framing.framed_count, 2);
    CHECK_EQ(rig.output.status.aims_solved, 2); // and once when it was armed
    rig_ticks(1500);
    rig_is_at(AXIS_PAN, 2200);
    CHECK_NEAR(rig.drive[0].angle_cdeg, 2200, 1);
    // The middle of the arc is a little above the two.
    const int64_t tilt = rig.output.status.axis[AXIS_TILT].setpoint_q48;
    CHECK_NEAR(tilt, 1000 * (DEGREE / 100) + DEGREE / 166, DEGREE / 1000);
    CHECK_EQ(rig.output.status.axis[AXIS_PAN].setpoint_q48,
             rig.output.status.axis[AXIS_PAN].goal_q48);
    // Half-angle 1.9696 degrees and 10 %: 2000 / (tan * 1.1) = 52,871 um, beyond the longest.
    CHECK_EQ(rig.output.status.focal_um, 20000);
    CHECK_EQ(rig.output.pulse_ns[AXIS_ZOOM], 2000000);
    CHECK_EQ(rig.output.status.aims_solved, 2);
    // Wider: half-angle 10 degrees, 10,311 um.
    rig_target(1, 2200, 1000);
    rig_target(2, 2200, 3000);
    rig_ticks(1500);
    rig_is_at(AXIS_PAN, 2200);
    rig_is_at(AXIS_TILT, 2000);
    CHECK_NEAR(rig.output.status.focal_um, 10311, 2);
    CHECK_NEAR(rig.output.pulse_ns[AXIS_ZOOM], 1394438, 200);
}

/// While it slews the picture is wide, so that the targets come into it early.
static void zooms_out_while_it_slews(void) {
    rig_init();
    rig_arm();
    rig_target(1, 0, 0);
    rig_ticks(1000);
    CHECK_EQ(rig.output.status.focal_um, 20000);
    rig_target(1, 9000, 0);
    uint32_t shortest = UINT32_MAX;
    for (int i = 0; i < 3000 && check_clean(); i++) {
        rig_tick();
        const uint32_t focal = rig.output.status.focal_um;
        shortest = focal < shortest ? focal : shortest;
    }
    CHECK_EQ(shortest, 4000);
    CHECK_EQ(rig.output.status.focal_um, 20000);
}

static void holds_when_there_is_nothing_to_aim_at(void) {
    rig_init();
    rig_arm();
    rig_target(1, 9000, 0);
    rig_ticks(400); // under way
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig_gone(1);
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_HOLDING);
    CHECK_EQ(rig.output.status.framing.status, FRAMING_EMPTY);
    rig_ticks(400);
    const int64_t held = rig.output.status.axis[AXIS_PAN].setpoint_q48;
    rig_ticks(100);
    CHECK_EQ(rig.output.status.axis[AXIS_PAN].setpoint_q48, held);
    CHECK(held > 10 * DEGREE && held < 80 * DEGREE);
    rig_target(1, 0, 0); // and there is something again
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig_ticks(1500);
    rig_is_at(AXIS_PAN, 0);
    rig_target(1, 0, 9000);
    rig_target(2, 0, -9000); // no direction sees both
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_HOLDING);
    CHECK_EQ(rig.output.status.framing.status, FRAMING_INFEASIBLE);
}

static void targets_expire(void) {
    rig_configure();
    rig.config.target_expiry_us = 200000;
    rig_start(0, 0);
    rig_arm();
    for (int i = 0; i < 500; i++) {
        if (i % 150 == 0) {
            rig_target(1, 1000, 0);
        }
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_TRACKING);
    }
    CHECK_EQ(rig.output.status.aims_solved, 2); // the same again is nothing to solve
    rig_ticks(151);                             // the last one came 49 ticks ago
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_HOLDING);
    CHECK_EQ(rig.output.status.target_count, 0);
}

static void stops_and_stays_stopped(void) {
    rig_init();
    rig_arm();
    rig_target(1, 9000, 0);
    rig_ticks(400);
    rig_command(COMMAND_STOP);
    CHECK_EQ(rig_mode(), MODE_STOPPED);
    rig_ticks(220); // 100 degrees a second at 500 a second^2, and the smoothing
    const int64_t held = rig.output.status.axis[AXIS_PAN].setpoint_q48;
    const uint32_t positions = rig.drive[0].positions;
    for (int i = 0; i < 500; i++) {
        rig_target(1, i * 10, i);
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_STOPPED);
        CHECK_EQ(rig.output.status.axis[AXIS_PAN].setpoint_q48, held);
    }
    CHECK_NEAR(rig.drive[0].positions - positions, 125, 1); // it holds: the setpoint still goes out
    rig_command(COMMAND_STOP);
    CHECK_EQ(rig_mode(), MODE_STOPPED);
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_SETTLING);
    rig_ticks(3000);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig_is_at(AXIS_PAN, 4990);
}

/// Armed again while still decelerating: first it comes to rest.
static void arms_from_rest_only(void) {
    rig_init();
    rig_arm();
    rig_target(1, 9000, 0);
    rig_ticks(400);
    rig_command(COMMAND_STOP);
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_STOPPED);
    uint32_t ticks = 0;
    while (rig_mode() == MODE_STOPPED && ticks < 400U) {
        rig_tick();
        ticks++;
    }
    CHECK_NEAR(ticks, 218, 5);
    CHECK_EQ(rig_mode(), MODE_SETTLING);
    rig_ticks(20);
    rig_command(COMMAND_STOP); // settling can be stopped, too
    CHECK_EQ(rig_mode(), MODE_STOPPED);
}

/// Whoever turned the head while it had no power, it goes on from there.
static void resumes_from_where_it_is_measured(void) {
    rig_init();
    CHECK(rig_until(MODE_READY, 60));
    rig_target(1, 0, 0);
    rig_ticks(50);
    rig.drive[0].angle_cdeg = 17000;
    rig_ticks(50);
    rig_is_at(AXIS_PAN, 17000);
    rig_command(COMMAND_ARM);
    rig_is_at(AXIS_PAN, 17000);
    rig_ticks(4);
    CHECK_EQ(rig.drive[0].angle_cdeg, 17000);
    rig_ticks(4000);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig_is_at(AXIS_PAN, 0);
}

/// Also when it was stopped and something holds it beside its setpoint.
static void resumes_from_where_it_is_held(void) {
    rig_init();
    rig_arm();
    rig_command(COMMAND_STOP);
    rig_ticks(10);
    rig.drive[0].blocked = true;
    rig.drive[0].angle_cdeg = 250;
    rig_ticks(10);
    rig_is_at(AXIS_PAN, 0);
    rig_command(COMMAND_ARM);
    rig_is_at(AXIS_PAN, 250);
    CHECK_EQ(rig.output.status.axis[AXIS_PAN].restarts, 2);
}

/// Turned by a turn while it had no power: the goal is the one on the near turn from the first tick
/// of tracking on.
static void the_first_goal_is_on_the_turn_of_the_measured_position(void) {
    rig_configure();
    rig.config.axis[AXIS_ZOOM].drive.kind = DRIVE_NONE; // nothing to settle
    rig_start(0, 0);
    rig_target(1, 1000, 0);
    CHECK(rig_until(MODE_READY, 60));
    rig.drive[0].angle_cdeg = 36500;
    rig_ticks(50);
    rig.input.commands = COMMAND_ARM;
    for (int i = 0; i < 100; i++) {
        rig_tick();
        if (rig_mode() == MODE_TRACKING) {
            CHECK(rig.output.status.axis[AXIS_PAN].setpoint_q48 >= 365 * DEGREE);
        }
    }
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig_ticks(1000);
    rig_is_at(AXIS_PAN, 37000);
    CHECK_EQ(rig.output.status.focal_um, 0); // without zoom
    CHECK(!rig.output.pulse_set[AXIS_ZOOM]);
}

static void starts_outside_the_limits_and_comes_in(void) {
    rig_init();
    rig.drive[0].angle_cdeg = 45000;
    rig.drive[1].angle_cdeg = -10500;
    rig_arm();
    rig_is_at(AXIS_PAN, 45000);
    rig_target(1, 9000, -8000);
    rig_ticks(4500);
    rig_is_at(AXIS_PAN, 9000);
    rig_is_at(AXIS_TILT, -8000);
}

// ---------------------------------------------------------------- moving aims

/// 50 reports a second of a target at 30 and 5 degrees a second. Setpoints of axes that are late by
/// pan_us and tilt_us are ahead of it by what it moves meanwhile.
static void follow_a_moving_target(uint32_t pan_us, uint32_t tilt_us) {
    rig_configure();
    rig.config.axis[AXIS_PAN].latency_us = pan_us;
    rig.config.axis[AXIS_TILT].latency_us = tilt_us;
    rig_start(0, 0x55);
    rig_arm();
    rig_target(1, 0, 0);
    rig_ticks(100);
    for (int i = 0; i < 3000 && check_clean(); i++) {
        if (i % 20 == 0) {
            rig_target(1, i * 3, i / 2);
        }
        rig_tick();
        if (i > 600) {
            const int64_t pan = i * 3 * (DEGREE / 100), tilt = i * (DEGREE / 200);
            const struct controller_axis_status *axis = rig.output.status.axis;
            CHECK_NEAR(axis[AXIS_PAN].setpoint_q48, pan + pan_us * (3 * DEGREE / 100000),
                       DEGREE / 50);
            CHECK_NEAR(axis[AXIS_TILT].setpoint_q48, tilt + tilt_us * (DEGREE / 200000),
                       DEGREE / 50);
            CHECK_NEAR(axis[AXIS_PAN].goal_q48, pan, DEGREE / 50); // where the target is
        }
    }
}

static void a_moving_target_is_followed_without_lag(void) {
    follow_a_moving_target(0, 0);
    follow_a_moving_target(15500, 100000);
    follow_a_moving_target(0, CONTROLLER_LATENCY_US_MAX);
}

/// Whatever an axis is late by, it rests where the target rests.
static void a_late_axis_comes_to_rest_on_the_target(void) {
    rig_configure();
    rig.config.axis[AXIS_PAN].latency_us = CONTROLLER_LATENCY_US_MAX;
    rig_start(0, 0);
    rig_arm();
    for (int i = 0; i < 100; i++) {
        rig_target(1, 3000, 0);
        rig_ticks(20);
    }
    rig_is_at(AXIS_PAN, 3000);
}

/// 30 degrees a second, 50 reports a second, `count` reports.
static void move_the_target(int count) {
    for (int i = 0; i <= count && check_clean(); i++) {
        rig_target(1, i * 60, 0);
        rig_ticks(20);
    }
}

/// It stops, and the reports that say so are all alike.
static void a_target_that_stops_is_aimed_at(void) {
    rig_configure();
    rig.config.tracker.memory_q16 = 32768;
    for (unsigned run = 0; run < 2U; run++) {
        rig_start(0, 0);
        rig_arm();
        move_the_target(50);
        for (int i = 0; i < 50; i++) {
            rig_target(1, 3000, 0);
            rig_ticks(20);
        }
        rig_is_at(AXIS_PAN, 3000);
        rig.config.tracker.memory_q16 = 0;
    }
}

/// It moves, and then there are no more reports of it.
static void a_silent_target_is_where_it_was_last_seen(void) {
    rig_init();
    rig_arm();
    move_the_target(50);
    rig_ticks(500); // the goal has coasted for 100 ticks at 0.03 degrees a tick
    rig_is_at(AXIS_PAN, 3300);
    rig_ticks(1000);
    rig_is_at(AXIS_PAN, 3000);
}

/// Of two targets one moves: the many reports of the other, which say nothing new, do not hold the
/// aim back.
static void a_resting_target_does_not_disturb_a_moving_one(void) {
    rig_init();
    rig_arm();
    rig_target(1, 0, 0);
    rig_target(2, 2000, 0);
    rig_ticks(1000);
    for (int i = 0; i < 1000 && check_clean(); i++) {
        if (i % 20 == 0) {
            rig_target(1, -i * 2, 0);
        }
        rig_target(2, 2000, 0);
        rig_tick();
        if (i > 300) {
            CHECK_NEAR(rig.output.status.axis[AXIS_PAN].setpoint_q48, 10 * DEGREE - i * CENTIDEGREE,
                       DEGREE / 50);
        }
    }
}

/// Round and round until the cable says no, then the long way back.
static void counts_through_the_seam_to_the_limit(void) {
    rig_init();
    rig_arm();
    rig_target(1, 0, 0);
    rig_ticks(50);
    for (int i = 0; i < 8200 && check_clean(); i++) { // to 410 degrees
        if (i % 20 == 0) {
            rig_target(1, i * 5, 0);
        }
        rig_tick();
        if (i > 600 && i < 7800) {
            CHECK_NEAR(rig.output.status.axis[AXIS_PAN].setpoint_q48, i * 5 * (DEGREE / 100),
                       DEGREE / 10);
        }
    }
    rig_ticks(5000);
    rig_is_at(AXIS_PAN, 4900); // 409 degrees was the last report
}

/// A target that crosses the zenith, with a high pan rate just before, and reports that go on while
/// it is there: the pan stays where it is.
static void along_the_pan_axis_pan_rests(void) {
    rig_init();
    rig_arm();
    rig_target(1, 4500, 8000);
    rig_ticks(1500);
    for (int i = 1; i <= 5; i++) {
        rig_target(1, 4500 + 150 * i, 8000 + 150 * i);
        rig_ticks(20);
    }
    const struct vec3 up[2] = {{1, 0, Q30_ONE}, {0, 1, Q30_ONE}};
    for (int i = 0; i < 400; i++) { // each report differs a little, so each is solved
        rig_update((struct target_update){
            .kind = TARGET_DIRECTION, .id = 1, .weight_q16 = 1, .direction = up[i % 2]});
        rig_ticks(10);
    }
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    CHECK_NEAR(rig.output.status.axis[AXIS_PAN].setpoint_q48, 53 * DEGREE, 3 * DEGREE);
    rig_is_at(AXIS_TILT, 9000);
}

static void hangs_from_the_ceiling(void) {
    rig_configure();
    rig.config.attitude.roll = bam32(BAM32_HALF);
    rig.config.attitude.heading = BAM_OF(9000); // facing east
    rig_start(0, 0);
    rig_arm();
    rig_target(1, 8000, 1000); // 10 degrees left of east, seen from above
    rig_ticks(1000);
    rig_is_at(AXIS_PAN, 1000);
    rig_is_at(AXIS_TILT, -1000);
}

/// A point in the world, from where the mount stands.
static void points_in_the_world(void) {
    rig_configure();
    rig.config.position_um = (struct vec3_i64){1000000, -2000000, 1500000};
    rig_start(0, 0);
    rig_arm();
    rig_update((struct target_update){.kind = TARGET_POSITION,
                                      .id = 1,
                                      .weight_q16 = 1,
                                      .position_um = {4000000, 1000000, 1500000},
                                      .radius_um = 300000});
    rig_ticks(1000);
    rig_is_at(AXIS_PAN, 4500);
    rig_is_at(AXIS_TILT, 0);
    // 0.3 m at 4.243 m: 4.0548 degrees, so f = 2000 / (tan * 1.1) = 25,651: beyond the longest.
    CHECK_NEAR(rig.output.status.framing.half_angle_bam32.bam, 48375700, 30000);
}

int main(void) {
    TEST(asks_and_moves_nothing_until_armed);
    TEST(arms_where_it_is);
    TEST(an_early_arm_command_waits_for_the_drives);
    TEST(goes_to_the_target_and_zooms);
    TEST(zooms_out_while_it_slews);
    TEST(holds_when_there_is_nothing_to_aim_at);
    TEST(targets_expire);
    TEST(stops_and_stays_stopped);
    TEST(arms_from_rest_only);
    TEST(resumes_from_where_it_is_measured);
    TEST(resumes_from_where_it_is_held);
    TEST(the_first_goal_is_on_the_turn_of_the_measured_position);
    TEST(starts_outside_the_limits_and_comes_in);
    TEST(a_moving_target_is_followed_without_lag);
    TEST(a_late_axis_comes_to_rest_on_the_target);
    TEST(a_target_that_stops_is_aimed_at);
    TEST(a_silent_target_is_where_it_was_last_seen);
    TEST(a_resting_target_does_not_disturb_a_moving_one);
    TEST(counts_through_the_seam_to_the_limit);
    TEST(along_the_pan_axis_pan_rests);
    TEST(hangs_from_the_ceiling);
    TEST(points_in_the_world);
    return check_finish();
}
