/// Moving objects: what differs from the background, in pieces that belong together, followed from
/// frame to frame.
///
/// Works on the picture at about 320 pixels of width. A camera that turns is no obstacle while its
/// pose is known (camera_pose.h): the background keeps the place of the pose it was begun at, and
/// frames are put there before they are compared; as the camera turns on, the background is moved
/// along. While the picture runs faster than a twentieth of its width a frame, or is new
/// altogether, nothing is told.
#ifndef DETECT_MOTION_H
#define DETECT_MOTION_H

#include "detect/detector.h"
#include "fixed/must_check.h"
#include "hal/camera.h"

#include <stdbool.h>
#include <stdint.h>

struct motion_settings {
    uint8_t contrast_min; ///< grey levels
    uint32_t area_px_min; ///< of an object, in pixels of the frame
    double absorb_s;      ///< what stands still for so long is background
    double quiet_s;       ///< nothing is told before the background was seen for so long
};

/// 18 levels, 1/2000 of the picture, 15 s, 0.5 s.
struct motion_settings motion_defaults(uint32_t width_px, uint32_t height_px);

struct motion;

struct motion *motion_create(const struct motion_settings *settings, uint32_t width_px,
                             uint32_t height_px);
void motion_destroy(struct motion *motion);

/// Appends the objects that are followed and seen in this frame, and the ids of those that ended.
/// Confidence: half how much it differs (1 at 64 grey levels), half for how many frames it was seen
/// (1 at 8).
/// elapsed_s: since the frame before. Recall and precision: tests/property/motion_frames.c.
void motion_find(struct motion *motion, const struct hal_camera_luma *frame, double elapsed_s,
                 const struct detector_sight *sight, struct detections *out);

#endif
