#include "devices/can_bus.h"

#include "world/trace_hash.h"

#include <string.h>

enum {
    CRC_POLYNOMIAL = 0x4599,
    HEADER_BITS_STANDARD = 19, // start, 11 identifier, RTR, IDE, r0, 4 length
    HEADER_BITS_EXTENDED = 39, // start, 11, SRR, IDE, 18, RTR, r1, r0, 4 length
    CRC_BITS = 15,
    TAIL_BITS = 10, // CRC delimiter, 2 acknowledge, 7 end of frame; never stuffed
    END_OF_FRAME_BITS = 7,
    ERROR_FRAME_BITS = 14, // 6 flag, 8 delimiter
    INTERMISSION_BITS = 3,
    // State of the bit counter: the last bit times 4, plus the length of its run minus 1. A run of
    // 5 never stays: the stuff bit that it calls for starts a run of the other value.
    STUFF_STATE_ONE_ZERO = 0,
};

static void build_tables(struct can_timing *timing) {
    for (unsigned byte = 0; byte < 256U; byte++) {
        unsigned crc = byte << 7;
        for (unsigned i = 0; i < 8U; i++) {
            crc = (crc & 0x4000U) != 0U ? (crc << 1) ^ CRC_POLYNOMIAL : crc << 1;
        }
        timing->crc[byte] = (uint16_t)(crc << 1);
        for (unsigned state = 0; state < 8U; state++) {
            unsigned last = state >> 2, run = (state & 3U) + 1U, stuffed = 0;
            for (unsigned i = 8; i-- != 0U;) {
                const unsigned bit = (byte >> i) & 1U;
                run = bit == last ? run + 1U : 1U;
                last = bit;
                if (run == 5U) {
                    stuffed++;
                    last ^= 1U;
                    run = 1;
                }
            }
            timing->stuff[state][byte] = (uint8_t)((last * 4U + run - 1U) | stuffed << 3);
        }
    }
}

/// The bits before the data, right-aligned; returns how many.
static unsigned header_of(const struct can_frame *f, uint64_t *bits) {
    const uint64_t remote = (f->flags & CAN_FRAME_REMOTE) != 0U ? 1U : 0U;
    const unsigned length = f->length & 15U;
    if ((f->flags & CAN_FRAME_EXTENDED) != 0U) {
        const uint64_t high = (f->id >> 18) & 0x7FFU, low = f->id & 0x3FFFFU;
        *bits = high << 27 | UINT64_C(3) << 25 | low << 7 | remote << 6 | length;
        return HEADER_BITS_EXTENDED;
    }
    *bits = (uint64_t)(f->id & 0x7FFU) << 7 | remote << 6 | length;
    return HEADER_BITS_STANDARD;
}

static unsigned data_bytes_of(const struct can_frame *f) {
    const unsigned length = f->length <= 8U ? f->length : 8U;
    return (f->flags & CAN_FRAME_REMOTE) != 0U ? 0U : length;
}

/// The state of both counters on the way along the bits of a frame.
struct bit_count {
    unsigned crc;   ///< CRC-15, shifted left by one: the tables want 16 bits
    unsigned entry; ///< next state of the stuff-bit counter in the lower 3 bits
    unsigned stuffed;
};

static void count_stuff(const struct can_timing *timing, struct bit_count *count, unsigned byte) {
    count->entry = timing->stuff[count->entry & 7U][byte];
    count->stuffed += count->entry >> 3;
}

static void count_crc(const struct can_timing *timing, struct bit_count *count, unsigned byte) {
    count->crc = (count->crc << 8 & 0xFFFFU) ^ timing->crc[count->crc >> 8 ^ byte];
}

