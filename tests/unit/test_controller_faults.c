/// firmware/control: every fault, what holds during it, and what leads out of it. What the rig
/// checks at every tick is in rig.h.
#include "rig.h"

static void faulted(uint32_t faults, unsigned axis) {
    CHECK_EQ(rig_mode(), MODE_FAULTED);
    CHECK_EQ(rig.output.status.faults, faults);
    CHECK_EQ(rig.output.status.fault_axis, axis);
}

/// Armed and on the way to 90 degrees of pan and 40 of tilt.
static void get_under_way(void) {
    rig_init();
    rig_arm();
    rig_target(1, 9000, 4000);
    rig_ticks(500);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    CHECK_EQ(rig.controller.limiter[AXIS_PAN].output_speed_q48, DEGREE / 10);
}

/// The setpoint of an axis comes to rest within so many ticks, and stays there.
static void comes_to_rest(unsigned axis, uint32_t ticks) {
    rig_ticks(ticks);
    const int64_t held = rig.output.status.axis[axis].setpoint_q48;
    for (int i = 0; i < 50 && check_clean(); i++) {
        rig_tick();
        CHECK_EQ(rig.output.status.axis[axis].setpoint_q48, held);
    }
}

// ---------------------------------------------------------------- silence

static void silence_before_arming_is_shown(void) {
    rig_init();
    rig.drive[1].silent = true;
    rig_ticks(51);
    CHECK_EQ(rig.output.status.faults, 0);
    rig_tick(); // 51 ms: longer than 50
    CHECK_EQ(rig_mode(), MODE_STARTING);
    CHECK_EQ(rig.output.status.faults, FAULT_DRIVE_SILENT);
    CHECK_EQ(rig.output.status.fault_axis, AXIS_TILT);
    rig_command(COMMAND_ARM);
    rig_command(COMMAND_STOP);
    rig.drive[1].silent = false;
    CHECK(rig_until(MODE_READY, 60));
    CHECK_EQ(rig.output.status.faults, 0);
    rig.drive[0].silent = true;
    CHECK(rig_until(MODE_STARTING, 60));
    rig_ticks(1);
    CHECK_EQ(rig.output.status.faults, FAULT_DRIVE_SILENT);
    CHECK_EQ(rig.output.status.fault_axis, AXIS_PAN);
    CHECK(!rig.output.status.axis[AXIS_PAN].measured_known);
}

static void silence_stops_everything(void) {
    get_under_way();
    rig.drive[0].silent = true;
    uint32_t ticks = 0;
    for (; rig_mode() == MODE_TRACKING && ticks < 100U; ticks++) {
        rig_tick();
    }
    CHECK_NEAR(ticks, 51, 2); // 50 ms after the last reply
    faulted(FAULT_DRIVE_SILENT, AXIS_PAN);
    const uint32_t told = rig.drive[0].positions, held = rig.drive[1].positions;
    comes_to_rest(AXIS_TILT, 220);
    CHECK_EQ(rig.drive[0].positions, told); // no setpoints for a dead drive
    CHECK(rig.drive[1].positions > held + 60U);
    CHECK(rig.output.pulse_ns[AXIS_ZOOM] != 0U);
    faulted(FAULT_DRIVE_SILENT, AXIS_PAN);
}

static void a_fault_stays_until_armed_with_its_cause_gone(void) {
    get_under_way();
    rig.drive[0].silent = true;
    CHECK(rig_until(MODE_FAULTED, 60));
    rig_ticks(300);
    rig_command(COMMAND_ARM); // refused, and not remembered
    rig.drive[0].silent = false;
    rig.drive[0].angle_cdeg = -3000; // somebody turned it
    rig.drive[0].watchdog_ms = 0;
    const uint32_t told = rig.drive[0].positions;
    rig_ticks(3);
    rig_command(COMMAND_ARM); // too early: not every question is answered
    CHECK_EQ(rig_mode(), MODE_FAULTED);
    rig_ticks(300);
    faulted(FAULT_DRIVE_SILENT, AXIS_PAN);
    CHECK_EQ(rig.drive[0].positions, told);
    CHECK_EQ(rig.drive[0].watchdog_ms, 50); // it was asked and told everything anew
    rig_is_at(AXIS_PAN, -3000);
    rig_command(COMMAND_STOP); // does not lead out of a fault
    faulted(FAULT_DRIVE_SILENT, AXIS_PAN);
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_SETTLING);
    CHECK_EQ(rig.output.status.faults, 0);
    rig_is_at(AXIS_PAN, -3000);
    rig_ticks(5);
    CHECK_NEAR(rig.drive[0].angle_cdeg, -3000, 1);
    rig_ticks(3000);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig_is_at(AXIS_PAN, 9000);
}

