#include "camera_source.h"

#include "message.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
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
    if (source->resting) {
        return;
    }
    const enum eye_status status = eye_submit(source->eye, format, frame);
    source->passed_over += status != EYE_OK ? 1U : 0U; // the eye counts why
}

static void give_nobody(void *context, const struct target_update *update) {
    (void)context;
    (void)update;
}

/// Of a camera that has left meanwhile, or is being changed, nothing counts any more.
static void take_results(void *context) {
    struct camera_source *const source = context;
    const bool counts = source->was_there && source->next_rig == NULL;
    const uint64_t before = eye_counts_of(source->eye).frames;
    (void)eye_collect(source->eye, hal_clock_now_us(source->clock),
                      counts && source->seen == NULL ? give : give_nobody, source);
    if (counts && source->seen != NULL && eye_counts_of(source->eye).frames != before) {
        source->seen(source->seen_context, source->eye);
    }
}

/// Time is not real, so it stands still for the detectors.
static void await_results(struct camera_source *source) {
    struct pollfd done = {eye_fd(source->eye), POLLIN, 0};
    while (!eye_is_idle(source->eye)) {
        (void)poll(&done, 1, -1);
    }
    take_results(source);
}

void camera_source_pose(struct camera_source *source, const struct controller_status *status,
                        uint64_t at_us, const struct camera_pose *truth) {
    if (source->eye == NULL) {
        return;
    }
    const uint32_t now_us = hal_clock_now_us(source->clock);
    const struct camera_pose pose = gimbal_pose_tick(&source->gimbal, status, at_us);
    eye_pose(source->eye, now_us, &pose);
    source->pose = pose;
    source->pose_us = now_us;
    if (source->staged != NULL) {
        stage_camera_pose(source->staged, now_us, truth != NULL ? truth : &pose);
    }
}

// ---------------------------------------------------------------- opening

/// The optics of the picture as it comes; the rig's numbers may be of another size.
static bool has_other_shape(const struct camera_source *source, char *text, size_t size) {
    const struct hal_camera_format *format = &source->feed.format;
    const struct camera_model *model = &source->rig->eye.model;
    snprintf(text, size,
             "%s gives pictures of %ux%u, which is not the shape of width_px and height_px: "
             "directions will be off",
             source->feed.path, format->width_px, format->height_px);
    return format->width_px * model->height_px != format->height_px * model->width_px;
}

/// Eye and stage of a rig that has a camera.
static enum exit_status make_parts(struct camera_source *source, const struct rig *rig) {
    struct eye_settings settings = {.model = rig->eye.model,
                                    .seat = rig->eye.seat,
                                    .latency_us = rig->eye.latency_us,
                                    .detectors = rig->eye.detectors};
    struct stage_camera_address address;
    mount_init(&settings.mount, rig->controller.attitude);
    gimbal_pose_init(&source->gimbal, &rig->controller, rig->fixed_focal_mm, rig->eye.focal_mm);
    source->eye = eye_create(&settings);
    if (source->eye == NULL) {
        message_at(rig->ini.file, 0, "the detectors can't be started: %s", strerror(errno));
        return EXIT_STATUS_FAILURE;
    }
    if (stage_camera_parse(rig->camera.device, &address)) {
        source->staged = &source->stage;
        if (!stage_camera_create(&source->stage, rig, source->clock)) {
            message_at(rig->ini.file, 0, "no memory for the simulated camera");
            return EXIT_STATUS_FAILURE;
        }
    }
    return EXIT_STATUS_OK;
}

static struct camera_feed_settings feed_settings(struct camera_source *source) {
    return (struct camera_feed_settings){.device = source->rig->camera.device,
                                         .stage = source->staged,
                                         .wish = source->rig->camera.wish,
                                         .clock = source->clock,
                                         .take = take_frame,
                                         .context = source};
}

