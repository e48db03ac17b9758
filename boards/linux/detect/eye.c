#include "detect/eye.h"

#include "detect/foresight.h"
#include "side_job.h"

#include "linux/linux_luma.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#define RADIAN_BAM (4294967296.0 / (2.0 * 3.14159265358979323846))

/// A frame on its way through the detectors.
struct job {
    uint8_t *bytes; ///< a copy of the frame's
    size_t capacity;
    struct hal_camera_format format;
    struct hal_camera_frame frame;
    struct camera_pose pose;
    uint32_t exposed_us; ///< by its stamp, less the latency
    // Results.
    bool decoded;
    struct camera_model model;
    struct camera_view view;
    struct detections found;
};

enum job_state { JOB_NONE, JOB_WAITING, JOB_DONE, JOB_END };

struct eye {
    struct eye_settings settings;
    struct pose_history history;
    struct foresight foresight;
    struct detector *detector; ///< for frames of that size
    uint32_t width_px, height_px;
    struct linux_luma luma;
    struct eye_counts counts;
    struct job job;
    // Between the threads; what else is in job belongs to the worker while state is JOB_WAITING.
    pthread_t worker;
    bool has_worker;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    enum job_state state;
    int done_fd;
};

static uint64_t now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U;
}

// ---------------------------------------------------------------- from pixels to targets

/// The largest angle between a direction and those at some pixels around it.
static double angle_around(const struct camera_model *model, const double pixel[2],
                           const double middle[3], double radius_px) {
    double widest = 0.0;
    for (unsigned i = 0; i < 4U; i++) {
        const double side = i & 2U ? -radius_px : radius_px;
        const double at[2] = {pixel[0] + (i & 1U ? side : 0.0), pixel[1] + (i & 1U ? 0.0 : side)};
        double ray[3];
        if (camera_model_ray(model, at, ray)) {
            const double x = ray[1] * middle[2] - ray[2] * middle[1];
            const double y = ray[2] * middle[0] - ray[0] * middle[2];
            const double z = ray[0] * middle[1] - ray[1] * middle[0];
            const double cosine = ray[0] * middle[0] + ray[1] * middle[1] + ray[2] * middle[2];
            widest = fmax(widest, atan2(sqrt(x * x + y * y + z * z), cosine));
        }
    }
    return widest;
}

/// With foresight: where it is now_us; NULL: where it was seen.
static bool update_of(const struct detection *detection, const struct camera_model *model,
                      const struct camera_view *view, struct foresight *foresight, uint32_t seen_us,
                      uint32_t now_us, struct target_update *update) {
    double ray[3], world[3];
    if (!camera_model_ray(model, detection->pixel, ray)) {
        return false;
    }
    camera_view_to_world(view, ray, world);
    if (foresight != NULL) {
        foresight_see(foresight, detection->id, seen_us, now_us, world);
    }
    const double radius = angle_around(model, detection->pixel, ray, detection->radius_px);
    *update = (struct target_update){.kind = TARGET_DIRECTION,
                                     .id = detection->id,
                                     .object = (uint16_t)(detection->kind + 1U),
                                     .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                     .direction = camera_direction_q30(world),
                                     .radius_bam32 = (uint32_t)(radius * RADIAN_BAM)};
    return true;
}

bool eye_update_of(const struct detection *detection, const struct camera_model *model,
                   const struct camera_view *view, struct target_update *update) {
    return update_of(detection, model, view, NULL, 0, 0, update);
}

// ---------------------------------------------------------------- a frame

static bool fit_detector(struct eye *eye, const struct hal_camera_luma *frame) {
    if (eye->detector != NULL && eye->width_px == frame->width_px &&
        eye->height_px == frame->height_px) {
        return true;
    }
    detector_destroy(eye->detector);
    eye->width_px = frame->width_px;
    eye->height_px = frame->height_px;
    eye->detector = detector_create(&eye->settings.detectors, frame->width_px, frame->height_px);
    return eye->detector != NULL;
}

