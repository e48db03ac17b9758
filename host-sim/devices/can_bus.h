/// A classic CAN bus in virtual time: which frame is on the wire when, to the bit.
///
/// - A frame lasts 44 + 8n bits (64 + 8n with a 29-bit identifier, n data bytes) and its stuff
/// bits,
///   which are counted from the real bit stream with its CRC-15; 3 bits of intermission follow.
/// - When the bus is idle, the frames that are ready compete and the lowest arbitration field wins,
///   bit for bit as on the wire (identifier, then standard before extended, data before remote).
///   Two nodes that send the same field at once would destroy each other's frame on a real bus;
///   here the node that was attached first wins and `same_id` counts it.
/// - A node sends its own frames first in, first out, and hears everything but its own frames. It
///   hears a frame when its last bit has passed.
/// - Bits are whole multiples of bit_ns; a start is not rounded to the bit grid.
///
/// Faults: a chance that a frame is lost (it takes its time on the bus, but nobody hears it), and a
/// hook that sees each frame before it starts and may lose, destroy, change or delay it. A
/// destroyed frame is followed by an error frame, and the sender tries again, as the CAN hardware
/// does. A node that is offline neither sends nor hears, and its queue waits.
///
/// All memory is the caller's. Deterministic: the same calls give the same events.
/// Cost: about 75 ns a frame of 8 bytes with three nodes, receivers included
/// (tests/property/plant_speed.c).
/// Source: Bosch CAN 2.0B (1991), sections 3 to 5. Shown: tests/scenario/test_can_bus.c.
#ifndef DEVICES_CAN_BUS_H
#define DEVICES_CAN_BUS_H

#include "drive/can_frame.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    CAN_BUS_NODES_MAX = 8,
    CAN_NODE_QUEUE = 16,      ///< frames of one node that wait to be sent
    CAN_BUS_DELAYED_MAX = 16, ///< frames that a fault holds back
    CAN_RX_QUEUE = 64,        ///< frames that wait to be read
};

/// Called when a frame has passed; may send.
typedef void can_receive_fn(void *context, const struct can_frame *frame, uint64_t now_ns);

struct can_node {
    can_receive_fn *receive;
    void *context;
    bool offline; ///< bus-off, unpowered or unplugged
    uint8_t index;
    uint8_t first, count; ///< of the queue
    uint64_t sent, refused;
    struct can_pending {
        uint64_t ready_ns;
        uint32_t key; ///< lower goes first
        struct can_frame frame;
    } queue[CAN_NODE_QUEUE];
};

enum can_fate {
    CAN_DELIVERED,
    CAN_LOST,      ///< takes its time, nobody hears it
    CAN_DESTROYED, ///< error frame, then the sender tries again
};

/// One frame on its way over the bus.
struct can_transfer {
    uint64_t start_ns, end_ns; ///< first bit to the end of the last; without intermission
    uint64_t delay_ns;         ///< how much later the nodes hear it
    enum can_fate fate;
    uint8_t sender; ///< index of the node
    struct can_frame frame;
};

/// May change frame (what is heard; the time on the wire stays), fate and delay_ns.
typedef void can_fault_fn(void *context, struct can_transfer *transfer);
/// Sees every transfer at its end, before the nodes hear it.
typedef void can_observer_fn(void *context, const struct can_transfer *transfer);

/// Tables that count stuff bits and the CRC a byte at a time.
struct can_timing {
    uint16_t crc[256];
    uint8_t stuff[8][256]; ///< by state of the bit counter and byte: next state + 8 * stuff bits
};

struct can_bus {
    uint64_t now_ns;  ///< everything before has happened
    uint64_t idle_ns; ///< the next frame may start
    uint32_t bit_ns;
    bool busy;
    uint8_t node_count, delayed_count;
    struct can_transfer current, delayed[CAN_BUS_DELAYED_MAX];
    struct can_node *nodes[CAN_BUS_NODES_MAX];

    uint32_t loss_threshold; ///< a frame is lost if a 32-bit random number is below it
    uint64_t random;
    can_fault_fn *fault;
    void *fault_context;
    can_observer_fn *observer;
    void *observer_context;

    uint64_t frames, lost, destroyed, same_id, delay_overflow;
    uint64_t busy_ns; ///< time taken by frames, error frames and their intermission

    struct can_timing timing;
};

/// bits_per_s: a divisor of 10^9 (1,000,000, 500,000, 250,000, 125,000). seed: any.
void can_bus_init(struct can_bus *bus, uint32_t bits_per_s, uint64_t seed);

/// Wires a node up. receive may be null (a node that only sends). False if the bus is full.
bool can_bus_attach(struct can_bus *bus, struct can_node *node, can_receive_fn *receive,
                    void *context);

/// probability: 0 to 1.
void can_bus_set_loss(struct can_bus *bus, double probability);

/// Puts a frame into the node's queue. It competes for the bus from ready_ns on, or from now on if
/// that is later. False (and `refused` counts) when the queue is full.
bool can_bus_send(struct can_bus *bus, struct can_node *node, const struct can_frame *frame,
                  uint64_t ready_ns);

/// Forgets what the node has queued. A frame of it that is under way is lost.
void can_bus_drop_queue(struct can_bus *bus, struct can_node *node);

/// Lets everything happen that ends up to t_ns. A frame whose first bit would fall on t_ns or later
/// does not start yet, so that frames sent at t_ns still compete with it.
void can_bus_run_until(struct can_bus *bus, uint64_t t_ns);

/// When something happens next if nobody sends anything more: a frame starts, ends, or is heard
/// late. UINT64_MAX: nothing will. can_bus_run_until needs one nanosecond more than that for a
/// start.
uint64_t can_bus_next_ns(const struct can_bus *bus);

/// Bits on the wire from start of frame to end of frame, stuff bits included, intermission not.
unsigned can_frame_bits(const struct can_timing *timing, const struct can_frame *frame);

/// CRC-15 of the frame.
uint16_t can_frame_crc(const struct can_timing *timing, const struct can_frame *frame);

/// Folds the state of the bus and its nodes into hash (world/trace_hash.h).
uint64_t can_bus_hash(const struct can_bus *bus, uint64_t hash);

/// A bounded queue of received frames: attach a node with can_rx_queue_receive and the queue.
struct can_rx_queue {
    unsigned first, count;
    uint64_t overruns; ///< frames dropped because it was full
    struct can_received {
        uint64_t t_ns;
        struct can_frame frame;
    } frames[CAN_RX_QUEUE];
};

can_receive_fn can_rx_queue_receive;

/// False if empty. t_ns may be null.
bool can_rx_queue_pop(struct can_rx_queue *queue, struct can_frame *frame, uint64_t *t_ns);

#endif
