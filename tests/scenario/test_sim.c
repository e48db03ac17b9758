/// The closed loop: firmware, bus, drives and plant together, on the scenarios that ship with the
/// program; and each invariant with a planted violation.
#include "check.h"

#include "scenario.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct scenario scenario;
static struct sim *sim;

static bool load(const char *name) {
    char path[256];
    snprintf(path, sizeof path, "host-sim/scenarios/%s.ini", name);
    // Kept until the end of the test: the simulation points into it.
    return CHECK(scenario_read(path, &scenario) == EXIT_STATUS_OK);
}

static bool start(void) {
    sim = sim_create(&scenario.sim);
    return CHECK(sim != NULL);
}

static void run_until(double seconds) {
    while ((double)sim->time_us < seconds * 1e6) {
        sim_step(sim);
    }
}

static struct sim_summary finish(void) {
    const struct sim_summary summary = sim_summarise(sim);
    if (sim_violation_count(&summary.violations) != 0U) {
        printf("  # %.3f s: %s\n", (double)summary.violations.first_us * 1e-6,
               summary.violations.first);
    }
    sim_destroy(sim);
    scenario_free(&scenario);
    sim = NULL;
    return summary;
}

static uint64_t finish_and_count(void) {
    const struct sim_summary summary = finish();
    return sim_violation_count(&summary.violations);
}

static struct sim_summary run_whole(void) {
    if (start()) {
        run_until((double)scenario.duration_us * 1e-6);
    }
    return finish();
}

static int64_t q48(double degrees) {
    return (int64_t)(degrees / 360.0 * 281474976710656.0);
}

// ---------------------------------------------------------------- the scenarios

static void stars_are_framed_and_held(void) {
    if (!load("stars")) {
        return;
    }
    const struct sim_summary summary = run_whole();
    CHECK_EQ(sim_violation_count(&summary.violations), 0);
    CHECK_EQ(summary.settle_count, 10);
    CHECK(summary.aim_error_max_deg < 0.02);
    CHECK(summary.settle_s < 3.0);
    check_note("worst steady error, micro-degrees", (int64_t)(summary.aim_error_max_deg * 1e6));
}

static void the_seed_decides_everything(void) {
    uint64_t hash[3] = {0};
    for (unsigned i = 0; i < 3U; i++) {
        if (!load("moving")) {
            return;
        }
        scenario.duration_us = 10000000;
        scenario.sim.seed = i == 2U ? 8 : 7;
        hash[i] = run_whole().trace_hash;
    }
    CHECK(hash[0] == hash[1]);
    CHECK(hash[0] != hash[2]);
}

/// The controller's 32-bit clock passes 2^32 in the middle of a slew: nothing may change.
static void the_clock_may_wrap(void) {
    uint64_t hash[2] = {0};
    for (unsigned i = 0; i < 2U; i++) {
        if (!load("stars")) {
            return;
        }
        scenario.duration_us = 9000000;
        scenario.sim.start_us = i == 0U ? 0U : UINT32_MAX - 7500000U;
        hash[i] = run_whole().trace_hash;
    }
    CHECK(hash[0] == hash[1]);
}

static void moving_targets_are_followed(void) {
    if (!load("moving")) {
        return;
    }
    const struct sim_summary summary = run_whole();
    CHECK_EQ(sim_violation_count(&summary.violations), 0);
    CHECK(summary.in_frame_percent > 99.0);
    CHECK(summary.aim_error_rms_deg < 0.5);
    check_note("rms error, micro-degrees", (int64_t)(summary.aim_error_rms_deg * 1e6));
}

static void the_group_of_pedestrians_is_followed(void) {
    if (!load("pedestrians")) {
        return;
    }
    const struct sim_summary summary = run_whole();
    CHECK_EQ(sim_violation_count(&summary.violations), 0);
    CHECK(summary.in_frame_percent > 90.0);
}

/// Into the limits at full speed, again and again.
static void limits_hold_at_full_speed(void) {
    double farthest_deg = 0.0;
    if (CHECK(scenario_read("tests/scenario/seam.ini", &scenario) == EXIT_STATUS_OK) && start()) {
        while (sim->time_us < scenario.duration_us) {
            sim_step(sim);
            farthest_deg = fmax(farthest_deg, fabs(sim_joint_deg(sim, AXIS_PAN)));
        }
    }
    CHECK_EQ(finish_and_count(), 0);
    CHECK(farthest_deg > 174.0 && farthest_deg < 175.05);
}

static void hobby_servos_stop_and_resume(void) {
    if (!load("hobby") || !start()) {
        return;
    }
    run_until(6.5);
    CHECK_EQ(sim->controller.mode, MODE_STOPPED);
    const double stopped_at = sim_joint_deg(sim, AXIS_PAN);
    run_until(7.9);
    CHECK(sim_joint_deg(sim, AXIS_PAN) == stopped_at); // the targets moved meanwhile
    run_until(12.0);
    CHECK_EQ(sim->controller.mode, MODE_TRACKING);
    const struct sim_summary summary = finish();
    CHECK_EQ(sim_violation_count(&summary.violations), 0);
    CHECK(summary.aim_error_max_deg < 0.2); // half of the servo's dead band, twice
}

