#include "rig_c.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static void write_limits(const struct limiter_config *limits, FILE *stream) {
    fprintf(stream,
            "            .limits = {.min_q48 = INT64_C(%" PRId64 "),\n"
            "                       .max_q48 = INT64_C(%" PRId64 "),\n"
            "                       .speed_max_q48 = INT64_C(%" PRId64 "),\n"
            "                       .accel_max_q48 = INT64_C(%" PRId64 "),\n"
            "                       .smooth_ticks = %" PRIu32 "U},\n",
            limits->min_q48, limits->max_q48, limits->speed_max_q48, limits->accel_max_q48,
            limits->smooth_ticks);
}

static void write_drive(const struct drive_config *drive, FILE *stream) {
    if (drive->kind == DRIVE_RMD) {
        const struct drive_rmd_config *rmd = &drive->rmd;
        fprintf(stream,
                "            .drive = {.kind = DRIVE_RMD,\n"
                "                      .rmd = {.id = %" PRIu8 "U,\n"
                "                              .reply_offset = 0x%" PRIx32 "U,\n"
                "                              .reversed = %s,\n"
                "                              .zero_q48 = INT64_C(%" PRId64 "),\n"
                "                              .speed_max_dps = %" PRIu16 "U,\n"
                "                              .watchdog_ms = %" PRIu32 "U}},\n",
                rmd->id, rmd->reply_offset, rmd->reversed ? "true" : "false", rmd->zero_q48,
                rmd->speed_max_dps, rmd->watchdog_ms);
    } else {
        const struct drive_pwm_config *pwm = &drive->pwm;
        fprintf(stream,
                "            .drive = {.kind = DRIVE_PWM,\n"
                "                      .pwm = {.channel = %" PRIu32 "U,\n"
                "                              .low_q48 = INT64_C(%" PRId64 "),\n"
                "                              .high_q48 = INT64_C(%" PRId64 "),\n"
                "                              .low_pulse_ns = %" PRIu32 "U,\n"
                "                              .high_pulse_ns = %" PRIu32 "U}},\n",
                pwm->channel, pwm->low_q48, pwm->high_q48, pwm->low_pulse_ns, pwm->high_pulse_ns);
    }
}

static void write_axes(const struct controller_config *config, FILE *stream) {
    static const char *const names[] = {"AXIS_PAN", "AXIS_TILT", "AXIS_ZOOM"};
    fprintf(stream, "    .axis = {\n");
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (config->axis[axis].drive.kind == DRIVE_NONE) {
            continue;
        }
        fprintf(stream, "        [%s] = {\n", names[axis]);
        write_limits(&config->axis[axis].limits, stream);
        write_drive(&config->axis[axis].drive, stream);
        fprintf(stream,
                "            .home_q48 = INT64_C(%" PRId64 "),\n"
                "            .latency_us = %" PRIu32 "U},\n",
                config->axis[axis].home_q48, config->axis[axis].latency_us);
    }
    fprintf(stream, "    },\n");
}

static void write_lens(const struct lens_config *lens, FILE *stream) {
    fprintf(stream, "    .lens = {.point_count = %" PRIu32 "U,\n             .point = {\n",
            lens->point_count);
    if (lens->point_count == 0U) {
        fprintf(stream, "                 {0},\n");
    }
    for (uint32_t i = 0; i < lens->point_count; i++) {
        fprintf(stream,
                "                 {.focal_um = %" PRIu32 "U, .position_q48 = INT64_C(%" PRId64
                ")},\n",
                lens->point[i].focal_um, lens->point[i].position_q48);
    }
    fprintf(stream,
            "             },\n"
            "             .sensor_width_um = %" PRIu32 "U,\n"
            "             .sensor_height_um = %" PRIu32 "U,\n"
            "             .margin_q16 = %" PRIu32 "U},\n",
            lens->sensor_width_um, lens->sensor_height_um, lens->margin_q16);
}

static void write_occlusion(const struct rig *rig, FILE *stream) {
    static const char *const policies[] = {"OCCLUSION_IGNORE", "OCCLUSION_DROP", "OCCLUSION_CALM",
                                           "OCCLUSION_WEIGH"};
    const struct occlusion_settings *const s = &rig->occlusion;
    fprintf(stream,
            "\nconst struct occlusion_settings compiled_occlusion = {\n"
            "    .policy = %s,\n"
            "    .frame_us = %" PRIu32 "U,\n"
            "    .ahead_us = %" PRIu32 "U,\n"
            "    .fade_us = %" PRIu32 "U,\n"
            "    .hidden_q16 = %" PRIu32 "U};\n",
            policies[rig->has_occlusion ? s->policy : OCCLUSION_IGNORE], s->frame_us, s->ahead_us,
            s->fade_us, s->hidden_q16);
}

static const char *file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

void rig_write_c(const struct rig *rig, const char *path, FILE *stream) {
    const struct controller_config *config = &rig->controller;
    fprintf(stream,
            "// Made by `boresight config c` from %s: change that, not this.\n"
            "#include \"compiled_rig.h\"\n\n"
            "const struct controller_config compiled_rig = {\n",
            file_name(path));
    fprintf(stream,
            "    .tick_us = %" PRIu32 "U,\n"
            "    .position_um = {INT64_C(%" PRId64 "), INT64_C(%" PRId64 "), INT64_C(%" PRId64
            ")},\n"
            "    .attitude = {.heading = {%" PRIu32 "U}, .pitch = {%" PRIu32 "U}, .roll = {%" PRIu32
            "U}},\n",
            config->tick_us, config->position_um.x, config->position_um.y, config->position_um.z,
            config->attitude.heading.bam, config->attitude.pitch.bam, config->attitude.roll.bam);
    write_axes(config, stream);
    write_lens(&config->lens, stream);
    fprintf(stream, "    .frame = %s,\n",
            config->frame == CONTROLLER_FRAME_RECT ? "CONTROLLER_FRAME_RECT"
                                                   : "CONTROLLER_FRAME_CONE");
    fprintf(stream,
            "    .target_expiry_us = UINT64_C(%" PRIu64 "),\n"
            "    .tracker = {.jump_q48 = INT64_C(%" PRId64 "), .memory_q16 = %" PRIu32
            "U, .coast_ticks = %" PRIu32 "U},\n"
            "    .silence_us = %" PRIu32 "U,\n"
            "    .settle_us = %" PRIu32 "U,\n"
            "    .follow_error_q48 = INT64_C(%" PRId64 "),\n"
            "    .follow_error_us = %" PRIu32 "U,\n"
            "    .arm_on_start = %s};\n",
            config->target_expiry_us, config->tracker.jump_q48, config->tracker.memory_q16,
            config->tracker.coast_ticks, config->silence_us, config->settle_us,
            config->follow_error_q48, config->follow_error_us,
            config->arm_on_start ? "true" : "false");
    write_occlusion(rig, stream);
}
