#include "linux/linux_camera.h"

#include "linux/linux_camera_format.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

// ---------------------------------------------------------------- errors

static enum hal_status set_gone(struct linux_camera *camera) {
    camera->gone = true;
    linux_error_set(&camera->error, camera->path, "the camera has left", "plug it in again");
    return HAL_ERROR_GONE;
}

static enum hal_status failed(struct linux_camera *camera) {
    switch (errno) {
    case ENODEV:
    case ENXIO:
    case ESHUTDOWN:
        return set_gone(camera);
    case ENOSPC:
        linux_error_set(&camera->error, camera->path, "not enough USB bandwidth",
                        "take MJPEG, a smaller picture, or a port of its own");
        return HAL_ERROR_IO;
    default:
        return linux_error_from_errno(&camera->error, camera->path, errno, LINUX_CAMERA_MISSING);
    }
}

/// The same of a camera that is ours.
static enum hal_status went_wrong(struct linux_camera *camera) {
    const enum hal_status status = failed(camera);
    return status == HAL_ERROR_DENIED ? HAL_ERROR_IO : status;
}

// ---------------------------------------------------------------- streaming

static void free_buffers(struct linux_camera *camera) {
    for (uint32_t i = 0; i < LINUX_CAMERA_BUFFERS_MAX; i++) {
        if (camera->buffer[i].data != NULL) {
            munmap(camera->buffer[i].data, camera->buffer[i].size_bytes);
        }
        camera->buffer[i] = (struct linux_camera_buffer){0};
    }
    camera->buffer_count = 0;
    struct v4l2_requestbuffers none = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE,
                                       .memory = V4L2_MEMORY_MMAP};
    (void)ioctl(camera->fd, VIDIOC_REQBUFS, &none);
}

