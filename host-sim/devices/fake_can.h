/// A CAN controller without a bus: what hal_can_send queues waits until some model of a bus takes
/// it, and what that model gives is received. fake_can_carry is the simplest bus, without time.
#ifndef DEVICES_FAKE_CAN_H
#define DEVICES_FAKE_CAN_H

#include "devices/fake_failures.h"
#include "hal/can.h"
#include "hal/clock.h"

#define FAKE_CAN_QUEUE_FRAMES 64U

struct fake_can_queue {
    struct can_frame frames[FAKE_CAN_QUEUE_FRAMES];
    uint32_t times_us[FAKE_CAN_QUEUE_FRAMES];
    uint32_t head, count, capacity;
};

struct fake_can {
    struct hal_can hal;
    struct fake_failures failures;
    const struct hal_clock *clock;
    struct fake_can_queue sending, received;
    struct hal_can_filter filters[HAL_CAN_FILTERS_MAX];
    uint32_t filter_count;
    struct hal_can_state state;
    /// A restart was asked for and the bus has not granted it yet.
    bool recovering;
};

/// Must not move in memory afterwards. Capacities: 1 to FAKE_CAN_QUEUE_FRAMES. clock: for the times
/// of arrival; stays the caller's.
void fake_can_init(struct fake_can *can, const struct hal_clock *clock, uint32_t send_capacity,
                   uint32_t receive_capacity);

// The bus's side.

/// The frame that the controller wants to put on the bus, or null. It stays until it is taken: a
/// frame that loses arbitration is tried again.
const struct can_frame *fake_can_next(const struct fake_can *can);
/// The frame of fake_can_next has been sent.
void fake_can_take(struct fake_can *can);
/// A frame arrives from the bus now: passes the filters, and is lost and counted if the queue is
/// full. Nothing arrives in bus-off.
void fake_can_give(struct fake_can *can, const struct can_frame *frame);
/// Error counters, 0 to 256 and 0 to 255; health follows. 256 is bus-off and empties the send
/// queue; from there only fake_can_recover leads back.
void fake_can_set_errors(struct fake_can *can, uint16_t transmit, uint16_t receive);
/// The bus has been idle for 128 x 11 bits: leaves bus-off if a restart was asked for.
void fake_can_recover(struct fake_can *can);

/// A bus of two: carries all frames both ways, a frame of each in turn, and lets both recover.
void fake_can_carry(struct fake_can *a, struct fake_can *b);

#endif
