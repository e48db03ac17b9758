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
    pump->detour = NULL;
    pump_forget(pump);
    pump->commands = 0;
    pump->pan_set = pump->input.pan_set = false;
    pump->input.frame_count = pump->input.update_count = 0;
    pump->errors = (struct pump_errors){0};
    pump->can_restarting = false;
    pump->output = (struct controller_output){0};
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        pump->pulse_ns[axis] = PULSE_UNKNOWN;
    }
    return devices->clock != NULL && (devices->can != NULL || !needs(controller, DRIVE_RMD)) &&
           (devices->pwm != NULL || !needs(controller, DRIVE_PWM));
}

static bool push(struct pump *pump, const struct target_update *update, bool as_is) {
    if (pump->update_count == PUMP_UPDATES_MAX) {
        pump->errors.updates_dropped++;
        pump_release(pump);
        return false;
    }
    const uint32_t place = (pump->update_first + pump->update_count) % PUMP_UPDATES_MAX;
    const uint32_t bit = UINT32_C(1) << place % 32U;
    pump->update[place] = *update;
    pump->as_is[place / 32U] = (pump->as_is[place / 32U] & ~bit) | (as_is ? bit : 0U);
    pump->update_count++;
    pump->held_count += pump->holds;
    return true;
}

bool pump_push(struct pump *pump, const struct target_update *update) {
    return push(pump, update, false);
}

bool pump_push_as_is(struct pump *pump, const struct target_update *update) {
    return push(pump, update, true);
}

bool pump_take(struct pump *pump, struct target_update *update, bool *as_is) {
    const uint32_t place = pump->update_first;
    if (pump->update_count == pump->held_count) {
        return false;
    }
    *update = pump->update[place];
    *as_is = (pump->as_is[place / 32U] >> place % 32U & 1U) != 0U;
    pump->update_first = (place + 1U) % PUMP_UPDATES_MAX;
    pump->update_count--;
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
    if (pump->detour != NULL) {
        pump->detour->count = 0;
        pump->detour->forget = true;
    }
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
        const enum hal_status status =
            hal_can_receive(pump->devices.can, &input->frame[input->frame_count],
                            &input->frame_us[input->frame_count]);
        if (status != HAL_OK) {
            pump->errors.can_receive_failed += status != HAL_EMPTY;
            return;
        }
        input->frame_count++;
    }
}

static bool take_passed(struct pump_detour *detour, struct target_update *update) {
    if (detour->count == 0U) {
        return false;
    }
    *update = detour->update[detour->first];
    detour->first = (detour->first + 1U) % PUMP_DETOUR_MAX;
    detour->count--;
    return true;
}

static void read_updates(struct pump *pump) {
    struct controller_input *input = &pump->input;
    bool as_is, more = true;
    for (input->update_count = 0; more && input->update_count < CONTROLLER_UPDATES_MAX;
         input->update_count += more) {
        struct target_update *const update = &input->update[input->update_count];
        more = pump->detour != NULL ? take_passed(pump->detour, update)
                                    : pump_take(pump, update, &as_is);
    }
}

static void write_frames(struct pump *pump) {
    const struct controller_output *output = &pump->output;
    for (uint32_t i = 0; i < output->frame_count; i++) {
        const enum hal_status status = hal_can_send(pump->devices.can, &output->frame[i]);
        if (status == HAL_OK) {
            pump->can_restarting = false;
            continue;
        }
        pump->errors.can_send_failed++;
        if (status == HAL_ERROR_DOWN && hal_can_restart(pump->devices.can) == HAL_OK) {
            pump->errors.can_restarts += !pump->can_restarting;
            pump->can_restarting = true;
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
