/// Faults on the image: what fails on the board or the bus while the gimbal slews at 60 degrees/s
/// must end in standstill within the times of docs/safety.md, stay so until armed, and be told on
/// the console.
#include "mcu/cpu/closed_loop.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define IMAGE    "build/boards/stm32f405/slew/boresight.elf"
#define SCENARIO "tests/mcu/cpu/slew/scenario.ini"

/// Noticed within 50 ms: 45 ms after a drive's last reply, and one may just have been due.
#define NOTICED_MS 50
/// From then on until the setpoints rest: from 60 degrees/s at 400 degrees/s^2 150 ms, and the 100
/// ms over which the limiter smooths for 8,000 degrees/s^3. The simulated axes follow 15 ms later.
#define SETPOINT_MS   250
#define STANDSTILL_MS 270
#define WATCHDOG_MS   33
#define OUTPUTS_MS    50

// ---------------------------------------------------------------- a board and its gimbal

static bool begin_with(struct mcu_board_options options) {
    options.image = IMAGE;
    return begin_loop(options, SCENARIO);
}

static double now_ms(void) {
    return (double)sim->time_us * 1e-3;
}

/// From now on.
static void inject(enum mcu_fault fault) {
    board.options.fault[board.options.fault_count++] = (struct mcu_board_fault){fault, 0};
}

static double speed_dps(unsigned axis) {
    return fabs(sim->axis[axis].plant.rate_rps) * 57.29577951308232;
}

static bool is_still(void) {
    return speed_dps(AXIS_PAN) < 0.5 && speed_dps(AXIS_TILT) < 0.5;
}

/// Runs until the first slew is at full speed.
static bool slew(void) {
    while (now_ms() < 8000.0 && speed_dps(AXIS_PAN) < 59.0) {
        sim_step(sim);
    }
    return CHECK(speed_dps(AXIS_PAN) >= 59.0) && CHECK_EQ(sim->controller.mode, MODE_TRACKING);
}

static bool begin_slewing(void) {
    return begin_with((struct mcu_board_options){0}) && slew();
}

struct rest {
    unsigned axes_ms, setpoints_ms;
};

/// Milliseconds from now until both axes, and their setpoints, rest for good; looked at for 700 ms.
static struct rest wait_for_rest(void) {
    struct rest rest = {0, 0};
    const struct controller_output *output = &sim->pump.output;
    for (unsigned ms = 1; ms <= 700U; ms++) {
        const int64_t pan = output->status.axis[AXIS_PAN].setpoint_q48;
        const int64_t tilt = output->status.axis[AXIS_TILT].setpoint_q48;
        sim_step(sim);
        rest.axes_ms = is_still() ? rest.axes_ms : ms;
        rest.setpoints_ms = pan == output->status.axis[AXIS_PAN].setpoint_q48 &&
                                    tilt == output->status.axis[AXIS_TILT].setpoint_q48
                                ? rest.setpoints_ms
                                : ms;
    }
    return rest;
}

/// And until the controller has noticed; at most limit_ms.
static unsigned noticed_ms(enum controller_mode mode, unsigned limit_ms) {
    unsigned ms = 0;
    while (ms < limit_ms && sim->controller.mode != mode) {
        sim_step(sim);
        ms++;
    }
    return ms;
}

static void stays_still(unsigned ms) {
    for (unsigned i = 0; i < ms; i++) {
        sim_step(sim);
        if (!CHECK(is_still())) {
            return;
        }
    }
}

/// Armed again it goes back to work.
static void arm_and_track(void) {
    mcu_board_command(&board, COMMAND_ARM);
    run_ms(4000);
    CHECK_EQ(sim->controller.mode, MODE_TRACKING);
    CHECK_EQ(sim->controller.faults, 0);
}

/// Noticed in time, still in time, latched.
static void check_safe_stop(enum controller_mode mode, unsigned limit_ms) {
    const unsigned noticed = noticed_ms(mode, limit_ms + 1U);
    const struct rest rest = wait_for_rest();
    check_note("noticed after ms", noticed);
    check_note("setpoints rest after ms", noticed + rest.setpoints_ms);
    check_note("axes rest after ms", noticed + rest.axes_ms);
    CHECK(noticed <= limit_ms);
    CHECK(rest.setpoints_ms <= SETPOINT_MS);
    CHECK(rest.axes_ms <= STANDSTILL_MS);
    stays_still(1000);
    CHECK_EQ(sim->controller.mode, mode);
}

// ---------------------------------------------------------------- the bus

