/// Which USB devices there are.
#include "linux/linux_usb.h"

#include <stdio.h>

#if HAVE_LIBUSB

#include "linux/linux_usb_private.h"

#include <libusb-1.0/libusb.h>

#define SERIAL_TRIES 2

int linux_usb_read_identity(struct libusb_device_handle *device,
                            const struct libusb_device_descriptor *about,
                            struct hal_usb_identity *identity) {
    *identity = (struct hal_usb_identity){
        .vendor = about->idVendor, .product = about->idProduct, .release_bcd = about->bcdDevice};
    int code = 0;
    for (int tries = 0; tries < SERIAL_TRIES && device != NULL && about->iSerialNumber != 0;
         tries++) {
        code = libusb_get_string_descriptor_ascii(device, about->iSerialNumber,
                                                  (unsigned char *)identity->serial_number,
                                                  (int)sizeof identity->serial_number);
        if (code >= 0 || code == LIBUSB_ERROR_PIPE || code == LIBUSB_ERROR_NO_DEVICE) {
            break;
        }
    }
    if (code < 0) {
        identity->serial_number[0] = '\0';
    }
    return code < 0 && code != LIBUSB_ERROR_PIPE ? code : 0; // refused: it has none
}

unsigned linux_usb_list(uint16_t vendor, struct hal_usb_identity *identities, unsigned capacity) {
    libusb_context *context = NULL;
    libusb_device **list = NULL;
    unsigned found = 0;
    if (libusb_init(&context) != 0) {
        return 0;
    }
    const ssize_t count = libusb_get_device_list(context, &list);
    for (ssize_t i = 0; i < count; i++) {
        struct libusb_device_descriptor about;
        if (libusb_get_device_descriptor(list[i], &about) != 0 ||
            (vendor != 0U && about.idVendor != vendor)) {
            continue;
        }
        if (found < capacity) {
            struct libusb_device_handle *device = NULL;
            (void)libusb_open(list[i], &device);
            (void)linux_usb_read_identity(device, &about, &identities[found]);
            if (device != NULL) {
                libusb_close(device);
            }
        }
        found++;
    }
    if (list != NULL) {
        libusb_free_device_list(list, 1);
    }
    libusb_exit(context);
    return found;
}

const char *linux_usb_library(void) {
    static char text[32];
    const struct libusb_version *version = libusb_get_version();
    snprintf(text, sizeof text, "libusb %u.%u.%u", version->major, version->minor, version->micro);
    return text;
}

#else

unsigned linux_usb_list(uint16_t vendor, struct hal_usb_identity *identities, unsigned capacity) {
    (void)vendor;
    (void)identities;
    (void)capacity;
    return 0;
}

const char *linux_usb_library(void) {
    return NULL;
}

#endif
