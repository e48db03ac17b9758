/// The console on two lines at once: a serial port that always runs, and the USB plug.
///
/// Both say the same; whichever speaks is heard. The serial port sets the pace. What the USB has no
/// room for while nobody reads it is left out there.
#ifndef PICO_CONSOLE_H
#define PICO_CONSOLE_H

#include "rp2040/rp2040_uart.h"
#include "rp2040/rp2040_usb.h"

struct console {
    struct hal_serial hal;
    struct rp2040_uart *uart;
    struct rp2040_usb *usb; ///< NULL: there is none
};

void console_init(struct console *console, struct rp2040_uart *uart, struct rp2040_usb *usb);

#endif
