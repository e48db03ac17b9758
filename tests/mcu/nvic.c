/// Which exception goes next, against the ARMv7-M manual, B1.5 and B3.4, and PM0214, 4.3.
#include "chip.h"

#define ISER  0xE000E100U
#define ICER  0xE000E180U
#define ISPR  0xE000E200U
#define ICPR  0xE000E280U
#define IABR  0xE000E300U
#define IPR   0xE000E400U
#define STIR  0xE000EF00U
#define AIRCR 0xE000ED0CU
#define KEY   0x05FA0000U

static const struct nvic_masks open_masks = {false, false, 0};

static unsigned next(void) {
    return nvic_preempts(&chip.nvic, &open_masks);
}

static unsigned next_with(struct nvic_masks masks) {
    return nvic_preempts(&chip.nvic, &masks);
}

static void set_priority(unsigned irq, uint8_t priority) {
    soc_write(&chip, IPR + irq, 1, priority);
}

static void enable(unsigned irq) {
    poke(ISER + 4U * (irq / 32U), UINT32_C(1) << (irq % 32U));
}

static void pend(unsigned irq) {
    poke(ISPR + 4U * (irq / 32U), UINT32_C(1) << (irq % 32U));
}

static void it_needs_pending_and_enabled(void) {
    power_on();
    pend(38);
    CHECK_EQ(next(), 0);
    enable(38);
    CHECK_EQ(next(), 16 + 38);
    poke(ICER + 4U, 1U << 6);
    CHECK_EQ(next(), 0);
    enable(38);
    poke(ICPR + 4U, 1U << 6);
    CHECK_EQ(next(), 0);
}

static void registers_show_what_was_written(void) {
    power_on();
    for (unsigned irq = 0; irq < 82U; irq++) {
        const uint32_t bit = UINT32_C(1) << (irq % 32U);
        const uint32_t at = 4U * (irq / 32U);
        enable(irq);
        pend(irq);
        CHECK((peek(ISER + at) & bit) != 0U && (peek(ICER + at) & bit) != 0U);
        CHECK((peek(ISPR + at) & bit) != 0U && (peek(ICPR + at) & bit) != 0U);
        poke(ICER + at, bit);
        poke(ICPR + at, bit);
        CHECK((peek(ISER + at) & bit) == 0U && (peek(ISPR + at) & bit) == 0U);
    }
    poke(ISER + 8U, 0xFFFFFFFFU); // only 82 interrupts exist
    CHECK_EQ(peek(ISER + 8U), 0x3FFFF);
    poke(ISER, 0); // zeros change nothing
    CHECK_EQ(peek(ISER + 8U), 0x3FFFF);
}

static void priorities_have_four_bits(void) {
    power_on();
    poke(IPR + 36U, 0xFFFFFFFFU);
    CHECK_EQ(peek(IPR + 36U), 0xF0F0F0F0);
    soc_write(&chip, IPR + 37U, 1, 0x37);
    CHECK_EQ(peek(IPR + 36U), 0xF0F030F0);
}

static void the_lowest_number_goes_first(void) {
    power_on();
    for (unsigned irq = 20; irq < 25U; irq++) {
        enable(irq);
        pend(irq);
        set_priority(irq, 0x80);
    }
    CHECK_EQ(next(), 16 + 20); // alike: the lowest exception
    set_priority(23, 0x70);
    CHECK_EQ(next(), 16 + 23);
    set_priority(21, 0x10);
    CHECK_EQ(next(), 16 + 21);
}

static void only_a_lower_priority_number_preempts(void) {
    power_on();
    enable(20);
    enable(21);
    set_priority(20, 0x80);
    set_priority(21, 0x80);
    pend(20);
    nvic_activate(&chip.nvic, 16 + 20);
    CHECK_EQ(peek(IABR), 1U << 20);
    CHECK_EQ(peek(ISPR), 0);
    pend(21);
    CHECK_EQ(next(), 0);
    set_priority(21, 0x70);
    CHECK_EQ(next(), 16 + 21);
    set_priority(21, 0x90);
    CHECK_EQ(next(), 0);
    nvic_deactivate(&chip.nvic, 16 + 20);
    CHECK_EQ(next(), 16 + 21);
}

static void an_active_one_does_not_preempt_itself(void) {
    power_on();
    enable(20);
    pend(20);
    nvic_activate(&chip.nvic, 16 + 20);
    pend(20);
    CHECK_EQ(next(), 0);
    nvic_deactivate(&chip.nvic, 16 + 20);
    CHECK_EQ(next(), 16 + 20);
}

static void subpriorities_order_but_do_not_preempt(void) {
    power_on();
    poke(AIRCR, KEY | 5U << 8); // bits 7 and 6 are the group
    enable(20);
    enable(21);
    set_priority(20, 0x70);
    set_priority(21, 0x40);
    pend(20);
    pend(21);
    CHECK_EQ(next(), 16 + 21); // the lower one first
    nvic_set_pending(&chip.nvic, 16 + 21, false);
    nvic_activate(&chip.nvic, 16 + 20);
    pend(21);
    CHECK_EQ(next(), 0); // same group
    set_priority(21, 0x30);
    CHECK_EQ(next(), 16 + 21);  // another group
    poke(AIRCR, KEY | 7U << 8); // no bit is group
    CHECK_EQ(next(), 0);
}

