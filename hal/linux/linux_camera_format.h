/// Which format a V4L2 device is to stream in. For linux_camera.c.
/// Shown: tests/contract/linux_camera.c, tests/vm/linux_vivid.c.
#ifndef HAL_LINUX_CAMERA_FORMAT_H
#define HAL_LINUX_CAMERA_FORMAT_H

#include "hal/camera.h"

#include <stdbool.h>

enum linux_camera_format_answer {
    LINUX_CAMERA_FORMAT_AGREED,
    LINUX_CAMERA_FORMAT_NONE,  ///< none that hal/camera.h knows
    LINUX_CAMERA_FORMAT_FAILED ///< errno tells
};

/// Tries every format of the device that the wish allows, and sets the one that comes nearest to
/// the size, then to the interval; of equals the one that is least work: GREY, YUYV, MJPEG. Without
/// a wish for the size it stays as it is.
enum linux_camera_format_answer linux_camera_format_agree(int fd, struct hal_camera_format *wish);

/// The formats that the device lists: a bit 1 << enum hal_camera_pixels each, and the size of the
/// largest picture. errno: EINVAL, the list has ended; else why it is cut.
uint32_t linux_camera_format_list(int fd, uint32_t *width_px, uint32_t *height_px);

#endif
