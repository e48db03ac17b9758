/// A USB device played by a process of the test, plugged into the kernel's own USB stack.
///
/// The kernel's virtual host controller (vhci-hcd) takes one end of a socket pair and speaks USB/IP
/// to the other end, where a child process answers from a model. So libusb and kernel drivers meet
/// a device that enumerates, stalls, and leaves, and nothing below them knows that it isn't there.
#ifndef VM_SUPPORT_USB_PORT_H
#define VM_SUPPORT_USB_PORT_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

enum usb_speed { USB_FULL_SPEED = 2, USB_HIGH_SPEED = 3 };

#define USB_MODEL_STALL (-1)
#define USB_MODEL_LATER (-2)

/// What a device answers. Runs in the child process: what the test shall see of it goes through
/// shared memory.
struct usb_model {
    const uint8_t *device;        ///< descriptor, 18 bytes
    const uint8_t *configuration; ///< descriptors, with the total length inside
    const char *strings[4];       ///< of the indices 1 to 4
    enum usb_speed speed;
    void *ctx;
    /// A control request that is not one of the standard ones. data: to read or, with bit 7 of
    /// setup[0], to fill. Returns: bytes, or USB_MODEL_STALL.
    int (*control)(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size);
    /// A bulk transfer. Returns: bytes; USB_MODEL_STALL; of an IN endpoint also USB_MODEL_LATER:
    /// asked again after whatever happens next.
    int (*bulk_out)(void *ctx, uint8_t endpoint, const uint8_t *data, uint32_t size);
    int (*bulk_in)(void *ctx, uint8_t endpoint, uint8_t *data, uint32_t capacity);
};

struct usb_port {
    pid_t child;
    unsigned number;
    int kick_fd;
};

/// Plugs a device into a port (0 to 7). The kernel then takes its time to look at it.
void usb_port_plug(struct usb_port *port, unsigned number, const struct usb_model *model);
/// Pulls it out, with everything that is under way, and waits until the kernel has noticed.
void usb_port_unplug(struct usb_port *port);

/// Lets the model look now whether it has something for its IN endpoints; without that it looks
/// every few milliseconds.
void usb_port_kick(const struct usb_port *port);

/// Memory that the child shares with the test.
void *usb_port_share(size_t size_bytes);

#endif
