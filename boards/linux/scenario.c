#include "scenario.h"

#include "ini_schema.h"
#include "scenario_event.h"
#include "scenario_movers.h"
#include "scenario_targets.h"
#include "scenario_world.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOVERS_MOST = 64 };

struct scenario_run {
    const char *name, *about, *rig;
    int64_t duration_us, seed, tick_us, clock_start_us, loss_ppm;
    struct ini_numbers start_mdeg;
    bool arm;
};

struct scenario_targets {
    const char *file;
    int format;
    struct star_show show;
    struct box_camera boxes;
};

struct scenario_file {
    struct scenario_run run;
    bool has_targets, has_occlusion;
    struct scenario_targets targets;
    bool has_camera;
    struct scenario_camera_keys camera;
    uint32_t mover_count, event_count;
    struct scenario_mover mover[MOVERS_MOST];
    struct scenario_event event[SCENARIO_EVENTS_MAX];
    struct scenario_world_file world;
};

enum { FORMAT_JSONL, FORMAT_STARS, FORMAT_BOXES };
static const char *const formats[] = {"jsonl", "stars", "boxes", NULL};

#define RUN(member) .offset = offsetof(struct scenario_run, member)
static const struct ini_key run_keys[] = {
    {.name = "name", .type = INI_TEXT, RUN(name), .help = "what it shows"},
    {.name = "about", .type = INI_TEXT, .fallback = "", RUN(about), .help = "a sentence about it"},
    {.name = "rig", .type = INI_TEXT, RUN(rig), .help = "the rig file"},
    {.name = "seconds",
     .type = INI_DECIMAL,
     .min = "0.001",
     .max = "4000000",
     .numerator = 1000000,
     RUN(duration_us),
     .help = "how long it runs"},
    {.name = "seed",
     .type = INI_WHOLE,
     .fallback = "1",
     .min = "0",
     RUN(seed),
     .help = "of everything random"},
    {.name = "tick_us",
     .type = INI_WHOLE,
     .fallback = "0",
     .min = "0",
     .max = "20000",
     RUN(tick_us),
     .help = "of the controller; 0: as in the rig file"},
    {.name = "clock_start_us",
     .type = INI_WHOLE,
     .fallback = "0",
     .min = "0",
     .max = "4294967295",
     RUN(clock_start_us),
     .help = "what the controller's clock reads at first"},
    {.name = "can_loss_percent",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "100",
     .numerator = 10000,
     RUN(loss_ppm),
     .help = "frames that nobody hears"},
    {.name = "start_deg",
     .type = INI_DECIMAL_LIST,
     .fallback = "0, 0",
     .min = "-180",
     .max = "180",
     .numerator = 1000,
     RUN(start_mdeg),
     .help = "pan and tilt at power-on"},
    {.name = "arm",
     .type = INI_YES_NO,
     .fallback = "yes",
     RUN(arm),
     .help = "arm as soon as the axes are homed"},
};

#define TARGETS(member) .offset = offsetof(struct scenario_targets, member)
static const struct ini_key target_keys[] = {
    {.name = "file", .type = INI_TEXT, TARGETS(file), .help = "where they come from"},
    {.name = "format",
     .type = INI_CHOICE,
     .fallback = "jsonl",
     .choices = formats,
     TARGETS(format),
     .help = "jsonl: a target stream; stars: a catalogue; boxes: a detector's, by frame"},
    {.name = "figures",
     .type = INI_TEXT_LIST,
     .fallback = "Ori",
     TARGETS(show.figures),
     .help = "stars: constellations to show, in order"},
    {.name = "dwell_s",
     .type = INI_DECIMAL,
     .fallback = "6",
     .min = "0.1",
     .max = "3600",
     .numerator = 1000000,
     TARGETS(show.dwell_us),
     .help = "stars: time for each"},
    {.name = "start_s",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "3600",
     .numerator = 1000000,
     TARGETS(show.start_us),
     .help = "stars: when the first one begins"},
    {.name = "latitude_deg",
     .type = INI_DECIMAL,
     .fallback = "45",
     .min = "-90",
     .max = "90",
     .numerator = 1000000,
     TARGETS(show.latitude_udeg),
     .help = "stars: of the observer"},
    {.name = "sidereal_h",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "24",
     .numerator = UINT64_C(3600000000),
     TARGETS(show.sidereal_us),
     .help = "stars: local sidereal time"},
    {.name = "width_px",
     .type = INI_WHOLE,
     .fallback = "768",
     .min = "1",
     .max = "100000",
     TARGETS(boxes.width_px),
     .help = "boxes: of the detector's picture"},
    {.name = "height_px",
     .type = INI_WHOLE,
     .fallback = "576",
     .min = "1",
     .max = "100000",
     TARGETS(boxes.height_px),
     .help = "boxes: likewise"},
    {.name = "hfov_deg",
     .type = INI_DECIMAL,
     .fallback = "60",
     .min = "1",
     .max = "170",
     .numerator = 1000000,
     TARGETS(boxes.hfov_udeg),
     .help = "boxes: horizontal field of view"},
    {.name = "score_min",
     .type = INI_DECIMAL,
     .fallback = "0.5",
     .numerator = 1000,
     TARGETS(boxes.score_min_millis),
     .help = "boxes: only those above it count"},
    {.name = "frame_ms",
     .type = INI_DECIMAL,
     .fallback = "100",
     .min = "1",
     .max = "60000",
     .numerator = 1000,
     TARGETS(boxes.frame_us),
     .help = "boxes: time between frames"},
};

