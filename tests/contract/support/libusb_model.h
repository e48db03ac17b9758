/// Stands for libusb below the USB drivers: the functions that hal/linux calls, on devices that the
/// test plays. A program that links it has no other USB.
///
/// Each of its functions that can fail is a call of syscalls.h, whose error number is then libusb's
/// code. Transfers end when events are handled, in order of their submission at each endpoint.
#ifndef CONTRACT_SUPPORT_LIBUSB_MODEL_H
#define CONTRACT_SUPPORT_LIBUSB_MODEL_H

#include <stdbool.h>
#include <stdint.h>

/// A device; answers as those of vm/support/usb_port.h.
struct libusb_model {
    uint16_t vendor, product, release_bcd;
    const char *serial_number; ///< null: none
    void *ctx;
    int (*control)(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size);
    int (*bulk_out)(void *ctx, uint8_t endpoint, const uint8_t *data, uint32_t size);
    int (*bulk_in)(void *ctx, uint8_t endpoint, uint8_t *data, uint32_t capacity);
};

#define LIBUSB_MODEL_DEVICES 2U

/// Plugs a device in, or pulls it out (null); the model stays the caller's.
void libusb_model_plug(unsigned number, const struct libusb_model *model);

/// What it does wrong.
struct libusb_model_faults {
    int open[LIBUSB_MODEL_DEVICES]; ///< opening it fails with that code; 0: it does not
    bool busy;                      ///< another program holds the interface
    /// The next transfers end with that status of libusb's, without having been carried out.
    unsigned spoil_next;
    int spoil_with;
    bool stuck; ///< nothing ends, whatever is cancelled
    bool serial_refused;
};
extern struct libusb_model_faults libusb_model_faults;

/// Objects of the library that have not been given back: contexts, lists, handles, transfers and
/// descriptors. Whatever is given back wrongly fails a check.
unsigned libusb_model_objects(void);

#endif
