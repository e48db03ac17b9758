/// The section [camera] of a scenario: the controller hears of the targets only through the rig's
/// camera, as on a rig. The simulator renders what it sees, and the detectors look.
/// Shown: tests/cli/camera_loop.sh.
#ifndef LINUX_SCENARIO_CAMERA_H
#define LINUX_SCENARIO_CAMERA_H

#include "ini_schema.h"
#include "rig.h"
#include "stage.h"

#include "detect/eye.h"
#include "detect/gimbal_pose.h"

#include "sim.h"

/// As in the file, scaled.
struct scenario_camera_keys {
    int looks;
    int64_t size_udeg, fps_milli, latency_us, noise_milli, blur_milli;
    int64_t backdrop_luma, backdrop_contrast;
};
enum { SCENARIO_CAMERA_KEY_COUNT = 8 };
extern const struct ini_key scenario_camera_keys[SCENARIO_CAMERA_KEY_COUNT];

/// Frames on their way from the sensor to the detectors.
enum { SCENARIO_CAMERA_FRAMES = 8 };

struct scenario_camera {
    struct scenario_camera_keys keys;
    const struct rig *rig;
    struct eye *eye;
    struct gimbal_pose gimbal;
    struct stage stage;
    uint64_t next_us; ///< of the next exposure
    uint32_t first, waiting;
    struct scenario_frame {
        uint64_t at_us;
        uint8_t *picture;
    } frame[SCENARIO_CAMERA_FRAMES];
    struct sim *sim; ///< during a step
    struct sim_camera hook;
};

/// Tells on stderr what is wrong with it: the rig names no detectors, tags without libapriltag.
/// Returns: EXIT_STATUS_OK, or another. Free with scenario_camera_close in any case.
enum exit_status scenario_camera_open(struct scenario_camera *camera, const struct rig *rig,
                                      const struct ini *scenario, uint64_t seed);

/// For a controller elsewhere: what the camera sees now, width_px * height_px of the rig's lens,
/// and how often it looks. False: no memory.
bool scenario_camera_draw(struct scenario_camera *camera, const struct sim *sim,
                          uint8_t *picture) MUST_CHECK;
uint64_t scenario_camera_period_us(const struct scenario_camera *camera);

void scenario_camera_close(struct scenario_camera *camera);

#endif
