/// The contract suite of CAN controllers on two nodes of the simulated bus.
#include "contract/support/can_suite.h"

#include "check.h"
#include "devices/bus_node_hal.h"

static struct can_bus bus;
static struct bus_node_hal a, b;
static struct hal_clock clock_;

/// Starts late, so that the times of arrival wrap on the way.
static const uint32_t start_us = UINT32_MAX - 20000U;

static uint32_t now_us(void *ctx) {
    (void)ctx;
    return start_us + (uint32_t)(bus.now_ns / 1000U);
}

static void reset(void *context) {
    (void)context;
    const uint64_t now_ns = bus.now_ns;
    can_bus_init(&bus, 1000000, 1);
    bus.now_ns = now_ns; // the clock goes on
    CHECK(bus_node_hal_init(&a, &bus, start_us));
    CHECK(bus_node_hal_init(&b, &bus, start_us));
}

static void settle(void *context) {
    (void)context;
    can_bus_run_until(&bus, bus.now_ns + 5000000U);
}

static void bus_off(void *context) {
    (void)context;
    bus_node_hal_set_bus_off(&a);
}

int main(void) {
    static const struct hal_clock_ops clock_ops = {now_us};
    CHECK_EQ(hal_clock_bind(&clock_, &clock_ops, NULL), HAL_OK);
    reset(NULL);
    can_suite(&(struct can_fixture){.name = "bus_node",
                                    .a = &a.hal,
                                    .b = &b.hal,
                                    .clock = &clock_,
                                    .reset = reset,
                                    .settle = settle,
                                    .bus_off = bus_off,
                                    .receive_capacity = CAN_RX_QUEUE,
                                    .send_capacity = CAN_NODE_QUEUE});
    return check_finish();
}
