/// The emulated board around the chip: switches, servo outputs, console, and what is counted of the
/// image.
#include "mcu/cpu/closed_loop.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define IMAGE    "build/boards/stm32f405/slew/boresight.elf"
#define SCENARIO "tests/mcu/cpu/slew/scenario.ini"
/// 60 % of a millisecond at 168 MHz, an instruction a cycle.
#define STEP_MOST 100800U

static bool begin(bool exact) {
    return begin_loop((struct mcu_board_options){.image = IMAGE, .exact = exact}, SCENARIO);
}

static void it_greets_and_tells_its_state_once_a_second(void) {
    if (begin(false)) {
        run_ms(3500);
        CHECK(says(" board: stm32f405\n"));
        CHECK(says("clock: 168 MHz, crystal and PLL run"));
        CHECK(says("reset: power-on"));
        CHECK(says("     1 s  ") && says("     2 s  ") && says("     3 s  ") &&
              !says("     4 s  "));
        CHECK_EQ(board.lines, 7);
    }
    finish();
}

/// Every switch holds the gimbal while it is open, by its name.
static void switches(void) {
    static const struct {
        unsigned pin;
        const char *name;
    } lines[] = {{GPIO_PIN('C', 0), "held: emergency stop"},
                 {GPIO_PIN('C', 1), "held: key switch off"},
                 {GPIO_PIN('C', 2), "held: pan limit switch"},
                 {GPIO_PIN('C', 3), "held: tilt limit switch"}};
    for (unsigned i = 0; i < 4U; i++) {
        if (begin(false)) {
            run_ms(1500);
            CHECK_EQ(sim->controller.mode, MODE_TRACKING);
            CHECK(!says(lines[i].name));
            gpio_drive(&board.machine.soc, lines[i].pin, GPIO_FLOATING);
            run_ms(1000);
            CHECK_EQ(sim->controller.mode, MODE_STOPPED);
            CHECK(says(lines[i].name));
        }
        finish();
    }
}

static void servos_get_pulses_only_while_the_supply_is_on(void) {
    if (begin(false)) {
        unsigned before_arming = 0;
        while (sim->controller.mode != MODE_TRACKING && sim->time_us < 3000000U) {
            sim_step(sim);
            before_arming += !sim->controller.powered[AXIS_ZOOM] && sim->pulse_ns[2] != 0U;
        }
        CHECK_EQ(before_arming, 0);
        CHECK_EQ(gpio_output(&board.machine.soc, GPIO_PIN('C', 4)), GPIO_HIGH);
        // PC8 is TIM3_CH3: 1 to 2 ms, 50 times a second; nothing else is a servo here.
        CHECK(sim->pulse_ns[2] >= 1000000U && sim->pulse_ns[2] <= 2000000U);
        const struct timer_pulse pulse = timer_pulse_of(&board.machine.soc.timer[2], 2);
        CHECK_NEAR(pulse.period_cycles, 168000000 / 50, 168);
        CHECK(sim->pulse_ns[0] == 0U && sim->pulse_ns[1] == 0U && sim->pulse_ns[3] == 0U);
        // What the controller asks for is what comes out a period later, in which the lens goes 7
        // us.
        run_ms(2500);
        CHECK_NEAR(sim->pulse_ns[2], sim->pump.output.pulse_ns[AXIS_ZOOM], 8000);
    }
    finish();
}

/// The same count, whether by blocks of instructions or one by one; but that the latter knows
/// nothing of the few that an IT instruction lets be skipped, and that take a cycle each all the
/// same.
static void instructions_are_counted_right(void) {
    struct probe_counts counts[2];
    uint64_t stepped = 0, instructions = 0;
    for (unsigned exact = 0; exact < 2U; exact++) {
        if (begin(exact != 0U)) {
            run_ms(600);
        }
        counts[exact] = board.probe.counts;
        stepped = board.machine.cpu.stepped;
        instructions = cpu_instructions(&board.machine.cpu);
        finish();
    }
    CHECK_EQ(counts[0].ticks, counts[1].ticks);
    CHECK_EQ(counts[0].step_sum, counts[1].step_sum);
    CHECK_EQ(counts[0].step_max, counts[1].step_max);
    CHECK_EQ(counts[0].loop_sum, counts[1].loop_sum);
    CHECK(stepped <= instructions && instructions - stepped <= instructions / 50U);
    check_note("instructions by blocks", (int64_t)instructions);
    check_note("one by one", (int64_t)stepped);
}

