/// How well the camera looks where it should: the truth against the plant.
#include "sim_private.h"

#include "fixed/trig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SETTLED_DEG     0.25
#define STEADY_AFTER_US 500000U
#define JUMP_DEG        5.0

static double degrees_of(bam32_t angle) {
    return (double)angle.bam * (360.0 / 4294967296.0);
}

static double angle_between_deg(struct vec3 a_q30, struct vec3 b_q30) {
    const uint64_t across = vec3_i64_length(vec3_cross(a_q30, b_q30));
    return degrees_of(trig_atan2((int64_t)across, vec3_dot_unit(a_q30, b_q30)));
}

void sim_measure_init(struct sim *sim) {
    struct sim_measure *measure = &sim->measure;
    memset(measure, 0, sizeof *measure);
    target_set_init(&measure->truth, sim->config.controller->position_um, 0);
    measure->framing.status = FRAMING_EMPTY;
    measure->framed_version = measure->truth.version;
}

void sim_measure_update(struct sim *sim, const struct target_update *update) {
    struct target_update shown = *update;
    if (sim->occlusion_workspace != NULL) { // what is hidden counts as the policy has it
        (void)occlusion_adjust(&sim->occlusion, update, &shown);
    }
    // What the controller must refuse is no truth either.
    (void)!target_set_apply(&sim->measure.truth, &shown, sim->time_us);
}

/// Units of work a tick: far more than the controller has, so that a picture is the best one when
/// it is there yet.
#define TRUTH_WORK_LIMIT 100000U

/// The cone, or the picture, that is best now.
static enum framing_status frame_truth(struct sim *sim) {
    struct sim_measure *measure = &sim->measure;
    const struct controller_config *config = sim->config.controller;
    const struct mount *mount = &sim->controller.mount;
    const struct framing_picture picture = {
        .width = config->lens.sensor_width_um,
        .height = config->lens.sensor_height_um,
        .base = {mount->right_q30, mount->ahead_q30, mount->up_q30}};
    const bool by_picture = config->frame == CONTROLLER_FRAME_RECT;
    return framing_follow(&measure->truth, measure->choice, by_picture ? &picture : NULL,
                          &measure->workspace.memory, by_picture ? TRUTH_WORK_LIMIT : 0U,
                          &measure->workspace, &measure->framing);
}

void sim_measure_choose(struct sim *sim, struct framing_choice choice) {
    sim->measure.choice = choice;
    sim->measure.workspace.memory = (struct framing_memory){0};
    sim->measure.framed_version = sim->measure.truth.version - 1U;
}

/// Follows the optimal axis; a jump of it (or the first one) starts the settling clock.
void sim_measure_follow(struct sim *sim) {
    struct sim_measure *measure = &sim->measure;
    if (measure->framed_version == measure->truth.version && !measure->framing.refining) {
        return;
    }
    measure->framed_version = measure->truth.version;
    if (measure->truth.count > measure->most_targets) {
        measure->most_targets = measure->truth.count;
    }
    const struct framing before = measure->framing;
    if (frame_truth(sim) != FRAMING_OK) {
        measure->timing = measure->settled = false;
        return;
    }
    if (before.status != FRAMING_OK ||
        angle_between_deg(before.ahead_q30, measure->framing.ahead_q30) > JUMP_DEG) {
        measure->aim_changed_us = sim->time_us;
        measure->timing = true;
        measure->settled = false;
    }
}

static bam32_t bam_of_deg(double degrees) {
    const double turns = degrees / 360.0;
    return bam32((uint32_t)(int64_t)(turns * 4294967296.0 + (turns >= 0.0 ? 0.5 : -0.5)));
}

struct sim_view sim_observe(const struct sim *sim) {
    struct sim_view view = {.pan_deg = sim_joint_deg(sim, AXIS_PAN),
                            .tilt_deg = sim_joint_deg(sim, AXIS_TILT),
                            .error_deg = -1.0,
                            .settled = sim->measure.settled};
    const bool zoom = sim->config.controller->axis[AXIS_ZOOM].drive.kind != DRIVE_NONE;
    view.focal_mm = zoom ? zoom_lens_focal_mm(&sim->lens) : sim->config.fixed_focal_mm;
    const struct mount_joints joints = {bam_of_deg(view.pan_deg), bam_of_deg(view.tilt_deg)};
    const struct mount *mount = &sim->controller.mount;
    view.ahead_q30 = mount_direction(mount, joints);
    view.right_q30 = mount_direction(
        mount, (struct mount_joints){bam32_add(joints.pan, bam32(BAM32_QUARTER)), bam32(0)});
    view.up_q30 = mount_direction(
        mount, (struct mount_joints){joints.pan, bam32_add(joints.tilt, bam32(BAM32_QUARTER))});
    if (sim->measure.framing.status == FRAMING_OK) {
        view.error_deg = angle_between_deg(view.ahead_q30, sim->measure.framing.ahead_q30);
    }
    return view;
}

