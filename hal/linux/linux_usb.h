/// hal/usb.h by libusb: devices for which the kernel has no driver, or that need none.
///
/// Nothing waits: transfers run in the kernel, poll looks whether one is done. A device that was
/// unplugged answers HAL_ERROR_GONE; close it and open it again when it is back. Each device has a
/// libusb of its own, so that no other is held up and no hot-plug daemon is needed.
/// Shown: tests/vm/linux_usb.c (the contract suite on devices emulated below the kernel's USB
/// stack, with unplugging and failing calls of the kernel), tests/contract/linux_usb.c (each call
/// of the library failing, with each of its errors).
#ifndef HAL_LINUX_USB_H
#define HAL_LINUX_USB_H

#include "fixed/must_check.h"
#include "hal/usb.h"
#include "linux/linux_error.h"

#include <stdbool.h>

struct linux_usb_slot;

struct linux_usb {
    struct hal_usb hal;
    /// Why the last call failed.
    struct linux_error error;
    /// The first bulk endpoints of the interface that was claimed; 0: none.
    uint8_t bulk_in, bulk_out;

    // Private from here on.
    void *context; ///< libusb's
    void *device;
    int claimed; ///< interface, or -1
    int fd;      ///< libusb's file of the device, by which a departure shows
    bool gone;
    char name[64]; ///< for messages
    struct hal_usb_identity identity;
    struct linux_usb_slot *slots;         ///< HAL_USB_PENDING_MAX of them
    int8_t done[HAL_USB_PENDING_MAX + 1]; ///< slots in the order in which they ended
    unsigned done_count, pending_count;
    uint32_t submitted;
};

struct linux_usb_id {
    uint16_t vendor, product;
};

/// Which device is wanted.
struct linux_usb_wanted {
    const struct linux_usb_id *ids; ///< id_count of them; the first device found is taken
    unsigned id_count;
    const char *serial_number; ///< null: any
    int interface;             ///< to claim, from a kernel driver if need be; -1: none
    const char *what;          ///< for messages: "Maestro"
};

/// Returns:  HAL_OK: usb->hal is bound, close it in the end;
///           HAL_ERROR_GONE: no such device; HAL_ERROR_DENIED: no permission, or its interface is
///           in use; HAL_ERROR_UNSUPPORTED: built without libusb; HAL_ERROR_IO. If not HAL_OK,
///           nothing is open, usb->error has the line, and usb->hal answers HAL_ERROR_GONE.
/// Must not move in memory afterwards. Cost: reads the descriptors of all devices.
enum hal_status linux_usb_open(struct linux_usb *usb,
                               const struct linux_usb_wanted *wanted) MUST_CHECK;

/// Takes back what is under way: its owner may reuse it.
void linux_usb_close(struct linux_usb *usb);

/// Devices of a vendor, for `boresight probe`. vendor 0: all. Returns how many there are, of which
/// at most capacity are written. Serial numbers of devices that can't be opened are empty.
unsigned linux_usb_list(uint16_t vendor, struct hal_usb_identity *identities, unsigned capacity);

/// "libusb 1.0.26" or the like; null: built without it.
const char *linux_usb_library(void);

#endif
