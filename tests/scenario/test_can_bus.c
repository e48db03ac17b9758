/// devices/can_bus: bit counts by hand and against a plain bit-by-bit reference, arbitration,
/// faults.
#include "check.h"

#include "devices/can_bus.h"

#include <stdio.h>
#include <string.h>

static struct can_bus bus;
static struct can_node nodes[4];
static struct can_rx_queue heard[4];

static void new_bus(uint32_t bits_per_s, uint64_t seed) {
    can_bus_init(&bus, bits_per_s, seed);
    memset(heard, 0, sizeof heard);
    for (unsigned i = 0; i < 4U; i++) {
        CHECK(can_bus_attach(&bus, &nodes[i], can_rx_queue_receive, &heard[i]));
    }
}

static struct can_frame frame(uint32_t id, uint8_t length, uint8_t first) {
    return (struct can_frame){.id = id, .length = length, .data = {first}};
}

static void send(unsigned node, struct can_frame f, uint64_t ready_ns) {
    CHECK(can_bus_send(&bus, &nodes[node], &f, ready_ns));
}

/// The next frame heard by a node: its id, and when.
static uint32_t next_id(unsigned node, uint64_t *t_ns) {
    struct can_frame f = {.id = UINT32_MAX};
    *t_ns = 0;
    return can_rx_queue_pop(&heard[node], &f, t_ns) ? f.id : UINT32_MAX;
}

// ---------------------------------------------------------------- reference

struct bits {
    uint8_t bit[256];
    unsigned count;
};

static void append(struct bits *b, uint64_t value, unsigned count) {
    while (count-- != 0U) {
        b->bit[b->count++] = (value >> count) & 1U;
    }
}

/// CRC-15 of CAN, a bit at a time, as the standard's shift register does it.
static unsigned reference_crc(const struct bits *b) {
    unsigned crc = 0;
    for (unsigned i = 0; i < b->count; i++) {
        const unsigned next = b->bit[i] ^ ((crc >> 14) & 1U);
        crc = (crc << 1) & 0x7FFFU;
        if (next != 0U) {
            crc ^= 0x4599U;
        }
    }
    return crc;
}

static struct bits unstuffed_bits(const struct can_frame *f) {
    struct bits b = {.count = 0};
    const unsigned remote = (f->flags & CAN_FRAME_REMOTE) != 0U;
    append(&b, 0, 1);
    if ((f->flags & CAN_FRAME_EXTENDED) != 0U) {
        append(&b, f->id >> 18, 11);
        append(&b, 3, 2);
        append(&b, f->id, 18);
        append(&b, remote, 1);
        append(&b, 0, 2);
    } else {
        append(&b, f->id, 11);
        append(&b, remote, 1);
        append(&b, 0, 2);
    }
    append(&b, f->length, 4);
    for (unsigned i = 0; i < f->length && remote == 0U; i++) {
        append(&b, f->data[i], 8);
    }
    append(&b, reference_crc(&b), 15);
    return b;
}

/// Puts the stuff bits in one by one, then adds delimiter, acknowledge and end of frame.
static unsigned reference_bits(const struct can_frame *f) {
    const struct bits plain = unstuffed_bits(f);
    struct bits wire = {.count = 0};
    for (unsigned i = 0; i < plain.count; i++) {
        append(&wire, plain.bit[i], 1);
        const uint8_t *end = &wire.bit[wire.count];
        if (wire.count >= 5U && end[-1] == end[-2] && end[-2] == end[-3] && end[-3] == end[-4] &&
            end[-4] == end[-5]) {
            append(&wire, end[-1] ^ 1U, 1);
        }
    }
    return wire.count + 1U + 2U + 7U;
}

// ---------------------------------------------------------------- durations

