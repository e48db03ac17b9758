/// The devices that interrupt handlers work on.
#ifndef PICO_DEVICES_H
#define PICO_DEVICES_H

#include "cortexm/cortexm_clock.h"
#include "rp2040/rp2040_uart.h"
#include "rp2040/rp2040_usb.h"

struct board_devices_here {
    struct cortexm_clock clock;
    struct rp2040_uart uart;
    struct rp2040_usb usb;
};
extern struct board_devices_here devices;

#endif
