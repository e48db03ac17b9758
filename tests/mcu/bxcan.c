/// The CAN controller's modes, mailboxes and receive queues, against RM0090, chapter 32.
#include "can_chip.h"

static void reset_values(void) {
    power_on();
    clock_everything();
    CHECK_EQ(peek(MCR), 0x00010002);
    CHECK_EQ(peek(MSR), 0x00000C02);
    CHECK_EQ(peek(TSR), 0x1C000000);
    CHECK_EQ(peek(RF0R), 0);
    CHECK_EQ(peek(IER), 0);
    CHECK_EQ(peek(ESR), 0);
    CHECK_EQ(peek(BTR), 0x01230000);
    CHECK_EQ(peek(FMR), 0x2A1C0E01);
    CHECK_EQ(peek(FA1R), 0);
}

static void modes_are_asked_for_and_acknowledged(void) {
    power_on();
    clock_everything();
    poke(MCR, INRQ); // no SLEEP: out of sleep into initialisation
    pass_us(100);
    CHECK_EQ(peek(MSR) & 3U, INAK);
    poke(BTR, BTR_1_MBIT);
    poke(MCR, 0);
    CHECK_EQ(peek(MSR) & 3U, INAK);
    pass_us(9); // 11 recessive bits first
    CHECK_EQ(peek(MSR) & 3U, INAK);
    pass_us(20);
    CHECK_EQ(peek(MSR) & 3U, 0);
    poke(MCR, 2);
    pass_us(10);
    CHECK_EQ(peek(MSR) & 3U, 2);
    CHECK_EQ(peek(MSR) & 0x10U, 0x10); // SLAKI
    poke(MSR, 0x10);
    CHECK_EQ(peek(MSR) & 0x10U, 0);
}

static void stuck_it_never_acknowledges(void) {
    power_on_with((struct soc_options){.hse_hz = 8000000, .stuck = SOC_STUCK_CAN});
    clock_everything();
    poke(MCR, INRQ);
    pass_us(1000000);
    CHECK_EQ(peek(MSR) & INAK, 0);
}

static void bit_timing_only_in_initialisation(void) {
    start_can(0);
    poke(BTR, 0);
    CHECK_EQ(peek(BTR), BTR_1_MBIT);
    CHECK_EQ(chip.complaints, 1);
    // tq * (1 + BS1 + BS2), tq = (BRP + 1) / PCLK1 (32.7.7)
    CHECK_EQ(bxcan_bit_ps(&chip.can[0]), 1000000);
    poke(MCR, INRQ);
    pass_us(10);
    poke(BTR, 5U << 20 | 6U << 16 | 3U);
    CHECK_EQ(bxcan_bit_ps(&chip.can[0]), (1 + 7 + 6) * 4 * 62500);
}

static void a_mailbox_goes_through_its_states(void) {
    start_can(0);
    poke(TDTR(0), 3);
    poke(TDLR(0), 0x00332211);
    poke(TIR(0), 0x141U << 21 | TXRQ);
    CHECK_EQ(peek(TSR) >> 26 & 7U, 6); // TME of the others
    CHECK_EQ(peek(TIR(0)) & TXRQ, TXRQ);
    struct can_frame frame;
    CHECK_EQ(bxcan_next(&chip.can[0], &frame), 0);
    CHECK_EQ(frame.id, 0x141);
    CHECK_EQ(frame.length, 3);
    CHECK(frame.data[0] == 0x11 && frame.data[1] == 0x22 && frame.data[2] == 0x33);
    bxcan_begin(&chip.can[0], 0);
    CHECK_EQ(peek(MSR) & 0x100U, 0x100); // TXM
    bxcan_end(&chip.can[0], BXCAN_SENT);
    CHECK_EQ(peek(TSR) & 0xFFU, 3); // RQCP, TXOK
    CHECK_EQ(peek(TSR) >> 26 & 7U, 7);
    CHECK_EQ(peek(TIR(0)) & TXRQ, 0);
    poke(TSR, 1); // RQCP clears TXOK with it
    CHECK_EQ(peek(TSR) & 0xFFU, 0);
}

static void extended_and_remote_frames(void) {
    struct can_frame frame;
    start_can(0);
    poke(TDTR(1), 8);
    poke(TIR(1), 0x12345678U << 3 | 4U | 2U | TXRQ);
    CHECK_EQ(bxcan_next(&chip.can[0], &frame), 1);
    CHECK_EQ(frame.id, 0x12345678);
    CHECK_EQ(frame.flags, CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE);
}

