/// One USB device, opened and claimed: control and bulk transfers that run in the background.
///
/// The caller owns each transfer and its data, and leaves both alone from submit until poll hands
/// the transfer back. Several may be under way; those of one endpoint are done in the order of
/// their submission.
/// Shown: tests/contract/support/usb_suite.h, on every implementation.
#ifndef HAL_USB_H
#define HAL_USB_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stddef.h>
#include <stdint.h>

enum hal_usb_kind { HAL_USB_CONTROL, HAL_USB_BULK };

/// Of request_type and of a bulk endpoint's address: data goes from the device to us.
#define HAL_USB_IN 0x80U
/// More than this in one transfer is HAL_ERROR_ARGUMENT.
#define HAL_USB_TRANSFER_BYTES_MAX 4096U
/// Every implementation takes so many transfers at a time.
#define HAL_USB_PENDING_MAX 16

/// The eight bytes in front of a control transfer, without the length.
struct hal_usb_setup {
    uint8_t request_type, request;
    uint16_t value, index;
};

/// Zero it before its first use.
struct hal_usb_transfer {
    enum hal_usb_kind kind;
    /// HAL_USB_CONTROL: what is asked. Its direction is bit HAL_USB_IN of request_type.
    struct hal_usb_setup setup;
    /// HAL_USB_BULK: 1 to 15, with HAL_USB_IN or without. HAL_USB_CONTROL: 0.
    uint8_t endpoint;
    /// size_bytes to send, or room for as many; may be null if that is 0.
    uint8_t *data;
    uint16_t size_bytes;
    /// From submission on; 0: as long as it takes.
    uint32_t timeout_us;

    /// Set when it is handed back: how many bytes were sent or received. Less than size_bytes is no
    /// error.
    uint16_t actual_bytes;
    /// HAL_BUSY while it is under way. Then HAL_OK;
    /// HAL_ERROR_UNSUPPORTED: the device refused it (stall);
    /// HAL_ERROR_TIMEOUT, HAL_ERROR_CANCELLED: actual_bytes tells how far it came;
    /// HAL_ERROR_IO; HAL_ERROR_GONE: the device was unplugged.
    enum hal_status status;
};

/// What the device said it is.
struct hal_usb_identity {
    uint16_t vendor, product;
    /// Its own version, binary coded decimal (bcdDevice).
    uint16_t release_bcd;
    /// Ends with 0; cut to fit; empty if it has none.
    char serial_number[32];
};

struct hal_usb_ops {
    enum hal_status (*identity)(void *ctx, struct hal_usb_identity *identity);
    enum hal_status (*submit)(void *ctx, struct hal_usb_transfer *transfer);
    enum hal_status (*poll)(void *ctx, struct hal_usb_transfer **done);
    enum hal_status (*cancel)(void *ctx, struct hal_usb_transfer *transfer);
};

struct hal_usb {
    const struct hal_usb_ops *ops;
    void *ctx;
};

/// Fills *usb. HAL_ERROR_ARGUMENT (and *usb as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status hal_usb_bind(struct hal_usb *usb,
                                                      const struct hal_usb_ops *ops, void *ctx) {
    if (usb == NULL || ops == NULL || ops->identity == NULL || ops->submit == NULL ||
        ops->poll == NULL || ops->cancel == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *usb = (struct hal_usb){ops, ctx};
    return HAL_OK;
}

/// Returns:  HAL_OK; HAL_ERROR_GONE: *identity is not set.
/// Cost:     a copy: it was read when the device was opened.
MUST_CHECK static inline enum hal_status hal_usb_identity(const struct hal_usb *usb,
                                                          struct hal_usb_identity *identity) {
    if (identity == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return usb->ops->identity(usb->ctx, identity);
}

static inline enum hal_status hal_usb_check(const struct hal_usb_transfer *transfer) {
    if (transfer == NULL || transfer->status == HAL_BUSY ||
        transfer->size_bytes > HAL_USB_TRANSFER_BYTES_MAX ||
        (transfer->size_bytes > 0U && transfer->data == NULL)) {
        return HAL_ERROR_ARGUMENT;
    }
    const unsigned number = transfer->endpoint & ~HAL_USB_IN;
    switch (transfer->kind) {
    case HAL_USB_CONTROL:
        return transfer->endpoint == 0U ? HAL_OK : HAL_ERROR_ARGUMENT;
    case HAL_USB_BULK:
        return number >= 1U && number <= 15U ? HAL_OK : HAL_ERROR_ARGUMENT;
    default:
        return HAL_ERROR_ARGUMENT;
    }
}

/// Begins a transfer.
/// Returns:  HAL_OK: under way, and poll will hand it back, whatever becomes of it;
///           HAL_BUSY: HAL_USB_PENDING_MAX or more are under way;
///           HAL_ERROR_ARGUMENT: a field out of its range, no such endpoint, or it is still under
///           way; HAL_ERROR_IO, HAL_ERROR_GONE. If not HAL_OK, it was not begun and is the
///           caller's.
/// Cost:     on Linux one system call.
MUST_CHECK static inline enum hal_status hal_usb_submit(const struct hal_usb *usb,
                                                        struct hal_usb_transfer *transfer) {
    const enum hal_status status = hal_usb_check(transfer);
    return status == HAL_OK ? usb->ops->submit(usb->ctx, transfer) : status;
}

/// Hands back one transfer that is done; its status tells how it went.
/// Returns:  HAL_OK: *done is that transfer; there may be more;
///           HAL_EMPTY: none is done;
///           HAL_ERROR_GONE: the device is gone and every transfer has been handed back;
///           HAL_ERROR_IO: try again. *done is set with HAL_OK only.
/// Cost:     on Linux one system call or two.
MUST_CHECK static inline enum hal_status hal_usb_poll(const struct hal_usb *usb,
                                                      struct hal_usb_transfer **done) {
    if (done == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return usb->ops->poll(usb->ctx, done);
}

/// Asks for the end of a transfer. poll hands it back soon: with HAL_ERROR_CANCELLED, or done if
/// the device was faster.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: it is not under way; HAL_ERROR_IO, HAL_ERROR_GONE.
/// Cost:     on Linux one system call.
MUST_CHECK static inline enum hal_status hal_usb_cancel(const struct hal_usb *usb,
                                                        struct hal_usb_transfer *transfer) {
    if (transfer == NULL || transfer->status != HAL_BUSY) {
        return HAL_ERROR_ARGUMENT;
    }
    return usb->ops->cancel(usb->ctx, transfer);
}

#endif
