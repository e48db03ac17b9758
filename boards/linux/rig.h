/// Rig files: how the mount stands, what drives its axes, which limits hold. `boresight config
/// check` explains one.
/// Shown: tests/cli/drive.sh, tests/cli/camera.sh, tests/cli/step.sh.
#ifndef LINUX_RIG_H
#define LINUX_RIG_H

#include "ini.h"
#include "rig_camera.h"

#include "control/controller.h"
#include "target/occlusion.h"

#include <stdbool.h>

/// An axis with a stepper driver. The controller sees a PWM drive, whose pulse is a number of
/// steps: RIG_STEP_BASE_NS at limit_min, unit_ns more for each step.
struct rig_step {
    uint32_t unit_ns; ///< 0: the axis has none
    uint32_t direction_channel;
    uint32_t rate_max;  ///< steps a second
    int64_t home_steps; ///< where the axis stands at the start
};
#define RIG_STEP_BASE_NS 1000000U

struct rig {
    struct ini ini; ///< keeps the texts
    struct controller_config controller;
    const char *bus[2];             ///< of pan and tilt, as in the file: "fake" or "can:NAME"
    const char *device[3];          ///< of PWM axes: "fake", a PWM chip, a camera
    bool is_uvc[3];                 ///< a camera's own axis: driven as PWM (linux_camera_servo.h)
    struct rig_step step[2];        ///< of pan and tilt
    const char *estop, *enable;     ///< lines, see rig_lines.h; empty: none
    const char *limit_switch[2][2]; ///< of pan and tilt, at the lower and the upper end
    uint32_t debounce_us;
    const char *board_device; ///< serial port of the board that drives the rig; NULL: this program
    uint32_t board_baud;
    bool any_board_build;  ///< the board's build may differ from ours
    double fixed_focal_mm; ///< of the camera when there is no zoom axis
    struct rig_eye eye;
    struct rig_frames camera;
    bool has_occlusion;                  ///< the file says what hidden targets count
    struct occlusion_settings occlusion; ///< else OCCLUSION_CALM as it is by default
    const char *scene;                   ///< what hides targets; NULL: nothing, or the board knows
};

/// Reads and checks a rig file. tick_us: overrides the file's; 0: does not.
/// Returns: EXIT_STATUS_OK, or another after lines on stderr that name the file and its lines. Free
/// with rig_free in
///          any case.
enum exit_status rig_read(const char *path, uint32_t tick_us, struct rig *out);
void rig_free(struct rig *rig);

/// Explains every value of a rig that was read, and what follows from them.
void rig_explain(const struct rig *rig, FILE *stream);

/// Can a flashed board drive its axes? False: told on stderr which not.
bool rig_fits_board(const struct rig *rig);

/// Does every device that the rig names exist in the simulator only?
bool rig_is_fake(const struct rig *rig);

#endif
