#include "devices/bus_node_hal.h"

#include <string.h>

enum {
    RECOVERY_STRETCHES = 128,
    STRETCH_BITS = 11,
    BUS_OFF_COUNT = 256,
};

/// Comes back if the bus has been quiet for long enough.
static void notice_recovery(struct bus_node_hal *n) {
    if (!n->recovering) {
        return;
    }
    const uint64_t elapsed_ns = n->bus->now_ns - n->recovering_since_ns;
    const uint64_t busy_ns = n->bus->busy_ns - n->busy_ns_before;
    const uint64_t idle_ns = elapsed_ns > busy_ns ? elapsed_ns - busy_ns : 0U;
    const uint64_t stretches =
        idle_ns / (STRETCH_BITS * (uint64_t)n->bus->bit_ns) + (n->bus->frames - n->frames_before);
    if (stretches >= RECOVERY_STRETCHES) {
        n->off = n->recovering = n->node.offline = false;
    }
}

static enum hal_status bus_node_send(void *ctx, const struct can_frame *frame) {
    struct bus_node_hal *n = ctx;
    notice_recovery(n);
    if (n->off) {
        return HAL_ERROR_DOWN;
    }
    return can_bus_send(n->bus, &n->node, frame, n->bus->now_ns) ? HAL_OK : HAL_BUSY;
}

static enum hal_status bus_node_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    struct bus_node_hal *n = ctx;
    notice_recovery(n);
    uint64_t t_ns;
    if (!can_rx_queue_pop(&n->received, frame, &t_ns)) {
        return HAL_EMPTY;
    }
    *received_us = n->start_us + (uint32_t)(t_ns / 1000U);
    return HAL_OK;
}

static enum hal_status bus_node_state(void *ctx, struct hal_can_state *state) {
    struct bus_node_hal *n = ctx;
    notice_recovery(n);
    *state = (struct hal_can_state){.health = n->off ? HAL_CAN_OFF : HAL_CAN_ACTIVE,
                                    .transmit_error_count = n->off ? BUS_OFF_COUNT : 0,
                                    .lost_count = (uint32_t)n->received.overruns};
    return HAL_OK;
}

static enum hal_status bus_node_set_filters(void *ctx, const struct hal_can_filter *filters,
                                            uint32_t count) {
    struct bus_node_hal *n = ctx;
    for (uint32_t i = 0; i < count; i++) {
        n->filters[i] = filters[i];
    }
    n->filter_count = count;
    return HAL_OK;
}

static enum hal_status bus_node_restart(void *ctx) {
    struct bus_node_hal *n = ctx;
    notice_recovery(n);
    if (n->off && !n->recovering) {
        n->recovering = true;
        n->recovering_since_ns = n->bus->now_ns;
        n->frames_before = n->bus->frames;
        n->busy_ns_before = n->bus->busy_ns;
    }
    return HAL_OK;
}

static void receive_filtered(void *context, const struct can_frame *frame, uint64_t now_ns) {
    struct bus_node_hal *n = context;
    for (uint32_t i = 0; i < n->filter_count; i++) {
        if (hal_can_filter_passes(&n->filters[i], frame)) {
            can_rx_queue_receive(&n->received, frame, now_ns);
            return;
        }
    }
}

bool bus_node_hal_init(struct bus_node_hal *node, struct can_bus *bus, uint32_t start_us) {
    static const struct hal_can_ops ops = {bus_node_send, bus_node_receive, bus_node_state,
                                           bus_node_set_filters, bus_node_restart};
    memset(node, 0, sizeof *node);
    node->bus = bus;
    node->start_us = start_us;
    node->filter_count = 1; // a filter of zeros lets everything pass
    return hal_can_bind(&node->hal, &ops, node) == HAL_OK &&
           can_bus_attach(bus, &node->node, receive_filtered, node);
}

void bus_node_hal_set_bus_off(struct bus_node_hal *node) {
    node->off = node->node.offline = true;
    node->recovering = false;
    can_bus_drop_queue(node->bus, &node->node);
}
