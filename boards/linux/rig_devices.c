#include "rig_devices_private.h"

#include <stdlib.h>
#include <string.h>

/// How often a Maestro is asked where its outputs are.
#define ASK_EVERY_US 50000U

// ---------------------------------------------------------------- outputs, numbered by axis

static const struct hal_pwm *pwm_of(const struct rig_devices *devices, uint32_t axis) {
    return axis < AXIS_COUNT && devices->output[axis].device != NULL
               ? devices->output[axis].device->hal
               : NULL;
}

static bool is_lost(const struct rig_devices *devices, uint32_t axis) {
    return axis < AXIS_COUNT && devices->output[axis].device != NULL &&
           devices->output[axis].device->lost;
}

static enum hal_status output_limits(void *ctx, uint32_t axis, struct hal_pwm_limits *limits) {
    const struct rig_devices *devices = ctx;
    const struct hal_pwm *pwm = pwm_of(devices, axis);
    return is_lost(devices, axis) ? HAL_ERROR_GONE
           : pwm == NULL          ? HAL_ERROR_ARGUMENT
                                  : hal_pwm_limits(pwm, devices->output[axis].channel, limits);
}

static enum hal_status output_set_period(void *ctx, uint32_t axis, uint32_t period_ns) {
    const struct rig_devices *devices = ctx;
    const struct hal_pwm *pwm = pwm_of(devices, axis);
    return is_lost(devices, axis) ? HAL_ERROR_GONE
           : pwm == NULL          ? HAL_ERROR_ARGUMENT
                         : hal_pwm_set_period(pwm, devices->output[axis].channel, period_ns);
}

static enum hal_status output_set_pulse(void *ctx, uint32_t axis, uint32_t pulse_ns) {
    struct rig_devices *devices = ctx;
    if (axis >= AXIS_COUNT) {
        return HAL_ERROR_ARGUMENT;
    }
    const struct hal_pwm *pwm = pwm_of(devices, axis);
    struct rig_output *output = &devices->output[axis];
    output->pulse_ns = pulse_ns;
    if (pwm == NULL || output->device->lost) {
        return pwm == NULL ? HAL_OK : HAL_ERROR_GONE;
    }
    return hal_pwm_set_pulse(pwm, output->channel, pulse_ns);
}

/// Whether a camera's own axis goes where the rig may send it.
static enum hal_status check_reach(const struct rig_devices *devices,
                                   struct rig_output_device *device, unsigned axis) {
    const struct linux_camera *camera = &device->camera;
    const struct rig_output *output = &devices->output[axis];
    struct hal_camera_range range;
    char reason[120];
    const enum hal_status status =
        hal_camera_control_range(&camera->hal, (enum hal_camera_control)output->channel, &range);
    if (status == HAL_ERROR_UNSUPPORTED) {
        snprintf(reason, sizeof reason, "the camera has no %s of its own",
                 rig_devices_axis_names[axis]);
        linux_error_set(&device->error, camera->path, reason, "`boresight probe` shows its axes");
        return status;
    }
    const int64_t zero = LINUX_CAMERA_SERVO_ZERO_NS;
    if (status != HAL_OK ||
        (output->pulse_ns_min >= range.min + zero && output->pulse_ns_max <= range.max + zero)) {
        return status;
    }
    if (axis == AXIS_ZOOM) {
        snprintf(reason, sizeof reason, "its zoom goes from %d to %d", range.min, range.max);
    } else {
        snprintf(reason, sizeof reason, "its %s goes from %.2f to %.2f degrees",
                 rig_devices_axis_names[axis], range.min / 3600.0, range.max / 3600.0);
    }
    linux_error_set(&device->error, camera->path, reason,
                    axis == AXIS_ZOOM ? "set zoom_units" : "set limit_min_deg and limit_max_deg");
    return HAL_ERROR_UNSUPPORTED;
}

static enum hal_status open_camera(const struct rig_devices *devices,
                                   struct rig_output_device *device) {
    enum hal_status status = linux_camera_open(&device->camera, device->text, &devices->clock.hal);
    device->error = device->camera.error;
    device->refusals = (struct refusals){0};
    if (linux_camera_servo_bind(&device->servo, &device->camera.hal) != HAL_OK) {
        abort(); // can't be: its table is complete
    }
    device->hal = &device->servo.hal;
    for (unsigned axis = 0; axis < AXIS_COUNT && status == HAL_OK; axis++) {
        if (devices->output[axis].device == device) {
            status = check_reach(devices, device, axis);
        }
    }
    return status;
}

