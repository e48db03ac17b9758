#include "app/board_status.h"

const char *board_status_held(const struct board_status *status) {
    return status->refusal != NULL ? status->refusal : status->stop;
}

// ---------------------------------------------------------------- words

static const char *cause_name(enum hal_reset_cause cause) {
    static const char *const names[] = {"not told",  "power-on", "brown-out",
                                        "reset pin", "software", "watchdog"};
    return names[cause];
}

static const char *health_name(enum hal_can_health health) {
    static const char *const names[] = {"active", "passive", "off"};
    return names[health];
}

static void put_number(struct text *text, const char *before, uint32_t number) {
    text_string(text, before);
    text_unsigned(text, number, 0);
}

static void put_angle(struct text *text, const char *before, int64_t position_q48, unsigned width) {
    text_string(text, before);
    text_hundredths(text, drive_cdeg_from_q48(position_q48), width);
}

static void put_bus(struct text *text, const struct hal_can_state *can) {
    text_string(text, "can ");
    text_string(text, health_name(can->health));
    put_number(text, " ", can->transmit_error_count);
    put_number(text, "/", can->receive_error_count);
}

// ---------------------------------------------------------------- greeting

bool board_status_greet(const struct board_status *status, const char *const *notes, uint32_t index,
                        struct text *text) {
    uint32_t note_count = 0;
    while (notes[note_count] != NULL) {
        note_count++;
    }
    if (index == 0U) {
        text_string(text, "boresight ");
        text_string(text, build_id);
    } else if (index <= note_count) {
        text_string(text, notes[index - 1U]);
    } else if (index == note_count + 1U) {
        text_string(text, "reset: ");
        text_string(text, cause_name(status->reset_cause));
    } else if (index == note_count + 2U && status->refusal != NULL) {
        text_string(text, "will not arm: ");
        text_string(text, status->refusal);
    } else {
        return false;
    }
    return true;
}

// ---------------------------------------------------------------- telemetry

void board_status_trace(const struct board_status *status, const struct pump *pump,
                        uint32_t seconds, struct text *text) {
    const struct controller_status *controller = &pump->output.status;
    const char *held = board_status_held(status);
    text_unsigned(text, seconds, 6);
    text_string(text, " s  ");
    text_string(text, controller_mode_name(controller->mode));
    put_angle(text, "  pan", controller->axis[AXIS_PAN].setpoint_q48, 8);
    put_angle(text, "  tilt", controller->axis[AXIS_TILT].setpoint_q48, 8);
    put_number(text, "  targets ", controller->target_count);
    if (pump->devices.can != NULL) {
        text_string(text, "  ");
        put_bus(text, &status->can);
    }
    put_number(text, "  busy ", status->busy_us_max);
    put_number(text, " us  missed ", status->ticks_missed);
    if (controller->faults != 0U) {
        text_string(text, "  fault: ");
        text_string(text, controller_fault_name(controller->faults));
    }
    if (held != NULL) {
        text_string(text, "  held: ");
        text_string(text, held);
    }
}

void board_status_begin_period(struct board_status *status) {
    status->busy_us_max = 0;
    status->can = (struct hal_can_state){.health = HAL_CAN_ACTIVE};
}

// ---------------------------------------------------------------- the longer account

static void tell_axis(struct text *text, const char *name,
                      const struct controller_axis_status *axis) {
    text_string(text, name);
    put_angle(text, " at ", axis->setpoint_q48, 0);
    put_angle(text, ", goal ", axis->goal_q48, 0);
    if (axis->measured_known) {
        put_angle(text, ", measured ", axis->measured_q48, 0);
    } else {
        text_string(text, ", not measured");
    }
}

static void tell_mode(struct text *text, const struct board_status *status,
                      const struct controller_status *controller) {
    const char *held = board_status_held(status);
    text_string(text, "mode: ");
    text_string(text, controller_mode_name(controller->mode));
    if (controller->faults != 0U) {
        text_string(text, ", fault: ");
        text_string(text, controller_fault_name(controller->faults));
    }
    if (held != NULL) {
        text_string(text, ", held: ");
        text_string(text, held);
    }
}

bool board_status_tell(const struct board_status *status, const struct pump *pump, uint32_t index,
                       struct text *text) {
    const struct controller_status *controller = &pump->output.status;
    switch (index) {
    case 0:
        tell_mode(text, status, controller);
        return true;
    case 1:
        tell_axis(text, "pan: ", &controller->axis[AXIS_PAN]);
        return true;
    case 2:
        tell_axis(text, "tilt:", &controller->axis[AXIS_TILT]);
        return true;
    case 3:
        put_number(text, "targets: ", controller->target_count);
        put_number(text, ", rejected ", controller->updates_rejected);
        put_number(text, ", dropped ", pump->errors.updates_dropped);
        return true;
    case 4:
        put_number(text, "tick: busy ", status->busy_us_max);
        put_number(text, " us at most, missed ", status->ticks_missed);
        if (pump->devices.can != NULL) {
            text_string(text, ", ");
            put_bus(text, &status->can);
        }
        return true;
    case 5:
        if (status->scene != NULL) {
            text_string(text, status->scene);
        }
        return status->scene != NULL;
    case 6:
        if (status->hidden != NULL) {
            text_string(text, status->hidden);
        }
        return status->hidden != NULL;
    default:
        return false;
    }
}