static void bit_counts_by_hand(void) {
    new_bus(1000000, 1);
    // 34 zeros (start, id, control, CRC): a stuff bit after each 5 of them, 6; 44 + 6.
    struct can_frame f = frame(0, 0, 0);
    CHECK_EQ(can_frame_crc(&bus.timing, &f), 0);
    CHECK_EQ(can_frame_bits(&bus.timing, &f), 50);
    // Remote, id 0, length 0. Only the RTR bit is set, 6 places before the CRC: x^21 mod P by hand:
    // 4599 4EAB 58CF 7407 2D97 5B2E 73C5. Wire: 12 zeros (2 stuff bits), 1, 6 zeros (1 stuff bit),
    // 111 00 1111 000 1 0 1 (none). 44 + 3.
    f.flags = CAN_FRAME_REMOTE;
    CHECK_EQ(can_frame_crc(&bus.timing, &f), 0x73C5);
    CHECK_EQ(can_frame_bits(&bus.timing, &f), 47);
    // The check value of CRC-15/CAN in the catalogue of CRCs: the text 123456789 gives 059E.
    struct bits b = {.count = 0};
    for (unsigned i = 0; i < 9U; i++) {
        append(&b, (uint64_t)'1' + i, 8);
    }
    CHECK_EQ(reference_crc(&b), 0x059E);
}

static void bit_counts_against_the_reference(void) {
    new_bus(1000000, 1);
    uint64_t seed = 77;
    check_note("seed", (int64_t)seed);
    unsigned longest = 0, shortest = 999;
    for (unsigned i = 0; i < 200000U && check_clean(); i++) {
        const uint64_t r = check_random(&seed), data = check_random(&seed);
        struct can_frame f = {.id = (uint32_t)r & 0x1FFFFFFFU, .length = (uint8_t)((r >> 32) % 9U)};
        f.flags = (r >> 40) % 4U; // standard, extended, each data and remote
        f.id &= (f.flags & CAN_FRAME_EXTENDED) != 0U ? UINT32_MAX : 0x7FFU;
        const uint64_t mask = check_random(&seed); // long runs of equal bits come up often
        for (unsigned k = 0; k < f.length; k++) {
            const uint8_t run = ((mask >> (4U * k)) & 1U) != 0U ? 0xFF : 0;
            f.data[k] = ((mask >> (4U * k + 1U)) & 1U) != 0U ? run : (uint8_t)(data >> (8U * k));
        }
        const unsigned bits = can_frame_bits(&bus.timing, &f);
        CHECK_EQ(bits, reference_bits(&f));
        if (f.flags == 0U && f.length == 8U) {
            longest = bits > longest ? bits : longest;
            shortest = bits < shortest ? bits : shortest;
        }
    }
    check_note("shortest frame of 8 bytes, bits", shortest);
    check_note("longest frame of 8 bytes, bits", longest);
    CHECK(shortest >= 108U && longest <= 132U);
}

static void frames_take_their_time(void) {
    static const uint32_t rates[] = {1000000, 500000, 125000};
    for (unsigned i = 0; i < 3U; i++) {
        new_bus(rates[i], 1);
        const uint64_t bit = 1000000000U / rates[i];
        send(0, frame(0, 0, 0), 5000);
        send(0, frame(0, 0, 0), 5000);
        can_bus_run_until(&bus, 5000 + 103 * bit - 1);
        uint64_t t;
        CHECK_EQ(next_id(1, &t), 0);
        CHECK_EQ(t, 5000 + 50 * bit);
        CHECK_EQ(heard[1].count, 0);
        can_bus_run_until(&bus, 5000 + 103 * bit); // 50 bits, 3 of intermission, 50 bits
        CHECK_EQ(next_id(1, &t), 0);
        CHECK_EQ(t, 5000 + 103 * bit);
        CHECK_EQ(bus.busy_ns, 106 * bit);
        CHECK_EQ(bus.frames, 2);
        CHECK_EQ(nodes[0].sent, 2);
        CHECK_EQ(heard[0].count, 0); // not its own
        CHECK_EQ(heard[2].count, 2);
    }
}

// ---------------------------------------------------------------- arbitration

