/// Where the camera looked when a frame was exposed, and with it from its pixels to directions in
/// the world.
///
/// Frames arrive some 10 to 100 ms after they were exposed, and the gimbal has moved meanwhile: at
/// 60 degrees a second 50 ms are 3 degrees. So poses are kept for a while, and a frame is seen from
/// the pose at the time of its exposure, between the two kept ones around it.
#ifndef DETECT_CAMERA_POSE_H
#define DETECT_CAMERA_POSE_H

#include "detect/camera_model.h"
#include "fixed/must_check.h"
#include "motion/mount.h"

#include <stdbool.h>
#include <stdint.h>

/// The gimbal's joints and lens at a time.
struct camera_pose {
    double pan_deg, tilt_deg; ///< may be beyond one turn
    double zoom;              ///< focal length by that of the model's calibration; 1 without zoom
};

enum { POSE_HISTORY_SIZE = 512 };

/// Poses at rising times, of a clock in microseconds that wraps (hal/clock.h).
struct pose_history {
    uint32_t count, next;
    struct pose_sample {
        uint32_t at_us;
        struct camera_pose pose;
    } ring[POSE_HISTORY_SIZE];
};

void pose_history_init(struct pose_history *history);

/// A pose of every tick is too many for half a second of 1 ms ticks and no gain: one that comes
/// less than 1 ms after the last takes its place. Time that runs backwards begins a new history.
void pose_history_add(struct pose_history *history, uint32_t at_us, const struct camera_pose *pose);

enum pose_status {
    POSE_OK = 0,
    POSE_ERROR_UNKNOWN = -1, ///< no pose was ever given
    POSE_ERROR_TOO_OLD = -2, ///< before the oldest kept
    POSE_ERROR_TOO_NEW = -3  ///< more than POSE_AHEAD_US_MAX after the newest
};

/// After the newest pose pan and tilt are taken to go on as between the last two, for as long as
/// those are apart, and then to stand, for so long.
#define POSE_AHEAD_US_MAX 100000U

/// The pose at a time, linear between the samples around it.
/// Cost: O(log POSE_HISTORY_SIZE). Shown: tests/scenario/test_camera_pose.c.
enum pose_status pose_history_at(const struct pose_history *history, uint32_t at_us,
                                 struct camera_pose *pose) MUST_CHECK;

/// How the camera sits on the head of the gimbal: turned right, lifted, then rolled clockwise as
/// seen from behind it. All 0: it looks where the gimbal points.
struct camera_seat {
    double right_deg, up_deg, roll_deg;
};

/// The camera's axes in the world, unit vectors.
struct camera_view {
    double right[3], ahead[3], up[3];
};

/// Accuracy: 4 nrad, that of the mount's axes (tests/scenario/test_camera_pose.c, against
/// mount_direction and by hand).
struct camera_view camera_view_at(const struct mount *mount, const struct camera_seat *seat,
                                  const struct camera_pose *pose);

/// A direction in camera axes (right, ahead, up) as one in world axes (east, north, up), and back.
/// Lengths stay.
void camera_view_to_world(const struct camera_view *view, const double camera[3], double world[3]);
void camera_view_from_world(const struct camera_view *view, const double world[3],
                            double camera[3]);

/// A direction in world axes as the firmware takes it: any length but zero, |component| up to
/// 2^30.
struct vec3 camera_direction_q30(const double world[3]);

#endif
