/// Pan, tilt and zoom of a V4L2 device, set by a thread of their own: a camera takes milliseconds
/// for each, and a broken one seconds.
///
/// What is set while an earlier value is still on its way replaces it, and pan and tilt that wait
/// together go in one request, so that a camera that has one motion for both makes one. For
/// linux_camera.c.
/// Shown: tests/contract/linux_camera.c, tests/vm/linux_camera.c.
#ifndef HAL_LINUX_CAMERA_CONTROLS_H
#define HAL_LINUX_CAMERA_CONTROLS_H

#include "hal/camera.h"

#include <pthread.h>

struct linux_camera_controls {
    int fd;
    bool present[HAL_CAMERA_CONTROLS];
    struct hal_camera_range range[HAL_CAMERA_CONTROLS];
    bool running; ///< the thread is
    pthread_t thread;
    pthread_mutex_t mutex; ///< of all that follows
    pthread_cond_t changed;
    bool ending, gone;
    bool waiting[HAL_CAMERA_CONTROLS];
    int32_t wanted[HAL_CAMERA_CONTROLS];
    int32_t held[HAL_CAMERA_CONTROLS]; ///< by the device, as far as it has said
    uint32_t taken;                    ///< settings that the device took
    uint32_t failed;                   ///< that it refused or that got lost
    int error_number;                  ///< of the last of them
};

/// Reads which controls the device has, and where they are. One that it fails to tell of twice is
/// missing, or taken to be where it is at first. false: no thread could be started, so the device
/// has none.
bool linux_camera_controls_open(struct linux_camera_controls *controls, int fd);
/// Waits for the request that is under way; what waits is not sent any more.
void linux_camera_controls_close(struct linux_camera_controls *controls);

/// As the operations of hal/camera.h; the device has the control.
int32_t linux_camera_controls_get(struct linux_camera_controls *controls,
                                  enum hal_camera_control control);
void linux_camera_controls_set(struct linux_camera_controls *controls,
                               enum hal_camera_control control, int32_t value);

/// Whether the device has said that it is gone; *taken, *failed: settings so far that it took, and
/// that did not get there.
bool linux_camera_controls_lost(struct linux_camera_controls *controls, uint32_t *taken,
                                uint32_t *failed);

#endif
