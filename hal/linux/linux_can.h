/// hal/can.h on a network interface of Linux (SocketCAN): can0, slcan0, vcan0.
///
/// Bit rate and link state are the administrator's (`ip link`); the driver finds them by name, says
/// what is missing, and follows them: an interface that is taken down answers HAL_ERROR_DOWN until
/// it is up again, one that goes away answers HAL_ERROR_GONE (open it again when it is back).
/// Error frames are turned into health and counters. The kernel filters.
///
/// Bus-off: restart asks the kernel for it, which needs the capability NET_ADMIN; an interface with
/// `restart-ms` set restarts by itself, and that shows, too.
/// Shown: tests/vm/linux_can.c (the contract suite and more, on a real kernel), tests/vm/gs_usb.c
/// (bus-off and unplugging of an emulated adapter).
#ifndef HAL_LINUX_CAN_H
#define HAL_LINUX_CAN_H

#include "fixed/must_check.h"
#include "hal/can.h"
#include "hal/clock.h"
#include "linux/linux_error.h"

#define LINUX_CAN_NAME_BYTES 16 ///< with the end; the kernel's limit

/// What the kernel tells about a CAN interface.
struct linux_can_link {
    char name[LINUX_CAN_NAME_BYTES];
    int index;
    bool up;
    bool has_controller; ///< false: virtual, there is nothing that could have a bit rate
    uint32_t bitrate;    ///< bits per second; 0: not set
    uint32_t restart_ms; ///< 0: bus-off lasts until somebody restarts it
    enum hal_can_health health;
    uint16_t transmit_error_count, receive_error_count;
};

struct linux_can {
    struct hal_can hal;
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    int fd, error_fd;
    int index;
    bool gone;
    bool link_down; ///< by `ip link set down`, as opposed to bus-off
    char name[LINUX_CAN_NAME_BYTES];
    const struct hal_clock *clock;
    struct hal_can_state state; ///< lost_count: by the controller
    uint32_t socket_drops;
    bool restarting;
    uint32_t restart_us; ///< when the kernel was last asked, and what it said
    enum hal_status restart_status;
};

/// Opens an interface that is up.
/// clock:    for the times of arrival; stays the caller's.
/// Returns:  HAL_OK: can->hal is bound, close it in the end;
///           HAL_ERROR_GONE: no such interface; HAL_ERROR_DOWN: it is not up;
///           HAL_ERROR_UNSUPPORTED: not a CAN interface, or the kernel has no CAN;
///           HAL_ERROR_DENIED; HAL_ERROR_ARGUMENT: the name is too long or empty;
///           HAL_ERROR_IO. If not HAL_OK, nothing is open, can->error has the line, and can->hal
///           answers HAL_ERROR_GONE. Must not move in memory afterwards.
enum hal_status linux_can_open(struct linux_can *can, const char *name,
                               const struct hal_clock *clock) MUST_CHECK;
void linux_can_close(struct linux_can *can);

/// All CAN interfaces, up to capacity, in the order of the kernel.
/// *count:   how many were found and written. Returns: HAL_OK; HAL_ERROR_IO, with the line in
///           *error.
enum hal_status linux_can_list(struct linux_can_link *links, uint32_t capacity, uint32_t *count,
                               struct linux_error *error) MUST_CHECK;

#endif
