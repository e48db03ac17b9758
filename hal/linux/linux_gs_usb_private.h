/// Between linux_gs_usb.c (frames) and linux_gs_usb_start.c (requests, one after the other).
#ifndef HAL_LINUX_GS_USB_PRIVATE_H
#define HAL_LINUX_GS_USB_PRIVATE_H

#include "linux/linux_can_errors.h"
#include "linux/linux_gs_usb.h"

/// Each but the last asks something; in this order up to running.
enum linux_gs_usb_step {
    GS_USB_FORMAT,
    GS_USB_CONFIG,
    GS_USB_LIMITS,
    GS_USB_RESET,
    GS_USB_TIMING,
    GS_USB_START,
    GS_USB_RUNNING,
    GS_USB_HALT,
    GS_USB_HALTED
};

/// Asks what the step asks; if that can't be done now, gs->waiting tells to try again.
void linux_gs_usb_begin(struct linux_gs_usb *gs, enum linux_gs_usb_step step);
/// Begins what a restart begins with.
void linux_gs_usb_begin_again(struct linux_gs_usb *gs);
/// The request of the step is done: begins the next.
void linux_gs_usb_request_done(struct linux_gs_usb *gs);
/// What it had to send is thrown away, here and there.
void linux_gs_usb_halt(struct linux_gs_usb *gs);
/// Halted, and why.
void linux_gs_usb_refuse(struct linux_gs_usb *gs, enum hal_status why, const char *reason,
                         const char *remedy);
enum hal_status linux_gs_usb_set_gone(struct linux_gs_usb *gs);

/// Little endian, as all that goes over the wire.
static inline void linux_gs_usb_put(uint8_t *at, uint32_t value) {
    for (unsigned i = 0; i < 4U; i++) {
        at[i] = (uint8_t)(value >> 8U * i);
    }
}

static inline uint32_t linux_gs_usb_get(const uint8_t *at) {
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

#endif