/// A drive that restarts while the controller is faulted must not pass for the one of before.
static void a_drive_that_restarts_in_a_fault_is_asked_anew(void) {
    get_under_way();
    rig.drive[0].silent = true;
    CHECK(rig_until(MODE_FAULTED, 60));
    rig.drive[0].silent = false;
    rig_ticks(100);
    CHECK(rig.controller.drive[0].ready);
    rig.drive[0].silent = true; // it has no power for a while
    rig_ticks(100);
    CHECK(!rig.controller.drive[0].ready);
    rig.drive[0].watchdog_ms = 0;
    rig.drive[0].silent = false;
    rig_ticks(3);
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_FAULTED);
    rig_ticks(60);
    CHECK_EQ(rig.drive[0].watchdog_ms, 50);
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_SETTLING);
}

/// Replies without the angle keep a drive alive, but nothing starts from an old angle.
static void stale_positions_do_not_arm(void) {
    rig_configure();
    rig.config.silence_us = 100000; // the status comes every 64 ms
    rig_start(0, 0);
    CHECK(rig_until(MODE_READY, 60));
    rig.drive[0].no_angle = true;
    CHECK(rig_until(MODE_STARTING, 110));
    CHECK_EQ(rig.output.status.faults, 0);
    rig.drive[0].angle_cdeg = 9000;
    rig_command(COMMAND_ARM);
    rig_ticks(500);
    CHECK_EQ(rig_mode(), MODE_STARTING);
    rig.drive[0].no_angle = false;
    CHECK(rig_until(MODE_SETTLING, 20));
    rig_is_at(AXIS_PAN, 9000);
}

// ---------------------------------------------------------------- reported errors

static void a_reported_error_stops_everything(void) {
    get_under_way();
    rig.drive[1].error_bits = 0x1000; // over temperature
    CHECK(rig_until(MODE_FAULTED, 70));
    faulted(FAULT_DRIVE_ERROR, AXIS_TILT);
    CHECK_EQ(rig.controller.drive[1].error_bits, 0x1000);
    const uint32_t told = rig.drive[1].positions;
    comes_to_rest(AXIS_PAN, 220);
    CHECK_EQ(rig.drive[1].positions, told);
    rig_command(COMMAND_ARM);
    rig_ticks(100);
    faulted(FAULT_DRIVE_ERROR, AXIS_TILT); // it still does
    rig.drive[1].error_bits = 0;
    rig_ticks(100);
    faulted(FAULT_DRIVE_ERROR, AXIS_TILT); // only an arm command leads out
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_SETTLING);
    rig_ticks(3000);
    rig_is_at(AXIS_TILT, 4000);
}

static void an_error_before_arming_is_shown(void) {
    rig_init();
    rig.drive[0].error_bits = 0x2000;
    rig_ticks(200);
    CHECK_EQ(rig_mode(), MODE_STARTING);
    CHECK_EQ(rig.output.status.faults, FAULT_DRIVE_ERROR);
    CHECK_EQ(rig.output.status.fault_axis, AXIS_PAN);
    rig.drive[0].error_bits = 0;
    CHECK(rig_until(MODE_READY, 100));
    CHECK_EQ(rig.output.status.faults, 0);
}

// ---------------------------------------------------------------- not following

