/// How long before its time stamp a frame was exposed, and how long the lens is: measured by what
/// stands still in the world while the gimbal turns.
///
/// Each sighting is a direction in the camera's axes and a time stamp; the poses say how the camera
/// stood. Only with the right latency do all sightings of a thing lie in one direction of the
/// world; the one that scatters them least is taken. Of axes that don't measure themselves the
/// poses are what they were told, so what such an axis is late by is in the result, too, unless its
/// own latency is known.
///
/// A lens that is longer or shorter than its model lets a thing move with the gimbal, or against
/// it, in time with the angle, where a wrong latency does so in time with the speed; so both are
/// told apart, and a lens that is known badly does no harm to the latency. What the lens is worth
/// depends on the gimbal: axes that do not measure themselves are as long as their calibration, and
/// a camera that sits r metres before the axes sees what is d metres away move by r / d more.
#ifndef LINUX_CAMERA_LATENCY_H
#define LINUX_CAMERA_LATENCY_H

#include "detect/camera_pose.h"

enum { CAMERA_LATENCY_POSES = 16384, CAMERA_LATENCY_SIGHTS = 2048, CAMERA_LATENCY_IDS = 32 };

/// Looked for within these.
#define CAMERA_LATENCY_MS_MIN   (-200)
#define CAMERA_LATENCY_MS_MAX   500
#define CAMERA_LATENCY_LENS_MIN 0.5
#define CAMERA_LATENCY_LENS_MAX 2.0

struct camera_latency {
    struct mount mount;
    struct camera_seat seat;
    uint32_t pose_count, sight_count, id_count;
    uint32_t pose_us[CAMERA_LATENCY_POSES]; ///< of the clock of the time stamps, rising
    struct camera_pose pose[CAMERA_LATENCY_POSES];
    struct camera_latency_sight {
        uint32_t stamp_us;
        uint32_t thing; ///< index of its id
        double ray[3];  ///< unit: right, ahead, up of the camera
    } sight[CAMERA_LATENCY_SIGHTS];
    uint32_t id[CAMERA_LATENCY_IDS];
};

void camera_latency_init(struct camera_latency *latency, const struct mount *mount,
                         const struct camera_seat *seat);

/// In the order of time. What there is no room for is left out; poses less than 1 ms apart, too.
void camera_latency_pose(struct camera_latency *latency, uint32_t at_us,
                         const struct camera_pose *pose);
void camera_latency_sight(struct camera_latency *latency, uint32_t stamp_us, uint32_t id,
                          const double ray[3]);

struct camera_latency_found {
    double latency_ms;
    double lens;    ///< the focal length is so many times that of the model
    double rms_deg; ///< how far the sightings are from their middles with both
};

/// Returns:  NULL, or why it can't be told: too few sightings, or too little motion.
/// Accuracy: 0.5 ms and 0.2 % with 0.02 degree of noise (tests/scenario/test_camera_latency.c).
///           What the rest of the rig does to it: tests/cli/calibrate.sh.
/// Cost:     about 250 looks at every sighting, some 100 ms.
const char *camera_latency_fit(const struct camera_latency *latency,
                               struct camera_latency_found *found) MUST_CHECK;

#endif
