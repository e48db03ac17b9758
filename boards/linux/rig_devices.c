#include "rig_devices.h"

#include <stdlib.h>
#include <string.h>

/// A camera that refuses a setting is asked again after so long, and so often.
#define SEND_AGAIN_US 200000U
#define REFUSALS_MAX  10U

static const char *const axis_names[AXIS_COUNT] = {"pan", "tilt", "zoom"};

#define GPIO_SCHEME "gpio:"

// ---------------------------------------------------------------- outputs, numbered by axis

static const struct hal_pwm *pwm_of(const struct rig_devices *devices, uint32_t axis) {
    return axis < AXIS_COUNT && devices->output[axis].device != NULL
               ? devices->output[axis].device->hal
               : NULL;
}

static enum hal_status output_limits(void *ctx, uint32_t axis, struct hal_pwm_limits *limits) {
    const struct rig_devices *devices = ctx;
    const struct hal_pwm *pwm = pwm_of(devices, axis);
    return pwm == NULL ? HAL_ERROR_ARGUMENT
                       : hal_pwm_limits(pwm, devices->output[axis].channel, limits);
}

static enum hal_status output_set_period(void *ctx, uint32_t axis, uint32_t period_ns) {
    const struct rig_devices *devices = ctx;
    const struct hal_pwm *pwm = pwm_of(devices, axis);
    return pwm == NULL ? HAL_ERROR_ARGUMENT
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
    if (pwm == NULL) {
        return HAL_OK;
    }
    return hal_pwm_set_pulse(pwm, output->channel, pulse_ns);
}

/// Whether a camera's own axis goes where the rig may send it.
static enum hal_status check_reach(struct rig_devices *devices, struct linux_camera *camera,
                                   unsigned axis) {
    const struct rig_output *output = &devices->output[axis];
    struct hal_camera_range range;
    char reason[120];
    const enum hal_status status =
        hal_camera_control_range(&camera->hal, (enum hal_camera_control)output->channel, &range);
    if (status == HAL_ERROR_UNSUPPORTED) {
        snprintf(reason, sizeof reason, "the camera has no %s of its own", axis_names[axis]);
        linux_error_set(&devices->error, camera->path, reason, "`boresight probe` shows its axes");
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
        snprintf(reason, sizeof reason, "its %s goes from %.2f to %.2f degrees", axis_names[axis],
                 range.min / 3600.0, range.max / 3600.0);
    }
    linux_error_set(&devices->error, camera->path, reason,
                    axis == AXIS_ZOOM ? "set zoom_units" : "set limit_min_deg and limit_max_deg");
    return HAL_ERROR_UNSUPPORTED;
}