static void a_blocked_axis_is_not_pushed_on(void) {
    get_under_way();
    rig.drive[0].blocked = true;
    const int64_t stuck = rig.drive[0].angle_cdeg;
    uint32_t ticks = 0;
    for (; rig_mode() == MODE_TRACKING && ticks < 200U; ticks++) {
        rig_tick();
    }
    CHECK_NEAR(ticks, 30 + 40, 5); // 3 degrees at 0.1 a tick, then follow_error_us
    faulted(FAULT_FOLLOWING, AXIS_PAN);
    CHECK_NEAR(rig.output.status.axis[AXIS_PAN].setpoint_q48, stuck * CENTIDEGREE, CENTIDEGREE);
    comes_to_rest(AXIS_TILT, 220);
    CHECK_NEAR(rig.output.status.axis[AXIS_PAN].setpoint_q48, stuck * CENTIDEGREE, CENTIDEGREE);
    rig.drive[0].blocked = false;
    rig_ticks(10);
    CHECK_EQ(rig.drive[0].angle_cdeg, stuck); // held, not let go and not pushed
    rig_command(COMMAND_ARM);
    rig_ticks(3000);
    rig_is_at(AXIS_PAN, 9000);
}

/// As far from its setpoint as is allowed, and a hundredth of a degree farther, to either side.
static void as_far_as_allowed_is_no_fault(void) {
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int more = 0; more <= 1; more++) {
            rig_configure();
            rig.config.follow_error_q48 = drive_q48_from_cdeg(300);
            rig_start(0, 0x55);
            rig_arm();
            rig.drive[0].blocked = true;
            rig.drive[0].angle_cdeg = sign * (300 + more);
            rig_ticks(200);
            CHECK_EQ(rig_mode(), more == 0 ? MODE_HOLDING : MODE_FAULTED);
        }
    }
    faulted(FAULT_FOLLOWING, AXIS_PAN);
}

static void a_moment_of_lag_is_no_fault(void) {
    get_under_way();
    for (int i = 0; i < 10; i++) {
        rig.drive[0].blocked = true;
        rig_ticks(60);
        rig.drive[0].blocked = false;
        rig_ticks(20);
        CHECK_EQ(rig_mode(), MODE_TRACKING);
    }
}

/// The angle is not reported any more while the axis moves on as told: it must not be called back
/// to where it was last seen.
static void an_old_angle_is_not_held(void) {
    get_under_way();
    rig.drive[0].no_angle = true;
    const int64_t seen = rig.drive[0].angle_cdeg;
    CHECK(rig_until(MODE_FAULTED, 100));
    CHECK_EQ(rig.output.status.faults, FAULT_FOLLOWING);
    CHECK(rig.output.status.axis[AXIS_PAN].setpoint_q48 > (seen + 500) * CENTIDEGREE);
    comes_to_rest(AXIS_PAN, 220);
    CHECK(rig.drive[0].angle_cdeg > seen + 500);
    rig_command(COMMAND_ARM);
    rig_ticks(10);
    CHECK_EQ(rig_mode(), MODE_FAULTED);
    rig.drive[0].no_angle = false;
    rig_ticks(10);
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_SETTLING);
}

/// A command that was given before the fault was known does not acknowledge it.
static void arming_in_the_tick_of_the_fault_is_too_early(void) {
    get_under_way();
    rig.drive[0].blocked = true;
    for (int i = 0; i < 200 && rig_mode() == MODE_TRACKING; i++) {
        rig_command(COMMAND_ARM);
    }
    faulted(FAULT_FOLLOWING, AXIS_PAN);
    rig.drive[0].blocked = false;
    rig_ticks(300);
    faulted(FAULT_FOLLOWING, AXIS_PAN);
}

// ---------------------------------------------------------------- time

static void late_ticks_again_and_again_are_a_fault(void) {
    get_under_way();
    rig.tick_us = 4000; // four periods: not late
    rig_ticks(60);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig.tick_us = 4001;
    rig_ticks(20); // of which the first is still on time
    rig.tick_us = 1000;
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_FAULTED);
    faulted(FAULT_OVERRUN, 0);

    get_under_way();
    rig.tick_us = 4001;
    rig_ticks(19);
    rig.tick_us = 1000;
    rig_ticks(100);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
}

