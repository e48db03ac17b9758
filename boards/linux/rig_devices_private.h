/// The parts of rig_devices.h: which outputs a rig names (rig_devices_find.c), and what is done
/// with them. For them only.
#ifndef LINUX_RIG_DEVICES_PRIVATE_H
#define LINUX_RIG_DEVICES_PRIVATE_H

#include "rig_devices.h"

#define RIG_DEVICES_GPIO_SCHEME "gpio:"

extern const char *const rig_devices_axis_names[AXIS_COUNT];

/// Fills in which device and channel each axis has; numbers the rig's PWM channels by axis. False
/// after a line on stderr.
bool rig_devices_find(struct rig_devices *devices, struct rig *rig) MUST_CHECK;

#endif
