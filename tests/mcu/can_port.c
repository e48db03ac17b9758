/// The emulated controller on the simulated bus: bit rates, competition, and what a cut wire does
/// to it.
#include "mcu/can_port.h"
#include "can_chip.h"

#define CAN_TX GPIO_PIN('B', 9)
#define CAN_RX GPIO_PIN('B', 8)

static struct can_bus bus;
static struct can_port port;
static struct can_node other;
static struct can_frame heard[16];
static uint64_t heard_ns[16];
static unsigned heard_count;

static void on_frame(void *context, const struct can_frame *frame, uint64_t now_ns) {
    (void)context;
    heard[heard_count % 16U] = *frame;
    heard_ns[heard_count++ % 16U] = now_ns;
}

static void on_world(void *context) {
    can_port_run(context, soc_now_ns(&chip));
}

static void wire_pins(void) {
    poke(GPIOB + 0x24U, 0x99); // AF9 for PB8 and PB9
    poke(GPIOB, (peek(GPIOB) & ~0xF0000U) | 0xA0000U);
}

/// A controller in normal mode on a bus with one other node (or without it).
static void begin_at(uint32_t btr, uint32_t mcr, bool alone) {
    heard_count = 0;
    power_on();
    clock_everything();
    can_bus_init(&bus, 1000000, 1);
    chip.world = on_world;
    chip.world_context = &port;
    (void)can_port_init(&port, &chip, 0, &bus, CAN_TX, CAN_RX);
    if (!alone) {
        (void)can_bus_attach(&bus, &other, on_frame, NULL);
    }
    wire_pins();
    poke(MCR, mcr | INRQ);
    pass_us(10);
    poke(BTR, btr);
    let_everything_in();
    poke(MCR, mcr);
    pass_us(50);
}

static void begin(void) {
    begin_at(BTR_1_MBIT, 0, false);
}

static void other_sends(uint32_t id) {
    const struct can_frame frame = {.id = id, .length = 2, .data = {1, 2}};
    (void)can_bus_send(&bus, &other, &frame, soc_now_ns(&chip));
    can_port_changed(&port);
}

static void a_frame_gets_over_in_its_time(void) {
    begin();
    poke(TDTR(0), 8);
    poke(TDLR(0), 0x55555555);
    poke(TDHR(0), 0x55555555);
    const uint64_t from = soc_now_ns(&chip);
    poke(TIR(0), 0x555U << 21 | TXRQ);
    CHECK_EQ(peek(MSR) & 0x100U, 0);
    pass_us(50);
    CHECK_EQ(peek(MSR) & 0x100U, 0x100); // on the wire
    CHECK_EQ(heard_count, 0);
    pass_us(100);
    CHECK_EQ(heard_count, 1);
    CHECK_EQ(heard[0].id, 0x555);
    CHECK_EQ(heard[0].data[7], 0x55);
    // 108 bits and the stuff bits of its CRC.
    CHECK(heard_ns[0] - from >= 108000U && heard_ns[0] - from <= 115000U);
    CHECK_EQ(peek(TSR) & 3U, 3);
    CHECK_EQ(peek(ESR), 0);
}

static void it_hears_the_others(void) {
    begin();
    other_sends(0x241);
    pass_us(150);
    CHECK_EQ(peek(RF0R) & 3U, 1);
    CHECK_EQ(peek(RIR(0)), 0x241U << 21);
    CHECK_EQ(heard_count, 0);
}

static void the_lower_identifier_wins_the_bus(void) {
    begin();
    other_sends(0x100); // takes the bus
    pass_us(5);
    request(0, 0x300);
    other_sends(0x200);
    pass_us(90);                 // the first has passed, the second is on the wire
    CHECK_EQ(peek(TSR) & 4U, 4); // ALST
    CHECK_EQ(peek(RF0R) & 3U, 1);
    pass_us(200);
    CHECK_EQ(heard_count, 1);
    CHECK_EQ(peek(TSR) & 3U, 3);
    begin();
    other_sends(0x100);
    pass_us(5);
    request(0, 0x150);
    other_sends(0x200);
    pass_us(130);
    CHECK_EQ(heard_count, 1); // this time it was ours
    pass_us(100);
    CHECK_EQ(peek(RF0R) & 3U, 2);
}

static void a_better_mailbox_overtakes(void) {
    begin();
    other_sends(0x100);
    pass_us(5);
    request(0, 0x300);
    request(1, 0x200);
    pass_us(400);
    CHECK_EQ(heard_count, 2);
    CHECK_EQ(heard[0].id, 0x200);
    CHECK_EQ(heard[1].id, 0x300);
}