/// Is a direction inside the picture?
static bool in_picture(const struct sim *sim, const struct sim_view *view, struct vec3 direction) {
    const struct lens_config *lens = &sim->config.controller->lens;
    const double ahead = (double)vec3_dot_unit(view->ahead_q30, direction);
    const double right = fabs((double)vec3_dot_unit(view->right_q30, direction));
    const double up = fabs((double)vec3_dot_unit(view->up_q30, direction));
    const double focal_um = view->focal_mm * 1000.0;
    return ahead > 0.0 && right * focal_um * 2.0 <= ahead * lens->sensor_width_um &&
           up * focal_um * 2.0 <= ahead * lens->sensor_height_um;
}

static void record_error(struct sim_measure *measure, double error_deg) {
    if (measure->error_count == measure->error_capacity) {
        const size_t larger = measure->error_capacity == 0U ? 4096U : 2U * measure->error_capacity;
        double *moved = realloc(measure->errors_deg, larger * sizeof *moved);
        if (moved == NULL) {
            return; // a summary of fewer samples
        }
        measure->errors_deg = moved;
        measure->error_capacity = larger;
    }
    measure->errors_deg[measure->error_count++] = error_deg;
}

void sim_measure_step(struct sim *sim) {
    struct sim_measure *measure = &sim->measure;
    sim_measure_follow(sim);
    if (measure->framing.status != FRAMING_OK || sim->controller.mode != MODE_TRACKING) {
        if (measure->timing && sim->controller.mode < MODE_TRACKING) {
            measure->aim_changed_us = sim->time_us; // not armed: nobody aims yet
        }
        return;
    }
    const struct sim_view view = sim_observe(sim);
    if (measure->timing && view.error_deg < SETTLED_DEG) {
        measure->timing = false;
        measure->settled = true;
        measure->settled_us = sim->time_us;
        measure->settle_sum_s += (double)(sim->time_us - measure->aim_changed_us) * 1e-6;
        measure->settle_count++;
    }
    if (measure->settled && sim->time_us - measure->settled_us >= STEADY_AFTER_US) {
        record_error(measure, view.error_deg);
    }
    for (uint32_t i = 0; i < measure->truth.count; i++) {
        const struct target *target = &measure->truth.target[i];
        if (target->weight_q16 == 0U || // hidden
            (measure->choice.one_object && target->object != measure->choice.object)) {
            continue;
        }
        measure->looked_at++;
        measure->seen += in_picture(sim, &view, measure->truth.direction_q30[i]);
    }
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double sim_hidden_percent(const struct occlusion *occlusion) {
    return occlusion->looked_total == 0U
               ? 0.0
               : 100.0 * (double)occlusion->hidden_total / (double)occlusion->looked_total;
}

struct sim_summary sim_summarise(struct sim *sim) {
    struct sim_measure *measure = &sim->measure;
    struct sim_summary summary = {.seconds = (double)sim->time_us * 1e-6,
                                  .targets = measure->most_targets,
                                  .steps = sim->tick,
                                  .trace_hash = sim->hash,
                                  .settle_count = measure->settle_count,
                                  .hidden_percent = sim_hidden_percent(&sim->occlusion),
                                  .violations = sim->violations,
                                  .errors = sim->pump.errors};
    double squares = 0.0;
    for (size_t i = 0; i < measure->error_count; i++) {
        squares += measure->errors_deg[i] * measure->errors_deg[i];
    }
    if (measure->error_count != 0U) {
        qsort(measure->errors_deg, measure->error_count, sizeof *measure->errors_deg,
              compare_doubles);
        summary.aim_error_rms_deg = sqrt(squares / (double)measure->error_count);
        summary.aim_error_p99_deg = measure->errors_deg[(measure->error_count - 1U) * 99U / 100U];
        summary.aim_error_max_deg = measure->errors_deg[measure->error_count - 1U];
    }
    if (measure->looked_at != 0U) {
        summary.in_frame_percent = 100.0 * (double)measure->seen / (double)measure->looked_at;
    }
    if (measure->settle_count != 0U) {
        summary.settle_s = measure->settle_sum_s / (double)measure->settle_count;
    }
    if (sim->time_us != 0U) {
        summary.bus_load_percent =
            100.0 * (double)sim->bus.busy_ns / ((double)sim->time_us * 1000.0);
    }
    return summary;
}
