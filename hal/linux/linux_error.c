#include "linux/linux_error.h"

#include <errno.h>
#include <grp.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/// Of a device's name so many bytes are shown.
#define DEVICE_BYTES 120U

void linux_error_set(struct linux_error *error, const char *device, const char *reason,
                     const char *remedy) {
    const size_t size = strlen(device);
    const bool cut = size > DEVICE_BYTES;
    snprintf(error->line, sizeof error->line, "%s%s: %s; %s", cut ? "..." : "",
             cut ? device + size - DEVICE_BYTES : device, reason, remedy);
}

/// The remedy depends on whom the file lets in.
enum hal_status linux_error_denied(struct linux_error *error, const char *device,
                                   const char *file) {
    char remedy[120] = "check the permissions of the file and its directory";
    struct stat about;
    if (stat(file, &about) == 0) {
        const struct group *group = getgrgid(about.st_gid);
        // Some files of the kernel's nobody reads.
        const mode_t needed = S_IWGRP | ((about.st_mode & S_IRUSR) != 0U ? S_IRGRP : 0U);
        const bool group_may = (about.st_mode & needed) == needed;
        if (group_may && about.st_gid != 0 && group != NULL) {
            snprintf(remedy, sizeof remedy,
                     "join group %.32s (sudo usermod -aG %.32s $USER) and log in again",
                     group->gr_name, group->gr_name);
        } else {
            snprintf(remedy, sizeof remedy, "its mode is %03o and no group is let in: %s",
                     (unsigned)about.st_mode & 0777U, "a udev rule or chmod has to change that");
        }
    }
    linux_error_set(error, device, "no permission", remedy);
    return HAL_ERROR_DENIED;
}

enum hal_status linux_error_from_errno(struct linux_error *error, const char *device,
                                       int error_number, const char *missing_remedy) {
    switch (error_number) {
    case ENOENT:
    case ENOTDIR:
        linux_error_set(error, device, "no such file or device", missing_remedy);
        return HAL_ERROR_GONE;
    case ENODEV:
    case ENXIO:
        linux_error_set(error, device, "the device is not there", missing_remedy);
        return HAL_ERROR_GONE;
    case EACCES:
    case EPERM:
        return linux_error_denied(error, device, device);
    case EBUSY:
    case EWOULDBLOCK:
        linux_error_set(error, device, "in use by another program",
                        "end that one first (`fuser -v` on the file shows it)");
        return HAL_ERROR_DENIED;
    case EISDIR:
    case ENOTTY:
        linux_error_set(error, device, "not a device of that kind", missing_remedy);
        return HAL_ERROR_UNSUPPORTED;
    default:
        linux_error_set(error, device, strerror(error_number), "`sudo dmesg | tail` may tell more");
        return HAL_ERROR_IO;
    }
}