static void lowest_identifier_first(void) {
    new_bus(1000000, 1);
    send(0, frame(0x300, 8, 0), 0);
    send(1, frame(0x123, 8, 0), 0);
    send(2, frame(0x122, 8, 0), 0);
    send(0, frame(0x001, 8, 0), 0); // behind 0x300 in its node's queue: first in, first out
    can_bus_run_until(&bus, 1000000);
    static const uint32_t order[] = {0x122, 0x123, 0x300, 0x001};
    uint64_t t, last = 0;
    for (unsigned i = 0; i < 4U; i++) {
        CHECK_EQ(next_id(3, &t), order[i]);
        CHECK(t > last);
        last = t;
    }
}

static void formats_in_wire_order(void) {
    new_bus(1000000, 1);
    // The same 11 bits: standard data, standard remote, extended data, extended remote.
    struct can_frame f = frame(0x123, 1, 1);
    f.flags = CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE;
    f.id = 0x123U << 18;
    send(0, f, 0);
    f.flags = CAN_FRAME_EXTENDED;
    send(1, f, 0);
    f.flags = CAN_FRAME_REMOTE;
    f.id = 0x123;
    send(2, f, 0);
    f.flags = 0;
    send(3, f, 0);
    can_bus_run_until(&bus, 1000000);
    static const uint8_t order[] = {0, CAN_FRAME_REMOTE, CAN_FRAME_EXTENDED};
    for (unsigned i = 0; i < 3U; i++) {
        CHECK(can_rx_queue_pop(&heard[0], &f, NULL));
        CHECK_EQ(f.flags, order[i]);
    }
    CHECK(!can_rx_queue_pop(&heard[0], &f, NULL)); // the fourth is its own
}

static void a_running_frame_is_not_interrupted(void) {
    new_bus(1000000, 1);
    send(0, frame(0x7F0, 8, 0), 0);
    can_bus_run_until(&bus, 50000);
    send(1, frame(0x001, 8, 0), 0); // ready "at 0", but it is 50 us
    send(2, frame(0x002, 8, 0), 400000);
    send(3, frame(0x000, 8, 0), 500000);
    can_bus_run_until(&bus, 1000000);
    uint64_t t[4];
    CHECK_EQ(next_id(1, &t[0]), 0x7F0);
    CHECK_EQ(next_id(3, &t[1]), 0x7F0);
    CHECK_EQ(next_id(3, &t[2]), 0x001);
    CHECK(t[2] > t[0] + 108000U);
    CHECK_EQ(next_id(3, &t[3]), 0x002); // the bus was idle: the lower one was not ready yet
    CHECK(t[3] > 400000U && t[3] < 533000U);
    CHECK_EQ(bus.same_id, 0);
}

/// A frame sent at t competes with one that was waiting for t.
static void the_end_of_a_run_is_open(void) {
    new_bus(1000000, 1);
    send(0, frame(0x200, 1, 0), 1000000);
    can_bus_run_until(&bus, 1000000);
    send(1, frame(0x100, 1, 0), 1000000);
    send(2, frame(0x200, 1, 9), 1000000); // same identifier as node 0
    can_bus_run_until(&bus, 2000000);
    uint64_t t;
    CHECK_EQ(next_id(3, &t), 0x100);
    struct can_frame f;
    CHECK(can_rx_queue_pop(&heard[3], &f, NULL));
    CHECK_EQ(f.data[0], 0); // the node attached first
    CHECK(bus.same_id != 0U);
}

// ---------------------------------------------------------------- bounds

