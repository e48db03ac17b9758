#include "camera_source.h"

#include "message.h"

#include <errno.h>
#include <string.h>

// ---------------------------------------------------------------- updates on their way

static void note_id(struct camera_source *source, const struct target_update *update) {
    uint32_t at = 0;
    while (at < source->id_count && source->id[at] != update->id) {
        at++;
    }
    if (update->kind == TARGET_GONE && at < source->id_count) {
        source->id[at] = source->id[--source->id_count];
    } else if (update->kind != TARGET_GONE && at == source->id_count && at < CAMERA_SOURCE_IDS) {
        source->id[source->id_count++] = update->id;
    }
}

static void give(void *context, const struct target_update *update) {
    struct camera_source *const source = context;
    if (source->head - source->tail == CAMERA_SOURCE_UPDATES) {
        source->dropped++;
        return;
    }
    source->update[source->head % CAMERA_SOURCE_UPDATES] = *update;
    source->head++;
    note_id(source, update);
}

const struct target_update *camera_source_next(const struct camera_source *source) {
    return source->head == source->tail ? NULL
                                        : &source->update[source->tail % CAMERA_SOURCE_UPDATES];
}

void camera_source_taken(struct camera_source *source) {
    source->tail++;
}

/// Whatever it had found is no longer seen.
static void forget_targets(struct camera_source *source) {
    source->head = source->tail; // older news don't count any more
    while (source->id_count > 0U) {
        const struct target_update gone = {.kind = TARGET_GONE, .id = source->id[0]};
        give(source, &gone);
    }
}

// ---------------------------------------------------------------- frames

static void take_frame(void *context, const struct hal_camera_format *format,
                       const struct hal_camera_frame *frame) {
    struct camera_source *const source = context;
    const enum eye_status status = eye_submit(source->eye, format, frame);
    source->passed_over += status != EYE_OK ? 1U : 0U; // the eye counts why
}

static void take_results(void *context) {
    struct camera_source *const source = context;
    (void)eye_collect(source->eye, give, source);
}

void camera_source_tick(struct camera_source *source, const struct controller_status *status) {
    if (source->eye == NULL) {
        return;
    }
    const struct camera_pose pose = gimbal_pose_tick(&source->gimbal, status);
    eye_pose(source->eye, hal_clock_now_us(source->clock), &pose);
    camera_feed_tick(&source->feed, event_loop_now_us());
    const bool is_there = camera_feed_is_there(&source->feed);
    if (source->was_there && !is_there) {
        forget_targets(source);
    }
    source->was_there = is_there;
}

// ---------------------------------------------------------------- opening

/// The optics of the picture as it comes; the rig's numbers may be of another size.
static void tell_shape(const struct camera_source *source) {
    const struct hal_camera_format *format = &source->feed.camera.format;
    const struct camera_model *model = &source->rig->eye.model;
    if (format->width_px * model->height_px != format->height_px * model->width_px) {
        message_at(source->rig->ini.file, 0,
                   "%s gives pictures of %ux%u, which is not the shape of width_px and height_px: "
                   "directions will be off",
                   source->feed.camera.path, format->width_px, format->height_px);
    }
}

enum exit_status camera_source_open(struct camera_source *source, const struct rig *rig,
                                    const struct hal_clock *clock) {
    memset(source, 0, sizeof *source);
    source->rig = rig;
    source->clock = clock;
    if (rig->camera.device[0] == '\0') {
        return EXIT_STATUS_OK;
    }
    struct eye_settings settings = {.model = rig->eye.model,
                                    .seat = rig->eye.seat,
                                    .latency_us = rig->eye.latency_us,
                                    .detectors = rig->eye.detectors};
    mount_init(&settings.mount, rig->controller.attitude);
    gimbal_pose_init(&source->gimbal, &rig->controller, rig->fixed_focal_mm, rig->eye.focal_mm);
    source->eye = eye_create(&settings);
    if (source->eye == NULL) {
        message_at(rig->ini.file, 0, "the detectors can't be started: %s", strerror(errno));
        return EXIT_STATUS_FAILURE;
    }
    const struct camera_feed_settings feed = {.device = rig->camera.device,
                                              .wish = rig->camera.wish,
                                              .clock = clock,
                                              .take = take_frame,
                                              .context = source};
    if (camera_feed_open(&source->feed, &feed) != HAL_OK) {
        message_at(rig->ini.file, 0, "%s", source->feed.news);
        camera_source_close(source);
        return EXIT_STATUS_DEVICE;
    }
    tell_shape(source);
    source->was_there = true;
    return EXIT_STATUS_OK;
}

bool camera_source_watch(struct camera_source *source, struct event_loop *loop) {
    if (source->eye == NULL) {
        return true;
    }
    source->loop = loop;
    return event_loop_watch(loop, eye_fd(source->eye), take_results, source) &&
           camera_feed_watch(&source->feed, loop);
}

void camera_source_close(struct camera_source *source) {
    if (source->eye == NULL) {
        return;
    }
    camera_feed_close(&source->feed);
    if (source->loop != NULL) {
        event_loop_forget(source->loop, eye_fd(source->eye));
    }
    eye_destroy(source->eye);
    source->eye = NULL;
}

const char *camera_source_news(struct camera_source *source, bool *lost) {
    static char line[sizeof source->feed.news];
    if (source->eye == NULL || source->feed.news[0] == '\0') {
        return NULL;
    }
    memcpy(line, source->feed.news, sizeof line);
    source->feed.news[0] = '\0';
    *lost = !camera_feed_is_there(&source->feed);
    return line;
}

void camera_source_facts(const struct camera_source *source, struct facts *facts) {
    if (source->eye == NULL) {
        return;
    }
    const struct eye_counts counts = eye_counts_of(source->eye);
    facts_u64(facts, "camera_frames", source->feed.frames);
    facts_u64(facts, "camera_lost", source->feed.lost);
    facts_u64(facts, "camera_damaged", source->feed.damaged);
    facts_u64(facts, "camera_returns", source->feed.returns);
    facts_u64(facts, "detected_frames", counts.frames);
    facts_u64(facts, "detected_not", source->passed_over + source->feed.late);
    facts_u64(facts, "detected_unplaced", counts.unplaced);
    facts_u64(facts, "detected_updates", counts.updates);
    facts_u64(facts, "detect_us_max", counts.work_us_max);
}
