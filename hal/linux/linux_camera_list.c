/// Which cameras there are. /dev has a node for each device, and udev links with names that stay.
#include "linux/linux_camera.h"
#include "linux/linux_camera_format.h"
#include "linux/linux_links.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
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

static bool describe(const char *path, struct linux_camera_info *info) {
    *info = (struct linux_camera_info){0};
    snprintf(info->path, sizeof info->path, "%s", path);
    const int fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        (void)linux_error_from_errno(&info->error, path, errno, LINUX_CAMERA_MISSING);
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

/// By names that stay the same.
static void name_for_good(struct linux_camera_info *cameras, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        cameras[i].has_id = linux_links_has_id(LINUX_LINKS_CAMERAS, cameras[i].path);
    }
    for (uint32_t i = 0; i < count; i++) {
        bool shared = false;
        for (uint32_t k = 0; k < count; k++) {
            shared = shared || (!cameras[k].has_id && k != i &&
                                strcmp(cameras[k].name, cameras[i].name) == 0);
        }
        linux_links_prefer(LINUX_LINKS_CAMERAS, shared, cameras[i].path, sizeof cameras[i].path);
    }
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
                cameras[count] = info;
            }
            count++;
        }
    }
    globfree(&nodes);
    name_for_good(cameras, count < capacity ? count : capacity);
    return count;
}

/// 0: asked; else why it can't be.
static int ask_name(const char *path, char name[LINUX_CAMERA_NAME_BYTES]) {
    struct linux_camera_info info = {0};
    const int fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        return errno == ENOENT || errno == ENODEV || errno == ENXIO ? 0 : errno;
    }
    errno = 0;
    const bool camera = look_at(fd, &info);
    const int why = camera || errno == ENOTTY || errno == ENODEV ? 0 : errno;
    close(fd);
    if (camera) { // it may have another device of that name, which gives none
        memcpy(name, info.name, sizeof info.name);
    }
    return why;
}

enum hal_status linux_camera_find(const char *name, char *path, size_t size,
                                  struct linux_error *error) {
    glob_t nodes = {0};
    unsigned found = 0;
    enum hal_status status = HAL_ERROR_GONE;
    linux_error_set(error, name, "no camera of that name", LINUX_CAMERA_MISSING);
    if (glob("/dev/video*", 0, NULL, &nodes) == 0) {
        for (size_t i = 0; i < nodes.gl_pathc; i++) {
            char its_name[LINUX_CAMERA_NAME_BYTES] = "";
            const int why = ask_name(nodes.gl_pathv[i], its_name);
            if (why != 0 && status == HAL_ERROR_GONE) { // it may be that one
                status =
                    linux_error_from_errno(error, nodes.gl_pathv[i], why, LINUX_CAMERA_MISSING);
            } else if (why == 0 && strcmp(its_name, name) == 0 && found++ == 0U) {
                snprintf(path, size, "%s", nodes.gl_pathv[i]);
            }
        }
    }
    globfree(&nodes);
    if (found > 1U) {
        linux_error_set(error, name, "several cameras have that name",
                        "write the path that `boresight probe` shows");
        return HAL_ERROR_ARGUMENT;
    }
    return found == 1U ? HAL_OK : status;
}