static void unplugged(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_CAN_UNPLUGGED);
        check_safe_stop(MODE_FAULTED, NOTICED_MS);
        CHECK(says("can passive 128/"));
        CHECK(says("fault: a drive does not answer"));
        inject(MCU_FAULT_CAN_PLUGGED);
        stays_still(1000); // plugged in again it does not go on by itself
        CHECK_EQ(sim->controller.mode, MODE_FAULTED);
        arm_and_track();
        CHECK(says("can active"));
    }
    finish();
}

static void shorted_until_bus_off(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_CAN_SHORT);
        check_safe_stop(MODE_FAULTED, NOTICED_MS);
        CHECK(says("can off 256/"));
        CHECK(says("fault: a drive does not answer"));
        inject(MCU_FAULT_CAN_REPAIRED);
        stays_still(1000);
        CHECK(!board.machine.soc.can[0].bus_off); // recovered by itself
        arm_and_track();
    }
    finish();
}

// ---------------------------------------------------------------- drives

static void pan_drive_silent(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_PAN_SILENT);
        check_safe_stop(MODE_FAULTED, NOTICED_MS);
        CHECK(says("fault: a drive does not answer"));
        CHECK(says("can active"));
        mcu_board_command(&board, COMMAND_ARM); // not while it is silent
        stays_still(500);
        CHECK_EQ(sim->controller.mode, MODE_FAULTED);
        inject(MCU_FAULT_DRIVES_WELL);
        stays_still(500);
        arm_and_track();
    }
    finish();
}

static void tilt_drive_silent(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_TILT_SILENT);
        check_safe_stop(MODE_FAULTED, NOTICED_MS);
        CHECK(says("fault: a drive does not answer"));
    }
    finish();
}

static void pan_drive_idle(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_PAN_IDLE);
        // It coasts, so it follows for a while; then the error has to grow and to last.
        const unsigned noticed = noticed_ms(MODE_FAULTED, 2000);
        check_note("noticed after ms", noticed);
        CHECK(noticed < 1500U);
        run_ms(1000);
        CHECK(speed_dps(AXIS_TILT) < 0.5);
        CHECK(says("fault: an axis does not follow"));
        CHECK_EQ(sim->controller.mode, MODE_FAULTED);
        inject(MCU_FAULT_DRIVES_WELL);
        run_ms(500);
        CHECK_EQ(sim->controller.mode, MODE_FAULTED);
        arm_and_track();
    }
    finish();
}

// ---------------------------------------------------------------- the program

/// Milliseconds until the servo outputs are off and the board has been reset.
static void check_watchdog(unsigned reset_limit_ms) {
    unsigned outputs_ms = 0, reset_ms = 0, still_ms = 0;
    for (unsigned ms = 1; ms <= 900U; ms++) {
        sim_step(sim);
        reset_ms = reset_ms == 0U && board.machine.cpu.resets != 0U ? ms : reset_ms;
        outputs_ms = outputs_ms == 0U && sim->pulse_ns[2] == 0U ? ms : outputs_ms;
        still_ms = is_still() ? still_ms : ms;
    }
    check_note("reset after ms", reset_ms);
    check_note("servo outputs off after ms", outputs_ms);
    check_note("standstill after ms", still_ms);
    CHECK(reset_ms != 0U && reset_ms <= reset_limit_ms);
    CHECK(outputs_ms != 0U && outputs_ms <= OUTPUTS_MS);
    CHECK(still_ms <= STANDSTILL_MS);
}

static void hang(enum mcu_fault fault, uint32_t lsi_hz) {
    if (begin_with((struct mcu_board_options){.lsi_hz = lsi_hz}) && slew()) {
        CHECK_EQ(board.machine.cpu.resets, 0);
        CHECK(sim->pulse_ns[2] != 0U);
        inject(fault);
        check_watchdog(WATCHDOG_MS);
        CHECK_EQ(board.machine.cpu.resets, 1);
        CHECK(says("reset: watchdog"));
        stays_still(1000);
        CHECK_EQ(sim->controller.mode, MODE_READY);
        arm_and_track();
    }
    finish();
}

static void program_hangs(void) {
    hang(MCU_FAULT_HANG, 32000);
}

static void everything_hangs(void) {
    hang(MCU_FAULT_HANG_ALL, 32000);
}

/// The watchdog's oscillator is anything from 17 to 47 kHz.
static void watchdog_with_the_slowest_oscillator(void) {
    hang(MCU_FAULT_HANG, 17000);
}

static void watchdog_with_the_fastest_oscillator(void) {
    hang(MCU_FAULT_HANG, 47000);
}

static void interrupt_storm(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_STORM);
        check_watchdog(WATCHDOG_MS);
        CHECK(board.machine.cpu.resets > 10U); // it goes on and on
        CHECK(!says("reset: watchdog"));       // and nobody gets to speak
        stays_still(300);
        inject(MCU_FAULT_CALM);
        run_ms(1500);
        CHECK(says("reset: watchdog"));
        CHECK_EQ(sim->controller.mode, MODE_READY);
        CHECK(is_still());
        arm_and_track();
    }
    finish();
}