/// Runs over everything before the CRC.
static struct bit_count count_bits(const struct can_timing *timing, const struct can_frame *frame,
                                   uint64_t header, unsigned header_bits, unsigned data_bytes) {
    // The header is filled up in front to whole bytes. For the CRC with zeros, which leave it zero;
    // for the stuff bits with alternating bits, which need none: the last is a 1, and the start bit
    // is a 0.
    const unsigned header_bytes = (header_bits + 7U) / 8U;
    const uint64_t filled = header | UINT64_C(0x15) << header_bits;
    struct bit_count count = {0, STUFF_STATE_ONE_ZERO, 0};
    for (unsigned i = header_bytes; i-- != 0U;) {
        count_crc(timing, &count, (header >> (8U * i)) & 0xFFU);
        count_stuff(timing, &count, (filled >> (8U * i)) & 0xFFU);
    }
    for (unsigned i = 0; i < data_bytes; i++) {
        count_crc(timing, &count, frame->data[i]);
        count_stuff(timing, &count, frame->data[i]);
    }
    return count;
}

uint16_t can_frame_crc(const struct can_timing *timing, const struct can_frame *frame) {
    uint64_t header;
    const unsigned header_bits = header_of(frame, &header);
    return (uint16_t)(count_bits(timing, frame, header, header_bits, data_bytes_of(frame)).crc >>
                      1);
}

unsigned can_frame_bits(const struct can_timing *timing, const struct can_frame *frame) {
    uint64_t header;
    const unsigned header_bits = header_of(frame, &header), data_bytes = data_bytes_of(frame);
    struct bit_count count = count_bits(timing, frame, header, header_bits, data_bytes);
    // The CRC and, to fill it up, a bit that differs from its last one and so needs no stuff bit.
    const unsigned tail = count.crc | (~count.crc >> 1 & 1U);
    count_stuff(timing, &count, tail >> 8);
    count_stuff(timing, &count, tail & 0xFFU);
    return header_bits + 8U * data_bytes + CRC_BITS + TAIL_BITS + count.stuffed;
}

/// The arbitration field as a number: the lower one wins the bus.
static uint32_t arbitration_key(const struct can_frame *f) {
    const uint32_t remote = (f->flags & CAN_FRAME_REMOTE) != 0U ? 1U : 0U;
    if ((f->flags & CAN_FRAME_EXTENDED) != 0U) {
        return (f->id >> 18 & 0x7FFU) << 21 | UINT32_C(3) << 19 | (f->id & 0x3FFFFU) << 1 | remote;
    }
    return (f->id & 0x7FFU) << 21 | remote << 20;
}

void can_bus_init(struct can_bus *bus, uint32_t bits_per_s, uint64_t seed) {
    memset(bus, 0, sizeof *bus);
    bus->bit_ns = UINT32_C(1000000000) / bits_per_s;
    bus->random = seed * UINT64_C(0x9E3779B97F4A7C15) | 1U;
    build_tables(&bus->timing);
}

bool can_bus_attach(struct can_bus *bus, struct can_node *node, can_receive_fn *receive,
                    void *context) {
    if (bus->node_count == CAN_BUS_NODES_MAX) {
        return false;
    }
    memset(node, 0, sizeof *node);
    node->receive = receive;
    node->context = context;
    node->index = bus->node_count;
    bus->nodes[bus->node_count++] = node;
    return true;
}

void can_bus_set_loss(struct can_bus *bus, double probability) {
    bus->loss_threshold = (uint32_t)(probability * 4294967295.0);
}

bool can_bus_send(struct can_bus *bus, struct can_node *node, const struct can_frame *frame,
                  uint64_t ready_ns) {
    if (node->count == CAN_NODE_QUEUE) {
        node->refused++;
        return false;
    }
    struct can_pending *p = &node->queue[(node->first + node->count) % CAN_NODE_QUEUE];
    p->ready_ns = ready_ns > bus->now_ns ? ready_ns : bus->now_ns;
    p->key = arbitration_key(frame);
    p->frame = *frame;
    node->count++;
    return true;
}

void can_bus_drop_queue(struct can_bus *bus, struct can_node *node) {
    const bool under_way = bus->busy && bus->current.sender == node->index;
    if (under_way) {
        bus->current.fate = CAN_LOST;
    }
    node->count = under_way ? 1 : 0;
}

static uint32_t random_u32(uint64_t *state) {
    uint64_t x = *state;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *state = x;
    return (uint32_t)((x * UINT64_C(0x2545F4914F6CDD1D)) >> 32);
}

