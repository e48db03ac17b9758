/// hal/pwm.h on a Pololu Maestro USB servo controller (Micro 6, Mini 12, 18 and 24), by its native
/// USB requests: no serial port, no kernel driver.
///
/// Pulses have steps of 250 ns and a period of 20 ms. A pulse that is set while the one before is
/// still on its way replaces it; one that gets lost is sent again. The controller clips pulses to
/// the limits that are stored in it (992 to 2000 us as delivered; Pololu's Control Center changes
/// them), so set them wide enough. Call linux_maestro_poll at every tick: it moves what is under
/// way. Shown: tests/vm/linux_usb.c (an emulated Maestro below the kernel's USB stack, with
/// unplugging), tests/contract/linux_maestro.c (every request byte for byte; failures). Source:
/// Pololu USB SDK, Maestro protocol.h.
#ifndef HAL_LINUX_MAESTRO_H
#define HAL_LINUX_MAESTRO_H

#include "fixed/must_check.h"
#include "hal/pwm.h"
#include "hal/usb.h"
#include "linux/linux_usb.h"

#include <stdbool.h>

#define LINUX_MAESTRO_CHANNELS_MAX 24U
/// Of linux_maestro.error_bits: what the controller says has gone wrong since it was last cleared.
#define LINUX_MAESTRO_SERIAL_TIMEOUT 0x20U

struct linux_maestro {
    struct hal_pwm hal;
    /// Why the last call failed.
    struct linux_error error;
    uint32_t channel_count;
    // As last read; see linux_maestro_ask.
    bool known;
    uint32_t position_ns[LINUX_MAESTRO_CHANNELS_MAX]; ///< of the pulses now; 0: none
    uint32_t target_ns[LINUX_MAESTRO_CHANNELS_MAX];   ///< what they move to
    uint16_t error_bits;
    uint32_t refused, failed; ///< requests, counted

    // Private from here on.
    const struct hal_usb *usb;
    struct linux_usb own_usb;
    bool gone;
    struct linux_maestro_channel {
        struct hal_usb_transfer transfer;
        uint16_t wanted_qus; ///< quarter microseconds
        bool dirty;
    } channel[LINUX_MAESTRO_CHANNELS_MAX];
    struct hal_usb_transfer asking, asking_errors, setting;
    uint8_t answer[168], errors_answer[8];
};

/// Opens the first Maestro, or the one with that serial number (null: any).
/// Returns: as linux_usb_open. Must not move in memory afterwards.
enum hal_status linux_maestro_open(struct linux_maestro *maestro,
                                   const char *serial_number) MUST_CHECK;
void linux_maestro_close(struct linux_maestro *maestro);

/// The same on a USB device that somebody else has opened (a fake), with so many channels: 6, 12,
/// 18 or 24.
enum hal_status linux_maestro_bind(struct linux_maestro *maestro, const struct hal_usb *usb,
                                   uint32_t channel_count) MUST_CHECK;

/// Takes in what has been done and sends what waits. Never waits itself.
/// Returns: HAL_OK; HAL_ERROR_GONE.
enum hal_status linux_maestro_poll(struct linux_maestro *maestro);

/// Asks for positions and errors, which come with a later poll. HAL_BUSY: the last question is
/// still under way.
enum hal_status linux_maestro_ask(struct linux_maestro *maestro);

/// Limits that the controller itself keeps. speed: 0.25 us a 10 ms, acceleration: 0.25 us a 10 ms a
/// 80 ms; 0: not limited.
/// Returns: HAL_OK; HAL_BUSY: the last one is under way; HAL_ERROR_ARGUMENT, HAL_ERROR_GONE,
/// HAL_ERROR_IO.
enum hal_status linux_maestro_limit_speed(struct linux_maestro *maestro, uint32_t channel,
                                          uint16_t speed) MUST_CHECK;
enum hal_status linux_maestro_limit_accel(struct linux_maestro *maestro, uint32_t channel,
                                          uint8_t acceleration) MUST_CHECK;
enum hal_status linux_maestro_clear_errors(struct linux_maestro *maestro) MUST_CHECK;

#endif
