#include "contract/support/v4l2_model.h"

#include "check.h"
#include "contract/support/syscalls.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BUFFERS_MAX  4U
#define BUFFER_BYTES 155648U ///< whole pages, and the largest picture
#define FORMATS      3U
#define CONTROLS     3U

struct v4l2_model_faults v4l2_model_faults;

static const uint32_t fourcc[FORMATS] = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
static const uint32_t sizes[][2] = {{320, 240}, {160, 120}};
static const struct v4l2_queryctrl ranges[CONTROLS] = {
    {.id = V4L2_CID_PAN_ABSOLUTE,
     .minimum = -V4L2_MODEL_PAN_MAX,
     .maximum = V4L2_MODEL_PAN_MAX,
     .step = V4L2_MODEL_PAN_STEP},
    {.id = V4L2_CID_TILT_ABSOLUTE, .minimum = -324000, .maximum = 324000, .step = 3600},
    {.id = V4L2_CID_ZOOM_ABSOLUTE,
     .minimum = V4L2_MODEL_ZOOM_MIN,
     .maximum = V4L2_MODEL_ZOOM_MAX,
     .step = 10,
     .default_value = V4L2_MODEL_ZOOM_MIN}};

static struct {
    pthread_mutex_t mutex; ///< controls are set by a thread of the driver's
    const struct hal_clock *clock;
    int file;
    bool gone;
    unsigned format, size;
    uint32_t interval_us;
    uint32_t buffer_count;
    uint32_t queue[BUFFERS_MAX], queued; ///< indices, the oldest first
    bool streaming;
    uint32_t due_us, sequence;
    struct v4l2_buffer ready[BUFFERS_MAX];
    uint32_t ready_count;
    int32_t value[CONTROLS];
    uint32_t settings;
} model = {.mutex = PTHREAD_MUTEX_INITIALIZER};

static int fails(int error_number) {
    errno = error_number;
    return -1;
}

// ---------------------------------------------------------------- controls

static const struct v4l2_queryctrl *range_of(uint32_t id, unsigned *at) {
    for (*at = 0; *at < CONTROLS; (*at)++) {
        if (ranges[*at].id == id && id != v4l2_model_faults.without) {
            return &ranges[*at];
        }
    }
    return NULL;
}

static bool control_breaks(void) {
    const bool breaks = v4l2_model_faults.control_errors > 0U;
    v4l2_model_faults.control_errors -= breaks ? 1U : 0U;
    return breaks;
}

static int query_control(struct v4l2_queryctrl *query) {
    unsigned at;
    const struct v4l2_queryctrl *range = range_of(query->id, &at);
    if (control_breaks()) {
        return fails(v4l2_model_faults.control_error);
    }
    if (range == NULL) {
        return fails(EINVAL);
    }
    *query = *range;
    return 0;
}

static int get_control(struct v4l2_control *control) {
    unsigned at;
    if (control_breaks()) {
        return fails(v4l2_model_faults.control_error);
    }
    if (range_of(control->id, &at) == NULL) {
        return fails(EINVAL);
    }
    control->value = model.value[at];
    return 0;
}

static int set_controls(const struct v4l2_ext_controls *request) {
    if (v4l2_model_faults.refuse != 0) {
        return fails(v4l2_model_faults.refuse);
    }
    for (uint32_t i = 0; i < request->count; i++) {
        unsigned at;
        if (range_of(request->controls[i].id, &at) == NULL) {
            return fails(EINVAL);
        }
        model.value[at] = request->controls[i].value;
        model.settings++;
    }
    return 0;
}

// ---------------------------------------------------------------- formats

static bool has_format(unsigned format) {
    return (v4l2_model_faults.missing >> format & 1U) == 0U;
}

static int enumerate_format(struct v4l2_fmtdesc *about) {
    uint32_t before = 0;
    for (unsigned i = 0; i < FORMATS; i++) {
        if (has_format(i) && before++ == about->index) {
            about->pixelformat = fourcc[i];
            return 0;
        }
    }
    return fails(EINVAL);
}

static int enumerate_size(struct v4l2_frmsizeenum *about) {
    if (about->index >= 2U) {
        return fails(EINVAL);
    }
    about->type = V4L2_FRMSIZE_TYPE_DISCRETE;
    about->discrete.width = sizes[about->index][0];
    about->discrete.height = sizes[about->index][1];
    return 0;
}

static uint32_t bytes_a_line(void) {
    return model.format == 2U ? 0U : sizes[model.size][0] * (model.format == 1U ? 2U : 1U);
}

static uint32_t frame_bytes(void) {
    return model.format == 2U ? 3000U : bytes_a_line() * sizes[model.size][1];
}