/// When the next frame starts; UINT64_MAX if none waits.
static uint64_t next_start(const struct can_bus *bus) {
    uint64_t start = UINT64_MAX;
    for (unsigned i = 0; i < bus->node_count; i++) {
        const struct can_node *node = bus->nodes[i];
        if (node->count != 0U && !node->offline && node->queue[node->first].ready_ns < start) {
            start = node->queue[node->first].ready_ns;
        }
    }
    start = start > bus->idle_ns ? start : bus->idle_ns;
    return start > bus->now_ns ? start : bus->now_ns; // a node that was offline sends now, not then
}

uint64_t can_bus_next_ns(const struct can_bus *bus) {
    uint64_t next_ns = bus->busy ? bus->current.end_ns : UINT64_MAX;
    for (unsigned i = 0; !bus->busy && i < bus->node_count; i++) {
        if (bus->nodes[i]->count != 0U && !bus->nodes[i]->offline) {
            next_ns = next_start(bus);
        }
    }
    if (bus->delayed_count != 0U) {
        const uint64_t due = bus->delayed[0].end_ns + bus->delayed[0].delay_ns;
        next_ns = due < next_ns ? due : next_ns;
    }
    return next_ns;
}

static void begin_transfer(struct can_bus *bus, uint64_t start_ns) {
    const struct can_node *winner = NULL;
    const struct can_pending *best = NULL;
    for (unsigned i = 0; i < bus->node_count; i++) {
        const struct can_node *node = bus->nodes[i];
        const struct can_pending *p = &node->queue[node->first];
        if (node->count == 0U || node->offline || p->ready_ns > start_ns) {
            continue;
        }
        if (best != NULL && p->key == best->key) {
            bus->same_id++;
        }
        if (best == NULL || p->key < best->key) {
            best = p;
            winner = node;
        }
    }
    struct can_transfer *t = &bus->current;
    t->start_ns = start_ns;
    t->delay_ns = 0;
    t->fate = CAN_DELIVERED;
    t->sender = winner->index;
    t->frame = best->frame;
    unsigned bits = can_frame_bits(&bus->timing, &t->frame);
    if (bus->loss_threshold != 0U && random_u32(&bus->random) < bus->loss_threshold) {
        t->fate = CAN_LOST;
    }
    if (bus->fault != NULL) {
        bus->fault(bus->fault_context, t);
    }
    if (t->fate == CAN_DESTROYED) {
        bits += ERROR_FRAME_BITS - END_OF_FRAME_BITS;
    }
    t->end_ns = start_ns + (uint64_t)bits * bus->bit_ns;
    bus->idle_ns = t->end_ns + INTERMISSION_BITS * (uint64_t)bus->bit_ns;
    bus->busy_ns += bus->idle_ns - start_ns;
    bus->busy = true;
}

static void deliver(struct can_bus *bus, const struct can_transfer *transfer, uint64_t now_ns) {
    for (unsigned i = 0; i < bus->node_count; i++) {
        const struct can_node *node = bus->nodes[i];
        if (i != transfer->sender && node->receive != NULL && !node->offline) {
            node->receive(node->context, &transfer->frame, now_ns);
        }
    }
}

/// Keeps the list in order of the time at which the frames are heard; equal times keep their order.
static void hold_back(struct can_bus *bus, const struct can_transfer *transfer) {
    if (bus->delayed_count == CAN_BUS_DELAYED_MAX) {
        bus->delay_overflow++;
        bus->lost++;
        return;
    }
    const uint64_t due = transfer->end_ns + transfer->delay_ns;
    unsigned at = bus->delayed_count++;
    for (; at != 0U && bus->delayed[at - 1U].end_ns + bus->delayed[at - 1U].delay_ns > due; at--) {
        bus->delayed[at] = bus->delayed[at - 1U];
    }
    bus->delayed[at] = *transfer;
}

