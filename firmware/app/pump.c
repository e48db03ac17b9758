#include "app/pump.h"

/// No pulse is so long. What a channel gives before the first write is not relied on: a program
/// that died may have left it pulsing.
#define PULSE_UNKNOWN UINT32_MAX

static bool needs(const struct controller *controller, enum drive_kind kind) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (controller->config->axis[axis].drive.kind == kind) {
            return true;
        }
    }
    return false;
}

bool pump_init(struct pump *pump, struct controller *controller,
               const struct pump_devices *devices) {
    pump->devices = *devices;
    pump->controller = controller;
    pump_forget(pump);
    pump->commands = 0;
    pump->pan_set = pump->input.pan_set = false;
    pump->input.frame_count = pump->input.update_count = 0;
    pump->errors = (struct pump_errors){0};
    pump->output = (struct controller_output){0};
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        pump->pulse_ns[axis] = PULSE_UNKNOWN;
    }
    return devices->clock != NULL && (devices->can != NULL || !needs(controller, DRIVE_RMD)) &&
           (devices->pwm != NULL || !needs(controller, DRIVE_PWM));
}

bool pump_push(struct pump *pump, const struct target_update *update) {
    if (pump->update_count == PUMP_UPDATES_MAX) {
        pump->errors.updates_dropped++;
        pump_release(pump);
        return false;
    }
    pump->update[(pump->update_first + pump->update_count) % PUMP_UPDATES_MAX] = *update;
    pump->update_count++;
    pump->held_count += pump->holds;
    return true;
}

void pump_hold(struct pump *pump) {
    pump->holds = true;
}

void pump_release(struct pump *pump) {
    pump->holds = false;
    pump->held_count = 0;
}

void pump_forget(struct pump *pump) {
    pump->update_first = pump->update_count = 0;
    pump_release(pump);
}

void pump_command(struct pump *pump, uint32_t commands) {
    pump->commands |= commands;
}

void pump_pan(struct pump *pump, const struct controller_pan *pan) {
    pump->pan = *pan;
    pump->pan_set = true;
}

/// Frames that do not fit into one tick wait in the device's queue.
static void read_frames(struct pump *pump) {
    struct controller_input *input = &pump->input;
    input->frame_count = 0;
    if (pump->devices.can == NULL) {
        return;
    }
    while (input->frame_count < CONTROLLER_FRAMES_IN_MAX) {
        uint32_t received_us;
        const enum hal_status status =
            hal_can_receive(pump->devices.can, &input->frame[input->frame_count], &received_us);
        if (status != HAL_OK) {
            pump->errors.can_receive_failed += status != HAL_EMPTY;
            return;
        }
        input->frame_count++;
    }
}

static void read_updates(struct pump *pump) {
    struct controller_input *input = &pump->input;
    input->update_count = 0;
    while (input->update_count < CONTROLLER_UPDATES_MAX && pump->update_count != pump->held_count) {
        input->update[input->update_count++] = pump->update[pump->update_first];
        pump->update_first = (pump->update_first + 1U) % PUMP_UPDATES_MAX;
        pump->update_count--;
    }
}

static void write_frames(struct pump *pump) {
    const struct controller_output *output = &pump->output;
    for (uint32_t i = 0; i < output->frame_count; i++) {
        const enum hal_status status = hal_can_send(pump->devices.can, &output->frame[i]);
        if (status == HAL_OK) {
            continue;
        }
        pump->errors.can_send_failed++;
        if (status == HAL_ERROR_DOWN && hal_can_restart(pump->devices.can) == HAL_OK) {
            pump->errors.can_restarts++;
        }
        return; // what follows would only be later than it is
    }
}

static void write_pulses(struct pump *pump) {
    const struct controller_output *output = &pump->output;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (!output->pulse_set[axis] || output->pulse_ns[axis] == pump->pulse_ns[axis]) {
            continue;
        }
        if (hal_pwm_set_pulse(pump->devices.pwm, output->pulse_channel[axis],
                              output->pulse_ns[axis]) == HAL_OK) {
            pump->pulse_ns[axis] = output->pulse_ns[axis];
        } else {
            pump->errors.pwm_failed++;
        }
    }
}

void pump_step(struct pump *pump) {
    pump->input.now_us = hal_clock_now_us(pump->devices.clock);
    pump->input.commands = pump->commands;
    pump->commands = 0;
    pump->input.pan_set = pump->pan_set;
    pump->input.pan = pump->pan;
    pump->pan_set = false;
    read_frames(pump);
    read_updates(pump);
    controller_step(pump->controller, &pump->input, &pump->output);
    write_frames(pump);
    write_pulses(pump);
}
