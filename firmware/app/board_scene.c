#include "app/board_scene.h"

#define HIDDEN_EVERY_TICKS 256U ///< the line about hidden targets

static struct text tell(struct board_scene *scene, const char *what) {
    struct text text;
    text_begin(&text, scene->told, sizeof scene->told - 1U);
    text_string(&text, "scene: ");
    text_string(&text, what);
    return text;
}

static void end(const struct text *text) {
    text->buffer[text->size_bytes] = '\0';
}

static void say(struct board_scene *scene, const char *what) {
    const struct text text = tell(scene, what);
    end(&text);
}

void board_scene_open(struct board_scene *scene, const void *block, uint32_t size_bytes) {
    size_t fault_offset = 0;
    scene->runs = scene->asked_to_hide = false;
    scene->hides = BOARD_SHADOWS_NONE;
    scene->hidden[0] = '\0';
    scene->mail = (struct board_scene_mail){.asked = false};
    scene->refusal = NULL;
    if (tree_open(block, size_bytes, &scene->tree, &fault_offset) != TREE_OK) {
        scene->refusal = "the scene is damaged";
        struct text text = tell(scene, "damaged at offset ");
        text_unsigned(&text, (uint32_t)fault_offset, 0);
        end(&text);
        return;
    }
    struct text text = tell(scene, "");
    text_unsigned(&text, scene->tree.header->point_count, 0);
    text_string(&text, " points; `scene X Y Z` aims at them");
    end(&text);
}

// ---------------------------------------------------------------- hidden targets

/// Since the shadows were cast, or why there are none.
static void tell_hidden(struct board_scene *scene) {
    static const char *const why[] = {"", "no solids and no faces in the scene",
                                      "nothing: the scene has too many solids, or too large ones",
                                      "nothing: a solid is not convex, or a face not flat",
                                      "nothing: the gimbal is too far from the scene"};
    const struct occlusion *const o = &scene->shadows.occlusion;
    struct text text;
    text_begin(&text, scene->hidden, sizeof scene->hidden - 1U);
    text_string(&text, "hidden: ");
    if (scene->hides != BOARD_SHADOWS_OK) {
        text_string(&text, why[-(int)scene->hides]);
        end(&text);
        return;
    }
    uint32_t hidden = 0;
    for (uint32_t i = 0; i < o->target_count; i++) {
        hidden += o->target[i].samples == 0U && o->target[i].look.number != 0U;
    }
    text_unsigned(&text, hidden, 0);
    text_string(&text, " of ");
    text_unsigned(&text, o->target_count, 0);
    text_string(&text, " targets, by ");
    text_unsigned(&text, scene->shadows.solids, 0);
    text_string(&text, " solids or faces; a look took ");
    text_unsigned(&text, o->look_us / 1000U, 0);
    text_string(&text, " ms");
    end(&text);
}

void board_scene_hide(struct board_scene *scene, const struct controller_config *rig,
                      const struct occlusion_settings *settings) {
    scene->asked_to_hide = settings->policy != OCCLUSION_IGNORE && scene->refusal == NULL;
    if (scene->asked_to_hide) {
        scene->hides = board_shadows_cast(&scene->shadows, &scene->tree, rig->position_um,
                                          rig->target_expiry_us, settings, &scene->casting);
        tell_hidden(scene);
    }
}

static void hide(struct board_scene *scene, struct board_loop *loop) {
    if (scene->asked_to_hide && scene->hides == BOARD_SHADOWS_OK) {
        pump_occlusion_step(&scene->shadows.stage, &loop->pump);
        if (loop->ticks % HIDDEN_EVERY_TICKS == 0U) {
            tell_hidden(scene);
        }
    }
}

static bool hide_more(struct board_scene *scene) {
    return scene->asked_to_hide && scene->hides == BOARD_SHADOWS_OK &&
           occlusion_work(&scene->shadows.occlusion, scene->shadows.stage.time_us);
}

// ---------------------------------------------------------------- the aim at all of it

void board_scene_attach(struct board_scene *scene, struct board_loop *loop) {
    loop->console.commands.scene = &scene->mail;
    loop->status.scene = scene->told;
    if (scene->asked_to_hide) {
        loop->status.hidden = scene->hidden;
    }
    if (scene->asked_to_hide && scene->hides == BOARD_SHADOWS_OK) {
        pump_occlusion_attach(&scene->shadows.stage, &loop->pump, &scene->shadows.occlusion, false);
    }
}