static void no_arming_while_ticks_are_late(void) {
    get_under_way();
    rig.tick_us = 5000;
    CHECK(rig_until(MODE_FAULTED, 40));
    rig_ticks(300);
    rig_command(COMMAND_ARM);
    rig_ticks(5);
    faulted(FAULT_OVERRUN, 0);
    rig.tick_us = 1000;
    rig_ticks(2);
    faulted(FAULT_OVERRUN, 0);
    rig_command(COMMAND_ARM);
    CHECK_EQ(rig_mode(), MODE_SETTLING);

    rig_init(); // and not before it was ever armed either
    rig.tick_us = 5000;
    rig_ticks(100);
    CHECK_EQ(rig_mode(), MODE_READY);
    rig_command(COMMAND_ARM);
    rig_ticks(50);
    CHECK_EQ(rig_mode(), MODE_READY);
    rig.tick_us = 1000;
    CHECK(rig_until(MODE_SETTLING, 3));
}

static void a_clock_that_runs_backwards(void) {
    get_under_way();
    const uint64_t before = rig.output.status.time_us;
    rig.input.now_us -= 500000;
    rig_ticks(100);
    CHECK_EQ(rig.output.status.time_us, before + 99000U); // one tick without time
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig.tick_us = 0U - 10U;
    rig_ticks(25);
    faulted(FAULT_OVERRUN, 0);
    CHECK_EQ(rig.output.status.time_us, before + 100000U);
    const uint32_t told = rig.drive[1].positions;
    rig_ticks(40);
    CHECK_EQ(rig.drive[1].positions, told + 10U); // it holds all the same
}

/// A computer that slept for 40 minutes: more than half of what the clock can tell.
static void a_very_long_gap(void) {
    get_under_way();
    rig.input.now_us += UINT32_C(2400000000);
    rig_ticks(300);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    rig.drive[0].silent = true; // time goes on
    CHECK(rig_until(MODE_FAULTED, 60));
    get_under_way();
    rig.input.now_us += 1800000000; // 30 minutes: the drives were not heard of
    rig_ticks(2);
    CHECK_EQ(rig.output.status.faults & FAULT_DRIVE_SILENT, FAULT_DRIVE_SILENT);
}

// ---------------------------------------------------------------- other rigs

static void lktech_drives_are_told_to_run(void) {
    rig_configure();
    rig.config.axis[AXIS_PAN].drive.rmd.reply_offset = 0;
    rig_start(0, 0);
    rig.drive[0].lktech = true;
    rig_arm();
    CHECK(rig.drive[0].running);
    rig_target(1, 3000, 0);
    rig_ticks(1000);
    CHECK_EQ(rig.drive[0].angle_cdeg, 3000);
    rig.drive[0].silent = true;
    CHECK(rig_until(MODE_FAULTED, 60));
    rig.drive[0].silent = rig.drive[0].running = false; // it has restarted
    rig_ticks(100);
    CHECK(!rig.drive[0].running);
    rig_command(COMMAND_ARM);
    rig_target(1, 0, 0);
    rig_ticks(1000);
    CHECK(rig.drive[0].running);
    CHECK_EQ(rig.drive[0].angle_cdeg, 0);
}

static void use_servos(void) {
    rig_configure();
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        rig.config.axis[axis].drive = (struct drive_config){
            .kind = DRIVE_PWM, .pwm = {axis, -100 * DEGREE, 100 * DEGREE, 1000000, 2000000}};
        rig.config.axis[axis].home_q48 = 20 * DEGREE;
    }
    rig_start(0, 0);
}