// ---------------------------------------------------------------- plain lines

/// A stepper driver as a PWM output: rig.h has the scale.
static enum hal_status steps_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    struct rig_output_device *device = ctx;
    (void)channel;
    *limits = (struct hal_pwm_limits){20000000U, 20000000U, 20000000U, 1U};
    return linux_gpio_steps_presence(&device->steps);
}

static enum hal_status steps_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    (void)ctx;
    (void)channel;
    (void)period_ns;
    return HAL_ERROR_ARGUMENT;
}

/// No pulse, no power: a stepper stays where it is.
static enum hal_status steps_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    struct rig_output_device *device = ctx;
    (void)channel;
    if (pulse_ns < RIG_STEP_BASE_NS) {
        return linux_gpio_steps_presence(&device->steps);
    }
    const uint32_t unit_ns = device->step->unit_ns;
    return linux_gpio_steps_go(&device->steps,
                               (pulse_ns - RIG_STEP_BASE_NS + unit_ns / 2U) / unit_ns);
}

/// A stepper goes on from where it was when the chip left.
static enum hal_status open_lines(struct rig_output_device *device) {
    static const struct hal_pwm_ops step_ops = {steps_limits, steps_set_period, steps_set_pulse};
    const char *chip = device->text + strlen(RIG_DEVICES_GPIO_SCHEME);
    enum hal_status status;
    if (device->kind == RIG_OUTPUT_GPIO) {
        status = linux_gpio_pulses_open(&device->pulses, chip, device->lines, device->line_count);
        device->error = device->pulses.error;
        device->hal = &device->pulses.hal;
        return status;
    }
    const int64_t position =
        device->lost ? linux_gpio_steps_position(&device->steps) : device->step->home_steps;
    status =
        linux_gpio_steps_open(&device->steps, chip, device->lines[0],
                              device->step->direction_channel, device->step->rate_max, position);
    device->error = device->steps.error;
    device->hal = &device->step_hal;
    return hal_pwm_bind(&device->step_hal, &step_ops, device) == HAL_OK ? status : HAL_ERROR_IO;
}

/// In any thread, alone.
static enum hal_status open_output(const struct rig_devices *devices,
                                   struct rig_output_device *device) {
    enum hal_status status;
    if (device->kind == RIG_OUTPUT_PWM) {
        status = linux_pwm_open(&device->pwm, LINUX_PWM_ROOT, device->text, device->channels);
        device->error = device->pwm.error;
        device->hal = &device->pwm.hal;
    } else if (device->kind == RIG_OUTPUT_MAESTRO) {
        const char *colon = strchr(device->text, ':');
        status = linux_maestro_open(&device->maestro, colon != NULL ? colon + 1 : NULL);
        device->error = device->maestro.error;
        device->hal = &device->maestro.hal;
    } else if (device->kind == RIG_OUTPUT_CAMERA) {
        status = open_camera(devices, device);
    } else {
        status = open_lines(device);
    }
    return status;
}

static const struct linux_error *error_of(const struct rig_output_device *device) {
    return device->kind == RIG_OUTPUT_PWM       ? &device->pwm.error
           : device->kind == RIG_OUTPUT_MAESTRO ? &device->maestro.error
           : device->kind == RIG_OUTPUT_CAMERA  ? &device->camera.error
           : device->kind == RIG_OUTPUT_GPIO    ? &device->pulses.error
                                                : &device->steps.error;
}

/// Outputs of a device that has just been opened get their pulses, which also refuses a channel
/// that it does not have.
static enum hal_status restore_pulses(struct rig_devices *devices,
                                      struct rig_output_device *device) {
    enum hal_status status = HAL_OK;
    for (unsigned axis = 0; axis < AXIS_COUNT && status == HAL_OK; axis++) {
        const struct rig_output *output = &devices->output[axis];
        if (output->device == device) {
            status = hal_pwm_set_pulse(device->hal, output->channel, output->pulse_ns);
        }
    }
    if (status != HAL_OK) {
        device->error = *error_of(device);
    }
    if (status == HAL_ERROR_ARGUMENT && device->error.line[0] == '\0') {
        linux_error_set(&device->error, device->text, "has no such channel",
                        "choose another channel in the rig file");
    }
    return status;
}

