/// Which cameras there are. /dev has a node for each device, and udev links with names that stay.
#include "linux/linux_camera.h"
#include "linux/linux_camera_format.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

/// Whether frames can be had from the device, and its name. A device that can't be opened may be
/// one.
static bool look_at(int fd, struct linux_camera_info *info) {
    struct v4l2_capability about = {0};
    if (ioctl(fd, VIDIOC_QUERYCAP, &about) != 0) {
        return false;
    }
    snprintf(info->name, sizeof info->name, "%.32s", (const char *)about.card);
    const uint32_t needed = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    return (about.device_caps & needed) == needed;
}

static void read_controls(int fd, struct linux_camera_info *info) {
    struct linux_camera_controls controls;
    if (!linux_camera_controls_open(&controls, fd)) {
        return;
    }
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS; i++) {
        info->controls |= controls.present[i] ? UINT32_C(1) << i : 0U;
    }
    info->zoom = controls.range[HAL_CAMERA_ZOOM];
    linux_camera_controls_close(&controls);
}

/// The link that udev made for the device, if it did.
static void prefer_link(char *path, size_t size) {
    glob_t links = {0};
    struct stat wanted, about;
    if (stat(path, &wanted) == 0 && glob("/dev/v4l/by-id/*", 0, NULL, &links) == 0) {
        for (size_t i = 0; i < links.gl_pathc; i++) {
            if (strlen(links.gl_pathv[i]) < size && stat(links.gl_pathv[i], &about) == 0 &&
                about.st_rdev == wanted.st_rdev) {
                snprintf(path, size, "%s", links.gl_pathv[i]);
                break;
            }
        }
    }
    globfree(&links);
}

static bool describe(const char *path, struct linux_camera_info *info) {
    *info = (struct linux_camera_info){0};
    snprintf(info->path, sizeof info->path, "%s", path);
    const int fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        (void)linux_error_from_errno(&info->error, path, errno, NULL);
        return errno != ENOENT && errno != ENODEV;
    }
    const bool camera = look_at(fd, info);
    if (camera) {
        info->pixels = linux_camera_format_list(fd, &info->width_px, &info->height_px);
        read_controls(fd, info);
    }
    close(fd);
    return camera;
}

uint32_t linux_camera_list(struct linux_camera_info *cameras, uint32_t capacity) {
    glob_t nodes = {0};
    uint32_t count = 0;
    if (glob("/dev/video*", 0, NULL, &nodes) == 0) {
        for (size_t i = 0; i < nodes.gl_pathc; i++) {
            struct linux_camera_info info;
            if (!describe(nodes.gl_pathv[i], &info)) {
                continue;
            }
            if (count < capacity) {
                prefer_link(info.path, sizeof info.path);
                cameras[count] = info;
            }
            count++;
        }
    }
    globfree(&nodes);
    return count;
}

bool linux_camera_find(const char *name, char *path, size_t size) {
    glob_t nodes = {0};
    bool found = false;
    if (glob("/dev/video*", 0, NULL, &nodes) == 0) {
        for (size_t i = 0; i < nodes.gl_pathc && !found; i++) {
            struct linux_camera_info info = {0};
            const int fd = open(nodes.gl_pathv[i], O_RDWR | O_NONBLOCK | O_CLOEXEC);
            found = fd >= 0 && look_at(fd, &info) && strcmp(info.name, name) == 0;
            if (fd >= 0) {
                close(fd);
            }
            if (found) {
                snprintf(path, size, "%s", nodes.gl_pathv[i]);
            }
        }
    }
    globfree(&nodes);
    return found;
}
