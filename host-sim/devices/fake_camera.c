#include "devices/fake_camera.h"

#include "devices/fake_bind.h"

#include <string.h>

static uint32_t clamp(uint32_t value, uint32_t min, uint32_t max) {
    return value < min ? min : (value > max ? max : value);
}

static enum hal_status fake_camera_negotiate(void *ctx, struct hal_camera_format *format) {
    struct fake_camera *camera = ctx;
    const struct fake_camera_model *model = camera->model;
    const enum hal_status status = fake_failures_call(&camera->failures);
    if (status != HAL_OK) {
        return status;
    }
    if (camera->streaming) {
        return HAL_BUSY;
    }
    const bool yuyv = format->pixels == HAL_CAMERA_YUYV;
    const uint32_t width_px = format->width_px == 0U ? model->width_px_max : format->width_px;
    const uint32_t height_px = format->height_px == 0U ? model->height_px_max : format->height_px;
    const uint32_t interval_us =
        format->interval_us == 0U ? FAKE_CAMERA_INTERVAL_US : format->interval_us;
    format->pixels = yuyv ? HAL_CAMERA_YUYV : HAL_CAMERA_GREY;
    format->width_px = clamp(width_px, FAKE_CAMERA_SIZE_PX_MIN, model->width_px_max) & ~1U;
    format->height_px = clamp(height_px, FAKE_CAMERA_SIZE_PX_MIN, model->height_px_max);
    format->interval_us =
        clamp(interval_us, FAKE_CAMERA_INTERVAL_US_MIN, FAKE_CAMERA_INTERVAL_US_MAX);
    format->stride_bytes = format->width_px * (yuyv ? 2U : 1U);
    format->frame_bytes_max = format->stride_bytes * format->height_px;
    camera->format = *format;
    camera->negotiated = true;
    return HAL_OK;
}

static void free_all(struct fake_camera *camera) {
    for (uint32_t i = 0; i < camera->model->buffer_count; i++) {
        camera->buffers[i].state = FAKE_CAMERA_FREE;
    }
}

static enum hal_status fake_camera_start(void *ctx) {
    struct fake_camera *camera = ctx;
    const enum hal_status status = fake_failures_call(&camera->failures);
    if (status != HAL_OK) {
        return status;
    }
    if (!camera->negotiated) {
        return HAL_ERROR_ARGUMENT;
    }
    if (!camera->streaming) {
        free_all(camera);
        camera->streaming = true;
        camera->exposure_us = hal_clock_now_us(camera->clock);
        camera->sequence = 0;
    }
    return HAL_OK;
}

static enum hal_status fake_camera_stop(void *ctx) {
    struct fake_camera *camera = ctx;
    camera->streaming = false; // even if it fails
    return fake_failures_call(&camera->failures);
}

/// A frame is exposed: it goes to a free buffer, or it is lost.
static void expose(struct fake_camera *camera) {
    const struct fake_camera_model *model = camera->model;
    const struct hal_camera_format *format = &camera->format;
    uint32_t index = 0;
    while (index < model->buffer_count && camera->buffers[index].state != FAKE_CAMERA_FREE) {
        index++;
    }
    if (camera->lose_count > 0U) {
        camera->lose_count--;
    } else if (index < model->buffer_count) {
        uint8_t *picture = model->pool + index * (model->pool_bytes / model->buffer_count);
        const uint32_t bytes = format->frame_bytes_max;
        if (model->paint != NULL) {
            model->paint(model->ctx, picture, format, camera->exposure_us, camera->sequence);
        } else {
            memset(picture, (int)(camera->sequence & 0xFFU), bytes);
        }
        const bool damaged = camera->damage_count > 0U;
        if (damaged) {
            camera->damage_count--;
            memset(picture + bytes / 2U, 0, bytes - bytes / 2U);
        }
        camera->buffers[index].state = FAKE_CAMERA_READY;
        camera->buffers[index].frame = (struct hal_camera_frame){
            picture, bytes, camera->exposure_us, camera->sequence, damaged, index};
    }
    camera->sequence++;
    camera->exposure_us += format->interval_us;
}

/// The ready frame that was exposed first; null if there is none.
static struct fake_camera_buffer *oldest_ready(struct fake_camera *camera) {
    struct fake_camera_buffer *oldest = NULL;
    for (uint32_t i = 0; i < camera->model->buffer_count; i++) {
        struct fake_camera_buffer *buffer = &camera->buffers[i];
        if (buffer->state == FAKE_CAMERA_READY &&
            (oldest == NULL || camera->sequence - buffer->frame.sequence >
                                   camera->sequence - oldest->frame.sequence)) {
            oldest = buffer;
        }
    }
    return oldest;
}

