/// Files of targets that a scenario can name. For scenario.c only.
/// Shown: tests/cli/drive.sh, tests/scenario/test_pedestrians.c.
#ifndef LINUX_SCENARIO_TARGETS_H
#define LINUX_SCENARIO_TARGETS_H

#include "ini.h"

#include "world/schedule.h"

/// Constellation figures, one after another, as seen from a place on Earth at a moment of sidereal
/// time.
struct star_show {
    struct ini_texts figures; ///< as in the catalogue: Ori, Tau, ...
    int64_t dwell_us;         ///< time for each
    int64_t start_us;
    int64_t latitude_udeg, sidereal_us; ///< micro-degrees; micro-seconds of sidereal time
};

/// Boxes of a detector in a fixed camera at the mount that looks north, level.
struct box_camera {
    int64_t width_px, height_px, hfov_udeg, score_min_millis;
    int64_t frame_us; ///< time between frames: a frame without a box has no line in the file
};

/// Each returns EXIT_STATUS_OK, or another after one line on stderr that names file and line.

/// JSON lines (target_line.h); t_us is the time of the scenario.
enum exit_status load_json_lines(const char *path, struct schedule *schedule);
/// A star catalogue: hip,constellation,figure_of,magnitude,ra_deg,dec_deg.
enum exit_status load_stars(const char *path, const struct star_show *show,
                            struct schedule *schedule);
/// time_ms,left_px,top_px,width_px,height_px,score: each frame replaces the targets; every box
/// gives its corners.
enum exit_status load_boxes(const char *path, const struct box_camera *camera,
                            struct schedule *schedule);

#endif
