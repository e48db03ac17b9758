/// A camera's own pan, tilt and zoom as channels of hal/pwm.h, so that they take the way of servos.
///
/// Channels are numbered as enum hal_camera_control. A pulse of LINUX_CAMERA_SERVO_ZERO_NS + n
/// nanoseconds sets the control to n: arc-seconds, or the camera's unit of zoom. What is beyond the
/// control's range goes to its end. No pulses: the camera stays where it is. A setting that can't
/// be handed over is handed over with the next one.
/// Shown: tests/contract/linux_camera_servo.c (on a fake camera), tests/vm/guest/camera.sh.
#ifndef HAL_LINUX_CAMERA_SERVO_H
#define HAL_LINUX_CAMERA_SERVO_H

#include "fixed/must_check.h"
#include "hal/camera.h"
#include "hal/pwm.h"

#define LINUX_CAMERA_SERVO_ZERO_NS   10000000U
#define LINUX_CAMERA_SERVO_PERIOD_NS 20000000U

struct linux_camera_servo {
    struct hal_pwm hal;
    const struct hal_camera *camera; ///< private
};

/// camera: opened, and kept so by the caller; it need not stream.
enum hal_status linux_camera_servo_bind(struct linux_camera_servo *servo,
                                        const struct hal_camera *camera) MUST_CHECK;

#endif