static void close_output(struct rig_output_device *device) {
    switch (device->kind) {
    case RIG_OUTPUT_PWM:
        linux_pwm_close(&device->pwm);
        break;
    case RIG_OUTPUT_MAESTRO:
        linux_maestro_close(&device->maestro);
        break;
    case RIG_OUTPUT_CAMERA:
        linux_camera_close(&device->camera);
        break;
    case RIG_OUTPUT_GPIO:
        linux_gpio_pulses_close(&device->pulses);
        break;
    default:
        linux_gpio_steps_close(&device->steps);
        break;
    }
}

// ---------------------------------------------------------------- all of them

enum exit_status rig_devices_open(struct rig_devices *devices, struct rig *rig) {
    static const struct hal_pwm_ops ops = {output_limits, output_set_period, output_set_pulse};
    memset(devices, 0, sizeof *devices);
    linux_clock_open(&devices->clock, 0);
    if (!rig_buses_find(&devices->buses, rig, &devices->clock.hal) ||
        !rig_devices_find(devices, rig) ||
        hal_pwm_bind(&devices->outputs, &ops, devices) != HAL_OK) {
        return EXIT_STATUS_USAGE;
    }
    bool good = rig_buses_open(&devices->buses) == HAL_OK;
    devices->error = devices->buses.error;
    unsigned opened = 0;
    while (good && opened < devices->device_count) {
        struct rig_output_device *device = &devices->device[opened++];
        good = open_output(devices, device) == HAL_OK && restore_pulses(devices, device) == HAL_OK;
        devices->error = device->error;
    }
    if (!good) {
        devices->device_count = opened;
        rig_devices_close(devices);
        return EXIT_STATUS_DEVICE;
    }
    devices->pump =
        (struct pump_devices){&devices->clock.hal, devices->buses.hal, &devices->outputs};
    return EXIT_STATUS_OK;
}

void rig_devices_close(struct rig_devices *devices) {
    side_job_wait(&devices->mending);
    rig_buses_close(&devices->buses);
    for (unsigned i = 0; i < devices->device_count; i++) {
        close_output(&devices->device[i]);
    }
    devices->device_count = 0;
}

/// Settings fail in the background.
static void look_after_camera(struct rig_devices *devices, struct rig_output_device *device) {
    struct linux_camera *camera = &device->camera;
    if (!refusals_look(&device->refusals, linux_camera_failed_settings(camera),
                       linux_camera_taken_settings(camera),
                       hal_clock_now_us(&devices->clock.hal))) {
        return;
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct rig_output *output = &devices->output[axis];
        if (output->device == device &&
            hal_pwm_set_pulse(device->hal, output->channel, output->pulse_ns) != HAL_OK) {
            return; // it has left, which is noticed elsewhere
        }
    }
}

struct linux_jitter rig_devices_jitter(struct rig_devices *devices) {
    struct linux_jitter jitter = {.step = 1000U};
    side_job_wait(&devices->mending);
    for (unsigned i = 0; i < devices->device_count; i++) {
        if (devices->device[i].kind == RIG_OUTPUT_GPIO) {
            linux_gpio_pulses_jitter(&devices->device[i].pulses, &jitter);
        } else if (devices->device[i].kind == RIG_OUTPUT_STEPS) {
            linux_gpio_steps_jitter(&devices->device[i].steps, &jitter);
        }
    }
    return jitter;
}

// ---------------------------------------------------------------- opening again, in the background

static void mend(void *context) {
    struct rig_devices *devices = context;
    for (unsigned i = 0; i < devices->buses.count; i++) {
        struct rig_bus *bus = &devices->buses.bus[i];
        devices->bus_mended[i] = devices->bus_mending[i] && rig_bus_reopen(&devices->buses, bus);
    }
    for (unsigned i = 0; i < devices->device_count; i++) {
        struct rig_output_device *device = &devices->device[i];
        if (device->mending) {
            close_output(device);
            device->mended = open_output(devices, device) == HAL_OK;
        }
    }
}

