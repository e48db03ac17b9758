/// A camera: frames that are lent to the caller and given back, and its own pan, tilt and zoom.
///
/// negotiate, start, then dequeue and requeue until stop. A device has a few buffers; a frame
/// occupies one from dequeue to requeue, and while all are out the frames that come are lost, which
/// shows in the sequence numbers.
/// Shown: tests/contract/support/camera_suite.h, on every implementation.
#ifndef HAL_CAMERA_H
#define HAL_CAMERA_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum hal_camera_pixels {
    /// 8 bits of luminance a pixel.
    HAL_CAMERA_GREY = 1,
    /// Y0 U Y1 V: two pixels in four bytes; width_px is even.
    HAL_CAMERA_YUYV,
    /// A JPEG picture a frame; size_bytes varies.
    HAL_CAMERA_MJPEG
};

struct hal_camera_format {
    enum hal_camera_pixels pixels;
    uint32_t width_px, height_px;
    /// From one line to the next; 0 with HAL_CAMERA_MJPEG. Set by the device.
    uint32_t stride_bytes;
    /// The largest frame. Set by the device.
    uint32_t frame_bytes_max;
    uint32_t interval_us;
};

struct hal_camera_frame {
    /// size_bytes of picture; valid until requeue or stop.
    const uint8_t *data;
    uint32_t size_bytes;
    /// Start of the exposure on the board's clock, as well as the device knows.
    uint32_t exposed_us;
    /// One more than the frame before; gaps are frames that were lost. 0 with the first after
    /// start. Wraps.
    uint32_t sequence;
    /// Part of the picture is missing or wrong.
    bool damaged;
    /// The device's own mark of the buffer.
    uint32_t buffer_index;
};

/// The brightness of a frame, whatever its pixels: what detectors work on. A view: the memory is
/// the frame's or that of whoever converted it.
struct hal_camera_luma {
    /// The top left pixel; then width_px bytes to the right, and stride_bytes to the next line.
    const uint8_t *luma;
    uint32_t width_px, height_px, stride_bytes;
    /// As of the frame.
    uint32_t exposed_us, sequence;
    bool damaged;
};

enum hal_camera_control {
    /// Arc-seconds (1/3600 degree), positive to the right.
    HAL_CAMERA_PAN,
    /// Arc-seconds, positive up.
    HAL_CAMERA_TILT,
    /// The camera's own unit, larger is narrower.
    HAL_CAMERA_ZOOM,
    HAL_CAMERA_CONTROLS
};

/// min <= initial <= max; step at least 1.
struct hal_camera_range {
    int32_t min, max, step, initial;
};

struct hal_camera_ops {
    enum hal_status (*negotiate)(void *ctx, struct hal_camera_format *format);
    enum hal_status (*start)(void *ctx);
    enum hal_status (*stop)(void *ctx);
    enum hal_status (*dequeue)(void *ctx, struct hal_camera_frame *frame);
    enum hal_status (*requeue)(void *ctx, const struct hal_camera_frame *frame);
    enum hal_status (*control_range)(void *ctx, enum hal_camera_control control,
                                     struct hal_camera_range *range);
    enum hal_status (*control_get)(void *ctx, enum hal_camera_control control, int32_t *value);
    enum hal_status (*control_set)(void *ctx, enum hal_camera_control control, int32_t value);
};

struct hal_camera {
    const struct hal_camera_ops *ops;
    void *ctx;
};

