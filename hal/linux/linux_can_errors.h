/// What the error frames of SocketCAN and of gs_usb adapters say, which is the same, as the state
/// of hal/can.h. For the CAN drivers of this folder only.
/// Shown: tests/contract/linux_can_errors.c.
#ifndef HAL_LINUX_CAN_ERRORS_H
#define HAL_LINUX_CAN_ERRORS_H

#include "hal/can.h"

/// Bits of an error frame's id.
#define LINUX_CAN_ERROR_CONTROLLER 0x004U
#define LINUX_CAN_ERROR_OFF        0x040U
#define LINUX_CAN_ERROR_RESTARTED  0x100U
#define LINUX_CAN_ERROR_COUNTERS   0x200U ///< since Linux 6.0: data 6 and 7 are given

/// Health with the counters that stand in for unknown ones.
void linux_can_set_health(struct hal_can_state *state, enum hal_can_health health);

/// Takes in an error frame, of which lost_count counts the controller's overflows. Returns whether
/// it tells of bus-off.
bool linux_can_digest_error(struct hal_can_state *state, uint32_t classes, const uint8_t data[8]);

#endif
