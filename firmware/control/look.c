#include "control/private.h"

#include <stddef.h>

/// Reads of a target that a tick may spend on the aim, of about 20 instructions of a Cortex-M4
/// each: with 16 updates, 16 frames and all else a tick stays below 100,800 of them, 60 % of 1 ms
/// at 168 MHz (tests/gate/tick.sh, tests/unit/test_tick_work.c).
#define AIM_WORK_LIMIT 2500U

void controller_start_pan(struct controller *c, const struct controller_pan *pan) {
    c->from = c->view;
    if (c->panning) { // broken off: on from where it is
        c->from.framing = c->framing;
        c->from.held = true;
    }
    c->view = (struct controller_view){.choice = pan->choice,
                                       .framing = {.status = FRAMING_EMPTY},
                                       .framed_version = c->targets.version - 1U};
    c->panning = pan->duration_us != 0U && c->from.framing.status == FRAMING_OK;
    c->pan_started_us = c->time_us;
    c->pan_duration_us = pan->duration_us;
    c->pan_path = pan->path;
}

static bool is_due(const struct controller *c, const struct controller_view *view) {
    return !view->held && (view->framed_version != c->targets.version || view->framing.refining);
}

static void solve(struct controller *c, struct controller_view *view) {
    view->framed_version = c->targets.version;
    c->aims_solved++;
    const struct framing_picture picture = {
        .width = c->config->lens.sensor_width_um,
        .height = c->config->lens.sensor_height_um,
        .base = {c->mount.right_q30, c->mount.ahead_q30, c->mount.up_q30}};
    const bool by_picture = c->config->frame == CONTROLLER_FRAME_RECT;
    (void)framing_follow(&c->targets, view->choice, by_picture ? &picture : NULL, &view->memory,
                         AIM_WORK_LIMIT, &c->framing_workspace, &view->framing);
}

static bam32_t blend_angles(bam32_t from, bam32_t to, q30_t weight_q30) {
    const int64_t more = ((int64_t)to.bam - (int64_t)from.bam) * weight_q30 >> 30;
    return bam32((uint32_t)((int64_t)from.bam + more));
}

/// Between the two views; the one it comes from counts where it was last seen. False: where the new
/// one has nothing to look at, or they are opposite, the aim stays.
static bool look_between(struct controller *c) {
    const struct framing *from = &c->from.framing, *to = &c->view.framing;
    if (to->status != FRAMING_OK) {
        c->pan_started_us = c->time_us;
        return false;
    }
    const q30_t weight_q30 = pan_weight_q30(c->time_us - c->pan_started_us, c->pan_duration_us);
    const uint32_t work = c->framing.work;
    if (weight_q30 == Q30_ONE) {
        c->panning = false;
        c->framing = *to;
    } else if (pan_blend(from->ahead_q30, to->ahead_q30, weight_q30, c->pan_path,
                         &c->framing.ahead_q30)) {
        c->framing.half_angle_bam32 =
            blend_angles(from->half_angle_bam32, to->half_angle_bam32, weight_q30);
        c->framing.half_width_bam32 =
            blend_angles(from->half_width_bam32, to->half_width_bam32, weight_q30);
        c->framing.half_height_bam32 =
            blend_angles(from->half_height_bam32, to->half_height_bam32, weight_q30);
        c->framing.is_picture = false; // the joints follow from the direction
        c->framing.framed_count = to->framed_count;
    }
    c->framing.work = work;
    return true;
}

bool controller_look(struct controller *c) {
    // Both views in one tick would be too much: they take turns.
    const bool turn = c->panning && (c->tick & 1U) != 0U;
    struct controller_view *view = turn ? &c->from : &c->view;
    const bool due = is_due(c, view);
    c->framed_version = c->targets.version;
    if (due) {
        solve(c, view);
        c->framing.work = view->framing.work;
    }
    if (c->panning) {
        return look_between(c);
    }
    if (due) {
        c->framing = view->framing;
    }
    return due;
}
