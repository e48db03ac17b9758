#include "app/board_commands.h"

/// 2^48 a turn to a binary angle; the turns are lost.
static bam32_t bam_from_q48(int64_t position_q48) {
    return bam32((uint32_t)((uint64_t)position_q48 >> 16));
}

static bool has_room(const struct pump *pump, uint32_t count) {
    return PUMP_UPDATES_MAX - pump->update_count >= count;
}

bool board_commands_update(struct board_commands *commands, const struct target_update *update) {
    if (commands->aims) { // targets take the place of what was aimed at by hand
        const struct target_update gone = {.kind = TARGET_GONE, .id = REQUEST_AIM_ID};
        if (!has_room(commands->pump, 2) || !pump_push(commands->pump, &gone)) {
            return false;
        }
        commands->aims = false;
    }
    return pump_push(commands->pump, update);
}

_Static_assert(TARGET_CAPACITY == 256U, "it is told so");

/// A new target, or a target's news, that a person or a script types.
static const char *watch(struct board_commands *commands, const struct target_update *update) {
    const struct target_set *targets = &commands->pump->controller->targets;
    uint32_t place;
    if (update->kind != TARGET_GONE && targets->count == TARGET_CAPACITY &&
        !target_set_find(targets, update->id, &place)) {
        return "256 targets are watched, and there is no room for more";
    }
    return board_commands_update(commands, update) ? NULL : "too many targets wait; try again";
}

static const char *aim(struct board_commands *commands, const struct target_update *update) {
    const struct target_update clear = {.kind = TARGET_CLEAR};
    if (!has_room(commands->pump, 2) || !pump_push_as_is(commands->pump, &clear) ||
        !pump_push_as_is(commands->pump, update)) {
        return "too many targets wait; try again";
    }
    commands->aims = true;
    return NULL;
}

static const char *look_home(struct board_commands *commands) {
    const struct controller *controller = commands->pump->controller;
    const struct controller_axis_config *axis = controller->config->axis;
    const struct mount_joints joints = {bam_from_q48(axis[AXIS_PAN].home_q48),
                                        bam_from_q48(axis[AXIS_TILT].home_q48)};
    const struct target_update update = {.kind = TARGET_DIRECTION,
                                         .id = REQUEST_AIM_ID,
                                         .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                         .direction = mount_direction(&controller->mount, joints)};
    return aim(commands, &update);
}

static const char *arm(struct board_commands *commands, const char *held) {
    if (held != NULL) {
        return held;
    }
    pump_command(commands->pump, COMMAND_ARM);
    return NULL;
}

void board_commands_stop_and_forget(struct board_commands *commands) {
    struct pump *pump = commands->pump;
    const struct target_update clear = {.kind = TARGET_CLEAR};
    pump_command(pump, COMMAND_STOP);
    pump_forget(pump); // what waits would come after it
    commands->aims = false;
    (void)!pump_push_as_is(pump, &clear);
}

const char *board_commands_do(struct board_commands *commands, const struct request *request,
                              const char *held, struct text *answer) {
    switch (request->kind) {
    case REQUEST_ARM:
        return arm(commands, held);
    case REQUEST_STOP:
        pump_command(commands->pump, COMMAND_STOP);
        return NULL;
    case REQUEST_HOME:
        return look_home(commands);
    case REQUEST_AIM:
        return aim(commands, &request->update);
    case REQUEST_UPDATE:
        return watch(commands, &request->update);
    case REQUEST_PAN:
        pump_pan(commands->pump,
                 &(struct controller_pan){request->choice, request->duration_us, request->path});
        return NULL;
    case REQUEST_GET:
        return board_settings_get(commands->settings, request->name, answer);
    case REQUEST_SET:
        return board_settings_set(commands->settings, request->name, request->value_micro,
                                  commands->pump->controller);
    case REQUEST_SCENE:
        if (commands->scene == NULL) {
            return "this image has no scene; see boards/README.md";
        }
        *commands->scene = (struct board_scene_mail){true, request->update.position_um};
        return NULL;
    default:
        return "not here";
    }
}
