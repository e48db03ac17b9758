/// The camera's optics: pixels to directions and back.
///
/// Camera axes: right, ahead, up, those of the gimbal's head when the camera sits on it straight.
/// Pixels: u to the right, v down, with fractions; (0, 0) is the middle of the top left one, so
/// that a picture reaches from -0.5 to width_px - 0.5. With x = right / ahead and y = -up / ahead:
///     r2 = x^2 + y^2, radial = 1 + k1 r2 + k2 r2^2 + k3 r2^3
///     x' = x radial + 2 p1 x y + p2 (r2 + 2 x^2)
///     y' = y radial + p1 (r2 + 2 y^2) + 2 p2 x y
///     u = fx x' + cx, v = fy y' + cy
/// the model of Brown (1966) with the coefficients that OpenCV, ROS and most calibration programs
/// print, in their order k1 k2 p1 p2 k3. Floating point: Linux and the simulator only.
#ifndef DETECT_CAMERA_MODEL_H
#define DETECT_CAMERA_MODEL_H

#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdint.h>

struct camera_model {
    uint32_t width_px, height_px;
    double fx_px, fy_px, cx_px, cy_px;
    double k1, k2, p1, p2, k3;
    /// Directions farther than this from the axis (tangent, squared) have no pixel: the radial
    /// polynomial turns back there. Set by camera_model_check.
    double r2_max;
};

/// A camera without distortion that looks through the middle of its picture.
struct camera_model camera_model_pinhole(uint32_t width_px, uint32_t height_px, double focal_px);

/// Sets r2_max. Returns: NULL, or what is wrong with the numbers: a focal length that is not above
/// 0, no pixels, or a distortion under which a corner of the picture has no direction or several.
const char *camera_model_check(struct camera_model *model) MUST_CHECK;

/// The same camera with its lens zoomed: focal lengths times `factor`.
struct camera_model camera_model_zoomed(const struct camera_model *model, double factor);

/// The same camera with its picture scaled to another size (a binned or scaled mode of the sensor
/// that shows the same field of view).
struct camera_model camera_model_resized(const struct camera_model *model, uint32_t width_px,
                                         uint32_t height_px);

/// Where a direction (right, ahead, up; any length) appears; also outside of the picture.
/// Returns: false: behind the camera, or beyond r2_max.
/// Accuracy: 1e-9 px against rationals worked out by hand and against OpenCV's projectPoints
///           (tests/scenario/test_camera_model.c).
bool camera_model_project(const struct camera_model *model, const double direction[3],
                          double pixel[2]) MUST_CHECK;

/// The direction (right, ahead, up; unit length) that appears at a pixel. The inverse has no closed
/// form: Newton's method on the model, from the undistorted guess.
/// Returns: false: no direction within r2_max appears there.
/// Accuracy: back at the pixel within 1e-9 px, for every pixel of pictures with barrel, pincushion,
///           mixed and tangential distortion (tests/scenario/test_camera_model.c).
/// Cost:     2 to 5 steps of 40 flops.
bool camera_model_ray(const struct camera_model *model, const double pixel[2],
                      double direction[3]) MUST_CHECK;

#endif
