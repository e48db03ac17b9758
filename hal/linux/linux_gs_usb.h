/// hal/can.h on a USB CAN adapter that speaks the gs_usb protocol (candleLight, CANable, canalyze
/// and their kin), by libusb: where the kernel has no driver for it, or no CAN at all. Where the
/// kernel has its own, it is detached while this one holds the adapter.
///
/// Nothing waits: whatever is called takes in what came over USB first, so call something at every
/// tick. Up to LINUX_GS_USB_SLOTS frames are on their way; the adapter echoes each as it sends it.
/// An adapter that goes bus-off, or whose echoes stay away for LINUX_GS_USB_PATIENCE_US (nobody
/// acknowledges: the cable is off, no drive has power), is reset, which throws away what it had to
/// send; hal_can_restart starts it again. Filters are applied here. Arrival times are the
/// adapter's own, if it has a clock, else those of reading.
///
/// Shown: tests/contract/linux_gs_usb.c (every request byte for byte, the contract suite, failures
/// at every transfer), tests/vm/linux_gs_usb.c (the contract suite on emulated adapters below the
/// kernel's USB stack, against its own driver, with unplugging and with failing calls of the
/// kernel; also with the sanitizers).
/// Source: the protocol as in Linux' gs_usb driver and candleLight's firmware.
#ifndef HAL_LINUX_GS_USB_H
#define HAL_LINUX_GS_USB_H

#include "fixed/must_check.h"
#include "hal/can.h"
#include "hal/clock.h"
#include "hal/usb.h"
#include "linux/linux_usb.h"

#include <stdbool.h>

/// Frames on their way to the bus; the kernel's driver has as many.
#define LINUX_GS_USB_SLOTS 10U
/// Transfers that wait for frames from the adapter: those, the slots and a control request are
/// HAL_USB_PENDING_MAX.
#define LINUX_GS_USB_READERS 5U
/// Received frames that wait to be taken; further ones are lost and counted.
#define LINUX_GS_USB_QUEUE       64U
#define LINUX_GS_USB_PATIENCE_US 500000U

/// What an adapter can do, as it says.
struct linux_gs_usb_limits {
    uint32_t clock_hz;
    uint32_t segment1_min, segment1_max; ///< propagation and phase segment 1, in quanta
    uint32_t segment2_min, segment2_max;
    uint32_t jump_max;
    uint32_t divider_min, divider_max, divider_step;
};

/// How a bit is divided: clock_hz / divider is a quantum; 1 + segment1 + segment2 quanta a bit.
struct linux_gs_usb_timing {
    uint32_t segment1, segment2, divider;
};

/// The timing that hits the bit rate best and then samples closest to 87.5 %.
/// Returns: false: none comes within 0.1 % of it.
bool linux_gs_usb_timing(const struct linux_gs_usb_limits *limits, uint32_t bitrate,
                         struct linux_gs_usb_timing *timing) MUST_CHECK;

struct linux_gs_usb {
    struct hal_can hal;
    /// Why the last call failed, or what the adapter's trouble is.
    struct linux_error error;
    /// Transfers that are done, counted: frames out, and frames and echoes in.
    uint32_t taken_count, given_count;
    uint32_t failed_count; ///< transfers that failed

    // Private from here on.
    const struct hal_usb *usb;
    struct linux_usb own_usb;
    const struct hal_clock *clock;
    char name[64]; ///< for messages
    uint8_t channel, channel_count;
    uint32_t bitrate;
    bool gone, restart_wanted, waiting; ///< waiting: a control request could not be begun yet
    int step;
    enum hal_status refusal; ///< why it did not start; HAL_OK: no reason known
    bool has_clock;
    struct linux_gs_usb_limits limits;
    struct hal_usb_transfer control;
    uint8_t control_data[40];
    uint8_t endpoint_in, endpoint_out;
    struct linux_gs_usb_reader {
        struct hal_usb_transfer transfer;
        uint8_t data[128];
    } reader[LINUX_GS_USB_READERS];
    uint32_t failures; ///< of readers, in a row
    struct linux_gs_usb_slot {
        struct hal_usb_transfer transfer;
        bool used; ///< until the echo
        uint8_t data[20];
    } slot[LINUX_GS_USB_SLOTS];
    uint32_t used_count;
    uint32_t progress_us; ///< when an echo came last, or the first frame of a pause was sent
    uint32_t restarted_us;
    bool offset_known;
    uint32_t offset_us, offset_at_us; ///< from the adapter's clock to ours, and when it was set
    struct hal_can_state state;
    struct hal_can_filter filters[HAL_CAN_FILTERS_MAX];
    uint32_t filter_count;
    uint32_t first, count;
    struct linux_gs_usb_received {
        struct can_frame frame;
        uint32_t at_us;
    } received[LINUX_GS_USB_QUEUE];
};

/// Opens an adapter and starts a channel of it.
/// serial_number: null: the first adapter. channel: 0 on most. bitrate: bits per second.
/// clock:    for the times of arrival; stays the caller's.
/// Returns:  as linux_usb_open; HAL_ERROR_UNSUPPORTED also for a bit rate that it can't do;
///           HAL_ERROR_ARGUMENT: it has no such channel; HAL_ERROR_TIMEOUT: it does not answer. If
///           not HAL_OK, nothing is open, gs->error has the line, and gs->hal answers
///           HAL_ERROR_GONE. Must not move in memory afterwards.
/// Cost:     waits for six requests, a few milliseconds; half a second if it does not answer.
enum hal_status linux_gs_usb_open(struct linux_gs_usb *gs, const char *serial_number,
                                  uint8_t channel, uint32_t bitrate,
                                  const struct hal_clock *clock) MUST_CHECK;
/// Stops the channel, if the adapter still listens.
void linux_gs_usb_close(struct linux_gs_usb *gs);

/// Starts a channel of an adapter that somebody else has opened (a fake), without waiting: it is
/// HAL_CAN_OFF until it runs.
enum hal_status linux_gs_usb_bind(struct linux_gs_usb *gs, const struct hal_usb *usb,
                                  uint8_t channel, uint32_t bitrate,
                                  const struct hal_clock *clock) MUST_CHECK;

/// Whether a USB device is such an adapter, for `boresight probe`.
bool linux_gs_usb_is_one(const struct hal_usb_identity *identity);

#endif
