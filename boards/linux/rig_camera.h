/// The section [camera] of a rig file: its keys, and the camera model that follows from them.
/// Shown: tests/cli/camera.sh.
#ifndef LINUX_RIG_CAMERA_H
#define LINUX_RIG_CAMERA_H

#include "ini_schema.h"

#include "detect/camera_pose.h"
#include "detect/detector.h"
#include "hal/camera.h"

struct rig_camera;

/// The camera on the head, as far as pictures are concerned.
struct rig_eye {
    struct camera_model model; ///< at focal_mm
    struct camera_seat seat;
    double focal_mm;
    int32_t latency_us; ///< from the middle of a frame's exposure to its time stamp
    struct detector_settings detectors;
    bool detects; ///< at least one detector is wanted
};

/// Where its frames come from.
struct rig_frames {
    const char *device;            ///< a path or a name, as linux_camera_open takes it; empty: none
    struct hal_camera_format wish; ///< the size is that of the model
};

enum { RIG_CAMERA_KEY_COUNT = 25 };
extern const struct ini_key rig_camera_keys[RIG_CAMERA_KEY_COUNT];

/// False: told on stderr what is wrong with the numbers.
bool rig_camera_build(const struct rig_camera *from, const struct ini *ini, struct rig_eye *out);
bool rig_frames_build(const struct rig_camera *from, const struct ini *ini, struct rig_frames *out);

#endif