#define TABLE(table) .keys = table, .key_count = sizeof table / sizeof *table
static const struct ini_section sections[] = {
    {.name = "scenario",
     TABLE(run_keys),
     .offset = offsetof(struct scenario_file, run),
     .help = "what runs"},
    {.name = "targets",
     .presence = INI_OPTIONAL,
     TABLE(target_keys),
     .offset = offsetof(struct scenario_file, targets),
     .seen_offset = offsetof(struct scenario_file, has_targets),
     .help = "targets from a file"},
    {.name = "camera",
     .presence = INI_OPTIONAL,
     .keys = scenario_camera_keys,
     .key_count = SCENARIO_CAMERA_KEY_COUNT,
     .offset = offsetof(struct scenario_file, camera),
     .seen_offset = offsetof(struct scenario_file, has_camera),
     .help = "the controller hears of the targets only through the rig's camera"},
    {.name = "mover",
     .presence = INI_MANY,
     .keys = scenario_mover_keys,
     .key_count = SCENARIO_MOVER_KEY_COUNT,
     .offset = offsetof(struct scenario_file, mover),
     .seen_offset = offsetof(struct scenario_file, mover_count),
     .stride = sizeof(struct scenario_mover),
     .most = MOVERS_MOST,
     .label_offset = offsetof(struct scenario_mover, label),
     .help = "a target that moves"},
    {.name = "event",
     .presence = INI_MANY,
     .keys = scenario_event_keys,
     .key_count = SCENARIO_EVENT_KEY_COUNT,
     .offset = offsetof(struct scenario_file, event),
     .seen_offset = offsetof(struct scenario_file, event_count),
     .stride = sizeof(struct scenario_event),
     .most = SCENARIO_EVENTS_MAX,
     .label_offset = offsetof(struct scenario_event, label),
     .help = "a command at a time"},
    {.name = "obstacle",
     .presence = INI_MANY,
     TABLE(scenario_obstacle_keys),
     .offset = offsetof(struct scenario_file, world.obstacle),
     .seen_offset = offsetof(struct scenario_file, world.obstacle_count),
     .stride = sizeof(struct scenario_obstacle),
     .most = OBSTACLES_MOST,
     .label_offset = offsetof(struct scenario_obstacle, label),
     .help = "a box that hides what is behind it"},
    {.name = "scene",
     .presence = INI_OPTIONAL,
     TABLE(scenario_scene_keys),
     .offset = offsetof(struct scenario_file, world.scene),
     .seen_offset = offsetof(struct scenario_file, world.has_scene),
     .help = "solids that stand still"},
    {.name = "flight",
     .presence = INI_OPTIONAL,
     TABLE(scenario_flight_keys),
     .offset = offsetof(struct scenario_file, world.flight),
     .seen_offset = offsetof(struct scenario_file, world.has_flight),
     .help = "the camera itself moves"},
    {.name = "occlusion",
     .presence = INI_OPTIONAL,
     .keys = occlusion_keys,
     .key_count = OCCLUSION_KEYS - 1,
     .offset = offsetof(struct scenario_file, world.occlusion),
     .seen_offset = offsetof(struct scenario_file, has_occlusion),
     .help = "what hidden targets count"},
};
static const struct ini_schema schema = {sections, sizeof sections / sizeof *sections};

// ---------------------------------------------------------------- what the sections mean

