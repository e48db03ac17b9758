/// Which frames pass, into which queue and with which number: RM0090, 32.7.4.
#include "can_chip.h"

/// What a frame is to be compared with, as in figure 342 of the manual.
static uint32_t wide(uint32_t standard) {
    return standard << 21;
}

static uint32_t wide_extended(uint32_t id) {
    return id << 3 | 4U;
}

static uint32_t narrow(uint32_t standard) {
    return standard << 5;
}

static void begin(void) {
    start_can(0);
    poke(FMR, peek(FMR) | 1U);
    poke(FA1R, 0);
}

static void bank(unsigned number, bool list, bool scale_32, unsigned fifo, uint32_t a, uint32_t b) {
    const uint32_t bit = UINT32_C(1) << number;
    poke(FM1R, list ? peek(FM1R) | bit : peek(FM1R) & ~bit);
    poke(FS1R, scale_32 ? peek(FS1R) | bit : peek(FS1R) & ~bit);
    poke(FFA1R, fifo != 0U ? peek(FFA1R) | bit : peek(FFA1R) & ~bit);
    poke(FR(number, 0), a);
    poke(FR(number, 1), b);
    poke(FA1R, peek(FA1R) | bit);
}

static void done(void) {
    poke(FMR, peek(FMR) & ~1U);
}

/// Returns FIFO * 256 + number, or -1.
static int match(uint32_t id, uint8_t flags) {
    const struct can_frame frame = {.id = id, .flags = flags};
    const struct bxcan_match result = bxcan_filters_match(&chip.filters, 0, &frame);
    return result.passes ? result.fifo * 256 + result.number : -1;
}

static void nothing_passes_without_a_filter(void) {
    begin();
    done();
    CHECK_EQ(match(0x123, 0), -1);
    hear(0x123);
    CHECK_EQ(peek(RF0R), 0);
}

static void a_32_bit_mask(void) {
    begin();
    bank(0, false, true, 0, wide(0x140), wide(0x7F0) | 4U);
    done();
    CHECK_EQ(match(0x140, 0), 0);
    CHECK_EQ(match(0x14F, 0), 0);
    CHECK_EQ(match(0x150, 0), -1);
    CHECK_EQ(match(0x140U << 18, CAN_FRAME_EXTENDED), -1); // IDE must be 0
}

static void a_32_bit_list(void) {
    begin();
    bank(0, true, true, 0, wide(0x140), wide_extended(0x12345));
    done();
    CHECK_EQ(match(0x140, 0), 0);
    CHECK_EQ(match(0x12345, CAN_FRAME_EXTENDED), 1);
    CHECK_EQ(match(0x12346, CAN_FRAME_EXTENDED), -1);
    CHECK_EQ(match(0x141, 0), -1);
    CHECK_EQ(match(0x140, CAN_FRAME_REMOTE), -1); // RTR is part of it
}

static void a_16_bit_mask_is_two_filters(void) {
    begin();
    bank(0, false, false, 1, narrow(0x140) | narrow(0x7FE) << 16,
         narrow(0x200) | narrow(0x7FF) << 16);
    done();
    CHECK_EQ(match(0x141, 0), 256 + 0);
    CHECK_EQ(match(0x142, 0), -1);
    CHECK_EQ(match(0x200, 0), 256 + 1);
    CHECK_EQ(match(0x201, 0), -1);
}

static void a_16_bit_list_is_four(void) {
    begin();
    bank(0, true, false, 0, narrow(0x141) | narrow(0x142) << 16,
         narrow(0x143) | narrow(0x144) << 16);
    done();
    for (uint32_t id = 0x140; id <= 0x145U; id++) {
        CHECK_EQ(match(id, 0), id >= 0x141U && id <= 0x144U ? (int)(id - 0x141U) : -1);
    }
    // Bits 4, 3 and 2 to 0 are RTR, IDE and EXID[17:15].
    begin();
    bank(0, true, false, 0, (narrow(0x141) | 0x10U) | (narrow(0x142) | 0x0DU) << 16, 0);
    done();
    CHECK_EQ(match(0x141, CAN_FRAME_REMOTE), 0);
    CHECK_EQ(match(0x142U << 18 | 5U << 15, CAN_FRAME_EXTENDED), 1);
    CHECK_EQ(match(0x142U << 18 | 4U << 15, CAN_FRAME_EXTENDED), -1);
}