static struct v4l2_buffer buffer_at(uint32_t index) {
    return (struct v4l2_buffer){
        .index = index, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
}

/// Maps a buffer and gives it to the device.
static bool add_buffer(struct linux_camera *camera, uint32_t index) {
    struct v4l2_buffer about = buffer_at(index);
    if (ioctl(camera->fd, VIDIOC_QUERYBUF, &about) != 0) {
        return false;
    }
    void *const data =
        mmap(NULL, about.length, PROT_READ | PROT_WRITE, MAP_SHARED, camera->fd, about.m.offset);
    if (data == MAP_FAILED) {
        return false;
    }
    camera->buffer[index] = (struct linux_camera_buffer){.data = data, .size_bytes = about.length};
    about = buffer_at(index);
    return ioctl(camera->fd, VIDIOC_QBUF, &about) == 0;
}

static bool add_buffers(struct linux_camera *camera) {
    struct v4l2_requestbuffers request = {.count = LINUX_CAMERA_BUFFERS,
                                          .type = V4L2_BUF_TYPE_VIDEO_CAPTURE,
                                          .memory = V4L2_MEMORY_MMAP};
    if (ioctl(camera->fd, VIDIOC_REQBUFS, &request) != 0) {
        return false;
    }
    if (request.count < 2U || request.count > LINUX_CAMERA_BUFFERS_MAX) {
        errno = ENOMEM;
        return false;
    }
    for (uint32_t i = 0; i < request.count; i++) {
        if (!add_buffer(camera, i)) {
            return false;
        }
    }
    camera->buffer_count = request.count;
    return true;
}

static enum hal_status camera_start(void *ctx) {
    struct linux_camera *camera = ctx;
    if (camera->gone) {
        return HAL_ERROR_GONE;
    }
    if (!camera->negotiated) {
        return HAL_ERROR_ARGUMENT;
    }
    if (camera->streaming) {
        return HAL_OK;
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!add_buffers(camera) || ioctl(camera->fd, VIDIOC_STREAMON, &type) != 0) {
        const enum hal_status status = failed(camera);
        free_buffers(camera);
        return status;
    }
    camera->streaming = true;
    camera->any_frame = false;
    return HAL_OK;
}

static enum hal_status camera_stop(void *ctx) {
    struct linux_camera *camera = ctx;
    if (!camera->streaming) {
        return camera->gone ? HAL_ERROR_GONE : HAL_OK;
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    enum hal_status status = HAL_OK;
    if (ioctl(camera->fd, VIDIOC_STREAMOFF, &type) != 0) {
        status = went_wrong(camera);
        (void)ioctl(camera->fd, VIDIOC_STREAMOFF, &type); // freeing the buffers ends it, too
    }
    camera->streaming = false;
    free_buffers(camera);
    return camera->gone ? HAL_ERROR_GONE : status;
}

/// When the exposure began, on the board's clock.
static uint32_t exposed_us(const struct linux_camera *camera, const struct v4l2_buffer *buffer) {
    struct timespec now;
    const uint32_t now_us = hal_clock_now_us(camera->clock);
    clock_gettime(CLOCK_MONOTONIC, &now);
    const int64_t kernel_us = (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
    int64_t age_us =
        kernel_us - ((int64_t)buffer->timestamp.tv_sec * 1000000 + buffer->timestamp.tv_usec);
    if ((buffer->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
        age_us = 0; // of some other clock
    }
    if ((buffer->flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_EOF) {
        age_us += camera->format.interval_us;
    }
    return now_us - (uint32_t)(age_us < 0 ? 0 : age_us);
}

static enum hal_status hand_out(struct linux_camera *camera, const struct v4l2_buffer *taken,
                                struct hal_camera_frame *frame) {
    struct linux_camera_buffer *const buffer = &camera->buffer[taken->index];
    if (!camera->any_frame) {
        camera->any_frame = true;
        camera->first_sequence = taken->sequence;
    }
    buffer->out = true;
    buffer->sequence = taken->sequence - camera->first_sequence;
    const struct hal_camera_format *format = &camera->format;
    const size_t whole = (size_t)format->stride_bytes * format->height_px; // 0 of JPEG
    *frame = (struct hal_camera_frame){.data = buffer->data,
                                       .size_bytes = taken->bytesused,
                                       .exposed_us = exposed_us(camera, taken),
                                       .sequence = buffer->sequence,
                                       .damaged = (taken->flags & V4L2_BUF_FLAG_ERROR) != 0U ||
                                                  taken->bytesused < whole,
                                       .buffer_index = taken->index};
    return HAL_OK;
}

/// Gives the device the buffers that nobody was handed. False: errno; the next call tries again.
static bool pay_back(struct linux_camera *camera) {
    for (uint32_t i = 0; i < camera->buffer_count; i++) {
        struct v4l2_buffer back = buffer_at(i);
        if (camera->buffer[i].owed && ioctl(camera->fd, VIDIOC_QBUF, &back) != 0) {
            return false;
        }
        camera->buffer[i].owed = false;
    }
    return true;
}

static enum hal_status camera_dequeue(void *ctx, struct hal_camera_frame *frame) {
    struct linux_camera *camera = ctx;
    if (camera->gone || !camera->streaming) {
        return camera->gone ? HAL_ERROR_GONE : HAL_ERROR_DOWN;
    }
    struct v4l2_buffer taken = buffer_at(0);
    if (!pay_back(camera)) {
        return went_wrong(camera);
    }
    if (ioctl(camera->fd, VIDIOC_DQBUF, &taken) != 0) {
        return errno == EAGAIN ? HAL_EMPTY : went_wrong(camera);
    }
    if (taken.index >= camera->buffer_count) {
        linux_error_set(&camera->error, camera->path, "a frame in no buffer of ours",
                        "another cable, port or format may help");
        return HAL_ERROR_IO;
    }
    if (taken.bytesused == 0U || taken.bytesused > camera->buffer[taken.index].size_bytes) {
        // Cancelled, or nothing of the frame came.
        camera->buffer[taken.index].owed = true;
        linux_error_set(&camera->error, camera->path, "a frame without a picture",
                        "another cable, port or format may help");
        return pay_back(camera) ? HAL_ERROR_IO : went_wrong(camera);
    }
    return hand_out(camera, &taken, frame);
}

static enum hal_status camera_requeue(void *ctx, const struct hal_camera_frame *frame) {
    struct linux_camera *camera = ctx;
    if (camera->gone || !camera->streaming) {
        return camera->gone ? HAL_ERROR_GONE : HAL_ERROR_DOWN;
    }
    struct linux_camera_buffer *const buffer =
        frame->buffer_index < camera->buffer_count ? &camera->buffer[frame->buffer_index] : NULL;
    if (buffer == NULL || !buffer->out || buffer->sequence != frame->sequence) {
        return HAL_ERROR_ARGUMENT;
    }
    struct v4l2_buffer back = buffer_at(frame->buffer_index);
    if (ioctl(camera->fd, VIDIOC_QBUF, &back) != 0) {
        return went_wrong(camera);
    }
    buffer->out = false;
    return HAL_OK;
}

static enum hal_status camera_negotiate(void *ctx, struct hal_camera_format *format) {
    struct linux_camera *camera = ctx;
    if (camera->gone) {
        return HAL_ERROR_GONE;
    }
    if (camera->streaming) {
        return HAL_BUSY;
    }
    struct hal_camera_format agreed = *format;
    switch (linux_camera_format_agree(camera->fd, &agreed)) {
    case LINUX_CAMERA_FORMAT_AGREED:
        camera->format = *format = agreed;
        camera->negotiated = true;
        return HAL_OK;
    case LINUX_CAMERA_FORMAT_NONE:
        linux_error_set(&camera->error, camera->path, "it has none of the formats GREY, YUYV, MJPG",
                        "`v4l2-ctl --list-formats` shows what it has");
        return HAL_ERROR_UNSUPPORTED;
    default:
        return failed(camera);
    }
}

// ---------------------------------------------------------------- controls

/// HAL_OK, or why a control can't be used. A device can leave without a frame that tells of it.
static enum hal_status control_status(struct linux_camera *camera,
                                      enum hal_camera_control control) {
    uint32_t ignored;
    if (!camera->gone && linux_camera_controls_lost(&camera->controls, &ignored, &ignored)) {
        (void)set_gone(camera);
    }
    if (camera->gone) {
        return HAL_ERROR_GONE;
    }
    return camera->controls.present[control] ? HAL_OK : HAL_ERROR_UNSUPPORTED;
}

static enum hal_status camera_control_range(void *ctx, enum hal_camera_control control,
                                            struct hal_camera_range *range) {
    struct linux_camera *camera = ctx;
    const enum hal_status status = control_status(camera, control);
    if (status == HAL_OK) {
        *range = camera->controls.range[control];
    }
    return status;
}

static enum hal_status camera_control_get(void *ctx, enum hal_camera_control control,
                                          int32_t *value) {
    struct linux_camera *camera = ctx;
    const enum hal_status status = control_status(camera, control);
    if (status == HAL_OK) {
        *value = linux_camera_controls_get(&camera->controls, control);
    }
    return status;
}

static enum hal_status camera_control_set(void *ctx, enum hal_camera_control control,
                                          int32_t value) {
    struct linux_camera *camera = ctx;
    const enum hal_status status = control_status(camera, control);
    if (status != HAL_OK) {
        return status;
    }
    const struct hal_camera_range *range = &camera->controls.range[control];
    if (value < range->min || value > range->max) {
        return HAL_ERROR_ARGUMENT;
    }
    linux_camera_controls_set(&camera->controls, control, hal_camera_round(range, value));
    return HAL_OK;
}

uint32_t linux_camera_failed_settings(struct linux_camera *camera) {
    uint32_t taken = 0, failed = 0;
    (void)linux_camera_controls_lost(&camera->controls, &taken, &failed);
    return failed;
}

uint32_t linux_camera_taken_settings(struct linux_camera *camera) {
    uint32_t taken = 0, failed = 0;
    (void)linux_camera_controls_lost(&camera->controls, &taken, &failed);
    return taken;
}

// ---------------------------------------------------------------- opening

static const struct hal_camera_ops linux_camera_ops = {
    camera_negotiate, camera_start,         camera_stop,        camera_dequeue,
    camera_requeue,   camera_control_range, camera_control_get, camera_control_set};

/// Whether it gives frames, one plane each, by streaming.
static bool gives_frames(struct linux_camera *camera) {
    struct v4l2_capability about = {0};
    if (ioctl(camera->fd, VIDIOC_QUERYCAP, &about) != 0) {
        return false;
    }
    snprintf(camera->name, sizeof camera->name, "%.32s", (const char *)about.card);
    const uint32_t has =
        (about.capabilities & V4L2_CAP_DEVICE_CAPS) != 0U ? about.device_caps : about.capabilities;
    const uint32_t needed = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    errno = ENOTTY;
    return (has & needed) == needed;
}

static enum hal_status open_path(struct linux_camera *camera) {
    camera->fd = open(camera->path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (camera->fd < 0) {
        return failed(camera);
    }
    if (!gives_frames(camera)) {
        if (errno != ENOTTY && errno != EINVAL) {
            return failed(camera);
        }
        linux_error_set(&camera->error, camera->path, "it gives no frames",
                        "`boresight probe` lists the cameras");
        return HAL_ERROR_UNSUPPORTED;
    }
    if (!linux_camera_controls_open(&camera->controls, camera->fd)) {
        linux_error_set(&camera->error, camera->path, "no thread for its controls",
                        "is the system short of memory?");
        return HAL_ERROR_IO;
    }
    return HAL_OK;
}

enum hal_status linux_camera_open(struct linux_camera *camera, const char *device,
                                  const struct hal_clock *clock) {
    memset(camera, 0, sizeof *camera);
    camera->fd = -1;
    camera->clock = clock;
    snprintf(camera->path, sizeof camera->path, "%s", device);
    enum hal_status status = hal_camera_bind(&camera->hal, &linux_camera_ops, camera);
    if (status == HAL_OK && strchr(device, '/') == NULL) {
        status = linux_camera_find(device, camera->path, sizeof camera->path, &camera->error);
    }
    if (status == HAL_OK) {
        status = open_path(camera);
    }
    if (status != HAL_OK) {
        linux_camera_close(camera);
    }
    return status;
}

void linux_camera_close(struct linux_camera *camera) {
    if (camera->fd >= 0) {
        linux_camera_controls_close(&camera->controls);
        (void)camera_stop(camera);
        close(camera->fd);
    }
    camera->fd = -1;
    camera->gone = true;
}