static void stray_interrupt(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_STRAY);
        check_watchdog(2);
        CHECK_EQ(board.machine.cpu.resets, 1);
        CHECK(says("last run: "));
        CHECK(says("reset: software"));
        stays_still(500);
        CHECK_EQ(sim->controller.mode, MODE_READY);
    }
    finish();
}

// ---------------------------------------------------------------- clocks

static void crystal_fails(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_HSE_FAILS);
        check_watchdog(2);
        CHECK(says("last run: the crystal stopped"));
        CHECK(says("clock: 16 MHz, the crystal does not oscillate"));
        CHECK(says("will not arm: the crystal does not oscillate"));
        mcu_board_command(&board, COMMAND_ARM);
        stays_still(1000);
        CHECK_EQ(sim->controller.mode, MODE_STARTING);
    }
    finish();
}

/// A ready bit never comes: up in time all the same, unarmed whatever is commanded, and saying why.
static void stuck(enum mcu_fault fault, const char *why) {
    const struct mcu_board_options options = {.fault = {{fault, 0}}, .fault_count = 1};
    if (begin_with(options)) {
        char line[128];
        snprintf(line, sizeof line, "will not arm: %s", why);
        unsigned ms = 0;
        for (; ms < 500U && !says(line); ms++) {
            sim_step(sim);
        }
        check_note("told after ms", ms);
        CHECK(ms < 300U);
        for (unsigned i = 0; i < 6000U; i++) { // past two slews
            if (i % 1000U == 0U) {
                mcu_board_command(&board, COMMAND_ARM);
            }
            sim_step(sim);
            CHECK(is_still());
        }
        CHECK(sim->controller.mode == MODE_STARTING || sim->controller.mode == MODE_READY);
        CHECK_EQ(sim->pulse_ns[2], 0);
        CHECK_EQ(board.machine.cpu.resets, 0);
        snprintf(line, sizeof line, "held: %s", why);
        CHECK(says(line));
    }
    finish();
}

static void crystal_never_starts(void) {
    stuck(MCU_FAULT_HSE_STUCK, "the crystal does not oscillate");
}

static void pll_never_locks(void) {
    stuck(MCU_FAULT_PLL_STUCK, "the PLL does not lock");
}

static void system_clock_never_switches(void) {
    stuck(MCU_FAULT_SWITCH_STUCK, "the chip does not switch to the PLL");
}

static void can_never_initialises(void) {
    stuck(MCU_FAULT_CAN_STUCK, "the CAN controller does not start");
}

// ---------------------------------------------------------------- the stop

static void emergency_stop(void) {
    if (begin_slewing()) {
        inject(MCU_FAULT_STOP_PRESSED);
        check_safe_stop(MODE_STOPPED, 2);
        CHECK(says("held: emergency stop"));
        mcu_board_command(&board, COMMAND_ARM);
        stays_still(500);
        CHECK_EQ(sim->controller.mode, MODE_STOPPED);
        inject(MCU_FAULT_STOP_RELEASED);
        stays_still(500);
        CHECK_EQ(sim->controller.mode, MODE_STOPPED);
        arm_and_track();
    }
    finish();
}

/// The other tests can fail: without a fault none of their claims holds.
static void without_a_fault_it_goes_on(void) {
    if (begin_slewing()) {
        CHECK(noticed_ms(MODE_FAULTED, 60) == 60U);
        const struct rest rest = wait_for_rest();
        CHECK(rest.setpoints_ms > STANDSTILL_MS && rest.axes_ms > STANDSTILL_MS);
        run_ms(3000);
        CHECK_EQ(sim->controller.mode, MODE_TRACKING);
        CHECK_EQ(board.machine.cpu.resets, 0);
        CHECK(!says("fault:") && !says("held:") && !says("watchdog") && !says("last run"));
    }
    finish();
}

int main(void) {
    TEST(without_a_fault_it_goes_on);
    TEST(unplugged);
    TEST(shorted_until_bus_off);
    TEST(pan_drive_silent);
    TEST(tilt_drive_silent);
    TEST(pan_drive_idle);
    TEST(program_hangs);
    TEST(everything_hangs);
    TEST(watchdog_with_the_slowest_oscillator);
    TEST(watchdog_with_the_fastest_oscillator);
    TEST(interrupt_storm);
    TEST(stray_interrupt);
    TEST(crystal_fails);
    TEST(crystal_never_starts);
    TEST(pll_never_locks);
    TEST(system_clock_never_switches);
    TEST(can_never_initialises);
    TEST(emergency_stop);
    return check_finish();
}
