/// Watches whether targets were refused because the controller has as many as it holds: what then
/// is framed is not all that was asked for, so somebody has to be told.
/// Shown: tests/cli/capacity.sh
#ifndef LINUX_CAPACITY_H
#define LINUX_CAPACITY_H

#include "control/controller.h"

#include <stdbool.h>

struct capacity {
    uint32_t rejected; ///< updates, so far
    bool told;
};

/// After each tick: true at the first at which a full set refused an update, and once only.
bool capacity_exceeded(struct capacity *capacity, const struct controller_status *status);

/// What to say, with TARGET_CAPACITY for its number.
#define CAPACITY_MESSAGE "more than %u targets at a time: what does not fit is not framed"

#endif