static void queues_are_bounded(void) {
    new_bus(1000000, 1);
    struct can_frame f = frame(1, 0, 0);
    for (unsigned i = 0; i < CAN_NODE_QUEUE; i++) {
        CHECK(can_bus_send(&bus, &nodes[0], &f, 0));
    }
    CHECK(!can_bus_send(&bus, &nodes[0], &f, 0));
    CHECK_EQ(nodes[0].refused, 1);
    can_bus_run_until(&bus, 100000000);
    CHECK_EQ(heard[1].count, CAN_NODE_QUEUE);
    for (unsigned i = 0; i < 100U; i++) {
        send(0, f, 0);
        can_bus_run_until(&bus, bus.now_ns + 1000000U);
    }
    CHECK_EQ(heard[1].count, CAN_RX_QUEUE);
    CHECK_EQ(heard[1].overruns, CAN_NODE_QUEUE + 100U - CAN_RX_QUEUE);
    struct can_node more[CAN_BUS_NODES_MAX];
    for (unsigned i = 4; i < CAN_BUS_NODES_MAX; i++) {
        CHECK(can_bus_attach(&bus, &more[i], NULL, NULL));
    }
    CHECK(!can_bus_attach(&bus, &more[0], NULL, NULL));
}

// ---------------------------------------------------------------- faults

static uint64_t run_with_loss(uint64_t seed, double probability, unsigned frames) {
    new_bus(1000000, seed);
    can_bus_set_loss(&bus, probability);
    uint64_t pattern = 0;
    for (unsigned i = 0; i < frames; i++) {
        send(0, frame(i & 0x7FFU, 0, 0), 0);
        can_bus_run_until(&bus, bus.now_ns + 1000000U);
        pattern = pattern * 31U + heard[1].count;
        heard[1].count = 0;
    }
    return pattern;
}

static void losses_follow_the_dice(void) {
    static const double chances[] = {0.0, 0.01, 0.1, 0.3, 1.0};
    for (unsigned i = 0; i < 5U; i++) {
        const uint64_t seed = 1000 + i;
        const unsigned frames = 20000;
        run_with_loss(seed, chances[i], frames);
        const double expected = chances[i] * frames;
        const double variance = expected * (1.0 - chances[i]);
        const double off = (double)bus.lost - expected;
        printf("# seed %u: %u of %u frames lost at %g\n", (unsigned)seed, (unsigned)bus.lost,
               frames, chances[i]);
        CHECK(off * off <= 25.0 * variance); // 5 sigma
        CHECK_EQ(bus.frames, frames);
    }
    CHECK(run_with_loss(5, 0.1, 1000) == run_with_loss(5, 0.1, 1000));
    CHECK(run_with_loss(5, 0.1, 1000) != run_with_loss(6, 0.1, 1000));
}

struct plan {
    unsigned destroy;    ///< so many transfers
    unsigned delay_each; ///< us for each 0x10 of the identifiers below 0x100
    unsigned seen;
    struct can_transfer last;
};

static void fault(void *context, struct can_transfer *t) {
    struct plan *plan = context;
    if (plan->destroy != 0U) {
        plan->destroy--;
        t->fate = CAN_DESTROYED;
    }
    t->delay_ns = t->frame.id < 0x100U ? plan->delay_each * 1000ULL * (t->frame.id >> 4) : 0;
    t->frame.data[7] ^= 0x80U;
}

static void observe(void *context, const struct can_transfer *t) {
    struct plan *plan = context;
    plan->seen++;
    plan->last = *t;
}

static void new_faulty_bus(struct plan *plan) {
    new_bus(1000000, 1);
    bus.fault = fault;
    bus.observer = observe;
    bus.fault_context = bus.observer_context = plan;
}

static void a_destroyed_frame_is_sent_again(void) {
    struct plan plan = {.destroy = 2};
    new_faulty_bus(&plan);
    struct can_frame f = frame(0x200, 8, 1);
    const unsigned bits = can_frame_bits(&bus.timing, &f);
    send(0, f, 0);
    can_bus_run_until(&bus, 10000000);
    uint64_t t;
    CHECK_EQ(heard[1].count, 1);
    CHECK_EQ(heard[1].frames[0].frame.data[7], 0x80); // changed on the way
    CHECK_EQ(next_id(1, &t), 0x200);
    // Twice: without end of frame (7), with error flag (6), delimiter (8), intermission (3).
    CHECK_EQ(t, (2U * (bits - 7U + 14U + 3U) + bits) * 1000U);
    CHECK_EQ(plan.seen, 3);
    CHECK_EQ(bus.destroyed, 2);
    CHECK_EQ(nodes[0].sent, 1);
    CHECK_EQ(plan.last.start_ns, t - bits * 1000U);
    CHECK_EQ(plan.last.end_ns, t);
    CHECK_EQ(plan.last.sender, 0);
}