/// Fills *camera. HAL_ERROR_ARGUMENT (and *camera as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status
hal_camera_bind(struct hal_camera *camera, const struct hal_camera_ops *ops, void *ctx) {
    if (camera == NULL || ops == NULL || ops->negotiate == NULL || ops->start == NULL ||
        ops->stop == NULL || ops->dequeue == NULL || ops->requeue == NULL ||
        ops->control_range == NULL || ops->control_get == NULL || ops->control_set == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *camera = (struct hal_camera){ops, ctx};
    return HAL_OK;
}

/// Agrees on a format. In: the wish (pixels, width, height, interval; 0 in any: no matter). Out:
/// what the device will give, as near as it can: compare, and do without the camera if that won't
/// do.
/// Returns:  HAL_OK; HAL_BUSY: stop first; HAL_ERROR_UNSUPPORTED: it has no format that this header
///           knows; HAL_ERROR_DENIED: another program has it; HAL_ERROR_IO, HAL_ERROR_GONE.
///           *format is changed with HAL_OK only.
/// Cost:     at start-up only: may take milliseconds on Linux.
MUST_CHECK static inline enum hal_status hal_camera_negotiate(const struct hal_camera *camera,
                                                              struct hal_camera_format *format) {
    if (format == NULL || (unsigned)format->pixels > HAL_CAMERA_MJPEG) {
        return HAL_ERROR_ARGUMENT;
    }
    return camera->ops->negotiate(camera->ctx, format);
}

/// Begins to stream in the negotiated format; with no effect if it streams.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: not negotiated; HAL_ERROR_DENIED: another program has it;
///           HAL_ERROR_IO (on Linux also: not enough USB bandwidth), HAL_ERROR_GONE.
/// Cost:     may take milliseconds on Linux.
MUST_CHECK static inline enum hal_status hal_camera_start(const struct hal_camera *camera) {
    return camera->ops->start(camera->ctx);
}

/// Ends the stream; with no effect if it doesn't stream. All frames go back to the device.
/// Returns:  HAL_OK; HAL_ERROR_IO, HAL_ERROR_GONE: it has stopped all the same.
/// Cost:     may take milliseconds on Linux.
MUST_CHECK static inline enum hal_status hal_camera_stop(const struct hal_camera *camera) {
    return camera->ops->stop(camera->ctx);
}

/// Takes the oldest frame.
/// Returns:  HAL_OK; HAL_EMPTY: none is ready (or all are out);
///           HAL_ERROR_DOWN: it doesn't stream; HAL_ERROR_IO: count it, the stream goes on;
///           HAL_ERROR_GONE. *frame is set with HAL_OK only.
/// Cost:     no copy of the picture; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_camera_dequeue(const struct hal_camera *camera,
                                                            struct hal_camera_frame *frame) {
    if (frame == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return camera->ops->dequeue(camera->ctx, frame);
}

/// Gives a frame back; in any order.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: it is not out (given back before, or before a stop);
///           HAL_ERROR_DOWN: it doesn't stream, nothing to give back;
///           HAL_ERROR_IO: still out, give it back later; HAL_ERROR_GONE.
/// Cost:     on Linux one system call.
MUST_CHECK static inline enum hal_status hal_camera_requeue(const struct hal_camera *camera,
                                                            const struct hal_camera_frame *frame) {
    if (frame == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return camera->ops->requeue(camera->ctx, frame);
}

static inline bool hal_camera_has_control(enum hal_camera_control control) {
    return (unsigned)control < HAL_CAMERA_CONTROLS;
}

/// What a control can be set to.
/// Returns:  HAL_OK; HAL_ERROR_UNSUPPORTED: this camera doesn't have it; HAL_ERROR_IO,
///           HAL_ERROR_GONE. *range is set with HAL_OK only.
/// Cost:     none to speak of: it was read when the device was opened.
MUST_CHECK static inline enum hal_status hal_camera_control_range(const struct hal_camera *camera,
                                                                  enum hal_camera_control control,
                                                                  struct hal_camera_range *range) {
    if (range == NULL || !hal_camera_has_control(control)) {
        return HAL_ERROR_ARGUMENT;
    }
    return camera->ops->control_range(camera->ctx, control, range);
}

/// Where a control is, as far as the device says; at least what it was last set to.
/// Returns:  as hal_camera_control_range.
/// Cost:     none to speak of: the last value known, no traffic.
MUST_CHECK static inline enum hal_status hal_camera_control_get(const struct hal_camera *camera,
                                                                enum hal_camera_control control,
                                                                int32_t *value) {
    if (value == NULL || !hal_camera_has_control(control)) {
        return HAL_ERROR_ARGUMENT;
    }
    return camera->ops->control_get(camera->ctx, control, value);
}

/// Sets a control; the camera moves there in its own time. A value between steps goes to the
/// nearest step, the lower one of two.
/// Returns:  HAL_OK: on its way; HAL_BUSY: the one before is still being handed over;
///           HAL_ERROR_ARGUMENT: outside the range; HAL_ERROR_UNSUPPORTED: no such control;
///           HAL_ERROR_IO, HAL_ERROR_GONE: the old value holds.
/// Cost:     a copy: the slow transfer to the device runs in the background.
MUST_CHECK static inline enum hal_status hal_camera_control_set(const struct hal_camera *camera,
                                                                enum hal_camera_control control,
                                                                int32_t value) {
    if (!hal_camera_has_control(control)) {
        return HAL_ERROR_ARGUMENT;
    }
    return camera->ops->control_set(camera->ctx, control, value);
}

/// The step nearest to value, which must lie in the range. For implementations.
static inline int32_t hal_camera_round(const struct hal_camera_range *range, int32_t value) {
    const int64_t above = (int64_t)value - range->min;
    const int64_t step = range->step;
    int64_t steps = above / step;
    steps += 2 * (above % step) > step ? 1 : 0;
    const int64_t rounded = range->min + steps * step;
    return (int32_t)(rounded > range->max ? rounded - step : rounded);
}

#endif
