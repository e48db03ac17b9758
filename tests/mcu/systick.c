/// SysTick, against PM0214, 4.5, and the ARMv7-M manual, B3.3.
#include "chip.h"

#define CTRL      0xE000E010U
#define LOAD      0xE000E014U
#define VAL       0xE000E018U
#define CALIB     0xE000E01CU
#define COUNTFLAG 0x10000U

static void start(uint32_t load, uint32_t control) {
    power_on();
    poke(LOAD, load);
    poke(VAL, 0);
    poke(CTRL, control);
}

static void after_reset_it_stands(void) {
    power_on();
    CHECK_EQ(peek(CTRL), 0);
    CHECK_EQ(peek(CALIB) & 0xFFFFFFU, 18750);
    pass_cycles(100);
    CHECK(!is_pending(15));
}

static void it_counts_down_and_loads_after_zero(void) {
    start(9, 5);
    // The write to VAL made it 0: the next clock loads.
    static const uint32_t values[] = {9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 9, 8};
    for (unsigned i = 0; i < 12U; i++) {
        pass_cycles(1);
        CHECK_EQ(peek(VAL), values[i]);
    }
}

static void the_flag_comes_from_1_to_0_and_reading_clears_it(void) {
    start(9, 5);
    pass_cycles(9);
    CHECK((peek(CTRL) & COUNTFLAG) == 0U);
    pass_cycles(1);
    CHECK((peek(CTRL) & COUNTFLAG) != 0U);
    CHECK((peek(CTRL) & COUNTFLAG) == 0U);
    pass_cycles(10);
    poke(VAL, 5); // any value clears both
    CHECK((peek(CTRL) & COUNTFLAG) == 0U);
    CHECK_EQ(peek(VAL), 0);
    CHECK(!is_pending(15));
}

static void the_exception_comes_every_load_plus_1(void) {
    start(999, 7);
    unsigned taken = 0;
    uint64_t first = 0, last = 0;
    for (unsigned i = 0; i < 10000U; i++) {
        pass_cycles(1);
        if (is_pending(15)) {
            nvic_set_pending(&chip.nvic, 15, false);
            first = taken++ == 0U ? chip.cycle : first;
            last = chip.cycle;
        }
    }
    CHECK_EQ(taken, 10);
    CHECK_EQ(last - first, 9000);
}

static void without_tickint_there_is_none(void) {
    start(99, 5);
    pass_cycles(1000);
    CHECK(!is_pending(15));
}

static void an_eighth_of_the_clock(void) {
    start(9, 3);
    pass_cycles(79);
    CHECK(!is_pending(15));
    pass_cycles(1);
    CHECK(is_pending(15));
}

static void it_has_24_bits(void) {
    power_on();
    poke(LOAD, 0xFFFFFFFFU);
    CHECK_EQ(peek(LOAD), 0xFFFFFF);
}

static void load_0_stops_it_at_0(void) {
    start(9, 7);
    pass_cycles(5);
    poke(LOAD, 0);
    pass_cycles(5);
    CHECK(is_pending(15));
    nvic_set_pending(&chip.nvic, 15, false);
    pass_cycles(100);
    CHECK(!is_pending(15));
    CHECK_EQ(peek(VAL), 0);
}

static void a_new_load_counts_from_the_next_round_on(void) {
    start(9, 7);
    pass_cycles(3);
    poke(LOAD, 99);
    pass_cycles(7);
    CHECK(is_pending(15));
    nvic_set_pending(&chip.nvic, 15, false);
    pass_cycles(99);
    CHECK(!is_pending(15));
    pass_cycles(1);
    CHECK(is_pending(15));
}

static void stopped_it_keeps_its_value(void) {
    start(99, 5);
    pass_cycles(40);
    const uint32_t value = peek(VAL);
    poke(CTRL, 4);
    pass_cycles(1000);
    CHECK_EQ(peek(VAL), value);
    poke(CTRL, 5);
    pass_cycles(10);
    CHECK_EQ(peek(VAL), value - 10U);
}

static void long_stretches_come_out_the_same(void) {
    start(12344, 5);
    pass_cycles(1);
    for (unsigned i = 0; i < 50U; i++) {
        const uint64_t step = 1U + i * 7919U;
        chip.cycle += step; // in one go
        const uint64_t since = chip.cycle - 1U;
        CHECK_EQ(peek(VAL), 12344U - since % 12345U);
    }
}

int main(void) {
    TEST(after_reset_it_stands);
    TEST(it_counts_down_and_loads_after_zero);
    TEST(the_flag_comes_from_1_to_0_and_reading_clears_it);
    TEST(the_exception_comes_every_load_plus_1);
    TEST(without_tickint_there_is_none);
    TEST(an_eighth_of_the_clock);
    TEST(it_has_24_bits);
    TEST(load_0_stops_it_at_0);
    TEST(a_new_load_counts_from_the_next_round_on);
    TEST(stopped_it_keeps_its_value);
    TEST(long_stretches_come_out_the_same);
    return check_finish();
}
