/// The contract of hal/camera.h as a test.
#ifndef CONTRACT_SUPPORT_CAMERA_SUITE_H
#define CONTRACT_SUPPORT_CAMERA_SUITE_H

#include "hal/camera.h"
#include "hal/clock.h"

struct camera_fixture {
    const char *name;
    const struct hal_camera *camera;
    /// What exposures are stamped with.
    const struct hal_clock *clock;
    /// A format that the camera has; interval_us at least 1000.
    struct hal_camera_format format;
    /// Frames that can be out at a time; 2 to 32.
    uint32_t buffer_count;
    void *context;
    /// As just opened: no format agreed on, no failure pending.
    void (*reset)(void *context);
    /// Lets a moment of real or virtual time pass, at most a quarter of format.interval_us.
    void (*settle)(void *context);
    void (*unplug)(void *context);
    /// Of rigs in real time: see check_run_timed. null: time is virtual.
    const char *(*excuse)(void);
    /// See contract.h.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
    bool some_cannot_fail;
};

/// Needs reset and settle.
void camera_suite(const struct camera_fixture *fixture);

#endif