static void the_lowest_identifier_goes_first(void) {
    start_can(0);
    request(0, 0x300);
    request(1, 0x100);
    request(2, 0x200);
    CHECK_EQ(peek(TSR) >> 29, 1);      // LOW: mailbox 0
    CHECK_EQ(peek(TSR) >> 24 & 3U, 0); // CODE: all pending, the lowest priority
    CHECK_EQ(carry(BXCAN_SENT), 1);
    CHECK_EQ(peek(TSR) >> 24 & 3U, 1); // the free one
    CHECK_EQ(carry(BXCAN_SENT), 2);
    CHECK_EQ(peek(TSR) >> 29, 0); // only one is left
    CHECK_EQ(carry(BXCAN_SENT), 0);
    CHECK_EQ(carry(BXCAN_SENT), -1);
    request(2, 0x100);
    request(1, 0x100); // alike: the lower mailbox
    CHECK_EQ(carry(BXCAN_SENT), 1);
    // A standard frame goes before an extended one with the same first 11 bits.
    start_can(0);
    poke(TIR(0), 0x100U << 21 | 4U | TXRQ);
    poke(TIR(1), 0x100U << 21 | TXRQ);
    CHECK_EQ(carry(BXCAN_SENT), 1);
}

static void with_txfp_the_first_request_goes_first(void) {
    start_can(4);
    request(1, 0x300);
    request(2, 0x100);
    request(0, 0x200);
    CHECK_EQ(peek(TSR) >> 29, 1);
    CHECK_EQ(carry(BXCAN_SENT), 1);
    CHECK_EQ(carry(BXCAN_SENT), 2);
    CHECK_EQ(carry(BXCAN_SENT), 0);
}

static void a_request_can_be_withdrawn(void) {
    start_can(0);
    request(0, 0x100);
    poke(TSR, ABRQ);
    CHECK_EQ(peek(TSR) & 0xFFU, 1); // RQCP without TXOK
    CHECK_EQ(bxcan_next(&chip.can[0], NULL), -1);
    request(0, 0x100); // on the wire already: what became of it decides
    bxcan_begin(&chip.can[0], 0);
    poke(TSR, ABRQ);
    CHECK_EQ(peek(TSR) & 0xFFU, ABRQ);
    bxcan_end(&chip.can[0], BXCAN_SENT);
    CHECK_EQ(peek(TSR) & 0xFFU, 3);
    request(0, 0x100);
    bxcan_begin(&chip.can[0], 0);
    poke(TSR, ABRQ);
    bxcan_end(&chip.can[0], BXCAN_BIT_ERROR);
    CHECK_EQ(peek(TSR) & 0xFFU, 9); // RQCP, TERR
    CHECK_EQ(bxcan_next(&chip.can[0], NULL), -1);
}

static void a_failure_is_tried_again_unless_nart(void) {
    start_can(0);
    request(0, 0x100);
    (void)carry(BXCAN_BIT_ERROR);
    CHECK_EQ(bxcan_next(&chip.can[0], NULL), 0);
    bxcan_lost_arbitration(&chip.can[0], 0);
    CHECK_EQ(bxcan_next(&chip.can[0], NULL), 0);
    start_can(0x10);
    request(0, 0x100);
    (void)carry(BXCAN_BIT_ERROR);
    CHECK_EQ(peek(TSR) & 0xFFU, 9);
    request(0, 0x100);
    bxcan_lost_arbitration(&chip.can[0], 0);
    CHECK_EQ(peek(TSR) & 0xFFU, 5); // RQCP, ALST
    CHECK_EQ(bxcan_next(&chip.can[0], NULL), -1);
}

static void a_queue_holds_three(void) {
    start_can(0);
    hear(0x101);
    CHECK_EQ(peek(RF0R), 1);
    CHECK_EQ(peek(RIR(0)), 0x101U << 21);
    CHECK_EQ(peek(RDTR(0)), 1);
    CHECK_EQ(peek(RDLR(0)), 1);
    hear(0x102);
    hear(0x103);
    CHECK_EQ(peek(RF0R), 3 | 8); // FULL
    hear(0x104);
    CHECK_EQ(peek(RF0R), 3 | 8 | 16); // FOVR: the last one is overwritten
    poke(RF0R, 16 | 8);
    CHECK_EQ(peek(RF0R), 3);
    static const uint32_t ids[] = {0x101, 0x102, 0x104};
    for (unsigned i = 0; i < 3U; i++) {
        CHECK_EQ(peek(RIR(0)), ids[i] << 21);
        poke(RF0R, 32); // RFOM
    }
    CHECK_EQ(peek(RF0R), 0);
    CHECK_EQ(peek(RF1R), 0);
}

