/// A camera whose pictures a callback paints: GREY and YUYV, any size up to a maximum.
///
/// A frame is exposed every interval from the start on, and handed out latency_us later.
#ifndef DEVICES_FAKE_CAMERA_H
#define DEVICES_FAKE_CAMERA_H

#include "devices/fake_failures.h"
#include "hal/camera.h"
#include "hal/clock.h"

#define FAKE_CAMERA_BUFFERS_MAX     8U
#define FAKE_CAMERA_SIZE_PX_MIN     16U
#define FAKE_CAMERA_INTERVAL_US     33333U
#define FAKE_CAMERA_INTERVAL_US_MIN 1000U
#define FAKE_CAMERA_INTERVAL_US_MAX 1000000U

/// What a fake camera is. Stays the caller's.
struct fake_camera_model {
    /// Even, at least FAKE_CAMERA_SIZE_PX_MIN.
    uint32_t width_px_max, height_px_max;
    /// Where pictures are kept: buffer_count * width_px_max * height_px_max * 2 bytes.
    uint8_t *pool;
    size_t pool_bytes;
    /// 1 to FAKE_CAMERA_BUFFERS_MAX.
    uint32_t buffer_count;
    uint32_t latency_us;
    /// step 0: the camera doesn't have that control.
    struct hal_camera_range ranges[HAL_CAMERA_CONTROLS];
    /// Paints a picture; null: every byte of it is the low byte of the sequence number.
    void (*paint)(void *ctx, uint8_t *picture, const struct hal_camera_format *format,
                  uint32_t exposed_us, uint32_t sequence);
    void *ctx;
};

struct fake_camera {
    struct hal_camera hal;
    struct fake_failures failures;
    const struct hal_clock *clock;
    const struct fake_camera_model *model;
    struct hal_camera_format format;
    bool negotiated, streaming;
    /// The next exposure.
    uint32_t exposure_us, sequence;
    struct fake_camera_buffer {
        enum { FAKE_CAMERA_FREE, FAKE_CAMERA_READY, FAKE_CAMERA_OUT } state;
        struct hal_camera_frame frame;
    } buffers[FAKE_CAMERA_BUFFERS_MAX];
    int32_t values[HAL_CAMERA_CONTROLS];
    uint32_t lose_count, damage_count;
};

/// Must not move in memory afterwards. Controls are at their initial values.
void fake_camera_init(struct fake_camera *camera, const struct hal_clock *clock,
                      const struct fake_camera_model *model);

/// The next count frames are exposed but never arrive.
void fake_camera_lose(struct fake_camera *camera, uint32_t count);
/// The next count frames arrive damaged: the lower half is missing (0).
void fake_camera_damage(struct fake_camera *camera, uint32_t count);
/// Gone for good, in the middle of whatever it does.
void fake_camera_unplug(struct fake_camera *camera);

#endif
