#include "app/board_scene.h"

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
    scene->runs = false;
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

void board_scene_attach(struct board_scene *scene, struct board_loop *loop) {
    loop->console.commands.scene = &scene->mail;
    loop->status.scene = scene->told;
}

bool board_scene_units(const struct tree *tree, int64_t um, int32_t *units) {
    // um / (10^6 unit) with unit = mantissa * 2^power, the mantissa cut to 40 bits: what that
    // changes is below a unit.
    const uint64_t bits =
        (uint64_t)tree->header->unit_double[1] << 32 | tree->header->unit_double[0];
    const uint64_t mantissa = (bits & ((UINT64_C(1) << 52) - 1U)) | UINT64_C(1) << 52;
    const int power = (int)(bits >> 52) - 1075 + 13;
    const uint64_t size = um < 0 ? 0U - (uint64_t)um : (uint64_t)um;
    if (bits >> 52 == 0U || bits >> 52 >= 0x7FFU || size >> 44 != 0U) {
        return false; // no number above 0, or farther than 17,000 km
    }
    uint64_t value = 0, rest;
    if (power <= 0 && size != 0U) {
        const unsigned shift = (unsigned)-power;
        if (shift > 84U) {
            return false;
        }
        const uint64_t divisor = (mantissa >> 13) * UINT64_C(1000000);
        const struct u128 scaled = shift < 64U ? u128_mul(size, UINT64_C(1) << shift)
                                               : (struct u128){0, size << (shift - 64U)};
        if (scaled.hi >= divisor) {
            return false;
        }
        value = u128_div_u64(scaled, divisor, &rest);
    }
    if (value > (uint64_t)TREE_COORDINATE_MAX) {
        return false;
    }
    *units = um < 0 ? -(int32_t)value : (int32_t)value;
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

void board_scene_work(struct board_scene *scene, struct board_loop *loop) {
    const uint32_t began_us = loop->pump.input.now_us;
    const struct hal_clock *const clock = loop->devices.pump.clock;
    if (scene->mail.asked) {
        start(scene);
    }
    while (scene->runs &&
           hal_clock_span_us(began_us, hal_clock_now_us(clock)) < BOARD_SCENE_UNTIL_US) {
        const enum scene_aim_status status = scene_aim_go(&scene->run, 1);
        if (status != SCENE_AIM_MORE) {
            finish(scene, loop, status);
        }
    }
}
