/// Which USB device is the one.
#include "linux/linux_usb.h"

#include <stdio.h>
#include <string.h>

#if HAVE_LIBUSB

#include "linux/linux_usb_private.h"

#include <libusb-1.0/libusb.h>

static bool is_wanted(const struct linux_usb_wanted *wanted,
                      const struct libusb_device_descriptor *about) {
    bool found = false;
    for (unsigned i = 0; i < wanted->id_count; i++) {
        found = found || (about->idVendor == wanted->ids[i].vendor &&
                          about->idProduct == wanted->ids[i].product);
    }
    return found;
}

void linux_usb_name(struct linux_usb *usb, const struct linux_usb_wanted *wanted,
                    const struct libusb_device_descriptor *about) {
    const char *serial = wanted->serial_number;
    if (serial != NULL || about == NULL) {
        snprintf(usb->name, sizeof usb->name, "%.24s%s%.36s", wanted->what,
                 serial != NULL ? " " : "", serial != NULL ? serial : "");
    } else {
        snprintf(usb->name, sizeof usb->name, "%.30s %04x:%04x", wanted->what, about->idVendor,
                 about->idProduct);
    }
}

/// 0: opened, and wanted. Not wanted: LIBUSB_ERROR_NOT_FOUND.
static int try_device(struct linux_usb *usb, const struct linux_usb_wanted *wanted,
                      libusb_device *there) {
    struct libusb_device_descriptor about;
    struct libusb_device_handle *device = NULL;
    int code = libusb_get_device_descriptor(there, &about);
    if (code != 0 || !is_wanted(wanted, &about)) {
        return code != 0 ? code : LIBUSB_ERROR_NOT_FOUND;
    }
    linux_usb_name(usb, wanted, &about);
    code = libusb_open(there, &device);
    if (code != 0) {
        return code;
    }
    const char *serial_number = wanted->serial_number;
    code = linux_usb_read_identity(device, &about, &usb->identity);
    if (serial_number == NULL && code != LIBUSB_ERROR_NO_DEVICE) {
        code = 0; // whatever it is
    }
    if (code == 0 && serial_number != NULL &&
        strcmp(usb->identity.serial_number, serial_number) != 0) {
        code = LIBUSB_ERROR_NOT_FOUND;
    }
    if (code != 0) {
        libusb_close(device);
        return code;
    }
    usb->device = device;
    return 0;
}

int linux_usb_find(struct linux_usb *usb, const struct linux_usb_wanted *wanted) {
    libusb_device **list = NULL;
    const ssize_t count = libusb_get_device_list(usb->context, &list);
    int result = count < 0 ? (int)count : LIBUSB_ERROR_NOT_FOUND;
    for (ssize_t i = 0; i < count && result != 0; i++) {
        const int code = try_device(usb, wanted, list[i]);
        result = code == 0 || result == LIBUSB_ERROR_NOT_FOUND ? code : result;
    }
    if (list != NULL) {
        libusb_free_device_list(list, 1);
    }
    return result;
}

int linux_usb_find_endpoints(struct linux_usb *usb) {
    struct libusb_config_descriptor *config = NULL;
    const int code = libusb_get_active_config_descriptor(libusb_get_device(usb->device), &config);
    if (code != 0) {
        return code;
    }
    for (unsigned i = 0; i < config->bNumInterfaces; i++) {
        const struct libusb_interface_descriptor *at = &config->interface[i].altsetting[0];
        for (unsigned k = 0; at->bInterfaceNumber == usb->claimed && k < at->bNumEndpoints; k++) {
            const struct libusb_endpoint_descriptor *endpoint = &at->endpoint[k];
            const bool in = (endpoint->bEndpointAddress & HAL_USB_IN) != 0U;
            uint8_t *found = in ? &usb->bulk_in : &usb->bulk_out;
            if ((endpoint->bmAttributes & 3U) == LIBUSB_TRANSFER_TYPE_BULK && *found == 0U) {
                *found = endpoint->bEndpointAddress;
            }
        }
    }
    libusb_free_config_descriptor(config);
    return 0;
}

#endif
