/// Timers, against RM0090, chapters 17 and 18.
#include "chip.h"

#define CR1   0x00U
#define DIER  0x0CU
#define SR    0x10U
#define EGR   0x14U
#define CCMR1 0x18U
#define CCMR2 0x1CU
#define CCER  0x20U
#define CNT   0x24U
#define PSC   0x28U
#define ARR   0x2CU
#define RCR   0x30U
#define CCR1  0x34U
#define CCR3  0x3CU
#define BDTR  0x44U
#define CEN   1U
#define UG    1U
#define UIF   1U

static void begin(void) {
    power_on();
    clock_everything();
}

static void reset_values(void) {
    begin();
    CHECK_EQ(peek(TIM3 + ARR), 0xFFFF);
    CHECK_EQ(peek(TIM2 + ARR), 0xFFFFFFFF); // 32 bits
    CHECK_EQ(peek(TIM1 + ARR), 0xFFFF);
    CHECK_EQ(peek(TIM3 + SR), 0);
    pass_cycles(100);
    CHECK_EQ(peek(TIM3 + CNT), 0);
}

static void it_counts_to_arr_and_starts_again(void) {
    begin();
    poke(TIM3 + ARR, 9);
    poke(TIM3 + CR1, CEN);
    pass_cycles(9);
    CHECK_EQ(peek(TIM3 + CNT), 9);
    CHECK_EQ(peek(TIM3 + SR) & UIF, 0);
    pass_cycles(1);
    CHECK_EQ(peek(TIM3 + CNT), 0);
    CHECK_EQ(peek(TIM3 + SR) & UIF, UIF);
    poke(TIM3 + SR, ~UIF);
    CHECK_EQ(peek(TIM3 + SR) & UIF, 0);
    pass_cycles(1000005);
    CHECK_EQ(peek(TIM3 + CNT), 5);
    poke(TIM3 + SR, 0xFFFF); // ones clear nothing
    CHECK_EQ(peek(TIM3 + SR) & UIF, UIF);
}

static void the_prescaler_takes_effect_at_an_update(void) {
    begin();
    poke(TIM3 + PSC, 15); // 1 MHz
    poke(TIM3 + CR1, CEN);
    pass_cycles(160);
    CHECK_EQ(peek(TIM3 + CNT), 160);
    poke(TIM3 + EGR, UG);
    CHECK_EQ(peek(TIM3 + CNT), 0);
    pass_cycles(160);
    CHECK_EQ(peek(TIM3 + CNT), 10);
    CHECK_EQ(peek(TIM3 + SR) & UIF, UIF);
}

static void urs_and_udis(void) {
    begin();
    poke(TIM3 + CR1, 4); // URS: UG raises no flag
    poke(TIM3 + PSC, 7);
    poke(TIM3 + EGR, UG);
    CHECK_EQ(peek(TIM3 + SR) & UIF, 0);
    poke(TIM3 + CR1, 4 | CEN);
    pass_cycles(80);
    CHECK_EQ(peek(TIM3 + CNT), 10); // but it was an update
    begin();
    poke(TIM3 + ARR, 9);
    poke(TIM3 + CR1, 2 | CEN); // UDIS
    poke(TIM3 + PSC, 7);
    pass_cycles(25);
    CHECK_EQ(peek(TIM3 + SR) & UIF, 0);
    CHECK_EQ(peek(TIM3 + CNT), 5);
}

static void the_timer_clock_is_twice_a_divided_bus(void) {
    power_on();
    run_at_168_mhz();
    clock_everything();
    poke(TIM3 + PSC, 83); // 84 MHz
    poke(TIM3 + EGR, UG);
    poke(TIM3 + CR1, CEN);
    poke(TIM1 + PSC, 167); // 168 MHz
    poke(TIM1 + EGR, UG);
    poke(TIM1 + CR1, CEN);
    pass_us(10000);
    CHECK_NEAR(peek(TIM3 + CNT), 10000, 1);
    CHECK_NEAR(peek(TIM1 + CNT), 10000, 1);
}

