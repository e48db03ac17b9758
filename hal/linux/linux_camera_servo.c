#include "linux/linux_camera_servo.h"

static enum hal_status servo_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    const struct linux_camera_servo *servo = ctx;
    struct hal_camera_range range;
    const enum hal_status status =
        hal_camera_control_range(servo->camera, (enum hal_camera_control)channel, &range);
    if (status == HAL_OK) {
        *limits =
            (struct hal_pwm_limits){LINUX_CAMERA_SERVO_PERIOD_NS, LINUX_CAMERA_SERVO_PERIOD_NS,
                                    LINUX_CAMERA_SERVO_PERIOD_NS, 1};
    }
    return status == HAL_ERROR_UNSUPPORTED ? HAL_ERROR_ARGUMENT : status; // no such channel
}

static enum hal_status servo_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    struct hal_pwm_limits limits;
    const enum hal_status status = servo_limits(ctx, channel, &limits);
    return status == HAL_OK && period_ns != limits.period_ns ? HAL_ERROR_ARGUMENT : status;
}

static enum hal_status servo_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    const struct linux_camera_servo *servo = ctx;
    const enum hal_camera_control control = (enum hal_camera_control)channel;
    struct hal_camera_range range;
    const enum hal_status status = hal_camera_control_range(servo->camera, control, &range);
    if (status != HAL_OK) {
        return status == HAL_ERROR_UNSUPPORTED ? HAL_ERROR_ARGUMENT : status;
    }
    if (pulse_ns >= LINUX_CAMERA_SERVO_PERIOD_NS) {
        return HAL_ERROR_ARGUMENT;
    }
    if (pulse_ns == 0U) {
        return HAL_OK;
    }
    int32_t value = (int32_t)pulse_ns - (int32_t)LINUX_CAMERA_SERVO_ZERO_NS;
    value = value < range.min ? range.min : value > range.max ? range.max : value;
    const enum hal_status set = hal_camera_control_set(servo->camera, control, value);
    return set == HAL_BUSY ? HAL_ERROR_IO : set; // the pump tries again at the next tick
}

static const struct hal_pwm_ops linux_camera_servo_pwm_ops = {servo_limits, servo_set_period,
                                                              servo_set_pulse};

enum hal_status linux_camera_servo_bind(struct linux_camera_servo *servo,
                                        const struct hal_camera *camera) {
    servo->camera = camera;
    return hal_pwm_bind(&servo->hal, &linux_camera_servo_pwm_ops, servo);
}
