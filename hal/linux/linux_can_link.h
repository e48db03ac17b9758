/// CAN interfaces as the kernel's routing socket tells and changes them. For linux_can.c only.
/// Shown: tests/contract/linux_can_link.c, tests/vm/linux_can.c.
#ifndef HAL_LINUX_CAN_LINK_H
#define HAL_LINUX_CAN_LINK_H

#include "linux/linux_can.h"

/// Returns: HAL_OK; HAL_ERROR_GONE: no interface of that name; HAL_ERROR_UNSUPPORTED: not a CAN
/// interface; HAL_ERROR_IO. If not HAL_OK, *error has the line.
enum hal_status linux_can_link_find(const char *name, struct linux_can_link *link,
                                    struct linux_error *error) MUST_CHECK;

/// Why it can't be used, and the commands that mend it.
void linux_can_link_explain_down(const struct linux_can_link *link, struct linux_error *error);

/// Whether it is up. socket: any. Returns: HAL_OK; HAL_ERROR_DOWN, HAL_ERROR_GONE, HAL_ERROR_IO.
enum hal_status linux_can_link_is_up(int socket, const char *name,
                                     struct linux_error *error) MUST_CHECK;

/// Leaves bus-off: asks the driver for it; one that can't is taken down and up.
/// *bounced: set to whether it was. Returns: HAL_OK; HAL_ERROR_DENIED: no capability NET_ADMIN;
/// HAL_ERROR_GONE, HAL_ERROR_IO.
enum hal_status linux_can_link_restart(int socket, int index, const char *name, bool *bounced,
                                       struct linux_error *error) MUST_CHECK;

#endif
