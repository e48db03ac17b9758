#include "view/story.h"

#include "view/scene_lines.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Pictures of a run whose schedule names no subjects.
#define STRETCHES 8U

static double degrees_of(bam32_t angle) {
    return (double)angle.bam * (360.0 / 4294967296.0);
}

// ---------------------------------------------------------------- subjects

static void list_subjects(struct story *story, const struct schedule *schedule,
                          uint64_t duration_us) {
    const size_t named = schedule->subject_count;
    for (size_t i = 0; i < story->subject_count; i++) {
        struct story_subject *subject = &story->subjects[i];
        if (named != 0U) {
            subject->from_us = schedule->subjects[i].at_us;
            subject->until_us = i + 1U < named ? schedule->subjects[i + 1U].at_us : duration_us;
            memcpy(subject->name, schedule->subjects[i].name, sizeof subject->name);
        } else {
            subject->from_us = duration_us * i / STRETCHES;
            subject->until_us = duration_us * (i + 1U) / STRETCHES;
            snprintf(subject->name, sizeof subject->name, "%.0f s",
                     (double)subject->until_us * 1e-6);
        }
    }
}

bool story_begin(struct story *story, const struct sim *sim, const char *title,
                 const char *subtitle, uint64_t duration_us, bool collects) {
    const struct schedule *schedule = sim->config.schedule;
    memset(story, 0, sizeof *story);
    report_init(&story->report, title, subtitle);
    story->sim = sim;
    story->collects = collects;
    story->complete = true;
    story->settled_s = -1.0;
    // 20 samples a second, fewer in long runs: the plots have no more columns than that.
    story->sample_period_us = duration_us > 600000000U ? duration_us / 12000U : 50000U;
    story->subject_count = schedule->subject_count != 0U ? schedule->subject_count : STRETCHES;
    story->subjects = calloc(story->subject_count, sizeof *story->subjects);
    if (story->subjects == NULL) {
        return false;
    }
    list_subjects(story, schedule, duration_us);
    return true;
}

void story_end(struct story *story) {
    report_free(&story->report);
    free(story->subjects);
    memset(story, 0, sizeof *story);
}

// ---------------------------------------------------------------- pictures

/// Image on the sensor of a direction. False if it is not in front.
static bool project(const struct sim_view *view, struct vec3 direction, double *x_mm,
                    double *y_mm) {
    const double ahead = (double)vec3_dot_unit(view->ahead_q30, direction);
    if (ahead <= 0.0) {
        return false;
    }
    *x_mm = view->focal_mm * (double)vec3_dot_unit(view->right_q30, direction) / ahead;
    *y_mm = view->focal_mm * (double)vec3_dot_unit(view->up_q30, direction) / ahead;
    return true;
}

/// What the schedule says of a target's dot.
static const struct schedule_item *find_item(const struct schedule *schedule, uint32_t id) {
    for (size_t i = 0; i < schedule->item_count; i++) {
        const struct target_update *update = &schedule->items[i].update;
        if (update->id == id && update->kind != TARGET_CLEAR && update->kind != TARGET_GONE) {
            return &schedule->items[i];
        }
    }
    return NULL;
}

static void add_point(struct report_picture *picture, const struct sim_view *view,
                      struct vec3 direction, const struct schedule_item *item, bool is_target) {
    struct report_point *point = &picture->points[picture->point_count];
    memset(point, 0, sizeof *point);
    if (!project(view, direction, &point->x_mm, &point->y_mm)) {
        return;
    }
    const bool outside = fabs(point->x_mm) > 0.5 * picture->sensor_width_mm ||
                         fabs(point->y_mm) > 0.5 * picture->sensor_height_mm;
    if (outside && !is_target) {
        return;
    }
    point->is_target = is_target;
    point->size = item != NULL ? item->size : 1.0;
    if (item != NULL) {
        memcpy(point->label, item->label, sizeof point->label);
    }
    picture->point_count++;
}

/// The targets where they are; those that something hides are no targets in the picture.
static void add_targets(struct report_picture *picture, const struct sim_view *view,
                        const struct sim *sim) {
    const struct schedule *schedule = sim->config.schedule;
    const struct target_set *truth = &sim->measure.truth;
    for (uint32_t i = 0; i < truth->count; i++) {
        struct vec3 direction = truth->direction_q30[i];
        bool hidden = false;
        for (uint32_t k = 0; k < sim->occlusion.target_count; k++) {
            const struct occlusion_target *const t = &sim->occlusion.target[k];
            if (t->last.id == truth->target[i].id && t->last.kind == TARGET_POSITION) {
                direction = vec3_i64_normalise(vec3_i64_sub(
                    t->last.position_um, sim->config.obstacles->occlusion.viewpoint_um));
                hidden = t->samples == 0U;
            }
        }
        add_point(picture, view, direction, find_item(schedule, truth->target[i].id), !hidden);
    }
}

