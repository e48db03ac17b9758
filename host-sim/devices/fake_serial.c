#include "devices/fake_serial.h"

#include "devices/fake_bind.h"

/// Appends as much as fits: how many bytes.
static size_t put(struct fake_serial_buffer *buffer, const uint8_t *data, size_t size_bytes) {
    size_t done = 0;
    while (done < size_bytes && buffer->count < buffer->capacity) {
        buffer->bytes[(buffer->head + buffer->count) % FAKE_SERIAL_BYTES_MAX] = data[done];
        buffer->count++;
        done++;
    }
    return done;
}

/// Removes the oldest: how many bytes.
static size_t get(struct fake_serial_buffer *buffer, uint8_t *data, size_t capacity_bytes) {
    size_t done = 0;
    while (done < capacity_bytes && buffer->count > 0U) {
        data[done] = buffer->bytes[buffer->head];
        buffer->head = (buffer->head + 1U) % FAKE_SERIAL_BYTES_MAX;
        buffer->count--;
        done++;
    }
    return done;
}

static enum hal_status fake_serial_write(void *ctx, const uint8_t *data, size_t size_bytes,
                                         size_t *written_bytes) {
    struct fake_serial *serial = ctx;
    const enum hal_status status = fake_failures_call(&serial->failures);
    if (status != HAL_OK) {
        return status;
    }
    *written_bytes = put(&serial->sending, data, size_bytes);
    return *written_bytes == 0U ? HAL_BUSY : HAL_OK;
}

static enum hal_status fake_serial_read(void *ctx, uint8_t *data, size_t capacity_bytes,
                                        size_t *read_bytes) {
    struct fake_serial *serial = ctx;
    const enum hal_status status = fake_failures_call(&serial->failures);
    if (status != HAL_OK) {
        return status;
    }
    *read_bytes = get(&serial->received, data, capacity_bytes);
    return *read_bytes == 0U ? HAL_EMPTY : HAL_OK;
}

static enum hal_status fake_serial_state(void *ctx, struct hal_serial_state *state) {
    struct fake_serial *serial = ctx;
    const enum hal_status status = fake_failures_call(&serial->failures);
    if (status == HAL_OK) {
        *state = serial->state;
    }
    return status;
}

static const struct hal_serial_ops ops = {fake_serial_write, fake_serial_read, fake_serial_state};

void fake_serial_init(struct fake_serial *serial, size_t send_capacity, size_t receive_capacity) {
    *serial = (struct fake_serial){.sending.capacity = send_capacity,
                                   .received.capacity = receive_capacity};
    if (send_capacity - 1U >= FAKE_SERIAL_BYTES_MAX ||
        receive_capacity - 1U >= FAKE_SERIAL_BYTES_MAX) {
        abort();
    }
    fake_bind_check(hal_serial_bind(&serial->hal, &ops, serial));
}

void fake_serial_give(struct fake_serial *serial, const uint8_t *data, size_t size_bytes) {
    if (!serial->failures.gone) {
        serial->state.lost_count +=
            (uint32_t)(size_bytes - put(&serial->received, data, size_bytes));
    }
}

size_t fake_serial_take(struct fake_serial *serial, uint8_t *data, size_t capacity_bytes) {
    return get(&serial->sending, data, capacity_bytes);
}

void fake_serial_damage(struct fake_serial *serial, uint32_t count) {
    serial->state.damaged_count += count;
}

void fake_serial_hang_up(struct fake_serial *serial) {
    fake_failures_set_gone(&serial->failures, true);
    serial->sending.count = 0;
    serial->received.count = 0;
}
