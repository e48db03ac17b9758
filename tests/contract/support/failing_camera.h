/// A camera of which a call fails: in front of a driver below which something can be made to fail.
#ifndef CONTRACT_SUPPORT_FAILING_CAMERA_H
#define CONTRACT_SUPPORT_FAILING_CAMERA_H

#include "hal/camera.h"

struct failing_camera {
    struct hal_camera hal;
    const struct hal_camera *inside;
    void (*fail)(bool on);
    uint32_t nth; ///< calls until the one that fails; 0: none does
};

/// Hands calls on to inside. fail: lets everything below the driver fail (so that its calls answer
/// HAL_ERROR_IO), or nothing any more.
void failing_camera_init(struct failing_camera *camera, const struct hal_camera *inside,
                         void (*fail)(bool on));

/// During the nth call from now on (1: the next) everything below fails; those for controls are
/// not made to fail. false: another status can't be had.
bool failing_camera_at(struct failing_camera *camera, uint32_t nth, enum hal_status status);

#endif
