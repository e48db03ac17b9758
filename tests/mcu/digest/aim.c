/// Targets, orientation and framing.
#include "mcu/digest/digest.h"

#include "aim/framing.h"
#include "aim/orient.h"
#include "aim/rectangle.h"
#include "fixed/trig.h"

#include <stddef.h>

static void orient(void) {
    struct digest d = digest_start(31);
    for (int i = 0; i < 1500; i++) {
        const struct vec3 ahead = vec3_normalise(digest_any_direction(&d));
        const struct orient_axes axes = orient_axes(ahead, digest_any_direction(&d));
        const struct orient_angles angles = orient_pan_tilt(ahead);
        struct orient_image image;
        digest_i64(&d, orient_image_of_cone(bam32((uint32_t)digest_any_u64(&d)), &image));
        digest_u64(&d, image.radius_q32);
        digest_u64(&d, image.distortion_q32);
        digest_vec3(&d, axes.right_q30);
        digest_vec3(&d, axes.up_q30);
        digest_u64(&d, angles.pan_bam32.bam);
        digest_u64(&d, angles.tilt_bam32.bam);
    }
    digest_finish(&d, "digest aim/orient");
}

static void targets_and_framing(void) {
    static struct target_set set;
    static struct framing_workspace solver;
    static struct framing framing;
    struct digest d = digest_start(32);
    target_set_init(&set, (struct vec3_i64){12345, -54321, 1500000}, 900000);
    for (uint64_t now_us = 0; now_us < 4000 * UINT64_C(1000); now_us += 1000) {
        struct target_update update = {.kind = TARGET_POSITION};
        update.id = digest_below(&d, 300);
        update.weight_q16 = digest_below(&d, 8) << 14;
        // Ahead, mostly, so that many of the framings have an answer.
        update.position_um.x = digest_any_i64(&d) / (INT64_C(1) << 40);
        update.position_um.z = digest_any_i64(&d) / (INT64_C(1) << 40);
        update.position_um.y = 40000000 + (int64_t)digest_below(&d, 40000000);
        update.radius_um = digest_below(&d, 2000000);
        if (digest_below(&d, 16) == 0U) {
            update.kind = digest_below(&d, 2) == 0U ? TARGET_GONE : TARGET_DIRECTION;
            update.direction = digest_any_direction(&d);
            update.radius_bam32 = digest_below(&d, UINT32_C(1) << 28);
        }
        digest_i64(&d, target_set_apply(&set, &update, now_us));
        digest_u64(&d, target_set_expire(&set, now_us));
        if (now_us % 16000U == 0U) {
            digest_i64(&d, framing_solve(&set, &solver, &framing));
            digest_vec3(&d, framing.ahead_q30);
            digest_u64(&d, framing.half_angle_bam32.bam);
            digest_u64(&d, framing.framed_count);
        }
    }
    for (uint32_t i = 0; i < set.count; i++) {
        digest_vec3(&d, set.direction_q30[i]);
        digest_u64(&d, set.target[i].id);
        digest_u64(&d, set.target[i].radius_bam32);
    }
    digest_finish(&d, "digest aim/framing");
}

/// Rectangles, to the end and in parts, at rest and moving.
static void rectangle(void) {
    static struct rectangle_search search;
    static struct rectangle_workspace workspace;
    static struct vec3 centre[24];
    static struct follow_radius radius[24];
    struct digest d = digest_start(33);
    for (int set = 0; set < 60; set++) {
        const struct vec3 ahead = vec3_normalise(digest_any_direction(&d));
        const struct vec3 base = vec3_normalise(digest_any_direction(&d));
        const struct orient_axes axes = orient_axes(base, digest_any_direction(&d));
        struct rectangle_input input = {.centre_q30 = centre, .work_limit = 2500};
        input.base.right_q30 = axes.right_q30;
        input.base.up_q30 = axes.up_q30;
        const struct vec3_i64 across = vec3_cross(axes.up_q30, axes.right_q30);
        input.base.ahead_q30 = vec3_i64_normalise(across);
        input.count = 1U + digest_below(&d, 24);
        input.width = 1U + digest_below(&d, 400);
        input.height = 200;
        input.radius = digest_below(&d, 2) == 0U ? NULL : radius;
        const int32_t spread = (int32_t)(UINT32_C(1) << (10U + digest_below(&d, 19)));
        for (uint32_t i = 0; i < input.count; i++) {
            centre[i].x = ahead.x / 2 + (int32_t)digest_below(&d, (uint32_t)spread);
            centre[i].y = ahead.y / 2 + (int32_t)digest_below(&d, (uint32_t)spread);
            centre[i].z = ahead.z / 2 + (int32_t)digest_below(&d, (uint32_t)spread);
            centre[i] = vec3_normalise(centre[i]);
            radius[i].angle = bam32(digest_below(&d, 10000000));
            const struct sincos of = trig_sincos(radius[i].angle);
            radius[i].sin_q30 = of.sin_q30;
            radius[i].cos_q30 = of.cos_q30;
        }
        rectangle_begin(&search, &input.base, ahead);
        for (int call = 0; call < 40; call++) {
            struct rectangle_result result;
            digest_i64(&d, rectangle_follow(&input, &search, &workspace, &result));
            digest_u64(&d, result.pan_bam32.bam);
            digest_u64(&d, result.tilt_bam32.bam);
            digest_u64(&d, result.half_width_bam32.bam);
            digest_u64(&d, result.half_height_bam32.bam);
            digest_u64(&d, result.work);
            input.moved = call % 8 == 7;
            centre[0].x += input.moved ? 100000 : 0;
            centre[0] = vec3_normalise(centre[0]);
            if (!search.begun) {
                rectangle_begin(&search, &input.base, ahead);
            }
        }
    }
    digest_finish(&d, "digest aim/rectangle");
}

int main(void) {
    TEST(orient);
    TEST(targets_and_framing);
    TEST(rectangle);
    return check_finish();
}
