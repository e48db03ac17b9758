/// A serial line: bytes in, bytes out, no more. Speed and framing (8N1, no flow control) are set
/// when the device is opened.
/// Shown: tests/contract/support/serial_suite.h, on every implementation.
#ifndef HAL_SERIAL_H
#define HAL_SERIAL_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stddef.h>
#include <stdint.h>

/// Counters since the device was opened; they wrap. 0 where a driver doesn't count.
struct hal_serial_state {
    /// Bytes that arrived while the receive buffer was full.
    uint32_t lost_count;
    /// Bytes that arrived damaged (framing, parity, noise, break). Not delivered.
    uint32_t damaged_count;
};

struct hal_serial_ops {
    enum hal_status (*write)(void *ctx, const uint8_t *data, size_t size_bytes,
                             size_t *written_bytes);
    enum hal_status (*read)(void *ctx, uint8_t *data, size_t capacity_bytes, size_t *read_bytes);
    enum hal_status (*state)(void *ctx, struct hal_serial_state *state);
};

struct hal_serial {
    const struct hal_serial_ops *ops;
    void *ctx;
};

/// Fills *serial. HAL_ERROR_ARGUMENT (and *serial as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status
hal_serial_bind(struct hal_serial *serial, const struct hal_serial_ops *ops, void *ctx) {
    if (serial == NULL || ops == NULL || ops->write == NULL || ops->read == NULL ||
        ops->state == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *serial = (struct hal_serial){ops, ctx};
    return HAL_OK;
}

/// Queues bytes for sending: as many of the first ones as there is room for.
/// size_bytes: at least 1. *written_bytes: how many were taken; set whenever it is not null.
/// Returns:  HAL_OK: at least one was taken, maybe not all: send the rest later;
///           HAL_BUSY: no room, none taken;
///           HAL_ERROR_IO: none taken; HAL_ERROR_GONE: what was queued may not have been sent.
/// Cost:     a copy; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_serial_write(const struct hal_serial *serial,
                                                          const uint8_t *data, size_t size_bytes,
                                                          size_t *written_bytes) {
    if (written_bytes == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *written_bytes = 0;
    if (data == NULL || size_bytes == 0U) {
        return HAL_ERROR_ARGUMENT;
    }
    return serial->ops->write(serial->ctx, data, size_bytes, written_bytes);
}

/// Takes bytes that arrived, in order.
/// capacity_bytes: room at data, at least 1. *read_bytes: how many came; set whenever not null.
/// Returns:  HAL_OK: at least one; there may be more;
///           HAL_EMPTY: none now; HAL_ERROR_IO: none, and none lost by that;
///           HAL_ERROR_GONE: the line is gone, and what had arrived before it went has been read,
///           as far as the system kept it.
/// Cost:     a copy; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_serial_read(const struct hal_serial *serial,
                                                         uint8_t *data, size_t capacity_bytes,
                                                         size_t *read_bytes) {
    if (read_bytes == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *read_bytes = 0;
    if (data == NULL || capacity_bytes == 0U) {
        return HAL_ERROR_ARGUMENT;
    }
    return serial->ops->read(serial->ctx, data, capacity_bytes, read_bytes);
}

/// Returns:  HAL_OK; HAL_ERROR_IO, HAL_ERROR_GONE: *state is not set.
/// Cost:     a copy; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_serial_state(const struct hal_serial *serial,
                                                          struct hal_serial_state *state) {
    if (state == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return serial->ops->state(serial->ctx, state);
}

#endif