static int get_format(struct v4l2_format *format) {
    format->fmt.pix =
        (struct v4l2_pix_format){.width = sizes[model.size][0],
                                 .height = sizes[model.size][1],
                                 .pixelformat = fourcc[model.format],
                                 .field = V4L2_FIELD_NONE,
                                 .bytesperline = bytes_a_line(),
                                 .sizeimage = model.format == 2U ? BUFFER_BYTES : frame_bytes()};
    return 0;
}

static int set_format(struct v4l2_format *format) {
    if (model.buffer_count > 0U || v4l2_model_faults.busy) {
        return fails(EBUSY);
    }
    for (unsigned i = 0; i < FORMATS; i++) {
        const bool asked_for = fourcc[i] == format->fmt.pix.pixelformat;
        model.format = has_format(i) && (asked_for || !has_format(model.format)) ? i : model.format;
    }
    model.size = format->fmt.pix.width >= 240U ? 0U : 1U;
    return get_format(format);
}

static int parameters(struct v4l2_streamparm *about, bool set) {
    struct v4l2_fract *each = &about->parm.capture.timeperframe;
    if (set && each->denominator > 0U) {
        const uint64_t us = (uint64_t)each->numerator * 1000000U / each->denominator;
        model.interval_us = us < 60000U ? 33333U : 100000U;
    }
    if (v4l2_model_faults.slow_pixels && model.format != 2U) {
        model.interval_us = 500000;
    }
    *each = (struct v4l2_fract){model.interval_us, 1000000};
    return 0;
}

// ---------------------------------------------------------------- streaming

static int request_buffers(struct v4l2_requestbuffers *request) {
    if (v4l2_model_faults.busy) {
        return fails(EBUSY);
    }
    request->count = request->count < BUFFERS_MAX ? request->count : BUFFERS_MAX;
    model.buffer_count = request->count;
    model.queued = model.ready_count = 0;
    model.streaming = false;
    return 0;
}

static int describe_buffer(struct v4l2_buffer *about) {
    if (about->index >= model.buffer_count) {
        return fails(EINVAL);
    }
    about->length = BUFFER_BYTES;
    about->m.offset = about->index * BUFFER_BYTES;
    return 0;
}

static int queue_buffer(const struct v4l2_buffer *buffer) {
    if (buffer->index >= model.buffer_count || model.queued == BUFFERS_MAX) {
        return fails(EINVAL);
    }
    for (uint32_t i = 0; i < model.queued; i++) {
        if (model.queue[i] == buffer->index) {
            return fails(EINVAL);
        }
    }
    model.queue[model.queued++] = buffer->index;
    return 0;
}

static bool takes(uint32_t *fault) {
    const bool has = *fault > 0U;
    *fault -= has ? 1U : 0U;
    return has;
}

/// Exposes what is due, into the buffers that it has.
static void expose(void) {
    const uint32_t now_us = hal_clock_now_us(model.clock);
    while (model.streaming && hal_clock_has_reached(now_us, model.due_us)) {
        const uint32_t number = model.sequence++;
        model.due_us += model.interval_us;
        if (takes(&v4l2_model_faults.lose) || model.queued == 0U) {
            continue;
        }
        struct v4l2_buffer *buffer = &model.ready[model.ready_count++];
        uint8_t picture[BUFFER_BYTES];
        memset(picture, (int)(number & 255U), sizeof picture);
        *buffer = (struct v4l2_buffer){.index = model.queue[0],
                                       .type = V4L2_BUF_TYPE_VIDEO_CAPTURE,
                                       .memory = V4L2_MEMORY_MMAP,
                                       .bytesused = frame_bytes(),
                                       .sequence = number};
        syscalls_watch(false);
        CHECK_EQ(pwrite(model.file, picture, sizeof picture, buffer->index * BUFFER_BYTES),
                 sizeof picture);
        syscalls_watch(true);
        model.queued--;
        memmove(model.queue, model.queue + 1, model.queued * sizeof *model.queue);
        buffer->flags = takes(&v4l2_model_faults.flag) ? V4L2_BUF_FLAG_ERROR : 0U;
        buffer->bytesused /= takes(&v4l2_model_faults.cut) ? 2U : 1U;
        buffer->bytesused = takes(&v4l2_model_faults.empty) ? 0U : buffer->bytesused;
        buffer->bytesused = takes(&v4l2_model_faults.swell) ? BUFFER_BYTES + 1U : buffer->bytesused;
    }
}

