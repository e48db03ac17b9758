/// A node of the simulated CAN bus as a CAN controller: hal/can.h on top of devices/can_bus.h.
///
/// Bus-off is set from outside (a fault). The way back is the hardware's: after a restart the node
/// counts 128 stretches of 11 recessive bits. An idle bus gives one every 11 bits, a frame one at
/// its end. The node notices that it is done at its next call, so within a tick.
/// Received frames wait in a queue of CAN_RX_QUEUE, frames to send in one of CAN_NODE_QUEUE.
/// Shown: tests/scenario/test_bus_node_hal.c, and the contract suite of the class
/// (tests/contract/bus_node.c).
#ifndef DEVICES_BUS_NODE_HAL_H
#define DEVICES_BUS_NODE_HAL_H

#include "devices/can_bus.h"
#include "hal/can.h"

#include <stdbool.h>
#include <stdint.h>

struct bus_node_hal {
    struct hal_can hal; ///< for the controller
    struct can_bus *bus;
    struct can_node node;
    struct can_rx_queue received;
    uint32_t start_us; ///< the board's clock at the bus's time 0
    struct hal_can_filter filters[HAL_CAN_FILTERS_MAX];
    uint32_t filter_count;
    bool off, recovering;
    uint64_t recovering_since_ns, frames_before, busy_ns_before;
};

/// Attaches itself to the bus; hears every frame until filters are set. Must not move in memory
/// afterwards. False if the bus is full.
bool bus_node_hal_init(struct bus_node_hal *node, struct can_bus *bus, uint32_t start_us);

/// The controller goes bus-off: what it has queued is gone, a frame under way is destroyed.
void bus_node_hal_set_bus_off(struct bus_node_hal *node);

#endif
