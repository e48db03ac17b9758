/// What the parts of the libusb driver share. For them only.
#ifndef HAL_LINUX_USB_PRIVATE_H
#define HAL_LINUX_USB_PRIVATE_H

#include "linux/linux_usb.h"

struct libusb_device_handle;
struct libusb_device_descriptor;

/// device: null if it could not be opened; then its serial number stays empty. Returns: 0, or
/// libusb's reason why the serial number can't be read, which is empty then. What got lost on its
/// way is asked for once more.
int linux_usb_read_identity(struct libusb_device_handle *device,
                            const struct libusb_device_descriptor *about,
                            struct hal_usb_identity *identity);

/// As lines for people name it: by its serial number where one was asked for. about: null if it is
/// not there.
void linux_usb_name(struct linux_usb *usb, const struct linux_usb_wanted *wanted,
                    const struct libusb_device_descriptor *about);

/// Opens the first device that is wanted: sets device, name and identity. Returns: 0; or libusb's
/// reason why the first device that may be it can't be had; LIBUSB_ERROR_NOT_FOUND: there is none.
int linux_usb_find(struct linux_usb *usb, const struct linux_usb_wanted *wanted);

/// Sets bulk_in and bulk_out to those of the claimed interface. Returns: 0, or why they are not
/// known.
int linux_usb_find_endpoints(struct linux_usb *usb);

#endif