static int dequeue_buffer(struct v4l2_buffer *buffer) {
    expose();
    if (!model.streaming || model.ready_count == 0U) {
        return fails(model.streaming ? EAGAIN : EINVAL);
    }
    *buffer = model.ready[0];
    model.ready_count--;
    memmove(model.ready, model.ready + 1, model.ready_count * sizeof *model.ready);
    return 0;
}

static int stream(bool on) {
    if (on && !model.streaming) {
        model.due_us = hal_clock_now_us(model.clock) + model.interval_us;
        model.sequence = 5; // drivers need not begin with 0
    }
    if (!on) {
        model.queued = model.ready_count = 0;
    }
    model.streaming = on;
    return 0;
}

// ---------------------------------------------------------------- serving

static int capability(struct v4l2_capability *about) {
    *about = (struct v4l2_capability){.capabilities = V4L2_CAP_DEVICE_CAPS};
    snprintf((char *)about->card, sizeof about->card, "model");
    about->device_caps =
        (v4l2_model_faults.no_frames ? V4L2_CAP_VIDEO_OUTPUT : V4L2_CAP_VIDEO_CAPTURE) |
        V4L2_CAP_STREAMING;
    return 0;
}

static int answer(unsigned long request, void *argument) {
    switch (request) {
    case VIDIOC_QUERYCAP:
        return capability(argument);
    case VIDIOC_QUERYCTRL:
        return query_control(argument);
    case VIDIOC_G_CTRL:
        return get_control(argument);
    case VIDIOC_S_EXT_CTRLS:
        return set_controls(argument);
    case VIDIOC_ENUM_FMT:
        return enumerate_format(argument);
    case VIDIOC_ENUM_FRAMESIZES:
        return enumerate_size(argument);
    case VIDIOC_G_FMT:
        return get_format(argument);
    case VIDIOC_S_FMT:
        return set_format(argument);
    case VIDIOC_G_PARM:
        return parameters(argument, false);
    case VIDIOC_S_PARM:
        return parameters(argument, true);
    case VIDIOC_REQBUFS:
        return request_buffers(argument);
    case VIDIOC_QUERYBUF:
        return describe_buffer(argument);
    case VIDIOC_QBUF:
        return queue_buffer(argument);
    case VIDIOC_DQBUF:
        return dequeue_buffer(argument);
    case VIDIOC_STREAMON:
        return stream(true);
    case VIDIOC_STREAMOFF:
        return stream(false);
    default:
        return fails(ENOTTY);
    }
}

static bool serve(int fd, unsigned long request, void *argument, int *result) {
    (void)fd;
    if ((request >> 8 & 255U) != 'V') {
        return false;
    }
    pthread_mutex_lock(&model.mutex);
    *result = model.gone ? fails(ENODEV) : answer(request, argument);
    const int why = errno;
    pthread_mutex_unlock(&model.mutex);
    errno = why;
    return true;
}

const char *v4l2_model_plug(const struct hal_clock *clock) {
    static char path[] = "/tmp/boresight-video-XXXXXX";
    model.clock = clock;
    model.file = mkstemp(path);
    CHECK(model.file >= 0 && ftruncate(model.file, BUFFERS_MAX * BUFFER_BYTES) == 0);
    syscalls_serve_ioctl(serve);
    v4l2_model_reset();
    return path;
}

void v4l2_model_reset(void) {
    pthread_mutex_lock(&model.mutex);
    memset(&v4l2_model_faults, 0, sizeof v4l2_model_faults);
    model.gone = model.streaming = false;
    model.format = 1;
    model.size = 0;
    model.interval_us = 100000;
    model.buffer_count = model.queued = model.ready_count = 0;
    for (unsigned i = 0; i < CONTROLS; i++) {
        model.value[i] = ranges[i].default_value;
    }
    model.settings = 0;
    pthread_mutex_unlock(&model.mutex);
}

void v4l2_model_unplug(void) {
    pthread_mutex_lock(&model.mutex);
    model.gone = true;
    pthread_mutex_unlock(&model.mutex);
}

int32_t v4l2_model_value(uint32_t id) {
    unsigned at;
    pthread_mutex_lock(&model.mutex);
    const int32_t value = range_of(id, &at) != NULL ? model.value[at] : 0;
    pthread_mutex_unlock(&model.mutex);
    return value;
}

uint32_t v4l2_model_settings(void) {
    pthread_mutex_lock(&model.mutex);
    const uint32_t settings = model.settings;
    pthread_mutex_unlock(&model.mutex);
    return settings;
}

uint32_t v4l2_model_queued(void) {
    pthread_mutex_lock(&model.mutex);
    const uint32_t queued = model.queued + model.ready_count;
    pthread_mutex_unlock(&model.mutex);
    return queued;
}
