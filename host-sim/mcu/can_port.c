#include "mcu/can_port.h"

#include <string.h>

enum { ERROR_FRAME_BITS = 20, INTERMISSION_BITS = 3, SUSPEND_BITS = 8, STRETCH_BITS = 11 };

// ---------------------------------------------------------------- recessive time

/// Counts stretches of 11 recessive bits: one at the end of each frame, and an idle bus gives one
/// every 11 bits.
static uint64_t quiet_stretches(void *context) {
    struct can_port *port = context;
    const struct can_bus *bus = port->bus;
    const uint64_t now_ns = soc_now_ns(port->soc);
    uint64_t busy_ns = bus->busy_ns - port->seen_busy_ns, frames = bus->frames - port->seen_frames;
    if (port->unplugged) {
        busy_ns = frames = 0;
    }
    const int64_t stretch_ns = STRETCH_BITS * (int64_t)bus->bit_ns;
    // The whole of a frame counts as busy when it begins, so this may go below zero for a while.
    port->quiet_ns += (int64_t)(now_ns - port->seen_ns) - (int64_t)busy_ns;
    port->stretches += frames;
    if (port->quiet_ns >= stretch_ns) {
        port->stretches += (uint64_t)(port->quiet_ns / stretch_ns);
        port->quiet_ns %= stretch_ns;
    }
    port->seen_ns = now_ns;
    port->seen_busy_ns = bus->busy_ns;
    port->seen_frames = bus->frames;
    return port->stretches;
}

static bool is_busy(void *context) {
    const struct can_port *port = context;
    return port->bus->busy && !port->unplugged;
}

// ---------------------------------------------------------------- what is connected

static bool is_wired(const struct can_port *port) {
    const unsigned part = port->can->index;
    return gpio_is_connected(port->soc, port->tx_pin, GPIO_SIGNAL_CAN_TX, part) &&
           gpio_is_connected(port->soc, port->rx_pin, GPIO_SIGNAL_CAN_RX, part);
}

/// Within half a percent of the bus.
static bool has_right_rate(const struct can_port *port) {
    const uint64_t bit_ps = bxcan_bit_ps(port->can), wanted_ps = port->bus->bit_ns * UINT64_C(1000);
    return bit_ps * 200U >= wanted_ps * 199U && bit_ps * 200U <= wanted_ps * 201U;
}

static bool reaches_bus(const struct can_port *port) {
    return !port->unplugged && is_wired(port) && has_right_rate(port);
}

static bool anyone_else(const struct can_port *port) {
    for (unsigned i = 0; i < port->bus->node_count; i++) {
        const struct can_node *node = port->bus->nodes[i];
        if (node != &port->node && !node->offline && node->receive != NULL) {
            return true;
        }
    }
    return false;
}

// ---------------------------------------------------------------- sending

static void withdraw(struct can_port *port) {
    const struct can_bus *bus = port->bus;
    port->orphan = bus->busy && bus->current.sender == port->node.index;
    can_bus_drop_queue(port->bus, &port->node);
    port->offered = -1;
}

/// Nobody is there to talk to: the frame ends in an error of its own.
static void talk_alone(struct can_port *port, int mailbox, const struct can_frame *frame) {
    if (port->alone_end_ns != SOC_NEVER) {
        return;
    }
    const bool wired = !port->unplugged && is_wired(port);
    const bool silent_bus = port->unplugged || (wired && has_right_rate(port));
    const uint64_t bits = can_frame_bits(&port->bus->timing, frame) + ERROR_FRAME_BITS +
                          INTERMISSION_BITS + (port->can->tec > 127U ? SUSPEND_BITS : 0U);
    port->alone_result = silent_bus && !port->shorted ? BXCAN_NO_ACKNOWLEDGE : BXCAN_BIT_ERROR;
    port->alone_end_ns = soc_now_ns(port->soc) + bits * bxcan_bit_ps(port->can) / UINT64_C(1000);
    bxcan_begin(port->can, mailbox);
}

static void schedule(struct can_port *port) {
    soc_schedule_ns(port->soc, SOC_WORLD, can_port_next_ns(port));
}

