#include "camera_feed.h"

#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define OPEN_EVERY_NS 500000000L

// ---------------------------------------------------------------- opening

static enum hal_status open_and_start(struct camera_feed *feed) {
    struct linux_camera *camera = &feed->camera;
    struct hal_camera_format format = feed->settings.wish;
    enum hal_status status = linux_camera_open(camera, feed->settings.device, feed->settings.clock);
    status = status == HAL_OK ? hal_camera_negotiate(&camera->hal, &format) : status;
    status = status == HAL_OK ? hal_camera_start(&camera->hal) : status;
    if (status != HAL_OK) {
        linux_camera_close(camera);
    }
    return status;
}

/// The thread: from when the camera was lost until it is there again.
static void *reopen(void *context) {
    struct camera_feed *const feed = context;
    linux_camera_close(&feed->camera);
    while (!atomic_load(&feed->ending)) {
        if (open_and_start(feed) == HAL_OK) {
            atomic_store(&feed->opened, true);
            break;
        }
        const struct timespec pause = {0, OPEN_EVERY_NS};
        nanosleep(&pause, NULL);
    }
    return NULL;
}

/// An ordinary thread, whatever priority the loop's has.
static bool start_thread(struct camera_feed *feed) {
    pthread_attr_t attributes;
    const struct sched_param ordinary = {0};
    if (pthread_attr_init(&attributes) != 0) {
        return false;
    }
    const bool started = pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED) == 0 &&
                         pthread_attr_setschedpolicy(&attributes, SCHED_OTHER) == 0 &&
                         pthread_attr_setschedparam(&attributes, &ordinary) == 0 &&
                         pthread_create(&feed->thread, &attributes, reopen, feed) == 0;
    pthread_attr_destroy(&attributes);
    return started;
}

/// The loop lets go of the camera, and a thread gets it. Without one it is tried again later.
static void let_go(struct camera_feed *feed) {
    if (feed->streaming && feed->loop != NULL) {
        event_loop_forget(feed->loop, feed->camera.fd);
    }
    feed->streaming = false;
    atomic_store(&feed->opened, false);
    feed->thread_runs = start_thread(feed);
}

static void join(struct camera_feed *feed) {
    if (feed->thread_runs) {
        pthread_join(feed->thread, NULL);
        feed->thread_runs = false;
    }
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
    if (hal_camera_requeue(&feed->camera.hal, frame) != HAL_OK) {
        feed->failures++; // one buffer fewer; of a camera that has left the next dequeue tells
    }
}

/// The camera can be read.
static void take_frames(void *context) {
    struct camera_feed *const feed = context;
    struct hal_camera_frame newest = {0}, frame;
    enum hal_status status;
    while ((status = hal_camera_dequeue(&feed->camera.hal, &frame)) == HAL_OK) {
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
            snprintf(feed->news, sizeof feed->news, "%s: frames come again", feed->camera.path);
        }
        feed->settings.take(feed->settings.context, &feed->camera.format, &newest);
        give_back(feed, &newest);
    }
    if (status == HAL_ERROR_GONE) {
        snprintf(feed->news, sizeof feed->news, "%s", feed->camera.error.line);
        let_go(feed);
    } else if (status != HAL_EMPTY) {
        feed->failures++;
    }
}

// ---------------------------------------------------------------- for the loop

static bool begin(struct camera_feed *feed) {
    feed->streaming = true;
    feed->any_frame = false;
    feed->heard_us = event_loop_now_us();
    return feed->loop == NULL || event_loop_watch(feed->loop, feed->camera.fd, take_frames, feed);
}

enum hal_status camera_feed_open(struct camera_feed *feed,
                                 const struct camera_feed_settings *settings) {
    memset(feed, 0, sizeof *feed);
    feed->settings = *settings;
    const enum hal_status status = open_and_start(feed);
    if (status != HAL_OK) {
        snprintf(feed->news, sizeof feed->news, "%s", feed->camera.error.line);
        return status;
    }
    (void)begin(feed); // nothing to watch yet
    return HAL_OK;
}

bool camera_feed_watch(struct camera_feed *feed, struct event_loop *loop) {
    feed->loop = loop;
    return !feed->streaming || begin(feed);
}

static void look_for_silence(struct camera_feed *feed, uint64_t now_us) {
    const uint64_t ten_us = 10U * (uint64_t)feed->camera.format.interval_us;
    const uint64_t most_us = ten_us > CAMERA_FEED_SILENCE_US ? ten_us : CAMERA_FEED_SILENCE_US;
    if (now_us - feed->heard_us <= most_us || now_us < feed->heard_us) {
        return;
    }
    if (!feed->silent) { // told once, however often it is opened
        snprintf(feed->news, sizeof feed->news, "%s: no frame for %.0f s; it is opened anew",
                 feed->camera.path, (double)most_us * 1e-6);
    }
    feed->silent = true;
    feed->silences++;
    let_go(feed);
}

void camera_feed_tick(struct camera_feed *feed, uint64_t now_us) {
    if (feed->streaming) {
        look_for_silence(feed, now_us);
        return;
    }
    if (!feed->thread_runs) {
        let_go(feed); // there was no room for a thread
        return;
    }
    if (atomic_load(&feed->opened)) {
        join(feed);
        feed->returns++;
        if (!feed->silent) {
            snprintf(feed->news, sizeof feed->news, "%s: the camera is there again",
                     feed->camera.path);
        }
        if (!begin(feed)) {
            let_go(feed);
        }
    }
}

bool camera_feed_is_there(const struct camera_feed *feed) {
    return feed->streaming;
}

void camera_feed_close(struct camera_feed *feed) {
    atomic_store(&feed->ending, true);
    join(feed);
    if (feed->loop != NULL && feed->streaming) {
        event_loop_forget(feed->loop, feed->camera.fd);
    }
    if (feed->settings.device != NULL) {
        linux_camera_close(&feed->camera);
    }
    memset(feed, 0, sizeof *feed);
}
