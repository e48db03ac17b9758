/// A USB port with a device model behind it. The port answers GET_DESCRIPTOR for the device
/// descriptor by itself; all else goes to the model.
#ifndef DEVICES_FAKE_USB_H
#define DEVICES_FAKE_USB_H

#include "devices/fake_failures.h"
#include "hal/clock.h"
#include "hal/usb.h"

struct fake_usb_model {
    struct hal_usb_identity identity;
    /// Answers a transfer: takes its data or fills it and sets actual_bytes (0 when called, at most
    /// size_bytes). HAL_OK: done; HAL_BUSY: no data yet (NAK), ask again at the next poll, and no
    /// other transfer of this endpoint until then; HAL_ERROR_UNSUPPORTED: refused (stall).
    enum hal_status (*answer)(void *ctx, struct hal_usb_transfer *transfer);
    void *ctx;
};

struct fake_usb {
    struct hal_usb hal;
    struct fake_failures failures;
    const struct hal_clock *clock;
    const struct fake_usb_model *model;
    /// In order of submission.
    struct fake_usb_pending {
        struct hal_usb_transfer *transfer;
        uint32_t submitted_us;
        bool cancelled;
    } pending[HAL_USB_PENDING_MAX];
    uint32_t pending_count;
};

/// Must not move in memory afterwards. clock: for time-outs. clock and model stay the caller's.
void fake_usb_init(struct fake_usb *usb, const struct hal_clock *clock,
                   const struct fake_usb_model *model);

/// The device leaves: what is under way comes back with HAL_ERROR_GONE.
void fake_usb_unplug(struct fake_usb *usb);

#endif