static void servos_go_home_first(void) {
    use_servos();
    rig_target(1, -5000, -5000);
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_READY); // nobody to ask
    rig_ticks(100);
    CHECK_EQ(rig.output.frame_count, 0);
    CHECK_EQ(rig.output.pulse_ns[AXIS_PAN], 0);
    rig_command(COMMAND_ARM);
    for (int i = 0; i < 29; i++) {
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_SETTLING);
        CHECK_EQ(rig.output.pulse_ns[AXIS_PAN], 1600000);
    }
    rig_ticks(2000);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    CHECK_EQ(rig.output.pulse_ns[AXIS_PAN], 1250000);
    // Stopped by lateness, it holds; armed again it goes on from there, without home.
    rig.tick_us = 5000;
    CHECK(rig_until(MODE_FAULTED, 40));
    CHECK_EQ(rig.output.pulse_ns[AXIS_PAN], 1250000);
    rig.tick_us = 1000;
    rig_ticks(100);
    rig_command(COMMAND_ARM);
    rig_tick();
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    CHECK_EQ(rig.output.pulse_ns[AXIS_PAN], 1250000);
    CHECK(!rig.output.status.axis[AXIS_PAN].measured_known);
}

// ---------------------------------------------------------------- all at once

/// Everything goes wrong at random. What rig.h checks holds at every tick, and whatever fault there
/// was, it can be left by arming once all is well.
static void random_faults(void) {
    uint64_t seed = UINT64_C(0xFA017);
    check_note("seed", (int64_t)seed);
    rig_init();
    uint32_t armed = 0, faults = 0;
    enum controller_mode last = MODE_STARTING;
    for (int i = 0; i < 60000 && check_clean(); i++) {
        const uint64_t dice = check_random(&seed);
        struct rig_drive *drive = &rig.drive[dice >> 20 & 1U];
        switch (dice % 400U) {
        case 0:
            drive->silent = !drive->silent;
            break;
        case 1:
            drive->blocked = !drive->blocked;
            break;
        case 2:
            drive->no_angle = !drive->no_angle;
            break;
        case 3:
            drive->error_bits = (uint16_t)(drive->error_bits == 0U ? 1U << (dice >> 30 & 15U) : 0U);
            break;
        case 4:
        case 5:
        case 6:
        case 7:
            rig.drive[0].silent = rig.drive[0].blocked = rig.drive[0].no_angle = false;
            rig.drive[1].silent = rig.drive[1].blocked = rig.drive[1].no_angle = false;
            rig.drive[0].error_bits = rig.drive[1].error_bits = 0;
            rig.tick_us = 1000;
            break;
        case 8:
            rig.tick_us = 6000;
            break;
        case 9:
            rig.input.commands = COMMAND_STOP;
            break;
        case 10:
            drive->angle_cdeg += (int64_t)(dice >> 40 & 0xFFFU) - 2048;
            break;
        default:
            rig.input.commands = dice % 400U < 60U ? COMMAND_ARM : 0U;
            break;
        }
        if (dice >> 50 < 300U) {
            rig_target(1, (int)(dice >> 24 & 0x7FFFU), (int)(dice >> 40 & 0x1FFFU) - 4096);
        }
        rig_tick();
        armed += last != MODE_SETTLING && rig_mode() == MODE_SETTLING;
        faults += last != MODE_FAULTED && rig_mode() == MODE_FAULTED;
        last = rig_mode();
    }
    check_note("times armed", armed);
    check_note("faults", faults);
    CHECK(armed > 100U && faults > 100U);
}

int main(void) {
    TEST(silence_before_arming_is_shown);
    TEST(silence_stops_everything);
    TEST(a_fault_stays_until_armed_with_its_cause_gone);
    TEST(a_drive_that_restarts_in_a_fault_is_asked_anew);
    TEST(stale_positions_do_not_arm);
    TEST(a_reported_error_stops_everything);
    TEST(an_error_before_arming_is_shown);
    TEST(a_blocked_axis_is_not_pushed_on);
    TEST(as_far_as_allowed_is_no_fault);
    TEST(a_moment_of_lag_is_no_fault);
    TEST(an_old_angle_is_not_held);
    TEST(arming_in_the_tick_of_the_fault_is_too_early);
    TEST(late_ticks_again_and_again_are_a_fault);
    TEST(no_arming_while_ticks_are_late);
    TEST(a_clock_that_runs_backwards);
    TEST(a_very_long_gap);
    TEST(lktech_drives_are_told_to_run);
    TEST(servos_go_home_first);
    TEST(random_faults);
    return check_finish();
}
