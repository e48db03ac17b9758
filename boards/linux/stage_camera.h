/// A camera that exists in the simulator only: `device = fake:FILE` in [camera] of a rig file.
///
/// It sees the targets of FILE (lines as `run --targets` takes them; those with t_us are due that
/// long after the file was read), dressed up as what the rig looks for, through the rig's own lens,
/// from where the gimbal is. FILE is looked at ten times a second and read anew when it changes; as
/// long as there is no such file the camera is unplugged. `fake:FILE@MS` stamps its frames so many
/// milliseconds after the middle of their exposure, which is what latency_ms of the rig should say.
///
/// Frames come when they are asked for, stamped by the clock, STAGE_CAMERA_TRANSFER_US after that:
/// there is no descriptor to wait for. Rendering takes the caller's time, some 20 ns a pixel.
/// Shown: tests/cli/camera_run.sh, tests/cli/calibrate.sh.
#ifndef LINUX_STAGE_CAMERA_H
#define LINUX_STAGE_CAMERA_H

#include "rig.h"
#include "stage.h"
#include "target_source.h"

#include "detect/camera_pose.h"
#include "devices/fake_camera.h"
#include "linux/linux_error.h"

#include <stdbool.h>
#include <sys/stat.h>

#define STAGE_CAMERA_TRANSFER_US 15000U

/// What `fake:FILE[@MS]` says. False: it is something else.
struct stage_camera_address {
    char path[256];
    uint32_t late_us;
};
bool stage_camera_parse(const char *device, struct stage_camera_address *address);

struct stage_camera {
    struct fake_camera camera; ///< camera.hal, from stage_camera_open on
    struct linux_error error;  ///< why it can't be opened, or that it has left

    // Private from here on.
    struct stage_camera_address address;
    const struct rig *rig;
    const struct hal_clock *clock;
    struct mount mount;
    struct fake_camera_model model;
    struct stage stage;
    uint8_t *pool, *picture;
    struct pose_history truth;
    struct target_set world;
    struct target_source source;
    bool has_source;
    bool is_there;
    struct stat read_from; ///< the file, as it was when it was read
    uint32_t last_us;      ///< of the clock
    uint64_t time_us, read_us, look_us;
};

/// Memory for it; the file is not looked at. rig->camera.device must be a fake: address. False:
/// no memory. stage_camera_free in any case. Must not move in memory afterwards.
bool stage_camera_create(struct stage_camera *stage, const struct rig *rig,
                         const struct hal_clock *clock) MUST_CHECK;
void stage_camera_free(struct stage_camera *stage);

/// Plugs it in, not streaming, if the file is there. Returns: HAL_OK; HAL_ERROR_GONE: stage->error.
enum hal_status stage_camera_open(struct stage_camera *stage) MUST_CHECK;

/// Pulls it out, while it is open.
void stage_camera_unplug(struct stage_camera *stage);

/// Where the gimbal really is at a time of the clock. After each step of it.
void stage_camera_pose(struct stage_camera *stage, uint32_t at_us, const struct camera_pose *pose);

/// Looks after the file, open or not. Returns whether it is there.
bool stage_camera_look(struct stage_camera *stage);

#endif
