/// Rendered frames with known truth, for the tests of detectors. The lens is this file's own: the
/// distortion formula written out again, and its inverse by plain iteration, so that an error in
/// the program's camera model can't hide.
#ifndef PROPERTY_FRAMES_H
#define PROPERTY_FRAMES_H

#include "detect/camera_pose.h"
#include "hal/camera.h"
#include "view/render.h"

#include <stdbool.h>
#include <stdint.h>

enum { FRAMES_WIDTH = 640, FRAMES_HEIGHT = 480 };

struct frames {
    struct render render;
    uint64_t random;
    double focal_px;
    uint8_t picture[FRAMES_HEIGHT][FRAMES_WIDTH];
};

/// A webcam with barrel distortion, or none.
bool frames_open(struct frames *frames, double focal_px, bool distorted, uint64_t seed);
void frames_close(struct frames *frames);

/// From low to high.
double frames_any(struct frames *frames, double low, double high);

/// Where a place (right, ahead, up) appears.
void frames_project(const struct frames *frames, const double at[3], double pixel[2]);
/// The direction (right, 1, up) at a pixel.
void frames_ray(const struct frames *frames, const double pixel[2], double direction[3]);

/// The same lens in the program's terms: its numbers, not its code.
struct camera_model frames_model(const struct frames *frames);

/// Draws; the camera looks north from the origin.
struct hal_camera_luma frames_draw(struct frames *frames, const struct render_backdrop *backdrop,
                                   const struct render_object *objects, uint32_t count,
                                   const struct render_sensor *sensor);

/// The same for a camera that is turned.
struct hal_camera_luma frames_draw_from(struct frames *frames, const struct camera_view *turned,
                                        const struct render_backdrop *backdrop,
                                        const struct render_object *objects, uint32_t count,
                                        const struct render_sensor *sensor);

/// So many frames; a tenth where only their cost counts (make bench-detect sets BENCH).
uint32_t frames_many(uint32_t full);

/// Seconds of processor time of this thread, for notes only.
double frames_cpu_s(void);

#endif