/// A target among 256 that lie all around the axis.
static struct target_update target(uint32_t id, uint32_t phase) {
    const int32_t row = (int32_t)(id / 16U) - 8, column = (int32_t)(id % 16U) - 8;
    const struct target_update update = {
        .kind = TARGET_DIRECTION,
        .id = id + 1U,
        .weight_q16 = 65536,
        .direction = {column * 20000000 + (int32_t)(phase % 100U) * 1000, 1000000000,
                      row * 20000000 + (int32_t)(phase % 77U) * 1000}};
    return update;
}

static void a_tick_with_256_targets_that_are_re_aimed_in_each(void) {
    if (!begin(false)) {
        return;
    }
    run_ms(10);
    for (uint32_t id = 0; id < 256U; id++) {
        const struct target_update update = target(id, 0);
        CHECK(sim_push(sim, &update));
        run_ms(id % CONTROLLER_UPDATES_MAX == CONTROLLER_UPDATES_MAX - 1U ? 1U : 0U);
    }
    run_ms(800);
    CHECK(sim->pump.output.status.target_count >= 256U);
    const uint32_t aims_before = sim->pump.output.status.aims_solved;
    probe_restart_counts(&board.probe);
    for (uint32_t tick = 0; tick < 2000U; tick++) {
        const struct target_update update = target(tick * 97U % 256U, tick);
        CHECK(sim_push(sim, &update));
        sim_step(sim);
    }
    const struct probe_counts *counts = &board.probe.counts;
    CHECK(sim->pump.output.status.aims_solved - aims_before >= 1990U);
    check_note("instructions of a step with 256 targets, mean",
               (int64_t)(counts->step_sum / counts->ticks));
    check_note("at most", (int64_t)counts->step_max);
    check_note("of the loop around it, at most", (int64_t)counts->loop_max);
    check_note("of", STEP_MOST);
    CHECK(counts->step_max <= STEP_MOST);
    finish();
}

static void lists_of_faults(void) {
    struct mcu_board_options options = {0};
    CHECK(mcu_board_read_faults("can-short@2.5,stop-pressed@0,hse-stuck", &options) == NULL);
    CHECK_EQ(options.fault_count, 3);
    CHECK_EQ(options.fault[0].fault, MCU_FAULT_CAN_SHORT);
    CHECK_EQ(options.fault[0].at_us, 2500000);
    CHECK_EQ(options.fault[2].fault, MCU_FAULT_HSE_STUCK);
    CHECK_EQ(options.fault[2].at_us, 0);
    static const char *const wrong[] = {"can",      "can-shorts@1", "storm@", "storm@x", "storm@1x",
                                        "storm@-1", "storm@nan",    ",storm", "storm@1 "};
    for (unsigned i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        options.fault_count = 0;
        CHECK(mcu_board_read_faults(wrong[i], &options) != NULL);
    }
    for (const char *name = mcu_board_fault_names(); *name != '\0';) { // every name is one
        char word[32];
        const size_t size = strcspn(name, " ");
        snprintf(word, sizeof word, "%.*s", (int)size, name);
        options.fault_count = 0;
        CHECK(mcu_board_read_faults(word, &options) == NULL);
        name += size + (name[size] == ' ' ? 1U : 0U);
    }
}

int main(void) {
    TEST(it_greets_and_tells_its_state_once_a_second);
    TEST(switches);
    TEST(servos_get_pulses_only_while_the_supply_is_on);
    TEST(instructions_are_counted_right);
    TEST(a_tick_with_256_targets_that_are_re_aimed_in_each);
    TEST(lists_of_faults);
    return check_finish();
}