static void take_mended(struct rig_devices *devices) {
    for (unsigned i = 0; i < devices->buses.count; i++) {
        devices->buses.bus[i].lost = devices->buses.bus[i].lost && !devices->bus_mended[i];
        devices->bus_mended[i] = false;
    }
    for (unsigned i = 0; i < devices->device_count; i++) {
        struct rig_output_device *device = &devices->device[i];
        if (device->mended) {
            device->lost = restore_pulses(devices, device) != HAL_OK;
        }
        device->mended = false;
    }
}

void rig_devices_mend(struct rig_devices *devices) {
    if (devices->mending_begun || !rig_devices_incomplete(devices)) {
        return;
    }
    for (unsigned i = 0; i < devices->buses.count; i++) {
        devices->bus_mending[i] = devices->buses.bus[i].lost;
    }
    for (unsigned i = 0; i < devices->device_count; i++) {
        devices->device[i].mending = devices->device[i].lost;
    }
    devices->mending_begun = side_job_start(&devices->mending, mend, devices);
}

// ---------------------------------------------------------------- ticks

/// Where its outputs are comes with a later poll.
static void look_after_maestro(struct rig_devices *devices, struct rig_output_device *device) {
    const uint32_t now_us = hal_clock_now_us(&devices->clock.hal);
    if (linux_maestro_poll(&device->maestro) == HAL_OK &&
        hal_clock_span_us(devices->asked_us, now_us) >= ASK_EVERY_US) {
        devices->asked_us = now_us;
        (void)linux_maestro_ask(&device->maestro); // the last question may be under way still
    }
}

void rig_devices_tick(struct rig_devices *devices) {
    if (devices->mending_begun && side_job_is_over(&devices->mending)) {
        devices->mending_begun = false;
        take_mended(devices);
    }
    for (unsigned i = 0; i < devices->device_count; i++) {
        struct rig_output_device *device = &devices->device[i];
        if (device->lost) {
            continue;
        }
        if (device->kind == RIG_OUTPUT_MAESTRO) {
            look_after_maestro(devices, device);
        } else if (device->kind == RIG_OUTPUT_PWM) {
            (void)linux_pwm_poll(&device->pwm);
        } else if (device->kind == RIG_OUTPUT_CAMERA) {
            look_after_camera(devices, device);
        }
    }
}

bool rig_devices_read_back(const struct rig_devices *devices, enum controller_axis axis,
                           bool *known, uint32_t *pulse_ns) {
    const struct rig_output *output = &devices->output[axis];
    const struct rig_output_device *device = output->device;
    if (device == NULL || device->kind != RIG_OUTPUT_MAESTRO) {
        return false;
    }
    *known = !device->lost && device->maestro.known;
    *pulse_ns = *known ? device->maestro.position_ns[output->channel] : 0U;
    return true;
}

// ---------------------------------------------------------------- leaving

/// Why the device can't be used any more; NULL: it can.
static const struct linux_error *loss_of(struct rig_output_device *device, uint32_t channel) {
    struct hal_pwm_limits limits;
    if (hal_pwm_limits(device->hal, channel, &limits) == HAL_ERROR_GONE) {
        return error_of(device);
    }
    if (device->kind != RIG_OUTPUT_CAMERA || !refusals_give_up(&device->refusals)) {
        return NULL;
    }
    linux_error_set(&device->camera.error, device->camera.path, "it refuses to be turned",
                    "unplug it and plug it in again");
    return &device->camera.error;
}

/// A device that leaves answers that it is gone to whatever it is asked.
const char *rig_devices_newly_lost(struct rig_devices *devices) {
    const char *lost = rig_buses_newly_lost(&devices->buses);
    if (lost != NULL) {
        return lost;
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct rig_output *output = &devices->output[axis];
        struct rig_output_device *device = output->device;
        const struct linux_error *loss =
            device != NULL && !device->lost ? loss_of(device, output->channel) : NULL;
        if (loss != NULL) {
            device->lost = true;
            devices->error = *loss;
            return devices->error.line;
        }
    }
    return NULL;
}

bool rig_devices_incomplete(const struct rig_devices *devices) {
    bool incomplete = rig_buses_incomplete(&devices->buses);
    for (unsigned i = 0; i < devices->device_count; i++) {
        incomplete = incomplete || devices->device[i].lost;
    }
    return incomplete;
}
