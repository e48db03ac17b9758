/// What went wrong with a device, as one line for the person at the rig: `DEVICE: REASON; REMEDY`.
///
/// The status tells the program, this line tells the user. Every Linux driver has one and fills it
/// whenever it answers HAL_ERROR_DENIED, HAL_ERROR_GONE, HAL_ERROR_IO or HAL_ERROR_UNSUPPORTED.
///
/// The files of this folder are called linux_*, because hal/ is on the include path and a
/// linux/serial.h would hide the kernel's.
#ifndef HAL_LINUX_ERROR_H
#define HAL_LINUX_ERROR_H

#include "hal/status.h"

#define LINUX_ERROR_BYTES 384

struct linux_error {
    /// Without a newline; empty as long as nothing went wrong.
    char line[LINUX_ERROR_BYTES];
};

/// Writes the line. Of a long device name the end is kept; reason and remedy at most 120 bytes each
/// are never cut. Nothing is null: whoever tells what is wrong tells what to do, too.
__attribute__((nonnull)) void linux_error_set(struct linux_error *error, const char *device,
                                              const char *reason, const char *remedy);

/// Writes the line for a file that this user may not open (or write); the remedy names the group
/// that may. Always HAL_ERROR_DENIED. device: what the line names, which need not be the file.
__attribute__((nonnull)) enum hal_status linux_error_denied(struct linux_error *error,
                                                            const char *device, const char *file);

/// Writes the line for a system call on a device file that failed with that errno, and gives the
/// status: HAL_ERROR_GONE for a device that isn't there, HAL_ERROR_DENIED if it isn't for us (the
/// remedy names the group that it belongs to) or in use, else HAL_ERROR_IO.
/// missing_remedy: what to do if it isn't there, or is something else.
/// Shown: tests/cli/refusals.sh, tests/vm/guest/refusals.sh.
__attribute__((nonnull)) enum hal_status linux_error_from_errno(struct linux_error *error,
                                                                const char *device,
                                                                int error_number,
                                                                const char *missing_remedy);

#endif
