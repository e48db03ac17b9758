/// The tables behind rig.h: what a rig file may hold, and where it is stored. For rig.c only.
/// Shown: tests/cli/drive.sh.
#ifndef LINUX_RIG_SCHEMA_H
#define LINUX_RIG_SCHEMA_H

#include "ini_schema.h"
#include "occlusion_file.h"

/// Values as in the file, scaled: _q48 in 2^-48 turns, _bam in 2^-32 turns, _ns, _um, _us.
struct rig_mount {
    struct ini_numbers position_um;
    int64_t heading_bam, pitch_bam, roll_bam;
};

struct rig_axis {
    int drive;
    const char *bus, *device, *switch_min, *switch_max;
    int64_t id;
    int dialect;
    bool reversed;
    int64_t zero_q48, limit_min_q48, limit_max_q48, home_q48;
    int64_t speed_q48, accel_q48, jerk_q48; ///< per second, per second^2, per second^3
    int64_t channel;
    struct ini_numbers calibration_q48, calibration_ns;
    int64_t direction_channel, steps_per_deg_micro;
    int64_t latency_us; ///< as measured; 0: not yet
    struct ini_numbers move_mdeg, move_ms;
};

struct rig_zoom {
    int drive;
    const char *device;
    int64_t channel;
    struct ini_numbers focal_um, pulse_ns, units;
    int64_t travel_us, ramp_us;
};

struct rig_camera {
    int64_t sensor_width_um, sensor_height_um, focal_um, margin_q16;
    int64_t width_px, height_px;
    int64_t fx_upx, fy_upx, cx_upx, cy_upx; ///< millionths of a pixel; cx, cy negative: the middle
    int64_t k1_nano, k2_nano, p1_nano, p2_nano, k3_nano;
    int64_t right_udeg, up_udeg, roll_udeg, latency_us;
    const char *device, *detect, *tag_family;
    int pixels, frame;
    int64_t rate_mhz;
};

struct rig_controller {
    int64_t tick_us, expiry_us, smoothing_q16, coast_us, jump_q48;
    const char *board;
    int64_t board_baud;
    int board_build;
};

struct rig_safety {
    int64_t silence_us, settle_us, follow_error_q48, follow_error_us, watchdog_ms, debounce_us;
    const char *estop, *enable;
    bool arm_on_start;
};

struct rig_file {
    struct rig_mount mount;
    struct rig_axis axis[2]; ///< pan, tilt
    bool has_zoom;
    bool has_section; ///< of sections whose absence only means defaults; nobody asks
    struct rig_zoom zoom;
    struct rig_camera camera;
    struct rig_controller controller;
    struct rig_safety safety;
    bool has_occlusion;
    struct occlusion_file occlusion;
};

enum rig_drive { RIG_DRIVE_RMD, RIG_DRIVE_PWM, RIG_DRIVE_FAKE, RIG_DRIVE_UVC, RIG_DRIVE_STEP };
enum rig_zoom_drive { RIG_ZOOM_PWM, RIG_ZOOM_UVC };

enum rig_board_build { RIG_BOARD_SAME, RIG_BOARD_ANY };

extern const struct ini_schema rig_schema;

#endif
