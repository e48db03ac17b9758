/// Names of devices that stay: the links that udev makes, by a device's serial number (by-id) or by
/// the socket it is plugged into (by-path). /dev/video0 and /dev/ttyACM0 are given out in the order
/// of plugging, and another device may have them tomorrow.
///
/// Two devices of one make without serial numbers share one by-id link, which leads to either: the
/// other one has none, and that tells it. Then only the socket tells them apart.
/// Shown: tests/contract/linux_links.c.
#ifndef HAL_LINUX_LINKS_H
#define HAL_LINUX_LINKS_H

#include <stdbool.h>
#include <stddef.h>

#define LINUX_LINKS_SERIAL  "/dev/serial"
#define LINUX_LINKS_CAMERAS "/dev/v4l"

/// Is there a link to the device in root/by-id?
bool linux_links_has_id(const char *root, const char *device);

/// Replaces the path of a device by the link in root/by-id, unless it is shared, or else by that in
/// root/by-path. Without either, or where it does not fit into size, the path stays.
/// shared: another device of the same make has no link of its own.
void linux_links_prefer(const char *root, bool shared, char *path, size_t size);

#endif