// ---------------------------------------------------------------- variations of the rig

/// Whatever way the base stands and the drives are wired, the camera looks at the same stars.
static void the_mount_may_stand_any_way(void) {
    static const struct {
        double heading, pitch, roll;
        bool reversed;
        double zero;
    } mounts[] = {{0, 0, 180, false, 0},
                  {180, 0, 180, true, 12.34},
                  {90, 20, -30, false, -150},
                  {-135, -10, 5, true, 359.99}};
    for (unsigned i = 0; i < sizeof mounts / sizeof *mounts; i++) {
        if (!load("stars")) {
            return;
        }
        struct controller_config *controller = &scenario.rig.controller;
        controller->attitude =
            (struct mount_attitude){bam32((uint32_t)(q48(mounts[i].heading) >> 16)),
                                    bam32((uint32_t)(q48(mounts[i].pitch) >> 16)),
                                    bam32((uint32_t)(q48(mounts[i].roll) >> 16))};
        for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
            controller->axis[axis].limits.min_q48 = q48(-190.0);
            controller->axis[axis].limits.max_q48 = q48(190.0);
            controller->axis[axis].drive.rmd.reversed = mounts[i].reversed;
            controller->axis[axis].drive.rmd.zero_q48 = q48(mounts[i].zero);
        }
        controller->axis[AXIS_TILT].limits.min_q48 = q48(-95.0);
        controller->axis[AXIS_TILT].limits.max_q48 = q48(95.0);
        scenario.duration_us = 17000000;
        const struct sim_summary summary = run_whole();
        CHECK_EQ(sim_violation_count(&summary.violations), 0);
        CHECK_EQ(summary.settle_count, 3);
        CHECK(summary.aim_error_max_deg < 0.02);
    }
}

/// A tenth of all frames lost: slower news, no harm.
static void lost_frames_do_no_harm(void) {
    if (!load("stars")) {
        return;
    }
    scenario.sim.can_loss = 0.1;
    scenario.duration_us = 25000000;
    const struct sim_summary summary = run_whole();
    CHECK_EQ(sim_violation_count(&summary.violations), 0);
    CHECK_EQ(summary.settle_count, 4);
    CHECK(summary.aim_error_max_deg < 0.02);
}

// ---------------------------------------------------------------- faults

static double speed_dps(unsigned axis) {
    return sim->axis[axis].plant.rate_rps * 180.0 / AXIS_PLANT_PI;
}

/// To the middle of the slew to the third figure, where the pan is fast.
static bool start_in_a_slew(void) {
    if (!load("stars") || !start()) {
        return false;
    }
    run_until(13.6);
    return CHECK(fabs(speed_dps(AXIS_PAN)) > 50.0);
}

/// A drive falls silent in mid-slew: noticed within 50 ms, all still within 250 ms more, and it
/// stays so.
static void a_silent_drive_stops_the_gimbal(void) {
    if (!start_in_a_slew()) {
        return;
    }
    rmd_drive_fail(&sim->axis[AXIS_TILT].drive, RMD_DRIVE_FAIL_SILENT, true);
    run_until(13.6 + 0.055);
    CHECK_EQ(sim->controller.mode, MODE_FAULTED);
    CHECK_EQ(sim->controller.faults, FAULT_DRIVE_SILENT);
    CHECK_EQ(sim->controller.fault_axis, AXIS_TILT);
    run_until(13.6 + 0.055 + 0.75); // 90 degrees a second at 180 a second^2, and the smoothing
    CHECK(fabs(speed_dps(AXIS_PAN)) < 0.5);
    run_until(15.0);
    CHECK_EQ(sim->controller.mode, MODE_FAULTED);
    pump_command(&sim->pump, COMMAND_ARM); // refused: it is still silent
    run_until(15.5);
    CHECK_EQ(sim->controller.mode, MODE_FAULTED);
    rmd_drive_fail(&sim->axis[AXIS_TILT].drive, RMD_DRIVE_FAIL_SILENT, false);
    run_until(16.0);
    CHECK_EQ(sim->controller.mode, MODE_FAULTED); // not by itself
    pump_command(&sim->pump, COMMAND_ARM);
    run_until(18.5);
    CHECK_EQ(sim->controller.mode, MODE_TRACKING);
    CHECK(sim_observe(sim).error_deg < 0.02);
    CHECK_EQ(finish_and_count(), 0);
}

