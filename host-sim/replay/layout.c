#include "replay/layout.h"

#include "control/controller.h"

#include <stdlib.h>
#include <string.h>

#define MEMBER(structure, field) (((struct structure *)0)->field)
#define FIELD(structure, field, kind, type)                                                        \
    {                                                                                              \
#field, kind, offsetof(struct structure, field), sizeof MEMBER(structure, field),          \
            _Alignof(__typeof__(MEMBER(structure, field))), type, 0, 0, 0                          \
    }
#define SAME(structure, field)         FIELD(structure, field, LAYOUT_SAME, NULL)
#define ENUM(structure, field)         FIELD(structure, field, LAYOUT_ENUM, NULL)
#define SIGNED_ENUM(structure, field)  FIELD(structure, field, LAYOUT_SIGNED_ENUM, NULL)
#define POINTER(structure, field)      FIELD(structure, field, LAYOUT_POINTER, NULL)
#define STRUCT(structure, field, type) FIELD(structure, field, LAYOUT_STRUCT, &layout_##type)
#define LAYOUT(structure, table)                                                                   \
    { #structure, table, sizeof table / sizeof *table, sizeof(struct structure), 0, 0 }

// ---------------------------------------------------------------- inputs

static struct layout_field target_update_fields[] =
    {
        ENUM(target_update, kind),        SAME(target_update, id),
        SAME(target_update, object),      SAME(target_update, weight_q16),
        SAME(target_update, position_um), // a union, whose largest member this is
        SAME(target_update, radius_um),   // likewise
};
struct layout layout_target_update = LAYOUT(target_update, target_update_fields);

static struct layout_field controller_pan_fields[] = {
    SAME(controller_pan, choice),
    SAME(controller_pan, duration_us),
    ENUM(controller_pan, path),
};
struct layout layout_controller_pan = LAYOUT(controller_pan, controller_pan_fields);

static struct layout_field controller_input_fields[] = {
    SAME(controller_input, now_us),
    SAME(controller_input, commands),
    SAME(controller_input, pan_set),
    STRUCT(controller_input, pan, controller_pan),
    SAME(controller_input, frame_count),
    SAME(controller_input, update_count),
    SAME(controller_input, frame),
    SAME(controller_input, frame_us),
    STRUCT(controller_input, update, target_update),
};
struct layout layout_controller_input = LAYOUT(controller_input, controller_input_fields);

// ---------------------------------------------------------------- outputs

static struct layout_field framing_fields[] = {
    SIGNED_ENUM(framing, status),
    SAME(framing, ahead_q30),
    SAME(framing, half_angle_bam32),
    SAME(framing, is_picture),
    SAME(framing, half_width_bam32),
    SAME(framing, half_height_bam32),
    SAME(framing, pan_bam32),
    SAME(framing, tilt_bam32),
    SAME(framing, framed_count),
    SAME(framing, refining),
    SAME(framing, work),
};
static struct layout layout_framing = LAYOUT(framing, framing_fields);

static struct layout_field controller_status_fields[] = {
    SAME(controller_status, time_us),        ENUM(controller_status, mode),
    SAME(controller_status, faults),         SAME(controller_status, fault_axis),
    SAME(controller_status, axis),           STRUCT(controller_status, framing, framing),
    SAME(controller_status, panning),        SAME(controller_status, focal_um),
    SAME(controller_status, target_count),   SAME(controller_status, updates_rejected),
    SAME(controller_status, frames_ignored), SAME(controller_status, aims_solved),
};
static struct layout layout_controller_status = LAYOUT(controller_status, controller_status_fields);

static struct layout_field controller_output_fields[] = {
    SAME(controller_output, frame_count), SAME(controller_output, frame),
    SAME(controller_output, pulse_set),   SAME(controller_output, pulse_channel),
    SAME(controller_output, pulse_ns),    STRUCT(controller_output, status, controller_status),
};
struct layout layout_controller_output = LAYOUT(controller_output, controller_output_fields);

// ---------------------------------------------------------------- settings

static struct layout_field drive_config_fields[] = {
    ENUM(drive_config, kind), SAME(drive_config, rmd), // a union, as long as its other member
};
static struct layout layout_drive_config = LAYOUT(drive_config, drive_config_fields);
_Static_assert(sizeof(struct drive_rmd_config) >= sizeof(struct drive_pwm_config),
               "the longest member of the union stands for it");

static struct layout_field controller_axis_config_fields[] = {
    SAME(controller_axis_config, limits),
    STRUCT(controller_axis_config, drive, drive_config),
    SAME(controller_axis_config, home_q48),
    SAME(controller_axis_config, latency_us),
};
static struct layout layout_controller_axis_config =
    LAYOUT(controller_axis_config, controller_axis_config_fields);

static struct layout_field controller_config_fields[] = {
    SAME(controller_config, tick_us),
    SAME(controller_config, position_um),
    SAME(controller_config, attitude),
    STRUCT(controller_config, axis, controller_axis_config),
    SAME(controller_config, lens),
    ENUM(controller_config, frame),
    SAME(controller_config, target_expiry_us),
    SAME(controller_config, tracker),
    SAME(controller_config, silence_us),
    SAME(controller_config, settle_us),
    SAME(controller_config, follow_error_q48),
    SAME(controller_config, follow_error_us),
    SAME(controller_config, arm_on_start),
};
struct layout layout_controller_config = LAYOUT(controller_config, controller_config_fields);

// ---------------------------------------------------------------- the controller

static struct layout_field limiter_fields[] = {
    POINTER(limiter, config),   SAME(limiter, position_q48),   SAME(limiter, speed_q48),
    SAME(limiter, recent_q48),  SAME(limiter, recent_sum_q48), SAME(limiter, recent_next),
    SAME(limiter, still_ticks), SAME(limiter, output_q48),     SAME(limiter, output_speed_q48),
};
static struct layout layout_limiter = LAYOUT(limiter, limiter_fields);

static struct layout_field drive_fields[] = {
    POINTER(drive, config),    SAME(drive, ready),         SAME(drive, position_known),
    SAME(drive, position_q48), SAME(drive, position_us),   SAME(drive, heard_us),
    SAME(drive, error_bits),   SAME(drive, temperature_c), SAME(drive, accel_plan_dps2),
    SAME(drive, asked),        SAME(drive, bad_replies),
};
static struct layout layout_drive = LAYOUT(drive, drive_fields);

static struct layout_field controller_view_fields[] = {
    SAME(controller_view, choice),
    SAME(controller_view, memory),
    STRUCT(controller_view, framing, framing),
    SAME(controller_view, framed_version),
    SAME(controller_view, held),
};
static struct layout layout_controller_view = LAYOUT(controller_view, controller_view_fields);

static struct layout_field controller_fields[] = {
    POINTER(controller, config),
    SAME(controller, mount),
    SAME(controller, targets),
    SAME(controller, framing_workspace),
    STRUCT(controller, framing, framing),
    STRUCT(controller, view, controller_view),
    STRUCT(controller, from, controller_view),
    SAME(controller, panning),
    SAME(controller, pan_started_us),
    SAME(controller, pan_duration_us),
    ENUM(controller, pan_path),
    SAME(controller, framed_version),
    SAME(controller, refining_ticks),
    SAME(controller, full_ticks),
    SAME(controller, aim_reports),
    STRUCT(controller, limiter, limiter),
    STRUCT(controller, drive, drive),
    SAME(controller, tracker),
    SAME(controller, goal_q48),
    SAME(controller, goal_rate_q48),
    SAME(controller, setpoint_q48),
    SAME(controller, powered),
    SAME(controller, ever_powered),
    SAME(controller, restarts),
    SAME(controller, following_since_us),
    SAME(controller, time_us),
    SAME(controller, settled_us),
    SAME(controller, last_now_us),
    SAME(controller, tick),
    SAME(controller, late_ticks),
    SAME(controller, started),
    SAME(controller, arm_wanted),
    ENUM(controller, mode),
    SAME(controller, faults),
    SAME(controller, fault_axis),
    SAME(controller, zoom_joints),
    SAME(controller, zoom_version),
    SAME(controller, updates_rejected),
    SAME(controller, frames_ignored),
    SAME(controller, aims_solved),
};
struct layout layout_controller = LAYOUT(controller, controller_fields);

static struct layout *const all[] = {&layout_target_update,
                                     &layout_controller_pan,
                                     &layout_controller_input,
                                     &layout_framing,
                                     &layout_controller_status,
                                     &layout_controller_output,
                                     &layout_drive_config,
                                     &layout_controller_axis_config,
                                     &layout_controller_config,
                                     &layout_limiter,
                                     &layout_drive,
                                     &layout_controller_view,
                                     &layout_controller};

// ---------------------------------------------------------------- over there

static uint32_t align_up(uint32_t at, uint32_t align) {
    return (at + align - 1U) / align * align;
}

/// Lays a structure out as the EABI says, once.
static void measure(struct layout *layout) {
    if (layout->arm_bytes != 0U) {
        return;
    }
    uint32_t at = 0;
    layout->arm_align = 1;
    for (unsigned i = 0; i < layout->field_count; i++) {
        struct layout_field *field = &layout->fields[i];
        uint32_t bytes = 1, align = 1; // an enum
        field->count = 1;
        if (field->kind == LAYOUT_SAME) {
            bytes = field->host_bytes;
            align = field->align;
        } else if (field->kind == LAYOUT_POINTER) {
            bytes = align = 4;
        } else if (field->kind == LAYOUT_STRUCT) {
            measure(field->type);
            field->count = field->host_bytes / field->type->host_bytes;
            bytes = field->type->arm_bytes * field->count;
            align = field->type->arm_align;
        }
        field->arm_at = align_up(at, align);
        field->arm_bytes = bytes;
        at = field->arm_at + bytes;
        layout->arm_align = align > layout->arm_align ? align : layout->arm_align;
    }
    layout->arm_bytes = align_up(at, layout->arm_align);
}

uint32_t layout_arm_bytes(struct layout *layout) {
    measure(layout);
    return layout->arm_bytes;
}

uint32_t layout_arm_offset(struct layout *layout, const char *field) {
    measure(layout);
    for (unsigned i = 0; i < layout->field_count; i++) {
        if (strcmp(layout->fields[i].name, field) == 0) {
            return layout->fields[i].arm_at;
        }
    }
    abort(); // a name that was mistyped here
}

// ---------------------------------------------------------------- translation

/// One field that is not a structure.
static void copy_to_host(const struct layout_field *field, const uint8_t *arm, uint8_t *host) {
    int32_t value = 0;
    switch (field->kind) {
    case LAYOUT_SAME:
        memcpy(host, arm, field->host_bytes);
        break;
    case LAYOUT_ENUM:
    case LAYOUT_SIGNED_ENUM:
        value = field->kind == LAYOUT_ENUM ? (int32_t)*arm : (int32_t)(int8_t)*arm;
        memcpy(host, &value, sizeof value);
        break;
    default:
        memset(host, 0, field->host_bytes);
        break;
    }
}

static void copy_to_arm(const struct layout_field *field, const uint8_t *host, uint8_t *arm) {
    switch (field->kind) {
    case LAYOUT_SAME:
        memcpy(arm, host, field->host_bytes);
        break;
    case LAYOUT_ENUM:
    case LAYOUT_SIGNED_ENUM:
        *arm = *host; // the lowest byte
        break;
    default:
        memset(arm, 0, 4);
        break;
    }
}

void layout_to_host(struct layout *layout, const void *arm, void *host) {
    measure(layout);
    for (unsigned i = 0; i < layout->field_count; i++) {
        const struct layout_field *field = &layout->fields[i];
        const uint8_t *from = (const uint8_t *)arm + field->arm_at;
        uint8_t *to = (uint8_t *)host + field->host_at;
        if (field->kind != LAYOUT_STRUCT) {
            copy_to_host(field, from, to);
            continue;
        }
        for (uint32_t k = 0; k < field->count; k++) {
            layout_to_host(field->type, from + k * field->type->arm_bytes,
                           to + k * field->type->host_bytes);
        }
    }
}

void layout_to_arm(struct layout *layout, const void *host, void *arm) {
    measure(layout);
    memset(arm, 0, layout->arm_bytes);
    for (unsigned i = 0; i < layout->field_count; i++) {
        const struct layout_field *field = &layout->fields[i];
        const uint8_t *from = (const uint8_t *)host + field->host_at;
        uint8_t *to = (uint8_t *)arm + field->arm_at;
        if (field->kind != LAYOUT_STRUCT) {
            copy_to_arm(field, from, to);
            continue;
        }
        for (uint32_t k = 0; k < field->count; k++) {
            layout_to_arm(field->type, from + k * field->type->host_bytes,
                          to + k * field->type->arm_bytes);
        }
    }
}

// ---------------------------------------------------------------- for the test

void layout_write_assertions(FILE *stream, bool arm) {
    fprintf(stream, "#include \"control/controller.h\"\n#include <stddef.h>\n");
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        struct layout *layout = all[i];
        measure(layout);
        for (unsigned k = 0; k < layout->field_count; k++) {
            const struct layout_field *field = &layout->fields[k];
            const uint32_t at = arm ? field->arm_at : field->host_at;
            const uint32_t bytes = arm ? field->arm_bytes : field->host_bytes;
            fprintf(stream,
                    "_Static_assert(offsetof(struct %s, %s) == %uU && "
                    "sizeof(((struct %s *)0)->%s) == %uU, \"struct %s: %s\");\n",
                    layout->name, field->name, at, layout->name, field->name, bytes, layout->name,
                    field->name);
        }
        fprintf(stream, "_Static_assert(sizeof(struct %s) == %uU, \"struct %s: its size\");\n",
                layout->name, arm ? layout->arm_bytes : layout->host_bytes, layout->name);
    }
}
