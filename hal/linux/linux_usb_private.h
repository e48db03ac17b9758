/// What the parts of the libusb driver share. For them only.
#ifndef HAL_LINUX_USB_PRIVATE_H
#define HAL_LINUX_USB_PRIVATE_H

#include "hal/usb.h"

struct libusb_device_handle;
struct libusb_device_descriptor;

/// device: null if it could not be opened; then its serial number stays empty.
void linux_usb_read_identity(struct libusb_device_handle *device,
                             const struct libusb_device_descriptor *about,
                             struct hal_usb_identity *identity);

#endif
