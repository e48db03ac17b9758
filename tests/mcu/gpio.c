/// Pins, against RM0090, chapter 8, and the data sheet's table 9.
#include "chip.h"

#define MODER   0x00U
#define OTYPER  0x04U
#define OSPEEDR 0x08U
#define PUPDR   0x0CU
#define IDR     0x10U
#define ODR     0x14U
#define BSRR    0x18U
#define LCKR    0x1CU
#define AFRL    0x20U
#define AFRH    0x24U

static void begin(void) {
    power_on();
    clock_everything();
}

static void reset_values(void) {
    begin();
    CHECK_EQ(peek(GPIOA + MODER), 0xA8000000);
    CHECK_EQ(peek(GPIOB + MODER), 0x00000280);
    CHECK_EQ(peek(GPIOC + MODER), 0);
    CHECK_EQ(peek(GPIOB + OSPEEDR), 0x000000C0);
    CHECK_EQ(peek(GPIOA + PUPDR), 0x64000000);
    CHECK_EQ(peek(GPIOB + PUPDR), 0x00000100);
    CHECK_EQ(peek(GPIOC + ODR), 0);
}

static void an_output_drives_its_level(void) {
    begin();
    poke(GPIOC + MODER, 1U << 8); // PC4
    CHECK_EQ(gpio_output(&chip, GPIO_PIN('C', 4)), GPIO_LOW);
    poke(GPIOC + ODR, 1U << 4);
    CHECK_EQ(gpio_output(&chip, GPIO_PIN('C', 4)), GPIO_HIGH);
    CHECK_EQ(peek(GPIOC + IDR), 1U << 4);
    CHECK_EQ(gpio_output(&chip, GPIO_PIN('C', 5)), GPIO_FLOATING); // an input
    gpio_drive(&chip, GPIO_PIN('C', 4), GPIO_LOW);                 // the output wins
    CHECK_EQ(peek(GPIOC + IDR), 1U << 4);
}

static void bsrr_sets_and_resets_and_set_wins(void) {
    begin();
    poke(GPIOC + ODR, 0x0FF0);
    poke(GPIOC + BSRR, 0x0000000FU);
    CHECK_EQ(peek(GPIOC + ODR), 0x0FFF);
    poke(GPIOC + BSRR, 0x00F00000U);
    CHECK_EQ(peek(GPIOC + ODR), 0x0F0F);
    poke(GPIOC + BSRR, 0x00010001U);
    CHECK_EQ(peek(GPIOC + ODR), 0x0F0F);
    CHECK_EQ(peek(GPIOC + BSRR), 0);
    soc_write(&chip, GPIOC + BSRR, 2, 0x0010); // the lower half alone
    CHECK_EQ(peek(GPIOC + ODR), 0x0F1F);
    soc_write(&chip, GPIOC + BSRR + 2U, 2, 0x0001);
    CHECK_EQ(peek(GPIOC + ODR), 0x0F1E);
}

static void inputs_follow_the_world_or_their_pull(void) {
    begin();
    CHECK_EQ(peek(GPIOC + IDR), 0);
    poke(GPIOC + PUPDR, 1U << 0 | 2U << 2 | 1U << 4); // up, down, up
    CHECK_EQ(peek(GPIOC + IDR), 5);
    gpio_drive(&chip, GPIO_PIN('C', 0), GPIO_LOW);
    gpio_drive(&chip, GPIO_PIN('C', 1), GPIO_HIGH);
    CHECK_EQ(peek(GPIOC + IDR), 6);
    gpio_drive(&chip, GPIO_PIN('C', 0), GPIO_FLOATING);
    CHECK_EQ(peek(GPIOC + IDR), 7);
    CHECK(gpio_level(&chip, GPIO_PIN('C', 1)));
    soc_reset(&chip, SOC_RESET_PIN); // what is wired stays
    clock_everything();
    CHECK_EQ(peek(GPIOC + IDR), 2);
}

static void open_drain_only_pulls_down(void) {
    begin();
    poke(GPIOC + MODER, 1);
    poke(GPIOC + OTYPER, 1);
    CHECK_EQ(gpio_output(&chip, GPIO_PIN('C', 0)), GPIO_LOW);
    poke(GPIOC + ODR, 1);
    CHECK_EQ(gpio_output(&chip, GPIO_PIN('C', 0)), GPIO_FLOATING);
    CHECK_EQ(peek(GPIOC + IDR), 0);
    poke(GPIOC + PUPDR, 1);
    CHECK_EQ(peek(GPIOC + IDR), 1);
    gpio_drive(&chip, GPIO_PIN('C', 0), GPIO_LOW); // somebody else pulls it down
    CHECK_EQ(peek(GPIOC + IDR), 0);
}

