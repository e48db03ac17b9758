/// The contract of hal/serial.h as a test.
#ifndef CONTRACT_SUPPORT_SERIAL_SUITE_H
#define CONTRACT_SUPPORT_SERIAL_SUITE_H

#include "hal/serial.h"

#include <stdbool.h>

struct serial_fixture {
    const char *name;
    const struct hal_serial *serial;
    void *context;
    /// A new line, nothing on its way, no failure pending.
    void (*reset)(void *context);
    /// The other end of the line, without waiting: how many bytes went.
    size_t (*peer_write)(void *context, const uint8_t *data, size_t size_bytes);
    size_t (*peer_read)(void *context, uint8_t *data, size_t capacity_bytes);
    /// Lets the line carry something: a moment of real or virtual time.
    void (*settle)(void *context);
    /// Cuts the line for good, until reset.
    void (*hang_up)(void *context);
    /// See contract.h.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
    /// Bytes that the device holds unread before it loses the next; 0: it loses none (the peer is
    /// held up instead).
    size_t receive_capacity;
};

/// Needs reset, peer_write, peer_read and settle; the other hands may be null.
void serial_suite(const struct serial_fixture *fixture);

#endif
