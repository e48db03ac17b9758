#include "rig_devices_private.h"

#include <string.h>

const char *const rig_devices_axis_names[AXIS_COUNT] = {"pan", "tilt", "zoom"};

/// What kind of device a text names. False: none.
static bool kind_of(const char *text, enum rig_output_kind *kind) {
    const size_t scheme = strlen(RIG_DEVICES_GPIO_SCHEME);
    const bool maestro = strcmp(text, "maestro") == 0 || strncmp(text, "maestro:", 8) == 0;
    const bool gpio = strncmp(text, RIG_DEVICES_GPIO_SCHEME, scheme) == 0 && text[scheme] != '\0';
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

bool rig_devices_find(struct rig_devices *devices, struct rig *rig) {
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
            ini_complain(&rig->ini, rig_devices_axis_names[axis], "", "device",
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
    return true;
}