/// Keeps the best mailbox waiting at the bus.
static void offer(struct can_port *port) {
    struct can_frame frame;
    const bool reaches = reaches_bus(port);
    port->node.offline = !reaches || !bxcan_listens(port->can);
    if (port->can->on_wire >= 0) {
        return; // settled when the frame has ended
    }
    const int best = bxcan_takes_part(port->can) ? bxcan_next(port->can, &frame) : -1;
    const bool by_bus = best >= 0 && reaches && anyone_else(port);
    if (port->offered >= 0 && (!by_bus || best != port->offered)) {
        withdraw(port);
    }
    if (best >= 0 && !by_bus) {
        talk_alone(port, best, &frame);
    } else if (by_bus && port->offered < 0 &&
               can_bus_send(port->bus, &port->node, &frame, soc_now_ns(port->soc))) {
        port->offered = best;
    }
}

static void on_changed(void *context) {
    struct can_port *port = context;
    offer(port);
    schedule(port);
}

void can_port_changed(struct can_port *port) {
    (void)quiet_stretches(port);
    on_changed(port);
}

// ---------------------------------------------------------------- what the bus tells

/// A frame is about to start: is it ours, and if not, did ours lose?
static void on_start(void *context, struct can_transfer *transfer) {
    struct can_port *port = context;
    if (port->fault != NULL) {
        port->fault(port->fault_context, transfer);
    }
    if (port->shorted) {
        transfer->fate = CAN_DESTROYED;
    }
    if (port->offered < 0) {
        return;
    }
    if (transfer->sender == port->node.index) {
        bxcan_begin(port->can, port->offered);
    } else if (!port->node.offline &&
               port->node.queue[port->node.first].ready_ns <= transfer->start_ns) {
        bxcan_lost_arbitration(port->can, port->offered);
    }
}

static void on_end(void *context, const struct can_transfer *transfer) {
    struct can_port *port = context;
    if (port->observer != NULL) {
        port->observer(port->observer_context, transfer);
    }
    const bool destroyed = transfer->fate == CAN_DESTROYED;
    if (transfer->sender != port->node.index) {
        if (destroyed && !port->node.offline) {
            bxcan_hear_error(port->can);
        }
        return;
    }
    if (port->orphan) { // the controller was reset meanwhile
        port->orphan = false;
        return;
    }
    // A frame that was sent leaves the bus's queue by itself; a destroyed one waits there again.
    port->offered = destroyed ? port->offered : -1;
    bxcan_end(port->can, destroyed ? BXCAN_BIT_ERROR : BXCAN_SENT);
}

static void on_frame(void *context, const struct can_frame *frame, uint64_t now_ns) {
    struct can_port *port = context;
    (void)now_ns;
    bxcan_hear(port->can, frame);
}

void can_port_run(struct can_port *port, uint64_t now_ns) {
    if (port->alone_end_ns <= now_ns) {
        port->alone_end_ns = SOC_NEVER;
        bxcan_end(port->can, port->alone_result);
    }
    can_bus_run_until(port->bus, now_ns);
    schedule(port);
}

uint64_t can_port_next_ns(const struct can_port *port) {
    uint64_t next_ns = can_bus_next_ns(port->bus);
    if (!port->bus->busy && next_ns != UINT64_MAX) {
        next_ns++; // a start has happened only when its time has passed
    }
    return next_ns < port->alone_end_ns ? next_ns : port->alone_end_ns;
}

bool can_port_init(struct can_port *port, struct soc *soc, unsigned index, struct can_bus *bus,
                   unsigned tx_pin, unsigned rx_pin) {
    memset(port, 0, sizeof *port);
    if (!can_bus_attach(bus, &port->node, on_frame, port)) {
        return false;
    }
    port->soc = soc;
    port->can = &soc->can[index];
    port->bus = bus;
    port->tx_pin = tx_pin;
    port->rx_pin = rx_pin;
    port->offered = -1;
    port->alone_end_ns = SOC_NEVER;
    port->fault = bus->fault;
    port->fault_context = bus->fault_context;
    port->observer = bus->observer;
    port->observer_context = bus->observer_context;
    bus->fault = on_start;
    bus->observer = on_end;
    bus->fault_context = bus->observer_context = port;
    port->operations = (struct bxcan_port){on_changed, quiet_stretches, is_busy, port};
    bxcan_connect(port->can, &port->operations);
    return true;
}
