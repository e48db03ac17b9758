#include "devices/fake_usb.h"

#include "devices/fake_bind.h"

#define REQUEST_GET_DESCRIPTOR 6U
#define DEVICE_DESCRIPTOR      0x0100U
#define DESCRIPTOR_BYTES       18U

static enum hal_status fake_usb_identity(void *ctx, struct hal_usb_identity *identity) {
    const struct fake_usb *usb = ctx;
    const enum hal_status status = fake_failures_presence(&usb->failures);
    if (status == HAL_OK) {
        *identity = usb->model->identity;
    }
    return status;
}

static enum hal_status fake_usb_submit(void *ctx, struct hal_usb_transfer *transfer) {
    struct fake_usb *usb = ctx;
    const enum hal_status status = fake_failures_call(&usb->failures);
    if (status != HAL_OK) {
        return status;
    }
    if (usb->pending_count == HAL_USB_PENDING_MAX) {
        return HAL_BUSY;
    }
    transfer->status = HAL_BUSY;
    transfer->actual_bytes = 0;
    usb->pending[usb->pending_count++] =
        (struct fake_usb_pending){transfer, hal_clock_now_us(usb->clock), false};
    return HAL_OK;
}

static void tell_descriptor(const struct hal_usb_identity *identity,
                            struct hal_usb_transfer *transfer) {
    const uint8_t descriptor[DESCRIPTOR_BYTES] = {DESCRIPTOR_BYTES,
                                                  1, // device
                                                  0x00,
                                                  0x02, // USB 2.0
                                                  0,
                                                  0,
                                                  0, // class: see the interfaces
                                                  64,
                                                  (uint8_t)identity->vendor,
                                                  (uint8_t)(identity->vendor >> 8),
                                                  (uint8_t)identity->product,
                                                  (uint8_t)(identity->product >> 8),
                                                  (uint8_t)identity->release_bcd,
                                                  (uint8_t)(identity->release_bcd >> 8),
                                                  0,
                                                  0,
                                                  0, // no strings
                                                  1};
    while (transfer->actual_bytes < transfer->size_bytes &&
           transfer->actual_bytes < DESCRIPTOR_BYTES) {
        transfer->data[transfer->actual_bytes] = descriptor[transfer->actual_bytes];
        transfer->actual_bytes++;
    }
}

static enum hal_status answer(const struct fake_usb *usb, struct hal_usb_transfer *transfer) {
    if (transfer->kind == HAL_USB_CONTROL && transfer->setup.request_type == HAL_USB_IN &&
        transfer->setup.request == REQUEST_GET_DESCRIPTOR &&
        transfer->setup.value == DEVICE_DESCRIPTOR) {
        tell_descriptor(&usb->model->identity, transfer);
        return HAL_OK;
    }
    const enum hal_status status = usb->model->answer(usb->model->ctx, transfer);
    if (transfer->actual_bytes > transfer->size_bytes) {
        abort(); // the model has written beyond the caller's data
    }
    return status;
}

/// Whether an older transfer of the same endpoint has not been done yet.
static bool must_wait(const struct fake_usb *usb, uint32_t index) {
    for (uint32_t i = 0; i < index; i++) {
        if (usb->pending[i].transfer->endpoint == usb->pending[index].transfer->endpoint) {
            return true;
        }
    }
    return false;
}

/// How a transfer stands now; HAL_BUSY: still under way.
static enum hal_status progress(const struct fake_usb *usb, uint32_t index) {
    const struct fake_usb_pending *pending = &usb->pending[index];
    struct hal_usb_transfer *transfer = pending->transfer;
    if (usb->failures.gone) {
        return HAL_ERROR_GONE;
    }
    if (pending->cancelled) {
        return HAL_ERROR_CANCELLED;
    }
    enum hal_status status = HAL_BUSY;
    if (!must_wait(usb, index)) {
        status = answer(usb, transfer);
    }
    const uint32_t waited_us =
        hal_clock_span_us(pending->submitted_us, hal_clock_now_us(usb->clock));
    if (status == HAL_BUSY && transfer->timeout_us != 0U && waited_us >= transfer->timeout_us) {
        status = HAL_ERROR_TIMEOUT;
    }
    return status;
}

static enum hal_status fake_usb_poll(void *ctx, struct hal_usb_transfer **done) {
    struct fake_usb *usb = ctx;
    const enum hal_status order = fake_failures_call(&usb->failures);
    if (order != HAL_OK && !(usb->failures.gone && usb->pending_count > 0U)) {
        return order;
    }
    for (uint32_t i = 0; i < usb->pending_count; i++) {
        const enum hal_status status = progress(usb, i);
        if (status == HAL_BUSY) {
            continue;
        }
        *done = usb->pending[i].transfer;
        (*done)->status = status;
        usb->pending_count--;
        for (uint32_t k = i; k < usb->pending_count; k++) {
            usb->pending[k] = usb->pending[k + 1U];
        }
        return HAL_OK;
    }
    return HAL_EMPTY;
}

static enum hal_status fake_usb_cancel(void *ctx, struct hal_usb_transfer *transfer) {
    struct fake_usb *usb = ctx;
    const enum hal_status status = fake_failures_call(&usb->failures);
    if (status != HAL_OK) {
        return status;
    }
    for (uint32_t i = 0; i < usb->pending_count; i++) {
        if (usb->pending[i].transfer == transfer) {
            usb->pending[i].cancelled = true;
            return HAL_OK;
        }
    }
    return HAL_ERROR_ARGUMENT;
}

static const struct hal_usb_ops ops = {fake_usb_identity, fake_usb_submit, fake_usb_poll,
                                       fake_usb_cancel};

void fake_usb_init(struct fake_usb *usb, const struct hal_clock *clock,
                   const struct fake_usb_model *model) {
    *usb = (struct fake_usb){.clock = clock, .model = model};
    fake_bind_check(hal_usb_bind(&usb->hal, &ops, usb));
}

void fake_usb_unplug(struct fake_usb *usb) {
    fake_failures_set_gone(&usb->failures, true);
}