static void work_on(struct eye *eye, const struct hal_camera_luma *frame) {
    struct job *job = &eye->job;
    job->decoded = fit_detector(eye, frame);
    if (!job->decoded) {
        return;
    }
    job->model = camera_model_resized(&eye->settings.model, frame->width_px, frame->height_px);
    job->model = camera_model_zoomed(&job->model, job->pose.zoom);
    job->view = camera_view_at(&eye->settings.mount, &eye->settings.seat, &job->pose);
    const struct detector_sight sight = {&job->model, job->view};
    const uint64_t start_us = now_us();
    detector_frame(eye->detector, frame, frame->exposed_us, &sight, &job->found);
    const uint64_t took_us = now_us() - start_us;
    eye->counts.work_us += took_us;
    eye->counts.work_us_max = took_us > eye->counts.work_us_max ? took_us : eye->counts.work_us_max;
}

static uint32_t tell(struct eye *eye, uint32_t at_us,
                     void (*give)(void *context, const struct target_update *update),
                     void *context) {
    const struct job *job = &eye->job;
    if (!job->decoded) {
        eye->counts.undecodable++;
        return 0;
    }
    eye->counts.frames++;
    const uint64_t before = eye->counts.updates + eye->counts.gone;
    for (uint32_t i = 0; i < job->found.gone_count; i++) {
        const struct target_update update = {.kind = TARGET_GONE, .id = job->found.gone[i]};
        foresight_forget(&eye->foresight, update.id);
        give(context, &update);
        eye->counts.gone++;
    }
    for (uint32_t i = 0; i < job->found.count; i++) {
        struct target_update update;
        if (update_of(&job->found.item[i], &job->model, &job->view, &eye->foresight,
                      job->exposed_us, at_us, &update)) {
            give(context, &update);
            eye->counts.updates++;
        }
    }
    return (uint32_t)(eye->counts.updates + eye->counts.gone - before);
}

/// The pose in the middle of the frame's exposure.
static bool place(struct eye *eye, uint32_t stamp_us) {
    const uint32_t at_us = stamp_us - (uint32_t)eye->settings.latency_us;
    eye->job.exposed_us = at_us;
    if (pose_history_at(&eye->history, at_us, &eye->job.pose) != POSE_OK) {
        eye->counts.unplaced++;
        return false;
    }
    return true;
}

// ---------------------------------------------------------------- the worker

static void *work(void *context) {
    struct eye *eye = context;
    pthread_mutex_lock(&eye->mutex);
    while (eye->state != JOB_END) {
        if (eye->state != JOB_WAITING) {
            pthread_cond_wait(&eye->changed, &eye->mutex);
            continue;
        }
        pthread_mutex_unlock(&eye->mutex);
        struct hal_camera_luma luma;
        eye->job.decoded =
            linux_luma_take(&eye->luma, &eye->job.format, &eye->job.frame, &luma) == HAL_OK;
        if (eye->job.decoded) {
            work_on(eye, &luma);
        }
        pthread_mutex_lock(&eye->mutex);
        if (eye->state == JOB_WAITING) {
            eye->state = JOB_DONE;
            (void)eventfd_write(eye->done_fd, 1);
        }
    }
    pthread_mutex_unlock(&eye->mutex);
    return NULL;
}

static bool start(struct eye *eye) {
    eye->has_worker = side_job_thread(&eye->worker, work, eye);
    return eye->has_worker;
}

struct eye *eye_create(const struct eye_settings *settings) {
    struct eye *eye = calloc(1, sizeof *eye);
    if (eye == NULL) {
        return NULL;
    }
    eye->settings = *settings;
    pose_history_init(&eye->history);
    foresight_init(&eye->foresight);
    pthread_mutex_init(&eye->mutex, NULL);
    pthread_cond_init(&eye->changed, NULL);
    eye->done_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (eye->done_fd < 0 || !start(eye)) {
        eye_destroy(eye);
        return NULL;
    }
    return eye;
}

