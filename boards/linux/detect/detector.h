/// The chosen detectors on a stream of frames: what they found, with ids that stay.
/// Shown: tests/cli/detect.sh, tests/property/motion_frames.c.
#ifndef DETECT_DETECTOR_H
#define DETECT_DETECTOR_H

#include "detect/camera_pose.h"
#include "detect/detection.h"
#include "fixed/must_check.h"
#include "hal/camera.h"

#include <stdbool.h>
#include <stdint.h>

struct detector_settings {
    bool wanted[DETECTION_KINDS];
    const char *tag_family; ///< of tags, as tags_family_known has it
    uint8_t contrast_min;   ///< of markers; 0: 40 levels
    uint32_t area_px_min;   ///< of moving objects; 0: 1/2000 of the picture
};

/// Names of detectors separated by commas or blanks: `tags`, `markers`, `motion`. Sets wanted[].
/// Returns: NULL, or what is wrong (valid until the next call).
const char *detector_settings_read(struct detector_settings *settings, const char *names,
                                   uint32_t size);

/// How the camera stood when a frame was exposed; NULL model: it stands still.
struct detector_sight {
    const struct camera_model *model; ///< of this very frame: zoomed, and of its size
    struct camera_view view;
};

struct detector;

/// For frames of one size. Returns: NULL: no memory, or tags are wanted and can't be had
/// (tags_available says why not).
struct detector *detector_create(const struct detector_settings *settings, uint32_t width_px,
                                 uint32_t height_px);
void detector_destroy(struct detector *detector);

/// A frame of that size. at_us: when it was exposed, of a clock in microseconds that wraps.
void detector_frame(struct detector *detector, const struct hal_camera_luma *frame, uint32_t at_us,
                    const struct detector_sight *sight, struct detections *out);

#endif