static struct timer_pulse pulse(unsigned timer, unsigned channel) {
    return timer_pulse_of(&chip.timer[timer - 1U], channel - 1U);
}

static void begin_pwm(uint32_t mode) {
    begin();
    poke(TIM3 + PSC, 15);
    poke(TIM3 + ARR, 19999);
    poke(TIM3 + CCMR1, mode << 4 | 8U); // with preload
    poke(TIM3 + CCER, 1);
    poke(TIM3 + CCR1, 1500);
    poke(TIM3 + EGR, UG);
    poke(TIM3 + CR1, CEN | 0x80U);
}

static void pwm_mode_1_is_high_below_the_compare_value(void) {
    begin_pwm(6);
    CHECK_EQ(pulse(3, 1).high_cycles, 1500 * 16);
    CHECK_EQ(pulse(3, 1).period_cycles, 20000 * 16);
    CHECK_EQ(pulse(3, 2).period_cycles, 0); // not switched on
    poke(TIM3 + CCER, 3);                   // active low
    CHECK_EQ(pulse(3, 1).high_cycles, 18500 * 16);
    poke(TIM3 + CCER, 0);
    CHECK_EQ(pulse(3, 1).period_cycles, 0);
}

static void pwm_mode_2_is_the_other_way_round(void) {
    begin_pwm(7);
    CHECK_EQ(pulse(3, 1).high_cycles, 18500 * 16);
    begin_pwm(4); // forced inactive: no pulses
    CHECK_EQ(pulse(3, 1).period_cycles, 0);
}

static void a_preloaded_value_waits_for_the_update(void) {
    begin_pwm(6);
    pass_cycles(160000);
    poke(TIM3 + CCR1, 1000);
    poke(TIM3 + ARR, 9999);
    CHECK_EQ(peek(TIM3 + CCR1), 1000);
    CHECK_EQ(pulse(3, 1).high_cycles, 1500 * 16);
    CHECK_EQ(pulse(3, 1).period_cycles, 20000 * 16);
    pass_cycles(160000);
    CHECK_EQ(pulse(3, 1).high_cycles, 1000 * 16);
    CHECK_EQ(pulse(3, 1).period_cycles, 10000 * 16);
    poke(TIM3 + CR1, CEN);       // no preload of ARR
    poke(TIM3 + CCMR1, 6U << 4); // nor of CCR1
    poke(TIM3 + CCR1, 700);
    poke(TIM3 + ARR, 4999);
    CHECK_EQ(pulse(3, 1).high_cycles, 700 * 16);
    CHECK_EQ(pulse(3, 1).period_cycles, 5000 * 16);
}

static void never_and_always_high_are_no_pulses(void) {
    begin_pwm(6);
    poke(TIM3 + CCR1, 0);
    poke(TIM3 + EGR, UG);
    CHECK_EQ(pulse(3, 1).period_cycles, 0);
    poke(TIM3 + CCR1, 20000);
    poke(TIM3 + EGR, UG);
    CHECK_EQ(pulse(3, 1).period_cycles, 0);
    poke(TIM3 + CCR1, 19999);
    poke(TIM3 + EGR, UG);
    CHECK_EQ(pulse(3, 1).high_cycles, 19999 * 16);
}

static void tim1_needs_its_main_output_enabled(void) {
    begin();
    poke(TIM1 + ARR, 999);
    poke(TIM1 + CCMR2, 6U << 4);
    poke(TIM1 + CCER, 1U << 8);
    poke(TIM1 + CCR3, 250);
    poke(TIM1 + CR1, CEN);
    CHECK_EQ(pulse(1, 3).period_cycles, 0);
    poke(TIM1 + BDTR, 0x8000);
    CHECK_EQ(pulse(1, 3).high_cycles, 250);
    CHECK_EQ(pulse(1, 3).period_cycles, 1000);
}