static void end_transfer(struct can_bus *bus) {
    const struct can_transfer transfer = bus->current; // receivers may send
    bus->busy = false;
    bus->frames++;
    if (bus->observer != NULL) {
        bus->observer(bus->observer_context, &transfer);
    }
    if (transfer.fate == CAN_DESTROYED) {
        bus->destroyed++;
        return;
    }
    struct can_node *sender = bus->nodes[transfer.sender];
    sender->first = (uint8_t)((sender->first + 1U) % CAN_NODE_QUEUE);
    sender->count--;
    sender->sent++;
    if (transfer.fate == CAN_LOST) {
        bus->lost++;
    } else if (transfer.delay_ns != 0U) {
        hold_back(bus, &transfer);
    } else {
        deliver(bus, &transfer, transfer.end_ns);
    }
}

/// Delivers the first of the held-back frames if it is due up to limit_ns.
static bool deliver_delayed(struct can_bus *bus, uint64_t limit_ns) {
    const struct can_transfer first = bus->delayed[0];
    const uint64_t due = first.end_ns + first.delay_ns;
    if (due > limit_ns) {
        return false;
    }
    bus->delayed_count--;
    memmove(&bus->delayed[0], &bus->delayed[1], bus->delayed_count * sizeof bus->delayed[0]);
    bus->now_ns = due;
    deliver(bus, &first, due);
    return true;
}

void can_bus_run_until(struct can_bus *bus, uint64_t t_ns) {
    for (;;) {
        const uint64_t next_ns = bus->busy ? bus->current.end_ns : next_start(bus);
        if (bus->delayed_count != 0U && deliver_delayed(bus, next_ns < t_ns ? next_ns : t_ns)) {
            continue;
        }
        if (bus->busy ? next_ns > t_ns : next_ns >= t_ns) {
            break;
        }
        bus->now_ns = next_ns;
        if (bus->busy) {
            end_transfer(bus);
        } else {
            begin_transfer(bus, next_ns);
        }
    }
    bus->now_ns = t_ns > bus->now_ns ? t_ns : bus->now_ns;
}

static uint64_t hash_frame(const struct can_frame *f, uint64_t hash) {
    uint64_t data;
    memcpy(&data, f->data, sizeof data);
    hash = trace_hash_u64(hash, f->id | (uint64_t)f->flags << 32 | (uint64_t)f->length << 40);
    return trace_hash_u64(hash, data);
}

uint64_t can_bus_hash(const struct can_bus *bus, uint64_t hash) {
    hash = trace_hash_u64(hash, bus->idle_ns);
    hash = trace_hash_u64(hash, bus->random);
    hash = trace_hash_u64(hash, bus->frames << 2 | (uint64_t)bus->busy);
    if (bus->busy) {
        hash = trace_hash_u64(hash, bus->current.end_ns);
        hash = hash_frame(&bus->current.frame, hash);
    }
    for (unsigned i = 0; i < bus->delayed_count; i++) {
        hash = trace_hash_u64(hash, bus->delayed[i].end_ns + bus->delayed[i].delay_ns);
        hash = hash_frame(&bus->delayed[i].frame, hash);
    }
    for (unsigned n = 0; n < bus->node_count; n++) {
        const struct can_node *node = bus->nodes[n];
        hash = trace_hash_u64(hash, node->count | (uint64_t)node->offline << 8);
        for (unsigned i = 0; i < node->count; i++) {
            const struct can_pending *p = &node->queue[(node->first + i) % CAN_NODE_QUEUE];
            hash = trace_hash_u64(hash, p->ready_ns);
            hash = hash_frame(&p->frame, hash);
        }
    }
    return hash;
}

void can_rx_queue_receive(void *context, const struct can_frame *frame, uint64_t now_ns) {
    struct can_rx_queue *queue = context;
    if (queue->count == CAN_RX_QUEUE) {
        queue->overruns++;
        return;
    }
    struct can_received *slot = &queue->frames[(queue->first + queue->count) % CAN_RX_QUEUE];
    slot->t_ns = now_ns;
    slot->frame = *frame;
    queue->count++;
}

bool can_rx_queue_pop(struct can_rx_queue *queue, struct can_frame *frame, uint64_t *t_ns) {
    if (queue->count == 0U) {
        return false;
    }
    *frame = queue->frames[queue->first].frame;
    if (t_ns != NULL) {
        *t_ns = queue->frames[queue->first].t_ns;
    }
    queue->first = (queue->first + 1U) % CAN_RX_QUEUE;
    queue->count--;
    return true;
}