static enum hal_status fake_camera_dequeue(void *ctx, struct hal_camera_frame *frame) {
    struct fake_camera *camera = ctx;
    const enum hal_status status = fake_failures_call(&camera->failures);
    if (status != HAL_OK) {
        return status;
    }
    if (!camera->streaming) {
        return HAL_ERROR_DOWN;
    }
    const uint32_t now_us = hal_clock_now_us(camera->clock);
    while (hal_clock_has_reached(now_us, camera->exposure_us + camera->model->latency_us)) {
        expose(camera);
    }
    struct fake_camera_buffer *buffer = oldest_ready(camera);
    if (buffer == NULL) {
        return HAL_EMPTY;
    }
    buffer->state = FAKE_CAMERA_OUT;
    *frame = buffer->frame;
    return HAL_OK;
}

static enum hal_status fake_camera_requeue(void *ctx, const struct hal_camera_frame *frame) {
    struct fake_camera *camera = ctx;
    const enum hal_status status = fake_failures_call(&camera->failures);
    if (status != HAL_OK) {
        return status;
    }
    if (!camera->streaming) {
        return HAL_ERROR_DOWN;
    }
    if (frame->buffer_index >= camera->model->buffer_count) {
        return HAL_ERROR_ARGUMENT;
    }
    struct fake_camera_buffer *buffer = &camera->buffers[frame->buffer_index];
    if (buffer->state != FAKE_CAMERA_OUT || buffer->frame.sequence != frame->sequence) {
        return HAL_ERROR_ARGUMENT;
    }
    buffer->state = FAKE_CAMERA_FREE;
    return HAL_OK;
}

/// Whether a control can be used: HAL_OK, or what to answer. Counts as a call.
static enum hal_status control_status(struct fake_camera *camera, enum hal_camera_control control) {
    const enum hal_status status = fake_failures_call(&camera->failures);
    if (status == HAL_OK && camera->model->ranges[control].step == 0) {
        return HAL_ERROR_UNSUPPORTED;
    }
    return status;
}

static enum hal_status fake_camera_control_range(void *ctx, enum hal_camera_control control,
                                                 struct hal_camera_range *range) {
    struct fake_camera *camera = ctx;
    const enum hal_status status = control_status(camera, control);
    if (status == HAL_OK) {
        *range = camera->model->ranges[control];
    }
    return status;
}

static enum hal_status fake_camera_control_get(void *ctx, enum hal_camera_control control,
                                               int32_t *value) {
    struct fake_camera *camera = ctx;
    const enum hal_status status = control_status(camera, control);
    if (status == HAL_OK) {
        *value = camera->values[control];
    }
    return status;
}

static enum hal_status fake_camera_control_set(void *ctx, enum hal_camera_control control,
                                               int32_t value) {
    struct fake_camera *camera = ctx;
    const struct hal_camera_range *range = &camera->model->ranges[control];
    if (range->step != 0 && (value < range->min || value > range->max)) {
        const enum hal_status presence = fake_failures_presence(&camera->failures);
        return presence == HAL_OK ? HAL_ERROR_ARGUMENT : presence;
    }
    const enum hal_status status = control_status(camera, control);
    if (status == HAL_OK) {
        camera->values[control] = hal_camera_round(range, value);
    }
    return status;
}

static const struct hal_camera_ops ops = {fake_camera_negotiate,   fake_camera_start,
                                          fake_camera_stop,        fake_camera_dequeue,
                                          fake_camera_requeue,     fake_camera_control_range,
                                          fake_camera_control_get, fake_camera_control_set};

void fake_camera_init(struct fake_camera *camera, const struct hal_clock *clock,
                      const struct fake_camera_model *model) {
    *camera = (struct fake_camera){.clock = clock, .model = model};
    const uint64_t needed_bytes =
        (uint64_t)model->buffer_count * model->width_px_max * model->height_px_max * 2U;
    if (model->buffer_count - 1U >= FAKE_CAMERA_BUFFERS_MAX || model->pool_bytes < needed_bytes ||
        model->width_px_max < FAKE_CAMERA_SIZE_PX_MIN || model->width_px_max % 2U != 0U ||
        model->height_px_max < FAKE_CAMERA_SIZE_PX_MIN) {
        abort();
    }
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS; i++) {
        camera->values[i] = model->ranges[i].initial;
    }
    fake_bind_check(hal_camera_bind(&camera->hal, &ops, camera));
}

void fake_camera_lose(struct fake_camera *camera, uint32_t count) {
    camera->lose_count = count;
}

void fake_camera_damage(struct fake_camera *camera, uint32_t count) {
    camera->damage_count = count;
}

void fake_camera_unplug(struct fake_camera *camera) {
    fake_failures_set_gone(&camera->failures, true);
}