static void tim1_repeats_before_an_update(void) {
    begin();
    poke(TIM1 + ARR, 9);
    poke(TIM1 + RCR, 2);
    poke(TIM1 + EGR, UG);
    poke(TIM1 + SR, 0);
    poke(TIM1 + CR1, CEN);
    pass_cycles(29);
    CHECK_EQ(peek(TIM1 + SR) & UIF, 0);
    pass_cycles(1);
    CHECK_EQ(peek(TIM1 + SR) & UIF, UIF);
}

static void one_pulse_mode_stops(void) {
    begin();
    poke(TIM3 + ARR, 9);
    poke(TIM3 + CR1, CEN | 8U);
    pass_cycles(25);
    CHECK_EQ(peek(TIM3 + CR1) & CEN, 0);
    CHECK_EQ(peek(TIM3 + CNT), 0);
}

static void interrupts_come_on_time(void) {
    begin();
    poke(TIM3 + ARR, 99);
    poke(TIM3 + CCR1, 40);
    poke(TIM3 + DIER, 3); // update and compare 1
    poke(TIM3 + CR1, CEN);
    pass_cycles(39);
    CHECK(!irq_is_pending(29));
    pass_cycles(1);
    CHECK(irq_is_pending(29));
    CHECK_EQ(peek(TIM3 + SR), 2);
    poke(TIM3 + SR, 0);
    clear_irq(29);
    pass_cycles(59);
    CHECK(!irq_is_pending(29));
    pass_cycles(1);
    CHECK(irq_is_pending(29));
    CHECK_EQ(peek(TIM3 + SR) & UIF, UIF);
    poke(TIM1 + DIER, 1);
    poke(TIM1 + EGR, UG);
    CHECK(irq_is_pending(25)); // TIM1_UP_TIM10
}

static void tim2_counts_32_bits(void) {
    begin();
    poke(TIM2 + CNT, 0xFFFF);
    poke(TIM2 + CR1, CEN);
    pass_cycles(2);
    CHECK_EQ(peek(TIM2 + CNT), 0x10001);
    poke(TIM3 + CNT, 0x12345);
    CHECK_EQ(peek(TIM3 + CNT), 0x2345);
}

static void the_counter_keeps_its_pace_over_a_change_of_clock(void) {
    begin();
    poke(TIM3 + CR1, CEN);
    pass_cycles(1000);
    poke(RCC + 8U, 9U << 4); // HCLK / 4: the timer slows down as well
    CHECK_EQ(peek(TIM3 + CNT), 1000);
    pass_us(100);
    CHECK_EQ(peek(TIM3 + CNT), 1400);
    begin();
    poke(TIM3 + CR1, CEN);
    pass_cycles(1000);
    poke(RCC + 8U, 5U << 10); // APB1 a quarter: the timer gets half of HCLK from now on
    pass_cycles(1000);
    CHECK_EQ(peek(TIM3 + CNT), 1500);
}

static void what_has_no_model_complains(void) {
    begin();
    poke(TIM3 + CR1, 0x10); // counting down
    CHECK_EQ(chip.complaints, 1);
    begin();
    poke(TIM3 + CCMR1, 1); // input capture
    CHECK_EQ(chip.complaints, 1);
}

int main(void) {
    TEST(reset_values);
    TEST(it_counts_to_arr_and_starts_again);
    TEST(the_prescaler_takes_effect_at_an_update);
    TEST(urs_and_udis);
    TEST(the_timer_clock_is_twice_a_divided_bus);
    TEST(pwm_mode_1_is_high_below_the_compare_value);
    TEST(pwm_mode_2_is_the_other_way_round);
    TEST(a_preloaded_value_waits_for_the_update);
    TEST(never_and_always_high_are_no_pulses);
    TEST(tim1_needs_its_main_output_enabled);
    TEST(tim1_repeats_before_an_update);
    TEST(one_pulse_mode_stops);
    TEST(interrupts_come_on_time);
    TEST(tim2_counts_32_bits);
    TEST(the_counter_keeps_its_pace_over_a_change_of_clock);
    TEST(what_has_no_model_complains);
    return check_finish();
}