void eye_destroy(struct eye *eye) {
    if (eye == NULL) {
        return;
    }
    if (eye->has_worker) {
        pthread_mutex_lock(&eye->mutex);
        eye->state = JOB_END;
        pthread_cond_signal(&eye->changed);
        pthread_mutex_unlock(&eye->mutex);
        pthread_join(eye->worker, NULL);
    }
    if (eye->done_fd >= 0) {
        close(eye->done_fd);
    }
    pthread_cond_destroy(&eye->changed);
    pthread_mutex_destroy(&eye->mutex);
    detector_destroy(eye->detector);
    linux_luma_free(&eye->luma);
    free(eye->job.bytes);
    free(eye);
}

// ---------------------------------------------------------------- the caller's side

void eye_pose(struct eye *eye, uint32_t now, const struct camera_pose *pose) {
    pose_history_add(&eye->history, now, pose);
}

static bool make_room(struct job *job, size_t size) {
    if (size > job->capacity) {
        uint8_t *larger = realloc(job->bytes, size);
        if (larger == NULL) {
            return false;
        }
        job->bytes = larger;
        job->capacity = size;
    }
    return true;
}

enum eye_status eye_submit(struct eye *eye, const struct hal_camera_format *format,
                           const struct hal_camera_frame *frame) {
    pthread_mutex_lock(&eye->mutex);
    const bool free = eye->state == JOB_NONE;
    pthread_mutex_unlock(&eye->mutex);
    if (!free) {
        eye->counts.busy++;
        return EYE_BUSY;
    }
    if (!place(eye, frame->exposed_us)) {
        return EYE_UNPLACED;
    }
    struct job *job = &eye->job;
    if (frame->size_bytes == 0U || !make_room(job, frame->size_bytes)) {
        eye->counts.undecodable++;
        return EYE_ERROR_FRAME;
    }
    memcpy(job->bytes, frame->data, frame->size_bytes);
    job->format = *format;
    job->frame = *frame;
    job->frame.data = job->bytes;
    pthread_mutex_lock(&eye->mutex);
    eye->state = JOB_WAITING;
    pthread_cond_signal(&eye->changed);
    pthread_mutex_unlock(&eye->mutex);
    return EYE_OK;
}

bool eye_is_idle(struct eye *eye) {
    pthread_mutex_lock(&eye->mutex);
    const bool idle = eye->state != JOB_WAITING;
    pthread_mutex_unlock(&eye->mutex);
    return idle;
}

int eye_fd(const struct eye *eye) {
    return eye->done_fd;
}

uint32_t eye_collect(struct eye *eye, uint32_t at_us,
                     void (*give)(void *context, const struct target_update *update),
                     void *context) {
    eventfd_t ignored;
    (void)eventfd_read(eye->done_fd, &ignored);
    pthread_mutex_lock(&eye->mutex);
    const bool done = eye->state == JOB_DONE;
    pthread_mutex_unlock(&eye->mutex);
    if (!done) {
        return 0;
    }
    const uint32_t told = tell(eye, at_us, give, context);
    pthread_mutex_lock(&eye->mutex);
    eye->state = JOB_NONE;
    pthread_mutex_unlock(&eye->mutex);
    return told;
}

enum eye_status eye_look(struct eye *eye, const struct hal_camera_luma *frame, uint32_t at_us,
                         void (*give)(void *context, const struct target_update *update),
                         void *context) {
    if (!place(eye, frame->exposed_us)) {
        return EYE_UNPLACED;
    }
    work_on(eye, frame);
    (void)tell(eye, at_us, give, context);
    return eye->job.decoded ? EYE_OK : EYE_ERROR_FRAME;
}

const struct detections *eye_last(const struct eye *eye) {
    return &eye->job.found;
}

uint32_t eye_last_stamp_us(const struct eye *eye) {
    return eye->job.frame.exposed_us;
}

bool eye_last_ray(const struct eye *eye, uint32_t index, double ray[3]) {
    return camera_model_ray(&eye->job.model, eye->job.found.item[index].pixel, ray);
}

struct eye_counts eye_counts_of(const struct eye *eye) {
    return eye->counts;
}