bool board_scene_units(const struct tree *tree, int64_t um, int32_t *units) {
    struct units scale;
    if (!units_of_tree(tree, 0, &scale)) {
        return false;
    }
    const int64_t value = units_from_um(scale, um);
    if (value > TREE_COORDINATE_MAX || value < -TREE_COORDINATE_MAX) {
        return false;
    }
    *units = (int32_t)value;
    return true;
}

static void start(struct board_scene *scene) {
    const struct vec3_i64 *const from = &scene->mail.viewpoint_um;
    struct scene_aim_options options = {.focal_px_q8 = 0};
    scene->mail.asked = false;
    scene->runs = false;
    if (scene->refusal != NULL) {
        return;
    }
    if (!board_scene_units(&scene->tree, from->x, &options.eye.x) ||
        !board_scene_units(&scene->tree, from->y, &options.eye.y) ||
        !board_scene_units(&scene->tree, from->z, &options.eye.z)) {
        say(scene, "that is too far away from it");
        return;
    }
    say(scene, "looking for its cone");
    scene_aim_start(&scene->run, &scene->tree, &options, &scene->memory, &scene->result);
    scene->runs = true;
}

/// The cone becomes what is aimed at.
static void aim(struct board_scene *scene, struct board_loop *loop) {
    const struct cone_result *const cone = &scene->result.cone;
    const struct request request = {.kind = REQUEST_AIM,
                                    .update = {.kind = TARGET_DIRECTION,
                                               .id = REQUEST_AIM_ID,
                                               .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                               .direction = cone->axis_q30,
                                               .radius_bam32 = cone->half_angle_bam32.bam}};
    char nothing[1];
    struct text answer;
    text_begin(&answer, nothing, 0);
    const char *const wrong = board_commands_do(&loop->console.commands, &request, NULL, &answer);
    if (wrong != NULL) {
        say(scene, wrong);
        return;
    }
    struct text text = tell(scene, "aimed at; half-angle ");
    text_hundredths(&text, (int64_t)((cone->half_angle_turn64 >> 32) * 36000U >> 32), 0);
    text_string(&text, " degrees, ");
    text_unsigned(&text, (uint32_t)scene->result.point_reads, 0);
    text_string(&text, " reads of ");
    text_unsigned(&text, scene->tree.header->point_count, 0);
    text_string(&text, " points");
    end(&text);
}

static void finish(struct board_scene *scene, struct board_loop *loop,
                   enum scene_aim_status status) {
    scene->runs = false;
    switch (status) {
    case SCENE_AIM_OK:
        aim(scene, loop);
        break;
    case SCENE_AIM_INFEASIBLE:
        say(scene, "no direction sees all of it from there");
        break;
    case SCENE_AIM_EMPTY:
        say(scene, "there is nothing in it");
        break;
    case SCENE_AIM_AT_VIEWPOINT:
        say(scene, "a point of it is at that place");
        break;
    default:
        say(scene, "no cone found");
        break;
    }
}

/// A step of the search. False: none runs.
static bool search_more(struct board_scene *scene, struct board_loop *loop) {
    if (scene->runs) {
        const enum scene_aim_status status = scene_aim_go(&scene->run, 1);
        if (status != SCENE_AIM_MORE) {
            finish(scene, loop, status);
        }
        return true;
    }
    return false;
}

void board_scene_work(struct board_scene *scene, struct board_loop *loop) {
    const uint32_t began_us = loop->pump.input.now_us;
    const struct hal_clock *const clock = loop->devices.pump.clock;
    if (scene->mail.asked) {
        start(scene);
    }
    // A unit in each tick, however busy it was, or what is decided would never come to an end.
    hide(scene, loop);
    bool more = hide_more(scene) || scene->runs;
    while (more && hal_clock_span_us(began_us, hal_clock_now_us(clock)) < BOARD_SCENE_UNTIL_US) {
        const bool hides = hide_more(scene), searches = search_more(scene, loop);
        more = hides || searches;
    }
}
