#include "contract/support/candle_model.h"

#include <string.h>

#define FRAME_PLAIN 20
#define FROM_BUS    "\xff\xff\xff\xff"

const uint8_t candle_device[18] = {18,   1,    0,    2, 0, 0, 0, 64, 0x50,
                                   0x1D, 0x6F, 0x60, 0, 0, 1, 2, 3,  1};
const uint8_t candle_configuration[32] = {9,  2, 32, 0,    1,    1,    0, 0x80, 50, 9,    4,
                                          0,  0, 2,  0xFF, 0xFF, 0xFF, 0, 7,    5,  0x81, 2,
                                          64, 0, 0,  7,    5,    0x02, 2, 64,   0,  0};

static void lock(struct candle_bus *bus) {
    while (atomic_flag_test_and_set(&bus->lock)) {
    }
}

static void unlock(struct candle_bus *bus) {
    atomic_flag_clear(&bus->lock);
}

static void give(struct candle_node *node, const uint8_t *frame) {
    if (node->waiting < CANDLE_QUEUE) {
        memcpy(node->in[(node->first + node->waiting) % CANDLE_QUEUE], frame, CANDLE_FRAME_BYTES);
        node->waiting++;
    }
}

/// Little endian, as this machine is.
static void stamp(const struct candle *candle, uint8_t *frame) {
    const uint32_t now_us = candle->now_us != NULL ? candle->now_us() : 0U;
    memcpy(frame + FRAME_PLAIN, &now_us, sizeof now_us);
}

static void forget(struct candle_bus *bus, unsigned node) {
    unsigned left = 0;
    for (unsigned i = 0; i < bus->held_count; i++) {
        if (bus->held[i].node != node) {
            bus->held[left++] = bus->held[i];
        }
    }
    bus->held_count = left;
}

static void set_mode(struct candle *candle, unsigned channel, const uint8_t *data) {
    struct candle_node *node = &candle->bus->node[candle->first_node + channel];
    forget(candle->bus, candle->first_node + channel);
    node->started = data[0] == 1U;
    node->starts += node->started;
    node->timed = (data[4] & 16U) != 0U;
    node->off = false;
}

static int answer(struct candle *candle, const uint8_t setup[8], uint8_t *data) {
    const uint32_t limits[10] = {candle->features, 48000000, 1, 16, 1, 8, 4, 1, 1024, 1};
    const uint8_t config[12] = {0, 0, 0, (uint8_t)(candle->channel_count - 1U), 2, 0, 0, 0, 1};
    const unsigned channel = setup[2];
    if (setup[0] == 0xC1 && setup[1] == 5 && channel == 1U) {
        memcpy(data, config, sizeof config);
        return sizeof config;
    }
    if (setup[0] == 0xC1 && setup[1] == 4 && channel < candle->channel_count) {
        memcpy(data, limits, sizeof limits);
        return sizeof limits;
    }
    if (setup[0] == 0x41 && setup[1] == 0) { // the order of bytes
        return channel == 1U ? 0 : CANDLE_STALL;
    }
    if (setup[0] != 0x41 || channel >= candle->channel_count) {
        return CANDLE_STALL;
    }
    if (setup[1] == 2) {
        set_mode(candle, channel, data);
    } else if (setup[1] == 1) {
        memcpy(candle->bus->node[candle->first_node + channel].timing, data, 20);
    }
    return setup[1] <= 2U ? 0 : CANDLE_STALL;
}

int candle_control(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size) {
    struct candle *candle = ctx;
    (void)size;
    if (candle->mute) {
        return CANDLE_LATER;
    }
    lock(candle->bus);
    const int count = candle->refusing ? CANDLE_STALL : answer(candle, setup, data);
    unlock(candle->bus);
    return count;
}

int candle_bulk_out(void *ctx, uint8_t endpoint, const uint8_t *data, uint32_t size) {
    struct candle *candle = ctx;
    struct candle_bus *bus = candle->bus;
    const unsigned channel = size >= FRAME_PLAIN ? data[9] : UINT32_MAX;
    if (endpoint != 2U || channel >= candle->channel_count) {
        return (int)size;
    }
    lock(bus);
    struct candle_node *node = &bus->node[candle->first_node + channel];
    if (!node->off && node->started && bus->held_count < CANDLE_QUEUE) {
        struct candle_held *held = &bus->held[bus->held_count++];
        held->node = candle->first_node + channel;
        memcpy(held->frame, data, FRAME_PLAIN);
    }
    node->taken++;
    unlock(bus);
    return (int)size;
}

/// Off the bus, with what it had to send. The host is told by an error frame.
static void lose_the_bus(struct candle_bus *bus, unsigned number, unsigned channel) {
    uint8_t error[CANDLE_FRAME_BYTES] = {0xFF, 0xFF, 0xFF, 0xFF, 0x40, 0, 0, 0x20, 8};
    struct candle_node *node = &bus->node[number];
    error[9] = (uint8_t)channel;
    node->bus_off_wanted = false;
    node->off = true;
    forget(bus, number);
    give(node, error);
}

/// All that is held crosses the bus. Channel numbers are put right when a host fetches its frames.
static void carry(const struct candle *candle) {
    struct candle_bus *bus = candle->bus;
    for (unsigned i = 0; i < bus->held_count; i++) {
        struct candle_held *held = &bus->held[i];
        stamp(candle, held->frame);
        give(&bus->node[held->node], held->frame); // the echo: it has been sent
        memcpy(held->frame, FROM_BUS, 4);
        for (unsigned other = 0; other < CANDLE_NODES; other++) {
            if (other != held->node && bus->node[other].started && !bus->node[other].off) {
                give(&bus->node[other], held->frame);
            }
        }
    }
    bus->held_count = 0;
}

static int fetch(struct candle_node *node, unsigned channel, uint8_t *data, uint32_t capacity) {
    const uint32_t size = node->timed ? CANDLE_FRAME_BYTES : FRAME_PLAIN;
    if (node->waiting == 0U || capacity < size) {
        return CANDLE_LATER;
    }
    memcpy(data, node->in[node->first], size);
    data[9] = (uint8_t)channel;
    node->first = (node->first + 1U) % CANDLE_QUEUE;
    node->waiting--;
    node->given++;
    return (int)size;
}

int candle_bulk_in(void *ctx, uint8_t endpoint, uint8_t *data, uint32_t capacity) {
    const struct candle *candle = ctx;
    int count = CANDLE_LATER;
    if (endpoint != 1U) {
        return CANDLE_LATER;
    }
    lock(candle->bus);
    for (unsigned channel = 0; channel < candle->channel_count; channel++) {
        if (candle->bus->node[candle->first_node + channel].bus_off_wanted) {
            lose_the_bus(candle->bus, candle->first_node + channel, channel);
        }
    }
    if (candle->bus->carries) {
        carry(candle);
    }
    for (unsigned i = 0; i < candle->channel_count && count == CANDLE_LATER; i++) {
        count = fetch(&candle->bus->node[candle->first_node + i], i, data, capacity);
    }
    unlock(candle->bus);
    return count;
}

void candle_inject(struct candle_bus *bus, unsigned node, const uint8_t frame[20]) {
    uint8_t padded[CANDLE_FRAME_BYTES] = {0};
    memcpy(padded, frame, FRAME_PLAIN);
    lock(bus);
    give(&bus->node[node], padded);
    unlock(bus);
}