static void a_locked_queue_drops_the_new_one(void) {
    start_can(8);
    for (uint32_t id = 0x101; id <= 0x104U; id++) {
        hear(id);
    }
    poke(RF0R, 32);
    poke(RF0R, 32);
    CHECK_EQ(peek(RIR(0)), 0x103U << 21);
}

static void received_frames_have_their_fields(void) {
    start_can(0);
    const struct can_frame frame = {.id = 0x1ABCDEF0,
                                    .flags = CAN_FRAME_EXTENDED,
                                    .length = 8,
                                    .data = {1, 2, 3, 4, 5, 6, 7, 8}};
    bxcan_hear(&chip.can[0], &frame);
    CHECK_EQ(peek(RIR(0)), 0x1ABCDEF0U << 3 | 4U);
    CHECK_EQ(peek(RDTR(0)) & 15U, 8);
    CHECK_EQ(peek(RDLR(0)), 0x04030201);
    CHECK_EQ(peek(RDHR(0)), 0x08070605);
}

static void interrupts(void) {
    start_can(0);
    poke(IER, 1 | 2); // TMEIE, FMPIE0
    request(0, 0x100);
    CHECK(!irq_is_pending(19));
    (void)carry(BXCAN_SENT);
    CHECK(irq_is_pending(19)); // CAN1_TX
    poke(TSR, 1);
    clear_irq(19);
    CHECK(!irq_is_pending(19));
    hear(0x123);
    CHECK(irq_is_pending(20)); // CAN1_RX0
    CHECK(!irq_is_pending(21));
    poke(RF0R, 32);
    clear_irq(20);
    CHECK(!irq_is_pending(20));
    poke(IER, 4 | 8); // FFIE0, FOVIE0
    hear(1);
    hear(2);
    CHECK(!irq_is_pending(20));
    hear(3);
    CHECK(irq_is_pending(20));
    poke(RF0R, 8);
    clear_irq(20);
    CHECK(!irq_is_pending(20));
    hear(4);
    CHECK(irq_is_pending(20));
}

static void loop_back_hears_itself(void) {
    power_on();
    clock_everything();
    poke(MCR, INRQ);
    pass_us(10);
    poke(BTR, BTR_1_MBIT | UINT32_C(3) << 30); // silent and loop-back: a self-test
    let_everything_in();
    poke(MCR, 0);
    pass_us(50);
    request(0, 0x222);
    CHECK_EQ(peek(RF0R), 0);
    pass_us(60);
    CHECK_EQ(peek(RF0R) & 3U, 1);
    CHECK_EQ(peek(RIR(0)), 0x222U << 21);
    CHECK_EQ(peek(TSR) & 3U, 3);
    CHECK(!bxcan_takes_part(&chip.can[0]));
}

static void silent_it_listens_and_sends_nothing(void) {
    start_can(0);
    CHECK(bxcan_takes_part(&chip.can[0]));
    poke(MCR, INRQ);
    pass_us(10);
    CHECK(!bxcan_takes_part(&chip.can[0]));
    CHECK(!bxcan_listens(&chip.can[0]));
    poke(BTR, BTR_1_MBIT | UINT32_C(1) << 31);
    poke(MCR, 0);
    pass_us(50);
    CHECK(bxcan_listens(&chip.can[0]));
    CHECK(!bxcan_takes_part(&chip.can[0]));
}

static void a_reset_by_software(void) {
    start_can(0);
    hear(1);
    poke(MCR, 0x8000);
    CHECK_EQ(peek(MCR), 0x00010002);
    CHECK_EQ(peek(MSR) & 3U, 2);
    CHECK_EQ(peek(RF0R), 0);
}

static void writing_a_pending_mailbox_complains(void) {
    start_can(0);
    request(0, 0x100);
    poke(TDLR(0), 1);
    CHECK_EQ(chip.complaints, 1);
}

int main(void) {
    TEST(reset_values);
    TEST(modes_are_asked_for_and_acknowledged);
    TEST(stuck_it_never_acknowledges);
    TEST(bit_timing_only_in_initialisation);
    TEST(a_mailbox_goes_through_its_states);
    TEST(extended_and_remote_frames);
    TEST(the_lowest_identifier_goes_first);
    TEST(with_txfp_the_first_request_goes_first);
    TEST(a_request_can_be_withdrawn);
    TEST(a_failure_is_tried_again_unless_nart);
    TEST(a_queue_holds_three);
    TEST(a_locked_queue_drops_the_new_one);
    TEST(received_frames_have_their_fields);
    TEST(interrupts);
    TEST(loop_back_hears_itself);
    TEST(silent_it_listens_and_sends_nothing);
    TEST(a_reset_by_software);
    TEST(writing_a_pending_mailbox_complains);
    return check_finish();
}
