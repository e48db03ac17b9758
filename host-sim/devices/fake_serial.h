/// One end of a serial line; tests, plants and protocol peers hold the other.
#ifndef DEVICES_FAKE_SERIAL_H
#define DEVICES_FAKE_SERIAL_H

#include "devices/fake_failures.h"
#include "hal/serial.h"

#define FAKE_SERIAL_BYTES_MAX 1024U

struct fake_serial_buffer {
    uint8_t bytes[FAKE_SERIAL_BYTES_MAX];
    size_t head, count, capacity;
};

struct fake_serial {
    struct hal_serial hal;
    struct fake_failures failures;
    struct fake_serial_buffer sending, received;
    struct hal_serial_state state;
};

/// Must not move in memory afterwards. Capacities in bytes: 1 to FAKE_SERIAL_BYTES_MAX.
void fake_serial_init(struct fake_serial *serial, size_t send_capacity, size_t receive_capacity);

// The other end. There is no flow control: what doesn't fit is lost and counted.

void fake_serial_give(struct fake_serial *serial, const uint8_t *data, size_t size_bytes);
/// How many bytes came, at most capacity_bytes.
size_t fake_serial_take(struct fake_serial *serial, uint8_t *data, size_t capacity_bytes);
/// count bytes arrive damaged.
void fake_serial_damage(struct fake_serial *serial, uint32_t count);
/// The line is cut; what was on its way is lost.
void fake_serial_hang_up(struct fake_serial *serial);

#endif
