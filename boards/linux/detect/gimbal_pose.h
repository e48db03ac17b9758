/// Where the gimbal is at a moment, from what its controller knows of it.
///
/// The controller knows what it asked for, and of axes that measure their position where they were
/// some milliseconds ago. An axis is behind its setpoint by its latency (latency_ms of the rig
/// file), so
/// - one without feedback is where its setpoint was that long ago;
/// - one with feedback is where it was measured, and has gone on since as its setpoint went, that
///   long ago.
/// At 60 degrees a second a hobby servo that is 50 ms late is 3 degrees behind its setpoint, and a
/// measurement that is 4 ms old is wrong by 0.24 degree.
#ifndef DETECT_GIMBAL_POSE_H
#define DETECT_GIMBAL_POSE_H

#include "control/controller.h"
#include "detect/camera_pose.h"

struct gimbal_pose {
    uint32_t latency_us[2]; ///< of pan and tilt
    double fixed_focal_mm;  ///< of a camera without zoom axis
    double model_focal_mm;  ///< what the camera's model was calibrated at
    // Private from here on.
    struct pose_history setpoints; ///< at times of the controller
    uint64_t told_us;              ///< of the newest
};

void gimbal_pose_init(struct gimbal_pose *gimbal, const struct controller_config *config,
                      double fixed_focal_mm, double model_focal_mm);

/// After each tick. Returns the pose at_us, a time of the controller, from status->time_us to a few
/// ticks later.
/// Accuracy: that of latency_us times the acceleration of the axis; exact at steady speed
///           (tests/scenario/test_gimbal_pose.c).
struct camera_pose gimbal_pose_tick(struct gimbal_pose *gimbal,
                                    const struct controller_status *status, uint64_t at_us);

#endif