static bool take_picture(struct story *story, const struct story_subject *subject) {
    const struct sim *sim = story->sim;
    const struct schedule *schedule = sim->config.schedule;
    const struct sim_measure *measure = &sim->measure;
    const struct sim_view view = sim_observe(sim);
    const struct lens_config *lens = &sim->config.controller->lens;
    struct report_picture picture = {.time_s = (double)sim->time_us * 1e-6,
                                     .sensor_width_mm = lens->sensor_width_um / 1000.0,
                                     .sensor_height_mm = lens->sensor_height_um / 1000.0,
                                     .focal_mm = view.focal_mm,
                                     .error_deg = view.error_deg,
                                     .pan_deg = view.pan_deg,
                                     .tilt_deg = view.tilt_deg};
    snprintf(picture.title, sizeof picture.title, "%s", subject->name);
    picture.points =
        calloc(measure->truth.count + schedule->background_count + 1U, sizeof *picture.points);
    if (picture.points == NULL) {
        return false;
    }
    if (measure->framing.status == FRAMING_OK) {
        const double half = degrees_of(measure->framing.half_angle_bam32);
        picture.half_angle_deg = half;
        if (half < 89.0) {
            picture.cone_radius_mm = view.focal_mm * tan(half * AXIS_PLANT_PI / 180.0);
        }
        (void)project(&view, measure->framing.ahead_q30, &picture.cone_x_mm, &picture.cone_y_mm);
    }
    for (size_t i = 0; i < schedule->background_count; i++) {
        add_point(&picture, &view, schedule->background[i].update.direction,
                  &schedule->background[i], false);
    }
    add_targets(&picture, &view, sim);
    picture.lines = scene_lines(sim, &view, picture.sensor_width_mm, picture.sensor_height_mm,
                                &picture.line_count);
    const bool drawn = picture.lines != NULL || picture.line_count == 0U;
    const bool added = drawn && report_add_picture(&story->report, &picture);
    free(picture.points);
    free(picture.lines);
    return added;
}

// ---------------------------------------------------------------- telling

static bool take_sample(struct story *story) {
    const struct sim *sim = story->sim;
    const struct sim_view view = sim_observe(sim);
    const struct controller_status *status = &sim->pump.output.status;
    const double per_unit = 360.0 / (double)AXIS_TURN_Q48;
    const struct report_sample sample = {
        .time_s = (double)sim->time_us * 1e-6,
        .pan_deg = view.pan_deg,
        .tilt_deg = view.tilt_deg,
        .pan_setpoint_deg = (double)status->axis[AXIS_PAN].setpoint_q48 * per_unit,
        .tilt_setpoint_deg = (double)status->axis[AXIS_TILT].setpoint_q48 * per_unit,
        .focal_mm = status->focal_um != 0U ? view.focal_mm : 0.0,
        .focal_setpoint_mm = status->focal_um / 1000.0,
        .error_deg = view.error_deg,
        .mode = controller_mode_name(status->mode)};
    return report_add_sample(&story->report, &sample);
}

static void tell_subject(struct story *story, const struct story_subject *subject) {
    const struct sim_measure *measure = &story->sim->measure;
    const struct sim_view view = sim_observe(story->sim);
    if (story->tell == NULL) {
        return;
    }
    const bool framed = measure->framing.status == FRAMING_OK;
    const struct story_line line = {
        .name = subject->name,
        .target_count = measure->truth.count,
        .pan_deg = view.pan_deg,
        .tilt_deg = view.tilt_deg,
        .half_angle_deg = framed ? degrees_of(measure->framing.half_angle_bam32) : 0.0,
        .focal_mm = view.focal_mm,
        .error_deg = view.error_deg,
        .settle_s = story->settled_s};
    story->tell(story->tell_context, &line);
}

void story_step(struct story *story) {
    const struct sim *sim = story->sim;
    const uint64_t tick_us = sim->config.controller->tick_us;
    if (story->collects && sim->time_us % story->sample_period_us < tick_us) {
        story->complete = take_sample(story) && story->complete;
    }
    if (story->next_subject >= story->subject_count) {
        return;
    }
    const struct story_subject *subject = &story->subjects[story->next_subject];
    if (sim->measure.settled && story->settled_s < 0.0 && sim->time_us > subject->from_us) {
        story->settled_s = (double)(sim->time_us - subject->from_us) * 1e-6;
    }
    if (sim->time_us >= subject->until_us) {
        tell_subject(story, subject);
        if (story->collects) {
            story->complete = take_picture(story, subject) && story->complete;
        }
        story->settled_s = -1.0;
        story->next_subject++;
    }
}
