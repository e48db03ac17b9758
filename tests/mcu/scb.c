/// System control block and cycle counter, against PM0214, 4.4, and the ARMv7-M manual, B3.2 and
/// C1.8.
#include "chip.h"

#define CPUID  0xE000ED00U
#define ICSR   0xE000ED04U
#define VTOR   0xE000ED08U
#define AIRCR  0xE000ED0CU
#define SCR    0xE000ED10U
#define CCR    0xE000ED14U
#define SHPR1  0xE000ED18U
#define SHPR2  0xE000ED1CU
#define SHPR3  0xE000ED20U
#define SHCSR  0xE000ED24U
#define CFSR   0xE000ED28U
#define HFSR   0xE000ED2CU
#define DEMCR  0xE000EDFCU
#define CTRL   0xE0001000U
#define CYCCNT 0xE0001004U

static void reset_values(void) {
    power_on();
    CHECK_EQ(peek(CPUID), 0x410FC241);
    CHECK_EQ(peek(ICSR) & ~0x800U, 0);
    CHECK_EQ(peek(VTOR), 0);
    CHECK_EQ(peek(AIRCR), 0xFA050000);
    CHECK_EQ(peek(SCR), 0);
    CHECK_EQ(peek(CCR), 0x200);
    CHECK_EQ(peek(SHCSR), 0);
    CHECK_EQ(peek(CFSR), 0);
    CHECK_EQ(peek(HFSR), 0);
}

static void icsr_pends_and_clears(void) {
    power_on();
    poke(ICSR, UINT32_C(1) << 28); // PENDSVSET
    CHECK_EQ(peek(ICSR) & ~0x800U, UINT32_C(1) << 28 | 14U << 12);
    poke(ICSR, UINT32_C(1) << 26); // PENDSTSET
    CHECK_EQ(peek(ICSR) & ~0x800U, UINT32_C(5) << 26 | 14U << 12);
    poke(ICSR, UINT32_C(1) << 27); // PENDSVCLR
    CHECK_EQ(peek(ICSR) & ~0x800U, UINT32_C(1) << 26 | 15U << 12);
    poke(ICSR, UINT32_C(1) << 25); // PENDSTCLR
    CHECK_EQ(peek(ICSR) & ~0x800U, 0);
    poke(ICSR, UINT32_C(1) << 31); // NMIPENDSET
    CHECK(is_pending(2));
    power_on();
    nvic_set_line(&chip.nvic, 40, true);
    CHECK((peek(ICSR) & UINT32_C(1) << 22) != 0U); // ISRPENDING
}

static void aircr_needs_its_key(void) {
    power_on();
    poke(AIRCR, 0x700);
    poke(AIRCR, 0x04);
    CHECK_EQ(peek(AIRCR), 0xFA050000);
    CHECK_EQ(chip.reset_wanted, SOC_RESET_NONE);
    poke(AIRCR, 0x05FA0300);
    CHECK_EQ(peek(AIRCR), 0xFA050300);
    poke(AIRCR, 0x05FA0004);
    CHECK_EQ(chip.reset_wanted, SOC_RESET_SOFTWARE);
}

static void the_vector_table_is_aligned(void) {
    power_on();
    poke(VTOR, 0xFFFFFFFFU);
    CHECK_EQ(peek(VTOR), 0x3FFFFE00);
    poke(VTOR, 0x08004000U);
    CHECK_EQ(peek(VTOR), 0x08004000);
}

static void handler_priorities(void) {
    power_on();
    poke(SHPR1, 0xFFFFFFFFU);
    poke(SHPR2, 0xFFFFFFFFU);
    poke(SHPR3, 0xFFFFFFFFU);
    CHECK_EQ(peek(SHPR1), 0x00F0F0F0);
    CHECK_EQ(peek(SHPR2), 0xF0000000);
    CHECK_EQ(peek(SHPR3), 0xF0F000F0);
    soc_write(&chip, SHPR3 + 3U, 1, 0x20); // SysTick
    CHECK_EQ(peek(SHPR3), 0x20F000F0);
    CHECK_EQ(nvic_priority_of(&chip.nvic, 15), 0x20);
    CHECK_EQ(nvic_priority_of(&chip.nvic, 3), -1);
    CHECK_EQ(nvic_priority_of(&chip.nvic, 2), -2);
}

static void faults_are_enabled_and_shown(void) {
    power_on();
    poke(SHCSR, 7U << 16);
    CHECK_EQ(peek(SHCSR), 7U << 16);
    nvic_set_pending(&chip.nvic, NVIC_USAGE_FAULT, true);
    CHECK_EQ(peek(SHCSR), 7U << 16 | 1U << 12);
    nvic_activate(&chip.nvic, NVIC_USAGE_FAULT);
    CHECK_EQ(peek(SHCSR), 7U << 16 | 1U << 3);
    nvic_activate(&chip.nvic, NVIC_SYSTICK);
    CHECK_EQ(peek(SHCSR), 7U << 16 | 1U << 3 | 1U << 11);
}

static void fault_flags_are_cleared_by_ones(void) {
    power_on();
    chip.scb.cfsr = 0x00010200U;
    chip.scb.hfsr = UINT32_C(1) << 30;
    poke(CFSR, 0);
    CHECK_EQ(peek(CFSR), 0x00010200);
    poke(CFSR, 0x200);
    CHECK_EQ(peek(CFSR), 0x00010000);
    poke(HFSR, UINT32_C(1) << 30);
    CHECK_EQ(peek(HFSR), 0);
}

static void cycles_are_counted_while_awake(void) {
    power_on();
    pass_cycles(100);
    CHECK_EQ(peek(CYCCNT), 0); // off after reset
    poke(DEMCR, UINT32_C(1) << 24);
    pass_cycles(100);
    CHECK_EQ(peek(CYCCNT), 0); // the counter itself is off, too
    poke(CTRL, 1);
    pass_cycles(100);
    CHECK_EQ(peek(CYCCNT), 100);
    chip.cycle += 50; // asleep
    chip.slept_cycles += 50;
    CHECK_EQ(peek(CYCCNT), 100);
    poke(CYCCNT, 0xFFFFFFF0U);
    pass_cycles(0x20);
    CHECK_EQ(peek(CYCCNT), 0x10);
    poke(CTRL, 0);
    pass_cycles(100);
    CHECK_EQ(peek(CYCCNT), 0x10);
    CHECK_EQ(peek(CTRL) >> 28, 4); // comparators
}

static void what_has_no_model_complains(void) {
    power_on();
    poke(0xE000ED94U, 5); // MPU_CTRL
    CHECK_EQ(chip.complaints, 1);
    poke(0x40012000U, 1); // an ADC
    CHECK_EQ(chip.complaints, 2);
    CHECK_EQ(peek(0x40012000U), 0);
}

int main(void) {
    TEST(reset_values);
    TEST(icsr_pends_and_clears);
    TEST(aircr_needs_its_key);
    TEST(the_vector_table_is_aligned);
    TEST(handler_priorities);
    TEST(faults_are_enabled_and_shown);
    TEST(fault_flags_are_cleared_by_ones);
    TEST(cycles_are_counted_while_awake);
    TEST(what_has_no_model_complains);
    return check_finish();
}