enum exit_status camera_source_open(struct camera_source *source, const struct rig *rig,
                                    const struct hal_clock *clock, bool waits) {
    memset(source, 0, sizeof *source);
    source->rig = rig;
    source->clock = clock;
    source->waits = waits;
    if (rig->camera.device[0] == '\0') {
        return EXIT_STATUS_OK;
    }
    enum exit_status status = make_parts(source, rig);
    const struct camera_feed_settings feed = feed_settings(source);
    if (status == EXIT_STATUS_OK && camera_feed_open(&source->feed, &feed) != HAL_OK) {
        memcpy(source->news, source->feed.news, sizeof source->news);
        status = EXIT_STATUS_DEVICE;
    }
    if (status != EXIT_STATUS_OK) {
        camera_source_close(source);
        return status;
    }
    char text[LINUX_ERROR_BYTES];
    if (has_other_shape(source, text, sizeof text)) {
        message_at(rig->ini.file, 0, "%s", text);
    }
    source->was_there = true;
    return EXIT_STATUS_OK;
}

bool camera_source_watch(struct camera_source *source, struct event_loop *loop) {
    source->loop = loop;
    return source->eye == NULL ||
           (event_loop_watch(loop, eye_fd(source->eye), take_results, source) &&
            camera_feed_watch(&source->feed, loop));
}

void camera_source_unwatch(struct camera_source *source) {
    if (source->eye != NULL && source->loop != NULL) {
        camera_feed_unwatch(&source->feed);
        event_loop_forget(source->loop, eye_fd(source->eye));
        source->loop = NULL;
    }
}

void camera_source_close(struct camera_source *source) {
    if (source->eye == NULL) {
        return;
    }
    camera_source_unwatch(source);
    camera_feed_close(&source->feed);
    eye_destroy(source->eye);
    source->eye = NULL;
    if (source->staged != NULL) {
        stage_camera_free(source->staged);
    }
    source->staged = NULL;
}

// ---------------------------------------------------------------- another rig file

void camera_source_change(struct camera_source *source, const struct rig *rig) {
    forget_targets(source);
    source->next_rig = rig;
}

bool camera_source_is_changing(const struct camera_source *source) {
    return source->next_rig != NULL;
}

/// Nothing here waits: the feed is closed in the background, the eye has nothing to do.
static void change_when_idle(struct camera_source *source) {
    if (source->eye != NULL && !(camera_feed_end(&source->feed) && eye_is_idle(source->eye))) {
        return;
    }
    struct event_loop *const loop = source->loop;
    camera_source_close(source);
    source->loop = loop;
    source->rig = source->next_rig;
    source->next_rig = NULL;
    source->was_there = false;
    if (source->rig->camera.device[0] == '\0') {
        return;
    }
    if (make_parts(source, source->rig) != EXIT_STATUS_OK ||
        !event_loop_watch(source->loop, eye_fd(source->eye), take_results, source)) {
        snprintf(source->news, sizeof source->news, "the camera can't be used: no room");
        camera_source_close(source);
        return;
    }
    const struct camera_feed_settings feed = feed_settings(source);
    camera_feed_open_later(&source->feed, &feed, source->loop);
}

// ---------------------------------------------------------------- ticks

static void tick_feed(struct camera_source *source) {
    if (source->resting && source->staged != NULL) {
        return; // nor is any picture drawn
    }
    camera_feed_tick(&source->feed, event_loop_now_us());
    const bool is_there = camera_feed_is_there(&source->feed);
    if (source->was_there && !is_there) {
        forget_targets(source);
    }
    source->was_there = is_there;
    if (source->waits) {
        await_results(source);
    }
}

void camera_source_tick(struct camera_source *source) {
    if (source->next_rig != NULL) {
        change_when_idle(source);
    } else if (source->eye != NULL) {
        tick_feed(source);
    }
}

/// Of a camera that was opened in the background, too, its shape is told.
static void note_shape(struct camera_source *source) {
    if (camera_feed_is_there(&source->feed) && source->news[0] == '\0' &&
        !has_other_shape(source, source->news, sizeof source->news)) {
        source->news[0] = '\0';
    }
}

const char *camera_source_news(struct camera_source *source, bool *lost) {
    static char line[sizeof source->news];
    if (source->news[0] != '\0') {
        memcpy(line, source->news, sizeof line);
        source->news[0] = '\0';
        *lost = source->eye == NULL;
        return line;
    }
    if (source->eye == NULL || source->feed.news[0] == '\0') {
        return NULL;
    }
    memcpy(line, source->feed.news, sizeof line);
    source->feed.news[0] = '\0';
    *lost = !camera_feed_is_there(&source->feed);
    note_shape(source);
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