static enum hal_status open_camera(struct rig_devices *devices, struct rig_output_device *device) {
    enum hal_status status = linux_camera_open(&device->camera, device->text, &devices->clock.hal);
    devices->error = device->camera.error;
    device->failed_settings = device->refusals = 0;
    if (linux_camera_servo_bind(&device->servo, &device->camera.hal) != HAL_OK) {
        abort(); // can't be: its table is complete
    }
    device->hal = &device->servo.hal;
    for (unsigned axis = 0; axis < AXIS_COUNT && status == HAL_OK; axis++) {
        if (devices->output[axis].device == device) {
            status = check_reach(devices, &device->camera, axis);
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
static enum hal_status open_lines(struct rig_devices *devices, struct rig_output_device *device) {
    static const struct hal_pwm_ops step_ops = {steps_limits, steps_set_period, steps_set_pulse};
    const char *chip = device->text + strlen(GPIO_SCHEME);
    enum hal_status status;
    if (device->kind == RIG_OUTPUT_GPIO) {
        status = linux_gpio_pulses_open(&device->pulses, chip, device->lines, device->line_count);
        devices->error = device->pulses.error;
        device->hal = &device->pulses.hal;
        return status;
    }
    const int64_t position =
        device->lost ? linux_gpio_steps_position(&device->steps) : device->step->home_steps;
    status =
        linux_gpio_steps_open(&device->steps, chip, device->lines[0],
                              device->step->direction_channel, device->step->rate_max, position);
    devices->error = device->steps.error;
    device->hal = &device->step_hal;
    return hal_pwm_bind(&device->step_hal, &step_ops, device) == HAL_OK ? status : HAL_ERROR_IO;
}

static enum hal_status open_output(struct rig_devices *devices, struct rig_output_device *device) {
    enum hal_status status;
    if (device->kind == RIG_OUTPUT_PWM) {
        status = linux_pwm_open(&device->pwm, LINUX_PWM_ROOT, device->text, device->channels);
        devices->error = device->pwm.error;
        device->hal = &device->pwm.hal;
    } else if (device->kind == RIG_OUTPUT_MAESTRO) {
        const char *colon = strchr(device->text, ':');
        status = linux_maestro_open(&device->maestro, colon != NULL ? colon + 1 : NULL);
        devices->error = device->maestro.error;
        device->hal = &device->maestro.hal;
    } else if (device->kind == RIG_OUTPUT_CAMERA) {
        status = open_camera(devices, device);
    } else {
        status = open_lines(devices, device);
    }
    for (unsigned axis = 0; axis < AXIS_COUNT && status == HAL_OK; axis++) {
        const struct rig_output *output = &devices->output[axis];
        if (output->device == device) { // also refuses a channel that it does not have
            status = hal_pwm_set_pulse(device->hal, output->channel, output->pulse_ns);
        }
    }
    if (status == HAL_ERROR_ARGUMENT && devices->error.line[0] == '\0') {
        linux_error_set(&devices->error, device->text, "has no such channel",
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

/// What kind of device a text names. False: none.
static bool kind_of(const char *text, enum rig_output_kind *kind) {
    const size_t scheme = strlen(GPIO_SCHEME);
    const bool maestro = strcmp(text, "maestro") == 0 || strncmp(text, "maestro:", 8) == 0;
    const bool gpio = strncmp(text, GPIO_SCHEME, scheme) == 0 && text[scheme] != '\0';
    *kind = maestro ? RIG_OUTPUT_MAESTRO : gpio ? RIG_OUTPUT_GPIO : RIG_OUTPUT_PWM;
    return maestro || gpio || strncmp(text, "pwmchip", 7) == 0;
}

/// The entry of an axis' device, which others may share; a stepper driver is one axis' only.
static struct rig_output_device *device_of(struct rig_devices *devices, const struct rig *rig,
                                           unsigned axis) {
    const char *text = rig->device[axis];
    const bool is_step = axis < AXIS_ZOOM && rig->step[axis].unit_ns != 0U;
    enum rig_output_kind kind = RIG_OUTPUT_CAMERA;
    if (!rig->is_uvc[axis] && (!kind_of(text, &kind) || (is_step && kind != RIG_OUTPUT_GPIO))) {
        return NULL;
    }
    kind = is_step ? RIG_OUTPUT_STEPS : kind;
    for (unsigned i = 0; i < devices->device_count; i++) {
        if (devices->device[i].kind == kind && !is_step &&
            strcmp(devices->device[i].text, text) == 0) {
            return &devices->device[i];
        }
    }
    struct rig_output_device *device = &devices->device[devices->device_count++];
    device->kind = kind;
    device->text = text;
    device->step = is_step ? &rig->step[axis] : NULL;
    return device;
}

/// The pulses at the ends of the axis' limits.
static void note_reach(struct rig_output *output, const struct controller_axis_config *axis) {
    const struct drive_pwm_config *pwm = &axis->drive.pwm;
    const double slope =
        ((double)pwm->high_pulse_ns - pwm->low_pulse_ns) / (double)(pwm->high_q48 - pwm->low_q48);
    const double a = pwm->low_pulse_ns + slope * (double)(axis->limits.min_q48 - pwm->low_q48);
    const double b = pwm->low_pulse_ns + slope * (double)(axis->limits.max_q48 - pwm->low_q48);
    output->pulse_ns_min = (uint32_t)((a < b ? a : b) + 0.5);
    output->pulse_ns_max = (uint32_t)((a < b ? b : a) + 0.5);
}

static bool find_outputs(struct rig_devices *devices, struct rig *rig) {
    static const struct hal_pwm_ops ops = {output_limits, output_set_period, output_set_pulse};
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        struct drive_config *drive = &rig->controller.axis[axis].drive;
        if (drive->kind != DRIVE_PWM) {
            continue;
        }
        struct rig_output *output = &devices->output[axis];
        output->channel = drive->pwm.channel;
        drive->pwm.channel = axis;
        if (strcmp(rig->device[axis], "fake") == 0) {
            continue;
        }
        note_reach(output, &rig->controller.axis[axis]);
        output->device = device_of(devices, rig, axis);
        if (output->device == NULL) {
            ini_complain(&rig->ini, axis_names[axis], "", "device",
                         "is '%s'; it has to be pwmchipN, maestro, maestro:SERIAL, gpio:CHIP or "
                         "fake (of a stepper gpio:CHIP)",
                         rig->device[axis]);
            return false;
        }
        struct rig_output_device *device = output->device;
        if (device->kind == RIG_OUTPUT_GPIO || device->kind == RIG_OUTPUT_STEPS) {
            device->lines[device->line_count++] = output->channel;
        } else if (output->channel < 32U) {
            output->device->channels |= UINT32_C(1) << output->channel;
        }
    }
    return hal_pwm_bind(&devices->outputs, &ops, devices) == HAL_OK;
}

// ---------------------------------------------------------------- all of them

enum exit_status rig_devices_open(struct rig_devices *devices, struct rig *rig) {
    memset(devices, 0, sizeof *devices);
    linux_clock_open(&devices->clock, 0);
    if (!rig_buses_find(&devices->buses, rig, &devices->clock.hal) || !find_outputs(devices, rig)) {
        return EXIT_STATUS_USAGE;
    }
    bool good = rig_buses_open(&devices->buses) == HAL_OK;
    devices->error = devices->buses.error;
    unsigned opened = 0;
    while (good && opened < devices->device_count) {
        good = open_output(devices, &devices->device[opened]) == HAL_OK;
        opened++;
    }
    if (!good) {
        message_at(rig->ini.file, 0, "%s", devices->error.line);
        devices->device_count = opened;
        rig_devices_close(devices);
        return EXIT_STATUS_DEVICE;
    }
    devices->pump =
        (struct pump_devices){&devices->clock.hal, devices->buses.hal, &devices->outputs};
    return EXIT_STATUS_OK;
}

void rig_devices_close(struct rig_devices *devices) {
    rig_buses_close(&devices->buses);
    for (unsigned i = 0; i < devices->device_count; i++) {
        close_output(&devices->device[i]);
    }
    devices->device_count = 0;
}

/// Settings fail in the background: a failed one is sent again, so that the axis does not stay
/// where it was without anybody knowing.
static void look_after_camera(struct rig_devices *devices, struct rig_output_device *device) {
    const uint32_t failed = linux_camera_failed_settings(&device->camera);
    const uint32_t span_us =
        hal_clock_span_us(device->refused_us, hal_clock_now_us(&devices->clock.hal));
    if (failed == device->failed_settings) {
        device->refusals = span_us > 5U * SEND_AGAIN_US ? 0U : device->refusals;
        return;
    }
    if (device->refusals > 0U && span_us < SEND_AGAIN_US) {
        return;
    }
    device->failed_settings = failed;
    device->refused_us += span_us;
    device->refusals++;
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
    for (unsigned i = 0; i < devices->device_count; i++) {
        if (devices->device[i].kind == RIG_OUTPUT_GPIO) {
            linux_gpio_pulses_jitter(&devices->device[i].pulses, &jitter);
        } else if (devices->device[i].kind == RIG_OUTPUT_STEPS) {
            linux_gpio_steps_jitter(&devices->device[i].steps, &jitter);
        }
    }
    return jitter;
}

void rig_devices_tick(struct rig_devices *devices) {
    for (unsigned i = 0; i < devices->device_count; i++) {
        struct rig_output_device *device = &devices->device[i];
        if (device->kind == RIG_OUTPUT_MAESTRO) {
            (void)linux_maestro_poll(&device->maestro);
        } else if (device->kind == RIG_OUTPUT_PWM) {
            (void)linux_pwm_poll(&device->pwm);
        } else if (device->kind == RIG_OUTPUT_CAMERA && !device->lost) {
            look_after_camera(devices, device);
        }
    }
}

static const struct linux_error *error_of(const struct rig_output_device *device) {
    return device->kind == RIG_OUTPUT_PWM       ? &device->pwm.error
           : device->kind == RIG_OUTPUT_MAESTRO ? &device->maestro.error
           : device->kind == RIG_OUTPUT_CAMERA  ? &device->camera.error
           : device->kind == RIG_OUTPUT_GPIO    ? &device->pulses.error
                                                : &device->steps.error;
}

/// Why the device can't be used any more; NULL: it can.
static const struct linux_error *loss_of(struct rig_output_device *device, uint32_t channel) {
    struct hal_pwm_limits limits;
    if (hal_pwm_limits(device->hal, channel, &limits) == HAL_ERROR_GONE) {
        return error_of(device);
    }
    if (device->kind != RIG_OUTPUT_CAMERA || device->refusals < REFUSALS_MAX) {
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

bool rig_devices_mend(struct rig_devices *devices) {
    rig_buses_mend(&devices->buses);
    for (unsigned i = 0; i < devices->device_count; i++) {
        struct rig_output_device *device = &devices->device[i];
        if (device->lost) {
            close_output(device);
            device->lost = open_output(devices, device) != HAL_OK;
        }
    }
    return !rig_devices_incomplete(devices);
}
