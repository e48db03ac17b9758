/// CAN adapters that speak gs_usb (candleLight's protocol), and the bus between them, for tests: as
/// the protocol is described, sharing no code with the driver. Adapters may be played by several
/// processes with the bus in shared memory.
///
/// The bus carries only while it is told to. A frame goes from its channel's queue to every other
/// channel that is started; then its echo goes to the sender's host.
#ifndef CONTRACT_SUPPORT_CANDLE_MODEL_H
#define CONTRACT_SUPPORT_CANDLE_MODEL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#define CANDLE_NODES       4
#define CANDLE_QUEUE       512U
#define CANDLE_FRAME_BYTES 24
#define CANDLE_STALL       (-1)
#define CANDLE_LATER       (-2)

struct candle_bus {
    atomic_flag lock;
    volatile bool carries; ///< by the test: the bus runs
    volatile unsigned held_count;
    struct candle_held {
        unsigned node;
        uint8_t frame[CANDLE_FRAME_BYTES];
    } held[CANDLE_QUEUE]; ///< on their way to the bus, in order
    struct candle_node {
        volatile bool bus_off_wanted; ///< by the test: the channel loses the bus
        volatile bool started, off, timed;
        volatile unsigned taken; ///< frames from the host
        volatile unsigned given; ///< to the host: frames, echoes, errors
        volatile unsigned starts;
        uint32_t timing[5]; ///< as sent by the host
        volatile unsigned first, waiting;
        uint8_t in[CANDLE_QUEUE][CANDLE_FRAME_BYTES]; ///< to the host
    } node[CANDLE_NODES];
};

struct candle {
    struct candle_bus *bus;
    unsigned first_node, channel_count;
    uint32_t features;            ///< of its first answer; bit 4: it has a clock
    uint32_t (*now_us)(void);     ///< that clock
    volatile bool mute, refusing; ///< requests are not answered; are refused
};

/// Descriptors: device (18 bytes), and configuration.
extern const uint8_t candle_device[18];
extern const uint8_t candle_configuration[32];

/// Answers a request; data as in a USB control transfer. Returns: bytes; CANDLE_STALL: refused;
/// CANDLE_LATER: no answer.
int candle_control(void *candle, const uint8_t setup[8], uint8_t *data, uint16_t size);
int candle_bulk_out(void *candle, uint8_t endpoint, const uint8_t *data, uint32_t size);
/// CANDLE_LATER: nothing waits.
int candle_bulk_in(void *candle, uint8_t endpoint, uint8_t *data, uint32_t capacity);

/// Gives a frame, as it goes over the wire, to the host of a channel.
void candle_inject(struct candle_bus *bus, unsigned node, const uint8_t frame[20]);

#endif