/// A drive that falls to idle says nothing of it: it is its axis that does not follow.
static void an_idle_drive_is_noticed(void) {
    if (!start_in_a_slew()) {
        return;
    }
    rmd_drive_fail(&sim->axis[AXIS_PAN].drive, RMD_DRIVE_FAIL_JAM, true);
    run_until(15.0);
    CHECK_EQ(sim->controller.mode, MODE_FAULTED);
    CHECK((sim->controller.faults & (FAULT_FOLLOWING | FAULT_DRIVE_ERROR)) != 0U);
    CHECK_EQ(sim->controller.fault_axis, AXIS_PAN);
    CHECK_EQ(finish_and_count(), 0);
}

static void a_stop_decelerates_and_holds(void) {
    if (!start_in_a_slew()) {
        return;
    }
    pump_command(&sim->pump, COMMAND_STOP);
    run_until(14.6);
    CHECK_EQ(sim->controller.mode, MODE_STOPPED);
    CHECK(fabs(speed_dps(AXIS_PAN)) < 0.1);
    pump_command(&sim->pump, COMMAND_ARM);
    run_until(18.0);
    CHECK(sim_observe(sim).error_deg < 0.02);
    CHECK_EQ(finish_and_count(), 0);
}

// ---------------------------------------------------------------- planted violations

/// The checker gets other limits than the controller, and must see them broken.
static uint64_t count_with(enum sim_invariant invariant,
                           void (*tighten)(struct limiter_config *pan)) {
    static struct controller_config tight;
    if (!load("stars") || !start()) {
        return 0;
    }
    tight = scenario.rig.controller;
    tighten(&tight.axis[AXIS_PAN].limits);
    sim->config.controller = &tight;
    run_until(15.0);
    const uint64_t count = sim->violations.count[invariant];
    sim_destroy(sim);
    scenario_free(&scenario);
    return count;
}

static void closer_limit(struct limiter_config *pan) {
    pan->min_q48 = q48(-15.0); // Orion is at -16
}

static void lower_speed(struct limiter_config *pan) {
    pan->speed_max_q48 -= pan->speed_max_q48 / 3;
}

static void lower_acceleration(struct limiter_config *pan) {
    pan->accel_max_q48 -= pan->accel_max_q48 / 50;
}

static void lower_jerk(struct limiter_config *pan) {
    pan->smooth_ticks += 2;
}

static void violations_of_limits_are_seen(void) {
    CHECK(count_with(SIM_I1_POSITION, closer_limit) > 0U);
    CHECK(count_with(SIM_I2_RATES, lower_speed) > 0U);
    CHECK(count_with(SIM_I2_RATES, lower_acceleration) > 0U);
    CHECK(count_with(SIM_I2_RATES, lower_jerk) > 0U);
}

static void unarmed_motion_is_seen(void) {
    if (!load("stars") || !start()) {
        return;
    }
    run_until(3.0);
    memset(sim->controller.ever_powered, 0, sizeof sim->controller.ever_powered);
    run_until(3.1);
    CHECK(sim->violations.count[SIM_I4_UNARMED_MOTION] > 0U);
    sim_destroy(sim);
    scenario_free(&scenario);
}

static void a_controller_that_differs_is_seen(void) {
    if (!load("stars") || !start()) {
        return;
    }
    run_until(2.0);
    CHECK_EQ(sim->violations.count[SIM_I5_SAME_BITS], 0);
    sim->shadow.limiter[AXIS_TILT].position_q48 += 1000;
    run_until(2.5);
    CHECK(sim->violations.count[SIM_I5_SAME_BITS] > 0U);
    sim_destroy(sim);
    scenario_free(&scenario);
}

static void a_jump_at_arming_is_seen(void) {
    if (!load("stars")) {
        return;
    }
    scenario.rig.controller.arm_on_start = false;
    if (!start()) {
        return;
    }
    run_until(1.0);
    sim->controller.drive[AXIS_PAN].position_q48 += q48(0.5);
    sim->shadow.drive[AXIS_PAN].position_q48 += q48(0.5);
    pump_command(&sim->pump, COMMAND_ARM);
    run_until(1.002);
    CHECK(sim->violations.count[SIM_I9_RESUME] > 0U);
    sim_destroy(sim);
    scenario_free(&scenario);
}

int main(void) {
    TEST(stars_are_framed_and_held);
    TEST(the_seed_decides_everything);
    TEST(the_clock_may_wrap);
    TEST(moving_targets_are_followed);
    TEST(the_group_of_pedestrians_is_followed);
    TEST(limits_hold_at_full_speed);
    TEST(hobby_servos_stop_and_resume);
    TEST(the_mount_may_stand_any_way);
    TEST(lost_frames_do_no_harm);
    TEST(a_silent_drive_stops_the_gimbal);
    TEST(an_idle_drive_is_noticed);
    TEST(a_stop_decelerates_and_holds);
    TEST(violations_of_limits_are_seen);
    TEST(unarmed_motion_is_seen);
    TEST(a_controller_that_differs_is_seen);
    TEST(a_jump_at_arming_is_seen);
    return check_finish();
}
