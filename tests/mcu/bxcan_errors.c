/// Error counters, bus-off and the way back, against RM0090, 32.7.6, and Bosch's CAN 2.0B,
/// section 8.
#include "can_chip.h"

#define ABOM    0x40U
#define EWGF    1U
#define EPVF    2U
#define BOFF    4U
#define ERRI    4U
#define SCE_IRQ 22U

static unsigned tec(void) {
    return peek(ESR) >> 16 & 0xFFU;
}

static unsigned rec(void) {
    return peek(ESR) >> 24;
}

static unsigned lec(void) {
    return peek(ESR) >> 4 & 7U;
}

static unsigned flags(void) {
    return peek(ESR) & 7U;
}

static void fail(unsigned times) {
    for (unsigned i = 0; i < times; i++) {
        (void)carry(BXCAN_BIT_ERROR);
    }
}

static void a_sender_counts_by_eight(void) {
    start_can(0);
    request(0, 0x100);
    fail(1);
    CHECK_EQ(tec(), 8);
    CHECK_EQ(lec(), 4); // bit recessive error
    CHECK_EQ(peek(TSR) & 8U, 8);
    (void)carry(BXCAN_SENT);
    CHECK_EQ(tec(), 7);
    CHECK_EQ(lec(), 0);
}

static void a_receiver_counts_by_one(void) {
    start_can(0);
    bxcan_hear_error(&chip.can[0]);
    bxcan_hear_error(&chip.can[0]);
    CHECK_EQ(rec(), 2);
    CHECK_EQ(lec(), 1); // stuff error
    hear(1);
    CHECK_EQ(rec(), 1);
    hear(1);
    hear(1);
    CHECK_EQ(rec(), 0);
}

static void a_passive_receiver_comes_back_to_120(void) {
    start_can(0);
    for (unsigned i = 0; i < 127U; i++) {
        bxcan_hear_error(&chip.can[0]);
    }
    CHECK_EQ(flags(), EWGF);
    bxcan_hear_error(&chip.can[0]);
    CHECK_EQ(flags(), EWGF | EPVF);
    bxcan_hear_error(&chip.can[0]);
    CHECK_EQ(rec(), 129);
    hear(1); // "reset to 120 if its value was higher than 128"
    CHECK_EQ(rec(), 120);
    CHECK_EQ(flags(), EWGF);
    for (unsigned i = 0; i < 300U; i++) {
        bxcan_hear_error(&chip.can[0]);
    }
    CHECK_EQ(rec(), 255);
}

static void warning_passive_and_off_at_96_128_and_256(void) {
    start_can(0);
    request(0, 0x100);
    fail(11);
    CHECK_EQ(flags(), 0); // 88
    fail(1);
    CHECK_EQ(tec(), 96);
    CHECK_EQ(flags(), EWGF);
    fail(3);
    CHECK_EQ(flags(), EWGF); // 120
    fail(1);
    CHECK_EQ(tec(), 128);
    CHECK_EQ(flags(), EWGF | EPVF);
    fail(15);
    CHECK_EQ(tec(), 248);
    CHECK_EQ(flags(), EWGF | EPVF);
    fail(1);
    CHECK_EQ(flags(), EWGF | EPVF | BOFF);
    CHECK(!bxcan_takes_part(&chip.can[0]));
    CHECK(!bxcan_listens(&chip.can[0]));
}

static void off_is_above_255(void) {
    start_can(0);
    request(0, 0x100);
    fail(1);
    (void)carry(BXCAN_SENT);
    request(0, 0x100);
    fail(31);
    CHECK_EQ(tec(), 255);
    CHECK_EQ(flags() & BOFF, 0);
    fail(1);
    CHECK_EQ(flags() & BOFF, BOFF);
}

static void alone_on_the_bus_it_ends_passive_not_off(void) {
    start_can(0);
    request(0, 0x100);
    for (unsigned i = 0; i < 100U; i++) {
        (void)carry(BXCAN_NO_ACKNOWLEDGE);
    }
    CHECK_EQ(tec(), 128);
    CHECK_EQ(flags(), EWGF | EPVF);
    CHECK_EQ(lec(), 3); // acknowledgment error
}

static void go_off(uint32_t mcr) {
    start_can(mcr);
    request(0, 0x100);
    fail(32);
    CHECK_EQ(flags() & BOFF, BOFF);
}

static void by_itself_with_abom_after_128_times_11_bits(void) {
    go_off(ABOM);
    pass_us(1300); // 1408 bits at 1 Mbit/s
    CHECK_EQ(flags() & BOFF, BOFF);
    pass_us(200);
    CHECK_EQ(flags(), 0);
    CHECK_EQ(tec(), 0);
    CHECK_EQ(rec(), 0);
    CHECK(bxcan_takes_part(&chip.can[0]));
    CHECK_EQ(bxcan_next(&chip.can[0], NULL), 0); // what was pending still is
}

static void without_abom_when_software_asks(void) {
    go_off(0);
    pass_us(1000000);
    CHECK_EQ(flags() & BOFF, BOFF);
    poke(MCR, INRQ);
    pass_us(100);
    CHECK_EQ(peek(MSR) & INAK, INAK);
    pass_us(10000);
    CHECK_EQ(flags() & BOFF, BOFF); // not while it stays in initialisation
    poke(MCR, 0);
    pass_us(1300);
    CHECK_EQ(flags() & BOFF, BOFF);
    pass_us(300);
    CHECK_EQ(flags(), 0);
}

static void interrupts_come_as_flags_rise(void) {
    start_can(0);
    poke(IER, UINT32_C(1) << 15 | 1U << 10); // ERRIE, BOFIE
    request(0, 0x100);
    fail(31);
    CHECK(!irq_is_pending(SCE_IRQ));
    fail(1);
    CHECK(irq_is_pending(SCE_IRQ));
    CHECK_EQ(peek(MSR) & ERRI, ERRI);
    poke(MSR, ERRI);
    CHECK_EQ(peek(MSR) & ERRI, 0);
    clear_irq(SCE_IRQ);
    pass_us(100);
    CHECK(!irq_is_pending(SCE_IRQ)); // the flag is up still, but did not rise again
    start_can(0);
    poke(IER, UINT32_C(1) << 15 | 1U << 8); // EWGIE
    request(0, 0x100);
    fail(11);
    CHECK(!irq_is_pending(SCE_IRQ));
    fail(1);
    CHECK(irq_is_pending(SCE_IRQ));
}

static void the_last_error_code_can_call(void) {
    start_can(0);
    poke(IER, UINT32_C(1) << 15 | 1U << 11); // LECIE
    hear(1);
    CHECK(!irq_is_pending(SCE_IRQ));
    bxcan_hear_error(&chip.can[0]);
    CHECK(irq_is_pending(SCE_IRQ));
    poke(ESR, 7U << 4); // software writes 7 to see the next one
    CHECK_EQ(lec(), 7);
    hear(1);
    CHECK_EQ(lec(), 0);
}

int main(void) {
    TEST(a_sender_counts_by_eight);
    TEST(a_receiver_counts_by_one);
    TEST(a_passive_receiver_comes_back_to_120);
    TEST(warning_passive_and_off_at_96_128_and_256);
    TEST(off_is_above_255);
    TEST(alone_on_the_bus_it_ends_passive_not_off);
    TEST(by_itself_with_abom_after_128_times_11_bits);
    TEST(without_abom_when_software_asks);
    TEST(interrupts_come_as_flags_rise);
    TEST(the_last_error_code_can_call);
    return check_finish();
}
