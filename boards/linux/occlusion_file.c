#include "occlusion_file.h"

#include "scene_tree.h"

#include <stdlib.h>

#define UNIT_UM 1000U ///< without a scene: millimetres

static const char *const policies[] = {"ignore", "drop", "calm", "weigh", NULL};

#define OCCLUSION(member) .offset = offsetof(struct occlusion_file, member)
const struct ini_key occlusion_keys[OCCLUSION_KEYS] = {
    {.name = "policy",
     .type = INI_CHOICE,
     .fallback = "calm",
     .choices = policies,
     OCCLUSION(policy),
     .help = "calm: what is hidden for a moment counts on; weigh: and what stays hidden counts "
             "less; drop: what is hidden does not count; ignore: nothing is hidden"},
    {.name = "frame_ms",
     .type = INI_DECIMAL,
     .fallback = "40",
     .min = "1",
     .max = "1000",
     .numerator = 1000,
     OCCLUSION(frame_us),
     .help = "how often it is decided what is in sight"},
    {.name = "ahead_s",
     .type = INI_DECIMAL,
     .fallback = "3",
     .min = "0",
     .max = "10",
     .numerator = 1000000,
     OCCLUSION(ahead_us),
     .help = "calm, weigh: how far it looks ahead"},
    {.name = "fade_s",
     .type = INI_DECIMAL,
     .fallback = "0.8",
     .min = "0",
     .max = "10",
     .numerator = 1000000,
     OCCLUSION(fade_us),
     .help = "calm, weigh: how long a target takes to count or not"},
    {.name = "hidden_percent",
     .type = INI_DECIMAL,
     .fallback = "50",
     .min = "0",
     .max = "100",
     .numerator = 65536,
     .denominator = 100,
     OCCLUSION(hidden_q16),
     .help = "weigh: what a hidden target counts"},
    {.name = "scene",
     .type = INI_TEXT,
     .fallback = "",
     OCCLUSION(scene),
     .help = "a scene, in metres, whose solids and faces hide what is behind them; a board has it "
             "in its flash"},
};

bool occlusion_file_read(const struct occlusion_file *file, const struct ini *ini,
                         struct occlusion_settings *out) {
    *out = (struct occlusion_settings){.policy = (enum occlusion_policy)file->policy,
                                       .frame_us = (uint32_t)file->frame_us,
                                       .ahead_us = (uint32_t)file->ahead_us,
                                       .fade_us = (uint32_t)file->fade_us,
                                       .hidden_q16 = (uint32_t)file->hidden_q16};
    if (!occlusion_settings_valid(out)) {
        ini_complain(ini, "occlusion", "", "ahead_s",
                     "must be at least fade_s, and at most 128 frames");
        return false;
    }
    return true;
}

static enum exit_status read_scene(const char *path, struct scene_drawn *drawn,
                                   struct units *units) {
    struct scene_tree scene;
    enum exit_status status = scene_tree_read(path, true, &scene_build_default, &scene);
    if (status == EXIT_STATUS_OK) {
        drawn->finer = units_finer(&scene.tree);
        if (!units_of_tree(&scene.tree, drawn->finer, units)) {
            message_at(path, 0, "is too large, or too small, to hide anything");
            status = EXIT_STATUS_USAGE;
        } else {
            status = scene_drawn_gather(drawn, &scene.tree, NULL, path);
        }
    }
    if (status == EXIT_STATUS_OK) {
        status = scene_drawn_check(drawn, &scene.tree, path);
    }
    scene_tree_free(&scene);
    return status;
}

enum exit_status occlusion_solids_read(const char *path, uint32_t extra_boxes,
                                       struct scene_drawn *drawn, struct units *units) {
    drawn->extra_boxes = extra_boxes;
    *units = units_of_um(UNIT_UM);
    if (path != NULL) {
        return read_scene(path, drawn, units);
    }
    return scene_drawn_room(drawn, NULL) ? EXIT_STATUS_OK : EXIT_STATUS_FAILURE;
}

static bool start(struct occlusion_rig *rig) {
    const size_t bytes = occlusion_workspace_bytes(rig->config.shapes);
    rig->workspace = malloc(bytes + 8U);
    return rig->workspace != NULL &&
           occlusion_init(&rig->occlusion, &rig->config, rig->workspace, bytes);
}

enum exit_status occlusion_rig_open(const char *scene, const struct occlusion_settings *settings,
                                    struct vec3_i64 viewpoint_um, uint64_t expiry_us,
                                    struct occlusion_rig **out) {
    *out = NULL;
    if (scene == NULL || settings->policy == OCCLUSION_IGNORE) {
        return EXIT_STATUS_OK;
    }
    struct occlusion_rig *const rig = calloc(1, sizeof *rig);
    *out = rig;
    if (rig == NULL) {
        message_at(scene, 0, "no memory for this scene");
        return EXIT_STATUS_FAILURE;
    }
    struct units units;
    const enum exit_status status = occlusion_solids_read(scene, 0, &rig->drawn, &units);
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    rig->config = (struct occlusion_config){.shapes = &rig->drawn.set,
                                            .units = units,
                                            .viewpoint_um = viewpoint_um,
                                            .expiry_us = expiry_us,
                                            .settings = *settings};
    if (!start(rig)) {
        message_at(scene, 0, "the camera is too far away from it, or there is no memory");
        return EXIT_STATUS_USAGE;
    }
    return EXIT_STATUS_OK;
}

void occlusion_rig_close(struct occlusion_rig *rig) {
    if (rig != NULL) {
        scene_drawn_free(&rig->drawn);
        free(rig->workspace);
        free(rig);
    }
}
