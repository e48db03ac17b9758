/// CAN of which a call fails: in front of a driver below which something can be made to fail.
#ifndef CONTRACT_SUPPORT_FAILING_CAN_H
#define CONTRACT_SUPPORT_FAILING_CAN_H

#include "hal/can.h"

#include <stdbool.h>

struct failing_can {
    struct hal_can hal;
    const struct hal_can *inside;
    void (*fail)(bool on);
    uint32_t nth; ///< calls until the one that fails; 0: none does
};

/// Hands calls on to inside. fail: lets everything below the driver fail (so that its calls answer
/// HAL_ERROR_IO), or nothing any more.
void failing_can_init(struct failing_can *can, const struct hal_can *inside, void (*fail)(bool on));

/// During the nth call from now on (1: the next) everything below fails. false: another status
/// can't be had.
bool failing_can_at(struct failing_can *can, uint32_t nth, enum hal_status status);

#endif
