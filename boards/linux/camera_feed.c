#include "camera_feed.h"

#include "linux/linux_luma.h"

#include <stdio.h>
#include <string.h>

#define OPEN_EVERY_US 500000U

// ---------------------------------------------------------------- opening

static enum hal_status open_device(struct camera_feed *feed) {
    struct stage_camera *stage = feed->settings.stage;
    if (stage != NULL) {
        const enum hal_status status = stage_camera_open(stage);
        feed->hal = &stage->camera.hal;
        feed->path = stage->address.path;
        return status;
    }
    const enum hal_status status =
        linux_camera_open(&feed->camera, feed->settings.device, feed->settings.clock);
    feed->hal = &feed->camera.hal;
    feed->path = feed->camera.path;
    return status;
}

static void close_device(struct camera_feed *feed) {
    if (feed->settings.stage == NULL && feed->settings.device != NULL) {
        linux_camera_close(&feed->camera);
    }
}

static const char *error_line(const struct camera_feed *feed) {
    return feed->settings.stage != NULL ? feed->settings.stage->error.line
                                        : feed->camera.error.line;
}

/// A program that can't read JPEG takes anything else that the camera has.
static enum hal_status negotiate(struct camera_feed *feed) {
    feed->format = feed->settings.wish;
    enum hal_status status = hal_camera_negotiate(feed->hal, &feed->format);
    for (unsigned pixels = HAL_CAMERA_GREY;
         status == HAL_OK && feed->format.pixels == HAL_CAMERA_MJPEG &&
         linux_luma_jpeg_library() == NULL && pixels < HAL_CAMERA_MJPEG;
         pixels++) {
        feed->format = feed->settings.wish;
        feed->format.pixels = (enum hal_camera_pixels)pixels;
        status = hal_camera_negotiate(feed->hal, &feed->format);
    }
    if (status == HAL_OK && feed->format.pixels == HAL_CAMERA_MJPEG &&
        linux_luma_jpeg_library() == NULL) {
        linux_error_set(&feed->camera.error, feed->path,
                        "it sends MJPEG only, and this program was built without libjpeg-turbo",
                        "install libjpeg62-turbo-dev and build it again");
        return HAL_ERROR_UNSUPPORTED;
    }
    return status;
}

static enum hal_status open_and_start(struct camera_feed *feed) {
    enum hal_status status = open_device(feed);
    status = status == HAL_OK ? negotiate(feed) : status;
    status = status == HAL_OK ? hal_camera_start(feed->hal) : status;
    if (status != HAL_OK) {
        close_device(feed);
    }
    return status;
}

/// In the background: lets go of what was there and, unless it is over, gets it again.
static void attempt(void *context) {
    struct camera_feed *const feed = context;
    close_device(feed);
    feed->opened = !feed->closing && open_and_start(feed) == HAL_OK;
}

/// A simulated camera has nothing to wait for.
static bool is_watched(const struct camera_feed *feed) {
    return feed->loop != NULL && feed->settings.stage == NULL;
}

/// The loop lets go of the camera.
static void let_go(struct camera_feed *feed) {
    if (feed->streaming && is_watched(feed)) {
        event_loop_forget(feed->loop, feed->camera.fd);
    }
    feed->streaming = false;
    feed->next_us = 0;
}

// ---------------------------------------------------------------- frames

static void count_frame(struct camera_feed *feed, const struct hal_camera_frame *frame) {
    feed->frames++;
    feed->lost += feed->any_frame ? frame->sequence - feed->next_sequence : frame->sequence;
    feed->damaged += frame->damaged ? 1U : 0U;
    feed->any_frame = true;
    feed->next_sequence = frame->sequence + 1U;
}

static void give_back(struct camera_feed *feed, const struct hal_camera_frame *frame) {
    if (hal_camera_requeue(feed->hal, frame) != HAL_OK) {
        feed->failures++; // one buffer fewer; of a camera that has left the next dequeue tells
    }
}

/// The camera can be read.
static void take_frames(void *context) {
    struct camera_feed *const feed = context;
    struct hal_camera_frame newest = {0}, frame;
    enum hal_status status;
    while ((status = hal_camera_dequeue(feed->hal, &frame)) == HAL_OK) {
        count_frame(feed, &frame);
        if (newest.data != NULL) {
            feed->late++;
            give_back(feed, &newest);
        }
        newest = frame;
    }
    if (newest.data != NULL) {
        feed->heard_us = event_loop_now_us();
        if (feed->silent) {
            feed->silent = false;
            snprintf(feed->news, sizeof feed->news, "%s: frames come again", feed->path);
        }
        feed->settings.take(feed->settings.context, &feed->format, &newest);
        give_back(feed, &newest);
    }
    if (status == HAL_ERROR_GONE) {
        snprintf(feed->news, sizeof feed->news, "%s", error_line(feed));
        let_go(feed);
    } else if (status != HAL_EMPTY) {
        feed->failures++;
    }
}

