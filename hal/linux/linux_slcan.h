/// hal/can.h through a CAN adapter on a serial port that speaks the LAWICEL (slcan) text protocol:
/// CANable and its kin, CANUSB, many home-made ones. Needs no CAN in the kernel.
///
/// What the protocol can't tell stays untold: frames that the adapter accepts leave in order, but
/// when is its business; arrival times are those of reading, so read at every tick; error counters
/// are stand-ins. An adapter that answers the flags command (F) is asked four times a second; 32
/// refusals in a row are taken for bus-off, and restart closes and opens its channel.
/// Filters are applied here.
///
/// A serial line may damage what it carries, and the protocol has no check sum. What can't be read
/// is dropped up to the next carriage return, where lines begin anew, and counted as lost; a digit
/// that became another digit goes unnoticed.
/// Shown: tests/contract/linux_slcan.c (the contract suite, between two adapters on
/// pseudo-terminals, with each system call failing), tests/contract/linux_slcan_errors.c
/// (`a_wrong_byte_costs_its_line`).
#ifndef HAL_LINUX_SLCAN_H
#define HAL_LINUX_SLCAN_H

#include "fixed/must_check.h"
#include "hal/can.h"
#include "hal/clock.h"
#include "linux/linux_error.h"
#include "linux/linux_serial.h"

/// Received frames that wait to be taken; further ones are lost and counted.
#define LINUX_SLCAN_QUEUE 64U
/// Room for the line that the port has not taken yet; the longest has 27 bytes.
#define LINUX_SLCAN_OUT_BYTES 40U

struct linux_slcan {
    struct hal_can hal;
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    struct linux_serial serial;
    const struct hal_clock *clock;
    char speed; ///< digit of the S command
    struct hal_can_state state;
    struct hal_can_filter filters[HAL_CAN_FILTERS_MAX];
    uint32_t filter_count;
    uint32_t first, count;
    struct linux_slcan_received {
        struct can_frame frame;
        uint32_t at_us;
    } received[LINUX_SLCAN_QUEUE];
    char line[40]; ///< that is being read
    size_t line_size;
    bool in_step;                       ///< where lines begin is known
    uint8_t out[LINUX_SLCAN_OUT_BYTES]; ///< not yet taken by the port
    size_t out_size;
    uint32_t refusals; ///< in a row
    bool answers_flags, flags_pending;
    uint32_t flags_asked_us;
};

/// Opens the port, sets the adapter's bit rate and opens its channel.
/// bitrate:  one of 10000 20000 50000 100000 125000 250000 500000 800000 1000000.
/// clock:    for the times of arrival; stays the caller's.
/// Returns:  as linux_serial_open; HAL_ERROR_ARGUMENT also for another bit rate. If not HAL_OK,
///           nothing is open, slcan->error has the line, and slcan->hal answers HAL_ERROR_GONE.
/// Must not move in memory afterwards.
enum hal_status linux_slcan_open(struct linux_slcan *slcan, const char *path, uint32_t bitrate,
                                 const struct hal_clock *clock) MUST_CHECK;

/// Closes the adapter's channel, if the port still takes the command, and the port.
void linux_slcan_close(struct linux_slcan *slcan);

#endif
