/// Orientation of the camera: its axes, pan and tilt, and how large the picture of a cone is.
///
/// World axes: x east, y north, z up. The camera's axes are right, ahead, up, with
/// det(right, ahead, up) = +1: a picture is never mirrored.
#ifndef AIM_ORIENT_H
#define AIM_ORIENT_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdint.h>

struct orient_axes {
    struct vec3 right_q30, up_q30;
};

/// Right R = A x up / |A x up| and up U = R x A of a camera that looks along A.
/// ahead_q30: not zero, components at most 2^30 in size; its length does not matter.
/// up:        any int32 vector but zero; its length does not matter.
/// A counts as parallel to up where it is so exactly, or is the Q1.30 unit vector of up or -up.
/// There R is +x made perpendicular to A, or +y where A is parallel to x: looking straight up or
/// down with z up gives R = +x. Zero vectors give zero vectors.
/// Accuracy: each component is the Q1.30 number nearest to the exact one, ties away from zero: a
///           multiple of `up` changes no bit (tests/property/orient_reference.c).
/// Cost:     two normalisations of a 128-bit vector, each 15 products of 256 bits or so.
/// Source:   Anderson 1985, equation 4.
struct orient_axes orient_axes(struct vec3 ahead_q30, struct vec3 up);

struct orient_angles {
    bam32_t pan_bam32, tilt_bam32;
};

/// Pan = atan2(x, y), clockwise from north seen from above; tilt = asin(z), up, -1/4 to +1/4 turn.
/// At the zenith and the nadir pan is 0: a controller keeps the pan it has.
/// ahead_q30: as for orient_axes.
/// Accuracy: 0.501 BAM (tests/property/orient_reference.c).
/// Cost:     one square root and two arc tangents of 64 bits.
/// Source:   the world axes of docs/geometry.md, "Conventions".
struct orient_angles orient_pan_tilt(struct vec3 ahead_q30);

enum orient_image_status {
    ORIENT_IMAGE_OK = 0,
    /// The half-angle is 90 degrees or more: no plane picture holds the cone. Both results are
    /// UINT64_MAX.
    ORIENT_IMAGE_UNBOUNDED = -1
};

struct orient_image {
    /// tan(half angle): radius of the cone's picture at distance 1. Q32.32.
    uint64_t radius_q32;
    /// 1 / cos(half angle): how much longer the cone's edge is drawn than its middle. Q32.32.
    uint64_t distortion_q32;
};

/// The picture of a cone. Q32.32 holds every value: one BAM below 90 degrees both are 6.8e8.
/// half_angle_bam32: read as 0 to 1 turn.
/// Accuracy: within 1 unit of 2^-32 plus 2^-58 of the value; near 90 degrees the angle's own half
///           unit matters far more (tests/property/orient_reference.c).
/// Cost:     trig_octant and two 128-by-64-bit divisions.
/// Source:   Anderson 1982: the image radius is tan x, the local distortion 1 / cos x.
enum orient_image_status orient_image_of_cone(bam32_t half_angle_bam32,
                                              struct orient_image *out) MUST_CHECK;

#endif
