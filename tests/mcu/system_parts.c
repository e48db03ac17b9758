/// Flash interface, power control, external interrupts: RM0090, chapters 3, 5, 9 and 12.
#include "chip.h"

static void flash_reset_values(void) {
    power_on();
    CHECK_EQ(peek(FLASH + 0x00U), 0);
    CHECK_EQ(peek(FLASH + 0x0CU), 0);
    CHECK_EQ(peek(FLASH + 0x10U), 0x80000000);
    CHECK_EQ(peek(FLASH + 0x14U), 0x0FFFAAED);
    poke(FLASH, 0x705);
    CHECK_EQ(peek(FLASH), 0x705);
}

static void flash_opens_with_two_keys(void) {
    power_on();
    poke(FLASH + 0x10U, 0);
    CHECK_EQ(peek(FLASH + 0x10U), 0x80000000);
    poke(FLASH + 0x04U, 0x45670123U);
    poke(FLASH + 0x04U, 0xCDEF89ABU);
    CHECK_EQ(peek(FLASH + 0x10U), 0);
    poke(FLASH + 0x10U, 0x80000000U); // locks again
    CHECK_EQ(peek(FLASH + 0x10U), 0x80000000);
    poke(FLASH + 0x04U, 0xCDEF89ABU); // a wrong key: until reset nothing helps
    poke(FLASH + 0x04U, 0x45670123U);
    poke(FLASH + 0x04U, 0xCDEF89ABU);
    CHECK_EQ(peek(FLASH + 0x10U), 0x80000000);
    CHECK(chip.complaints != 0U);
}

static void power_control(void) {
    power_on();
    set_bits(RCC + 0x40U, UINT32_C(1) << 28);
    CHECK_EQ(peek(PWR), 0x4000);                // VOS: scale 1
    CHECK_EQ(peek(PWR + 4U) & 0x4000U, 0x4000); // VOSRDY
    set_bits(PWR, 0x100);                       // DBP
    poke(RCC + 0x70U, 1);                       // LSEON is in the backup domain
    CHECK_EQ(peek(RCC + 0x70U), 1);
    power_on();
    poke(RCC + 0x70U, 1);
    CHECK_EQ(peek(RCC + 0x70U), 0);
}

static void begin_edges(uint32_t port) {
    power_on();
    clock_everything();
    poke(SYSCFG + 0x08U, port << 4); // EXTICR1: line 1
    poke(EXTI + 0x00U, 2);           // IMR
}

static void edges_of_the_chosen_port(void) {
    begin_edges(2);
    poke(EXTI + 0x08U, 2); // rising
    gpio_drive(&chip, GPIO_PIN('B', 1), GPIO_HIGH);
    CHECK(!irq_is_pending(7));
    gpio_drive(&chip, GPIO_PIN('C', 1), GPIO_HIGH);
    CHECK(irq_is_pending(7)); // EXTI1
    CHECK_EQ(peek(EXTI + 0x14U), 2);
    poke(EXTI + 0x14U, 2);
    CHECK_EQ(peek(EXTI + 0x14U), 0);
    clear_irq(7);
    gpio_drive(&chip, GPIO_PIN('C', 1), GPIO_LOW); // a falling edge is not asked for
    CHECK_EQ(peek(EXTI + 0x14U), 0);
    poke(EXTI + 0x08U, 0);
    poke(EXTI + 0x0CU, 2);
    gpio_drive(&chip, GPIO_PIN('C', 1), GPIO_HIGH);
    CHECK_EQ(peek(EXTI + 0x14U), 0);
    gpio_drive(&chip, GPIO_PIN('C', 1), GPIO_LOW);
    CHECK_EQ(peek(EXTI + 0x14U), 2);
}

static void masks_and_software(void) {
    begin_edges(2);
    poke(EXTI + 0x00U, 0);
    poke(EXTI + 0x08U, 2);
    gpio_drive(&chip, GPIO_PIN('C', 1), GPIO_HIGH);
    CHECK(!irq_is_pending(7));
    poke(EXTI + 0x00U, 0x22);
    poke(EXTI + 0x10U, 0x20); // SWIER, line 5
    CHECK_EQ(peek(EXTI + 0x14U), 0x20);
    CHECK(irq_is_pending(23)); // EXTI9_5
    CHECK(!irq_is_pending(7));
    poke(EXTI + 0x00U, 0x400);
    poke(EXTI + 0x10U, 0x400);
    CHECK(irq_is_pending(40)); // EXTI15_10
}

static void bytes_and_halves(void) {
    power_on();
    clock_everything();
    // AHB takes single bytes, APB repeats them over the word (RM0090, 2.1).
    soc_write(&chip, GPIOC + 0x15U, 1, 0xA5);
    CHECK_EQ(peek(GPIOC + 0x14U), 0xA500);
    soc_write(&chip, TIM3 + 0x2CU, 1, 0x12);
    CHECK_EQ(peek(TIM3 + 0x2CU), 0x1212);
    soc_write(&chip, TIM2 + 0x2CU, 2, 0x1234);
    CHECK_EQ(peek(TIM2 + 0x2CU), 0x12341234);
    CHECK_EQ(soc_read(&chip, TIM2 + 0x2EU, 2), 0x1234);
    CHECK_EQ(soc_read(&chip, TIM2 + 0x2DU, 1), 0x12);
}

static void time_goes_on_over_changes_of_clock_and_resets(void) {
    power_on();
    pass_us(12345);
    run_at_168_mhz();
    const uint64_t before = soc_now_ns(&chip);
    CHECK_EQ(before, 12345000 + 11000000);
    pass_us(500);
    soc_reset(&chip, SOC_RESET_PIN);
    pass_us(500);
    CHECK_NEAR(soc_now_ns(&chip), before + 1000000, 100);
    pass_ns(UINT64_C(250000000000)); // farther than the horizon of events
    CHECK_NEAR(soc_now_ns(&chip), before + UINT64_C(250001000000), 100);
}

int main(void) {
    TEST(flash_reset_values);
    TEST(flash_opens_with_two_keys);
    TEST(power_control);
    TEST(edges_of_the_chosen_port);
    TEST(masks_and_software);
    TEST(bytes_and_halves);
    TEST(time_goes_on_over_changes_of_clock_and_resets);
    return check_finish();
}
