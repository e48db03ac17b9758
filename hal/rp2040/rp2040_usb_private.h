/// Between rp2040_usb.c (packets) and rp2040_usb_control.c (what endpoint 0 is asked).
#ifndef RP2040_RP2040_USB_PRIVATE_H
#define RP2040_RP2040_USB_PRIVATE_H

#include "rp2040/rp2040_registers.h"
#include "rp2040/rp2040_usb.h"

enum { RP2040_USB_EP_CONTROL, RP2040_USB_EP_NOTICES, RP2040_USB_EP_DATA };

/// Gives a buffer to the hardware. direction: RP2040_USB_IN or _OUT; more: further bits of the
/// buffer's control word.
void rp2040_usb_hand_over(unsigned endpoint, unsigned direction, uint32_t more, bool data1,
                          uint32_t size_bytes);

/// The computer has chosen the configuration, or (false) not yet or no longer.
void rp2040_usb_configure(struct rp2040_usb *usb, bool on);

/// Takes back the buffer of the data in one direction and counts packets anew (USB 2.0, 9.4.5).
void rp2040_usb_restart(struct rp2040_usb *usb, unsigned direction);

/// A request has come.
void rp2040_usb_on_setup(struct rp2040_usb *usb);

/// Endpoint 0 has sent or received its packet.
void rp2040_usb_on_control(struct rp2040_usb *usb, unsigned direction);

#endif