// ---------------------------------------------------------------- for the loop

static bool begin(struct camera_feed *feed) {
    feed->opened = false;
    feed->streaming = true;
    feed->any_frame = false;
    feed->heard_us = event_loop_now_us();
    return !is_watched(feed) || event_loop_watch(feed->loop, feed->camera.fd, take_frames, feed);
}

static void init(struct camera_feed *feed, const struct camera_feed_settings *settings) {
    memset(feed, 0, sizeof *feed);
    feed->settings = *settings;
    feed->camera.fd = -1;
    feed->path = settings->device;
}

enum hal_status camera_feed_open(struct camera_feed *feed,
                                 const struct camera_feed_settings *settings) {
    init(feed, settings);
    const enum hal_status status = open_and_start(feed);
    if (status != HAL_OK) {
        snprintf(feed->news, sizeof feed->news, "%s", error_line(feed));
        return status;
    }
    feed->told = true;
    (void)begin(feed); // nothing to watch yet
    return HAL_OK;
}

void camera_feed_open_later(struct camera_feed *feed, const struct camera_feed_settings *settings,
                            struct event_loop *loop) {
    init(feed, settings);
    feed->loop = loop;
}

bool camera_feed_watch(struct camera_feed *feed, struct event_loop *loop) {
    feed->loop = loop;
    return !feed->streaming || begin(feed);
}

static void look_for_silence(struct camera_feed *feed, uint64_t now_us) {
    const uint64_t ten_us = 10U * (uint64_t)feed->format.interval_us;
    const uint64_t most_us = ten_us > CAMERA_FEED_SILENCE_US ? ten_us : CAMERA_FEED_SILENCE_US;
    if (now_us - feed->heard_us <= most_us || now_us < feed->heard_us) {
        return;
    }
    if (!feed->silent) { // told once, however often it is opened
        snprintf(feed->news, sizeof feed->news, "%s: no frame for %.0f s; it is opened anew",
                 feed->path, (double)most_us * 1e-6);
    }
    feed->silent = true;
    feed->silences++;
    let_go(feed);
}

/// A simulated camera is never silent: it leaves, or has frames.
static void tick_stage(struct camera_feed *feed) {
    const bool is_there = stage_camera_look(feed->settings.stage);
    if (feed->streaming) { // else it is the background's
        if (!is_there) {
            stage_camera_unplug(feed->settings.stage);
        }
        take_frames(feed);
    }
}

/// What has become of the attempt to open it.
static void take_camera(struct camera_feed *feed) {
    feed->returns++;
    feed->told = true;
    if (!feed->silent) {
        snprintf(feed->news, sizeof feed->news, "%s: the camera is there again", feed->path);
    }
    if (!begin(feed)) {
        let_go(feed);
    }
}

static void tell_failure(struct camera_feed *feed) {
    if (!feed->told && feed->next_us != 0U) {
        snprintf(feed->news, sizeof feed->news, "%s", error_line(feed));
        feed->told = true;
    }
}

void camera_feed_tick(struct camera_feed *feed, uint64_t now_us) {
    if (feed->settings.stage != NULL) {
        tick_stage(feed);
    } else if (feed->streaming) {
        look_for_silence(feed, now_us);
    }
    if (feed->streaming || !side_job_is_over(&feed->attempt)) {
        return;
    }
    if (feed->opened) {
        take_camera(feed);
        return;
    }
    tell_failure(feed);
    if (now_us >= feed->next_us && side_job_start(&feed->attempt, attempt, feed)) {
        feed->next_us = now_us + OPEN_EVERY_US;
    }
}

void camera_feed_unwatch(struct camera_feed *feed) {
    if (feed->streaming) {
        let_go(feed);
    }
    feed->loop = NULL;
}

bool camera_feed_is_there(const struct camera_feed *feed) {
    return feed->streaming;
}

bool camera_feed_end(struct camera_feed *feed) {
    if (feed->streaming) {
        let_go(feed);
    }
    if (!side_job_is_over(&feed->attempt)) {
        return false;
    }
    if (feed->closing) {
        return true;
    }
    feed->closing = true;
    return !side_job_start(&feed->attempt, attempt, feed); // else as camera_feed_close will
}

void camera_feed_close(struct camera_feed *feed) {
    if (feed->streaming) {
        let_go(feed);
    }
    side_job_wait(&feed->attempt);
    close_device(feed);
    memset(feed, 0, sizeof *feed);
}
