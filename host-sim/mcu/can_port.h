/// The wires between an emulated CAN controller and the simulated bus (devices/can_bus.h).
///
/// The controller's best mailbox waits at the bus and competes there, bit for bit, with the drives.
/// A controller whose pins are not connected, whose bit rate differs from the bus's by more than
/// 0.5 %, or that is cut off, talks to itself: its frames end in bit errors, or in no
/// acknowledgement when it is merely alone. Left out: what a controller with a wrong bit rate does
/// to the frames of others. Shown: tests/mcu/can_port.c.
#ifndef MCU_CAN_PORT_H
#define MCU_CAN_PORT_H

#include "devices/can_bus.h"
#include "mcu/soc.h"

struct can_port {
    struct soc *soc;
    struct bxcan *can;
    struct can_bus *bus;
    struct can_node node;
    struct bxcan_port operations;
    unsigned tx_pin, rx_pin; ///< where the transceiver is
    int offered;             ///< mailbox that waits at the bus; -1: none
    bool unplugged;          ///< our end of the cable is off
    bool shorted;            ///< the bus is: every frame is destroyed
    bool orphan;             ///< a frame on the wire whose controller forgot it
    // Talking to itself.
    uint64_t alone_end_ns; ///< SOC_NEVER: it doesn't
    enum bxcan_result alone_result;
    // Recessive time.
    uint64_t seen_ns, seen_busy_ns, seen_frames, stretches;
    int64_t quiet_ns;
    // Who else watches the bus.
    can_fault_fn *fault;
    can_observer_fn *observer;
    void *fault_context, *observer_context;
};

/// Attaches the controller to the bus, whose fault hook and observer it takes and passes on. False:
/// the bus is full. Must not move.
bool can_port_init(struct can_port *port, struct soc *soc, unsigned index, struct can_bus *bus,
                   unsigned tx_pin, unsigned rx_pin);

/// What happens at the bus up to now; call it when can_port_next_ns has come.
void can_port_run(struct can_port *port, uint64_t now_ns);
uint64_t can_port_next_ns(const struct can_port *port);

/// After a change of `unplugged`.
void can_port_changed(struct can_port *port);

#endif