static void primask_holds_back_all_but_nmi_and_hard_fault(void) {
    const struct nvic_masks masks = {.primask = true};
    power_on();
    enable(20);
    pend(20);
    CHECK_EQ(next_with(masks), 0);
    CHECK(nvic_wakes(&chip.nvic, &masks)); // from WFI all the same
    nvic_set_pending(&chip.nvic, NVIC_HARD_FAULT, true);
    CHECK_EQ(next_with(masks), NVIC_HARD_FAULT);
    nvic_set_pending(&chip.nvic, NVIC_NMI, true);
    CHECK_EQ(next_with(masks), NVIC_NMI);
}

static void faultmask_holds_back_all_but_nmi(void) {
    const struct nvic_masks masks = {.faultmask = true};
    power_on();
    enable(20);
    pend(20);
    nvic_set_pending(&chip.nvic, NVIC_HARD_FAULT, true);
    CHECK_EQ(next_with(masks), 0);
    nvic_set_pending(&chip.nvic, NVIC_NMI, true);
    CHECK_EQ(next_with(masks), NVIC_NMI);
    power_on(); // also while a handler of priority 0 runs
    enable(20);
    pend(20);
    nvic_activate(&chip.nvic, 16 + 20);
    nvic_set_pending(&chip.nvic, NVIC_HARD_FAULT, true);
    CHECK_EQ(next(), NVIC_HARD_FAULT);
    CHECK_EQ(next_with(masks), 0);
}

static void basepri_holds_back_its_number_and_higher(void) {
    power_on();
    enable(20);
    pend(20);
    set_priority(20, 0x50);
    CHECK_EQ(next_with((struct nvic_masks){.basepri = 0x50}), 0);
    CHECK_EQ(next_with((struct nvic_masks){.basepri = 0x40}), 0);
    CHECK_EQ(next_with((struct nvic_masks){.basepri = 0x60}), 16 + 20);
    CHECK_EQ(next_with((struct nvic_masks){.basepri = 0}), 16 + 20); // 0: off
    const struct nvic_masks masks = {.basepri = 0x50};
    CHECK(!nvic_wakes(&chip.nvic, &masks)); // unlike PRIMASK
}

static void a_line_that_stays_high_comes_again(void) {
    power_on();
    enable(20);
    nvic_set_line(&chip.nvic, 20, true);
    CHECK_EQ(next(), 16 + 20);
    poke(ICPR, 1U << 20);
    CHECK_EQ(next(), 16 + 20); // the line is still there
    nvic_activate(&chip.nvic, 16 + 20);
    CHECK_EQ(peek(ISPR), 0);
    nvic_deactivate(&chip.nvic, 16 + 20);
    CHECK_EQ(next(), 16 + 20);
    nvic_activate(&chip.nvic, 16 + 20);
    nvic_set_line(&chip.nvic, 20, false);
    nvic_deactivate(&chip.nvic, 16 + 20);
    CHECK_EQ(next(), 0);
}

static void a_line_that_went_low_stays_pending(void) {
    power_on();
    enable(20);
    nvic_set_line(&chip.nvic, 20, true);
    nvic_set_line(&chip.nvic, 20, false);
    CHECK_EQ(next(), 16 + 20);
    poke(ICPR, 1U << 20);
    CHECK_EQ(next(), 0);
}

static void software_triggers_by_number(void) {
    power_on();
    enable(81);
    poke(STIR, 81);
    CHECK_EQ(next(), 16 + 81);
    CHECK_EQ(peek(ISPR + 8U), 1U << 17);
}

static void system_exceptions_are_always_enabled(void) {
    static const unsigned exceptions[] = {NVIC_SYSTICK, NVIC_PENDSV, NVIC_SVCALL};
    power_on();
    for (unsigned i = 0; i < 3U; i++) {
        nvic_set_pending(&chip.nvic, exceptions[i], true);
        CHECK_EQ(next(), exceptions[i]); // the lower exception goes first
    }
    nvic_set_pending(&chip.nvic, NVIC_BUS_FAULT, true);
    CHECK_EQ(next(), NVIC_SVCALL); // SHCSR has not enabled it
    poke(0xE000ED24U, 1U << 17);
    CHECK_EQ(next(), NVIC_BUS_FAULT);
}

static void a_fault_is_taken_only_above_what_runs(void) {
    power_on();
    poke(0xE000ED24U, 7U << 16);
    CHECK(nvic_can_take(&chip.nvic, NVIC_USAGE_FAULT, &open_masks));
    const struct nvic_masks masks = {.primask = true};
    CHECK(!nvic_can_take(&chip.nvic, NVIC_USAGE_FAULT, &masks));
    CHECK(nvic_can_take(&chip.nvic, NVIC_HARD_FAULT, &masks));
    nvic_activate(&chip.nvic, NVIC_HARD_FAULT);
    CHECK(!nvic_can_take(&chip.nvic, NVIC_USAGE_FAULT, &open_masks));
    CHECK(!nvic_can_take(&chip.nvic, NVIC_HARD_FAULT, &open_masks));
}

int main(void) {
    TEST(it_needs_pending_and_enabled);
    TEST(registers_show_what_was_written);
    TEST(priorities_have_four_bits);
    TEST(the_lowest_number_goes_first);
    TEST(only_a_lower_priority_number_preempts);
    TEST(an_active_one_does_not_preempt_itself);
    TEST(subpriorities_order_but_do_not_preempt);
    TEST(primask_holds_back_all_but_nmi_and_hard_fault);
    TEST(faultmask_holds_back_all_but_nmi);
    TEST(basepri_holds_back_its_number_and_higher);
    TEST(a_line_that_stays_high_comes_again);
    TEST(a_line_that_went_low_stays_pending);
    TEST(software_triggers_by_number);
    TEST(system_exceptions_are_always_enabled);
    TEST(a_fault_is_taken_only_above_what_runs);
    return check_finish();
}