static void unplugged_it_ends_passive(void) {
    begin();
    port.unplugged = true;
    can_port_changed(&port);
    request(0, 0x100);
    pass_us(20000);
    CHECK_EQ(heard_count, 0);
    CHECK_EQ(peek(ESR) >> 16 & 0xFFU, 128);
    CHECK_EQ(peek(ESR) & 7U, 3);
    CHECK_EQ(peek(ESR) >> 4 & 7U, 3); // no acknowledgment
    other_sends(0x200);
    pass_us(1000);
    CHECK_EQ(peek(RF0R), 0);
    port.unplugged = false;
    can_port_changed(&port);
    pass_us(1000);
    CHECK_EQ(heard_count, 1);
    CHECK_EQ(peek(ESR) >> 16 & 0xFFU, 127);
}

static void alone_it_ends_passive_too(void) {
    begin_at(BTR_1_MBIT, 0, true);
    request(0, 0x100);
    pass_us(20000);
    CHECK_EQ(peek(ESR) >> 16 & 0xFFU, 128);
    CHECK_EQ(peek(ESR) & 4U, 0);
}

static void shorted_it_goes_off_and_comes_back(void) {
    begin_at(BTR_1_MBIT, 0x40, false); // ABOM
    port.shorted = true;
    request(0, 0x100);
    unsigned times_off = 0;
    for (unsigned us = 0; us < 10000U; us += 10U) { // off, and back each time, to try again
        const uint32_t before = peek(ESR) & 4U;
        pass_us(10);
        times_off += before == 0U && (peek(ESR) & 4U) != 0U;
    }
    CHECK(times_off >= 2U && times_off <= 4U);
    port.shorted = false;
    pass_us(5000);
    CHECK_EQ(peek(ESR) & 4U, 0);
    CHECK_EQ(heard_count, 1);
}

static void alone_on_a_shorted_bus_it_goes_off(void) {
    begin_at(BTR_1_MBIT, 0, true);
    port.shorted = true;
    request(0, 0x100);
    pass_us(5000);
    CHECK_EQ(peek(ESR) & 4U, 4);
}

static void a_wrong_bit_rate_gets_nowhere(void) {
    begin_at(BTR_1_MBIT | 1U, 0, false); // 500 kbit/s
    request(0, 0x100);
    pass_us(20000);
    CHECK_EQ(heard_count, 0);
    CHECK_EQ(peek(ESR) & 4U, 4); // bit errors: off
    other_sends(0x200);
    pass_us(1000);
    CHECK_EQ(peek(RF0R), 0);
    begin_at(UINT32_C(13) << 16 | UINT32_C(1) << 20, 0, false); // 17 quanta: 6 % off
    request(0, 0x100);
    pass_us(20000);
    CHECK_EQ(heard_count, 0);
    begin_at(UINT32_C(11) << 16 | UINT32_C(1) << 20, 0, false); // 15: 7 % too fast
    request(0, 0x100);
    pass_us(20000);
    CHECK_EQ(heard_count, 0);
}

static void pins_that_are_not_connected(void) {
    begin();
    poke(GPIOB, peek(GPIOB) & ~0xF0000U);
    can_port_changed(&port);
    request(0, 0x100);
    pass_us(20000);
    CHECK_EQ(heard_count, 0);
    CHECK(peek(ESR) != 0U);
}

static void a_chip_that_resets_forgets_its_frame(void) {
    begin();
    request(0, 0x100);
    pass_us(10);
    soc_reset(&chip, SOC_RESET_PIN); // in the middle of it
    clock_everything();
    wire_pins();
    pass_us(500);
    CHECK_EQ(peek(TSR), 0x1C000000);
    CHECK_EQ(peek(ESR), 0);
    other_sends(0x200); // the bus goes on
    other_sends(0x201);
    pass_us(500);
    CHECK_EQ(bus.busy, false);
}

static void frames_one_after_the_other_fill_the_bus(void) {
    begin();
    unsigned sent = 0;
    for (unsigned i = 0; i < 2000U; i++) {
        for (unsigned m = 0; m < 3U; m++) {
            if ((peek(TSR) >> (26U + m) & 1U) != 0U) {
                request(m, 0x100);
                sent++;
            }
        }
        pass_us(10);
    }
    // 20 ms: 50 bits with stuff and intermission each.
    CHECK(heard_count >= 330U && heard_count <= 425U);
    CHECK(sent >= heard_count && sent - heard_count <= 3U);
}

int main(void) {
    TEST(a_frame_gets_over_in_its_time);
    TEST(it_hears_the_others);
    TEST(the_lower_identifier_wins_the_bus);
    TEST(a_better_mailbox_overtakes);
    TEST(unplugged_it_ends_passive);
    TEST(alone_it_ends_passive_too);
    TEST(shorted_it_goes_off_and_comes_back);
    TEST(alone_on_a_shorted_bus_it_goes_off);
    TEST(a_wrong_bit_rate_gets_nowhere);
    TEST(pins_that_are_not_connected);
    TEST(a_chip_that_resets_forgets_its_frame);
    TEST(frames_one_after_the_other_fill_the_bus);
    return check_finish();
}
