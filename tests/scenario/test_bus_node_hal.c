/// devices/bus_node_hal: what the contract suite of hal/can.h can't see, because it knows no bit
/// times: when frames arrive, how long bus-off lasts, and what becomes of a frame under way.
#include "check.h"

#include "devices/bus_node_hal.h"

#define MS UINT64_C(1000000)

static struct can_bus bus;
static struct bus_node_hal a, b;
static struct can_node other;

static void new_bus(void) {
    can_bus_init(&bus, 1000000, 1);
    CHECK(bus_node_hal_init(&a, &bus, 0));
    CHECK(bus_node_hal_init(&b, &bus, UINT32_MAX - 100U));
    CHECK(can_bus_attach(&bus, &other, NULL, NULL));
}

static const struct can_frame empty = {.id = 0}; // 50 bits, can_bus's test counts them by hand

static unsigned received_by(struct bus_node_hal *n) {
    struct can_frame f;
    uint32_t t_us;
    unsigned count = 0;
    while (hal_can_receive(&n->hal, &f, &t_us) == HAL_OK) {
        count++;
    }
    return count;
}

static void arrival_is_the_end_of_the_frame_on_the_boards_clock(void) {
    new_bus();
    can_bus_run_until(&bus, 200000);
    CHECK_EQ(hal_can_send(&a.hal, &empty), HAL_OK);
    can_bus_run_until(&bus, MS);
    struct can_frame f;
    uint32_t t_us = 0;
    CHECK_EQ(hal_can_receive(&b.hal, &f, &t_us), HAL_OK);
    CHECK(can_frame_equal(&f, &empty));
    CHECK_EQ(t_us, 149); // 250 us after UINT32_MAX - 100
}

static uint64_t recovery_ns(uint32_t frames_meanwhile) {
    new_bus();
    can_bus_run_until(&bus, MS);
    bus_node_hal_set_bus_off(&a);
    CHECK_EQ(hal_can_restart(&a.hal), HAL_OK);
    for (uint32_t i = 0; i < frames_meanwhile; i++) {
        CHECK(can_bus_send(&bus, &other, &empty, 0));
    }
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    while (state.health == HAL_CAN_OFF && bus.now_ns < 10U * MS) {
        can_bus_run_until(&bus, bus.now_ns + 1000U);
        CHECK_EQ(hal_can_state(&a.hal, &state), HAL_OK);
    }
    return bus.now_ns - MS;
}

static void recovery_takes_128_times_11_recessive_bits(void) {
    CHECK_EQ(recovery_ns(0), 1408000);
    // Ten frames of 53 bits with intermission give one stretch each: 118 are left for idle bits.
    CHECK_NEAR(recovery_ns(10), 118 * 11000 + 10 * 53000, 2000);
}

static void bus_off_is_not_left_without_a_restart(void) {
    new_bus();
    bus_node_hal_set_bus_off(&a);
    can_bus_run_until(&bus, 100U * MS);
    CHECK_EQ(hal_can_send(&a.hal, &empty), HAL_ERROR_DOWN);
    CHECK_EQ(hal_can_restart(&a.hal), HAL_OK);
    can_bus_run_until(&bus, 101U * MS);
    bus_node_hal_set_bus_off(&a); // again, on the way back
    can_bus_run_until(&bus, 110U * MS);
    CHECK_EQ(hal_can_send(&a.hal, &empty), HAL_ERROR_DOWN);
}

/// The frame under way when the controller drops off is heard by nobody, once and for all.
static void a_frame_under_way_dies_with_its_sender(void) {
    new_bus();
    for (unsigned i = 0; i < 3U; i++) {
        CHECK_EQ(hal_can_send(&a.hal, &empty), HAL_OK);
    }
    can_bus_run_until(&bus, 60000); // one is through, the second has begun
    bus_node_hal_set_bus_off(&a);
    CHECK_EQ(hal_can_restart(&a.hal), HAL_OK);
    can_bus_run_until(&bus, 10U * MS);
    CHECK_EQ(received_by(&b), 1);
    CHECK_EQ(hal_can_send(&a.hal, &empty), HAL_OK);
    can_bus_run_until(&bus, 11U * MS);
    CHECK_EQ(received_by(&b), 1);
    CHECK_EQ(a.node.count, 0);
}

static void a_full_bus_is_refused(void) {
    new_bus();
    static struct bus_node_hal more[CAN_BUS_NODES_MAX];
    for (unsigned i = 3; i < CAN_BUS_NODES_MAX; i++) {
        CHECK(bus_node_hal_init(&more[i], &bus, 0));
    }
    CHECK(!bus_node_hal_init(&more[0], &bus, 0));
}

int main(void) {
    TEST(arrival_is_the_end_of_the_frame_on_the_boards_clock);
    TEST(recovery_takes_128_times_11_recessive_bits);
    TEST(bus_off_is_not_left_without_a_restart);
    TEST(a_frame_under_way_dies_with_its_sender);
    TEST(a_full_bus_is_refused);
    return check_finish();
}
