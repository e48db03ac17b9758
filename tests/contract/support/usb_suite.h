/// The contract of hal/usb.h as a test. What every USB device can do is enough for most of it (it
/// tells its device descriptor and refuses to tell one that doesn't exist).
#ifndef CONTRACT_SUPPORT_USB_SUITE_H
#define CONTRACT_SUPPORT_USB_SUITE_H

#include "hal/usb.h"

#include <stdbool.h>

struct usb_fixture {
    const char *name;
    const struct hal_usb *usb;
    /// What the device is known to be.
    struct hal_usb_identity identity;
    void *context;
    /// Plugged in, no transfer under way, no failure pending.
    void (*reset)(void *context);
    /// A moment of real or virtual time: at least 1 ms.
    void (*settle)(void *context);
    void (*unplug)(void *context);
    bool replug_is_slow; ///< it is unplugged a few times only
    /// See contract.h.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
    /// Bulk endpoints: what goes out at one comes in at the other, a transfer for a transfer.
    /// 0: none.
    uint8_t echo_out, echo_in;
};

/// Needs reset and settle.
void usb_suite(const struct usb_fixture *fixture);

#endif
