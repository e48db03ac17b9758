#include "console.h"

static enum hal_status serial_write(void *ctx, const uint8_t *data, size_t size_bytes,
                                    size_t *written_bytes) {
    const struct console *console = ctx;
    const enum hal_status status =
        rp2040_uart_write(console->uart, data, size_bytes, written_bytes);
    if (status == HAL_OK && console->usb != NULL) {
        size_t written;
        (void)!rp2040_usb_write(console->usb, data, *written_bytes, &written);
    }
    return status;
}

static enum hal_status serial_read(void *ctx, uint8_t *data, size_t capacity_bytes,
                                   size_t *read_bytes) {
    const struct console *console = ctx;
    const enum hal_status status =
        console->usb == NULL ? HAL_EMPTY
                             : rp2040_usb_read(console->usb, data, capacity_bytes, read_bytes);
    return status == HAL_OK ? HAL_OK
                            : rp2040_uart_read(console->uart, data, capacity_bytes, read_bytes);
}

static enum hal_status serial_state(void *ctx, struct hal_serial_state *state) {
    const struct console *console = ctx;
    *state = (struct hal_serial_state){console->uart->lost_count, console->uart->damaged_count};
    return HAL_OK;
}

static const struct hal_serial_ops console_serial_ops = {serial_write, serial_read, serial_state};

void console_init(struct console *console, struct rp2040_uart *uart, struct rp2040_usb *usb) {
    (void)!hal_serial_bind(&console->hal, &console_serial_ops, console);
    console->uart = uart;
    console->usb = usb;
}