/// Selects an alternate function by the registers.
static void select(char port, unsigned number, unsigned function) {
    const uint32_t base = GPIOA + 0x400U * (uint32_t)(port - 'A');
    const uint32_t afr = base + (number < 8U ? AFRL : AFRH), shift = 4U * (number % 8U);
    poke(afr, (peek(afr) & ~(15U << shift)) | function << shift);
    poke(base + MODER, (peek(base + MODER) & ~(3U << (2U * number))) | 2U << (2U * number));
}

static void alternate_functions(void) {
    // The data sheet's table 9, for what boards use.
    static const struct {
        char port;
        uint8_t number, function;
        enum gpio_signal signal;
        uint8_t part, channel;
    } table[] = {{'B', 9, 9, GPIO_SIGNAL_CAN_TX, 0, 0},   {'B', 8, 9, GPIO_SIGNAL_CAN_RX, 0, 0},
                 {'A', 12, 9, GPIO_SIGNAL_CAN_TX, 0, 0},  {'D', 0, 9, GPIO_SIGNAL_CAN_RX, 0, 0},
                 {'B', 13, 9, GPIO_SIGNAL_CAN_TX, 1, 0},  {'B', 5, 9, GPIO_SIGNAL_CAN_RX, 1, 0},
                 {'A', 9, 7, GPIO_SIGNAL_USART_TX, 0, 0}, {'A', 10, 7, GPIO_SIGNAL_USART_RX, 0, 0},
                 {'A', 2, 7, GPIO_SIGNAL_USART_TX, 1, 0}, {'C', 6, 8, GPIO_SIGNAL_USART_TX, 5, 0},
                 {'C', 6, 2, GPIO_SIGNAL_TIMER, 2, 0},    {'C', 7, 2, GPIO_SIGNAL_TIMER, 2, 1},
                 {'C', 8, 2, GPIO_SIGNAL_TIMER, 2, 2},    {'C', 9, 2, GPIO_SIGNAL_TIMER, 2, 3},
                 {'B', 6, 2, GPIO_SIGNAL_TIMER, 3, 0},    {'B', 7, 2, GPIO_SIGNAL_TIMER, 3, 1},
                 {'A', 8, 1, GPIO_SIGNAL_TIMER, 0, 0},    {'A', 0, 1, GPIO_SIGNAL_TIMER, 1, 0},
                 {'A', 0, 2, GPIO_SIGNAL_TIMER, 4, 0}};
    begin();
    for (unsigned i = 0; i < sizeof table / sizeof *table; i++) {
        const unsigned pin = GPIO_PIN(table[i].port, table[i].number);
        select(table[i].port, table[i].number, table[i].function);
        const struct gpio_function function = gpio_connection(&chip, pin);
        CHECK_EQ(function.signal, table[i].signal);
        CHECK_EQ(function.part, table[i].part);
        CHECK_EQ(function.channel, table[i].channel);
    }
    poke(GPIOC + MODER, 0); // an input again
    CHECK_EQ(gpio_connection(&chip, GPIO_PIN('C', 6)).signal, GPIO_SIGNAL_NONE);
    select('C', 6, 3); // TIM8, which has no model
    CHECK_EQ(gpio_connection(&chip, GPIO_PIN('C', 6)).signal, GPIO_SIGNAL_NONE);
}

static void the_lock_freezes_until_reset(void) {
    begin();
    poke(GPIOC + LCKR, 0x10001);
    poke(GPIOC + LCKR, 0x00001);
    poke(GPIOC + LCKR, 0x10001);
    CHECK_EQ(peek(GPIOC + LCKR), 0x10001);
    poke(GPIOC + MODER, 0xFFFFFFFFU);
    CHECK_EQ(peek(GPIOC + MODER), 0xFFFFFFFC);
    poke(GPIOC + ODR, 0xFFFF); // not frozen
    CHECK_EQ(peek(GPIOC + ODR), 0xFFFF);
    begin(); // other pins in between: no lock
    poke(GPIOC + LCKR, 0x10001);
    poke(GPIOC + LCKR, 0x00003);
    poke(GPIOC + LCKR, 0x10001);
    poke(GPIOC + MODER, 0xFFFFFFFFU);
    CHECK_EQ(peek(GPIOC + MODER), 0xFFFFFFFF);
}

int main(void) {
    TEST(reset_values);
    TEST(an_output_drives_its_level);
    TEST(bsrr_sets_and_resets_and_set_wins);
    TEST(inputs_follow_the_world_or_their_pull);
    TEST(open_drain_only_pulls_down);
    TEST(alternate_functions);
    TEST(the_lock_freezes_until_reset);
    return check_finish();
}