static enum exit_status read_targets(const struct scenario_file *file, struct scenario *out) {
    if (!file->has_targets) {
        return EXIT_STATUS_OK;
    }
    const char *targets = ini_beside(&out->ini, file->targets.file);
    if (targets == NULL) {
        return EXIT_STATUS_FAILURE;
    }
    switch (file->targets.format) {
    case FORMAT_STARS:
        return load_stars(targets, &file->targets.show, &out->schedule);
    case FORMAT_BOXES:
        return load_boxes(targets, &file->targets.boxes, &out->schedule);
    default:
        return load_json_lines(targets, &out->schedule);
    }
}

/// The rig's scene and settings, if the scenario has no own.
static enum exit_status read_world(const struct scenario_file *file, struct scenario *out) {
    const char *scene = out->rig.scene;
    struct occlusion_settings settings = out->rig.occlusion;
    if (file->world.has_scene) {
        scene = ini_beside(&out->ini, file->world.scene.file);
        if (scene == NULL) {
            return EXIT_STATUS_FAILURE;
        }
    }
    if ((file->has_occlusion || !out->rig.has_occlusion) &&
        !occlusion_file_read(&file->world.occlusion, &out->ini, &settings)) {
        return EXIT_STATUS_USAGE;
    }
    return scenario_world_read(&file->world, &out->ini, scene, &settings,
                               out->rig.controller.position_um, &out->schedule, &out->world);
}

static void fill_sim(const struct scenario_file *file, struct scenario *out) {
    out->sim = (struct sim_config){.controller = &out->rig.controller,
                                   .schedule = &out->schedule,
                                   .commands = out->commands,
                                   .command_count = out->command_count,
                                   .seed = (uint64_t)file->run.seed,
                                   .start_us = (uint32_t)file->run.clock_start_us,
                                   .can_loss = (double)file->run.loss_ppm * 1e-6,
                                   .obstacles = scenario_world_obstacles(out->world),
                                   .fixed_focal_mm = out->rig.fixed_focal_mm};
    out->sim.start_deg[0] = (double)file->run.start_mdeg.item[0] * 1e-3;
    out->sim.start_deg[1] = (double)file->run.start_mdeg.item[1] * 1e-3;
    out->rig.controller.arm_on_start = file->run.arm;
}

static enum exit_status build(const struct scenario_file *file, struct scenario *out) {
    if (file->run.start_mdeg.count != 2U) {
        ini_complain(&out->ini, "scenario", "", "start_deg", "needs two values: pan, tilt");
        return EXIT_STATUS_USAGE;
    }
    if (file->run.tick_us != 0 && file->run.tick_us < 100) {
        ini_complain(&out->ini, "scenario", "", "tick_us", "must be 0, or 100 to 20000");
        return EXIT_STATUS_USAGE;
    }
    out->name = file->run.name;
    out->about = file->run.about;
    out->duration_us = (uint64_t)file->run.duration_us;
    const char *rig = ini_beside(&out->ini, file->run.rig);
    enum exit_status status =
        rig == NULL ? EXIT_STATUS_FAILURE : rig_read(rig, (uint32_t)file->run.tick_us, &out->rig);
    if (status == EXIT_STATUS_OK) {
        status = read_targets(file, out);
    }
    if (status == EXIT_STATUS_OK &&
        !scenario_movers_add(file->mover, file->mover_count, &out->ini, &out->schedule)) {
        status = EXIT_STATUS_USAGE;
    }
    if (status == EXIT_STATUS_OK) {
        status = read_world(file, out);
    }
    out->command_count = file->event_count;
    scenario_read_events(file->event, file->event_count, out->commands);
    fill_sim(file, out);
    if (status == EXIT_STATUS_OK && file->has_camera) {
        out->has_camera = true;
        out->camera.keys = file->camera;
        status = scenario_camera_open(&out->camera, &out->rig, &out->ini, out->sim.seed);
        out->sim.camera = &out->camera.hook;
    }
    return status;
}

enum exit_status scenario_read(const char *path, struct scenario *out) {
    memset(out, 0, sizeof *out);
    schedule_init(&out->schedule);
    struct scenario_file *file = calloc(1, sizeof *file);
    if (file == NULL) {
        message_at(path, 0, "no memory for it");
        return EXIT_STATUS_FAILURE;
    }
    enum exit_status status = ini_read(path, &out->ini);
    if (status == EXIT_STATUS_OK) {
        status = ini_apply(&out->ini, &schema, file);
    }
    if (status == EXIT_STATUS_OK) {
        status = build(file, out);
    }
    free(file);
    return status;
}

void scenario_free(struct scenario *scenario) {
    if (scenario->has_camera) {
        scenario_camera_close(&scenario->camera);
    }
    schedule_free(&scenario->schedule);
    scenario_world_free(scenario->world);
    rig_free(&scenario->rig);
    ini_free(&scenario->ini);
}