static void delayed_frames_arrive_later_and_out_of_order(void) {
    struct plan plan = {.delay_each = 100};
    new_faulty_bus(&plan);
    struct can_frame f = frame(0x050, 0, 0);
    const uint64_t end = can_frame_bits(&bus.timing, &f) * 1000U;
    send(0, f, 0);
    send(0, frame(0x200, 0, 0), 0);
    send(0, frame(0x010, 0, 0), 0); // sent later, held back for less
    send(0, frame(0x090, 0, 0), 0);
    can_bus_run_until(&bus, 1500000);
    uint64_t t;
    CHECK_EQ(next_id(1, &t), 0x200);
    CHECK(t < 200000U);
    CHECK_EQ(next_id(1, &t), 0x010);
    CHECK_EQ(next_id(1, &t), 0x050);
    CHECK_EQ(t, end + 500000U);
    CHECK_EQ(next_id(1, &t), 0x090);
    // Held back over the end of a run, and more of them than there is room for.
    plan.delay_each = 50000;
    for (unsigned i = 0; i < CAN_BUS_DELAYED_MAX + 3U; i++) {
        send(0, frame(0x10U + i % 16U, 0, 0), 0);
        can_bus_run_until(&bus, bus.now_ns + 100000U);
    }
    CHECK_EQ(heard[2].count, 4);
    can_bus_run_until(&bus, 100000000);
    CHECK_EQ(heard[2].count, 4U + CAN_BUS_DELAYED_MAX);
    CHECK_EQ(bus.delay_overflow, 3);
    CHECK_EQ(bus.lost, 3);
}

static void a_node_offline_is_cut_off(void) {
    new_bus(1000000, 1);
    nodes[0].offline = true;
    nodes[1].offline = true;
    send(0, frame(0x010, 0, 0), 0);
    send(2, frame(0x020, 0, 0), 0);
    can_bus_run_until(&bus, 1000000);
    CHECK_EQ(heard[1].count, 0);
    CHECK_EQ(heard[3].count, 1);
    nodes[0].offline = false;
    can_bus_run_until(&bus, 2000000);
    CHECK_EQ(heard[3].count, 2);
    CHECK(heard[3].frames[1].t_ns > 1000000U); // it starts now, not in the past
    CHECK_EQ(heard[0].count, 0);
}

static void the_hash_covers_what_waits(void) {
    new_bus(1000000, 1);
    const uint64_t empty = can_bus_hash(&bus, 1);
    send(0, frame(0x010, 8, 1), 0);
    const uint64_t queued = can_bus_hash(&bus, 1);
    can_bus_run_until(&bus, 50000);
    const uint64_t running = can_bus_hash(&bus, 1);
    can_bus_run_until(&bus, 500000);
    const uint64_t done = can_bus_hash(&bus, 1);
    CHECK(empty != queued && queued != running && running != done && done != empty);
    new_bus(1000000, 1);
    send(0, frame(0x010, 8, 2), 0);
    CHECK(can_bus_hash(&bus, 1) != queued);
}

int main(void) {
    TEST(bit_counts_by_hand);
    TEST(bit_counts_against_the_reference);
    TEST(frames_take_their_time);
    TEST(lowest_identifier_first);
    TEST(formats_in_wire_order);
    TEST(a_running_frame_is_not_interrupted);
    TEST(the_end_of_a_run_is_open);
    TEST(queues_are_bounded);
    TEST(losses_follow_the_dice);
    TEST(a_destroyed_frame_is_sent_again);
    TEST(delayed_frames_arrive_later_and_out_of_order);
    TEST(a_node_offline_is_cut_off);
    TEST(the_hash_covers_what_waits);
    return check_finish();
}