static void numbers_count_on_by_queue_active_or_not(void) {
    // The example of figure 343: banks of all kinds, some of them off.
    begin();
    bank(0, true, true, 0, wide(1), wide(2));                                          // 0, 1
    bank(1, false, true, 0, wide(3), wide(0x7FF));                                     // 2
    bank(3, true, false, 0, narrow(4) | narrow(5) << 16, narrow(6) | narrow(7) << 16); // 3 to 6
    bank(4, true, true, 0, wide(0x700), wide(0x701));                                  // 7, 8: off
    bank(5, false, false, 0, narrow(8) | narrow(0x7FF) << 16, narrow(9) | narrow(0x7FF) << 16); // 9
    bank(2, false, false, 1, narrow(10) | narrow(0x7FF) << 16, narrow(11) | narrow(0x7FF) << 16);
    bank(6, false, true, 1, wide(12), wide(0x7FF)); // 2 of FIFO 1
    poke(FA1R, peek(FA1R) & ~(UINT32_C(1) << 4));
    // The banks beyond 6 have two 16-bit filters each by default, and belong to FIFO 0.
    done();
    static const int wanted[] = {0, 1, 2, 3, 4, 5, 6, 9, 10, 256, 257, 258};
    for (uint32_t id = 1; id <= 12U; id++) {
        CHECK_EQ(match(id, 0), wanted[id - 1U]);
    }
    CHECK_EQ(match(0x700, 0), -1);
}

static void the_better_filter_decides(void) {
    begin();
    bank(0, false, false, 0, narrow(0x100) | narrow(0x7FF) << 16, 0xFFE0FFE0U); // 16 bits, mask
    bank(1, false, true, 1, wide(0x100), wide(0x7FF));                          // 32 bits, mask
    done();
    CHECK_EQ(match(0x100, 0), 256); // 32 bits before 16
    begin();
    bank(2, true, true, 0, wide(0x100), wide(0x101));
    bank(1, false, true, 1, wide(0x100), wide(0x7FF));
    poke(FA1R, 6);
    done();
    CHECK_EQ(match(0x100, 0) / 256, 0); // a list before a mask
    begin();
    bank(1, true, true, 1, wide(0x100), wide(0x101));
    bank(2, true, true, 0, wide(0x100), wide(0x102));
    poke(FA1R, 6);
    done();
    CHECK_EQ(match(0x100, 0) / 256, 1); // alike: the lower number
}

static void while_they_are_set_up_nothing_is_received(void) {
    start_can(0);
    poke(FMR, peek(FMR) | 1U);
    hear(0x123);
    CHECK_EQ(peek(RF0R), 0);
    done();
    hear(0x123);
    CHECK_EQ(peek(RF0R), 1);
}

static void what_is_active_can_not_be_written(void) {
    start_can(0);
    poke(FM1R, 0xFF);
    CHECK_EQ(peek(FM1R), 0); // only with FINIT
    poke(FR(0, 0), 0x55);
    CHECK_EQ(peek(FR(0, 0)), 0);
    poke(FR(5, 0), 0x55); // not active: it can
    CHECK_EQ(peek(FR(5, 0)), 0x55);
}

static void the_number_comes_with_the_frame(void) {
    begin();
    bank(0, true, false, 1, narrow(0x141) | narrow(0x142) << 16,
         narrow(0x143) | narrow(0x144) << 16);
    done();
    hear(0x143);
    CHECK_EQ(peek(RF1R), 1);
    CHECK_EQ(peek(RDTR(1)), 2U << 8 | 1U);
}

static void the_banks_are_shared_out(void) {
    begin();
    bank(13, false, true, 0, 0, 0);
    bank(14, false, true, 0, 0, 0);
    done();
    const struct can_frame frame = {.id = 5};
    // Before it: bank 0 with one filter (start_can), twelve of two.
    CHECK_EQ(bxcan_filters_match(&chip.filters, 0, &frame).number, 25);
    CHECK_EQ(bxcan_filters_match(&chip.filters, 1, &frame).number, 0);
    poke(FMR, (peek(FMR) & ~0x3F00U) | 20U << 8); // CAN2SB: CAN2 has banks 20 to 27
    CHECK(!bxcan_filters_match(&chip.filters, 1, &frame).passes);
    CHECK_EQ(peek(CAN2 + 0x21CU), 0); // CAN2 has no filter registers of its own
}

int main(void) {
    TEST(nothing_passes_without_a_filter);
    TEST(a_32_bit_mask);
    TEST(a_32_bit_list);
    TEST(a_16_bit_mask_is_two_filters);
    TEST(a_16_bit_list_is_four);
    TEST(numbers_count_on_by_queue_active_or_not);
    TEST(the_better_filter_decides);
    TEST(while_they_are_set_up_nothing_is_received);
    TEST(what_is_active_can_not_be_written);
    TEST(the_number_comes_with_the_frame);
    TEST(the_banks_are_shared_out);
    return check_finish();
}
