/// The independent watchdog, against RM0090, chapter 21.
#include "chip.h"

#define KR  (IWDG + 0x0U)
#define PR  (IWDG + 0x4U)
#define RLR (IWDG + 0x8U)
#define SR  (IWDG + 0xCU)

/// Microseconds until it bites; 0: not within 60 s.
static uint64_t bites_after_us(void) {
    const uint64_t from = soc_now_ns(&chip);
    for (unsigned i = 0; i < 600000U && chip.reset_wanted == SOC_RESET_NONE; i++) {
        pass_us(100);
    }
    return chip.reset_wanted == SOC_RESET_WATCHDOG ? (soc_now_ns(&chip) - from) / 1000U : 0U;
}

static void set_up(uint32_t prescaler, uint32_t reload) {
    poke(KR, 0xCCCC);
    poke(KR, 0x5555);
    poke(PR, prescaler);
    poke(RLR, reload);
    pass_us(1000);
    poke(KR, 0xAAAA);
}

static void off_it_never_bites(void) {
    power_on();
    CHECK_EQ(peek(RLR), 0xFFF);
    CHECK_EQ(peek(PR), 0);
    CHECK_EQ(bites_after_us(), 0);
}

static void time_out_by_prescaler_and_reload(void) {
    // 4 * 2^PR * (RLR + 1) / LSI; table 107 of the manual has those of 32 kHz.
    static const uint32_t cases[][3] = {{0, 0xFFF, 512000},  {0, 0, 125},          {3, 31, 32000},
                                        {4, 0xFFF, 8192000}, {6, 0xFFF, 32768000}, {7, 99, 800000}};
    for (unsigned i = 0; i < sizeof cases / sizeof *cases; i++) {
        power_on();
        set_up(cases[i][0], cases[i][1]);
        CHECK_NEAR(bites_after_us(), cases[i][2], 100);
    }
}

static void it_follows_the_oscillators_speed(void) {
    power_on_with((struct soc_options){.hse_hz = 8000000, .lsi_hz = 17000});
    set_up(0, 135);
    CHECK_NEAR(bites_after_us(), 32000, 100);
    power_on_with((struct soc_options){.hse_hz = 8000000, .lsi_hz = 47000});
    set_up(0, 135);
    CHECK_NEAR(bites_after_us(), 11574, 100);
}

static void feeding_keeps_it_quiet(void) {
    power_on();
    set_up(0, 79); // 10 ms
    for (unsigned i = 0; i < 100U; i++) {
        pass_us(9000);
        poke(KR, 0xAAAA);
    }
    CHECK_EQ(chip.reset_wanted, SOC_RESET_NONE);
    CHECK_NEAR(bites_after_us(), 10000, 100);
}

static void registers_need_the_key(void) {
    power_on();
    poke(KR, 0xCCCC);
    poke(PR, 3);
    poke(RLR, 99);
    CHECK_EQ(peek(PR), 0);
    CHECK_EQ(peek(RLR), 0xFFF);
    poke(KR, 0x5555);
    poke(KR, 0xAAAA); // any other key locks again
    poke(PR, 3);
    CHECK_EQ(peek(PR), 0);
}

static void values_take_time_to_cross(void) {
    power_on();
    poke(KR, 0xCCCC);
    poke(KR, 0x5555);
    poke(PR, 3);
    poke(RLR, 99);
    CHECK_EQ(peek(SR), 3);
    poke(PR, 5); // lost: the first is still on its way
    pass_us(1000);
    CHECK_EQ(peek(SR), 0);
    CHECK_EQ(peek(PR), 3);
    poke(PR, 5);
    CHECK_EQ(peek(SR), 1);
    CHECK_EQ(peek(PR), 5);
}

static void nothing_stops_it_but_a_reset(void) {
    power_on();
    set_up(0, 79);
    poke(KR, 0);
    poke(RCC + 0x74U, 0); // LSION off
    CHECK_NEAR(bites_after_us(), 10000, 100);
    soc_reset(&chip, SOC_RESET_WATCHDOG);
    CHECK_EQ(bites_after_us(), 0);
    CHECK((peek(RCC + 0x74U) & UINT32_C(1) << 29) != 0U);
}

static void starting_it_starts_its_oscillator(void) {
    power_on();
    CHECK_EQ(peek(RCC + 0x74U) & 2U, 0);
    poke(KR, 0xCCCC);
    pass_us(100);
    CHECK_EQ(peek(RCC + 0x74U) & 2U, 2);
}

int main(void) {
    TEST(off_it_never_bites);
    TEST(time_out_by_prescaler_and_reload);
    TEST(it_follows_the_oscillators_speed);
    TEST(feeding_keeps_it_quiet);
    TEST(registers_need_the_key);
    TEST(values_take_time_to_cross);
    TEST(nothing_stops_it_but_a_reset);
    TEST(starting_it_starts_its_oscillator);
    return check_finish();
}
