/// The contract of hal/can.h as a test of two controllers on one bus.
#ifndef CONTRACT_SUPPORT_CAN_SUITE_H
#define CONTRACT_SUPPORT_CAN_SUITE_H

#include "hal/can.h"
#include "hal/clock.h"

struct can_fixture {
    const char *name;
    /// Nobody else talks on the bus.
    const struct hal_can *a, *b;
    /// What arrival times are measured with.
    const struct hal_clock *clock;
    void *context;
    /// Both healthy, queues empty, counters 0, every frame received, no failure pending.
    void (*reset)(void *context);
    /// Lets the bus carry all that is queued.
    void (*settle)(void *context);
    /// Drives a into bus-off. The bus is well again afterwards.
    void (*bus_off)(void *context);
    /// Fails a call of a: see contract.h.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
    bool some_cannot_fail;
    /// Frames that b's receive queue holds; 0: unknown.
    uint32_t receive_capacity;
    /// Frames that a's send queue holds while the bus is not let run (settle); 0: it runs by
    /// itself.
    uint32_t send_capacity;
    /// Of the random rounds one in so many, and some lengths and filters left out, for rigs that
    /// take long; 0: all.
    uint32_t share;
    /// The rig's bus mangles remote frames that ask for a length: none are sent.
    bool remote_length_lost;
};

/// Needs reset and settle; the other hands may be null.
void can_suite(const struct can_fixture *fixture);

#endif
