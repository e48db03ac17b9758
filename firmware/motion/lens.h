/// The zoom lens: which position of its axis gives which focal length, and which focal length
/// frames a cone.
#ifndef MOTION_LENS_H
#define MOTION_LENS_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdint.h>

#define LENS_TABLE_MAX 16U

/// One calibrated point of the lens.
struct lens_point {
    uint32_t focal_um;    ///< focal length, micrometres
    int64_t position_q48; ///< of the zoom axis
};

struct lens_config {
    /// At least two points, both columns strictly ascending, positions within 16 turns of 0.
    /// Between them, linear.
    struct lens_point point[LENS_TABLE_MAX];
    uint32_t point_count;
    uint32_t sensor_width_um, sensor_height_um; ///< of the image, 1 um to 1 m
    /// How much wider than the cone the picture's short side is, or each side than what it must
    /// hold: 0.10 is 6554. At most 10.0.
    uint32_t margin_q16;
};

/// Is the table usable?
bool lens_valid(const struct lens_config *lens);

/// Focal length at which a cone of this half-angle, widened by the margin, touches the short sides
/// of the picture, rounded down; clamped to the table. A quarter turn and more gives the shortest.
/// Accuracy: 1 um + 2^-29 / sin(2 half-angle) of the result (tests/property/lens.c).
/// Cost: two 64-bit divisions.
uint32_t lens_focal_um(const struct lens_config *lens, bam32_t half_angle);

/// The same for a picture: the longest focal length at which both of its sides, widened by the
/// margin, are held.
/// Accuracy: as above (tests/property/lens.c). Cost: four 64-bit divisions.
uint32_t lens_focal_of_picture_um(const struct lens_config *lens, bam32_t half_width,
                                  bam32_t half_height);

/// Position of the zoom axis for a focal length, clamped to the table, rounded to nearest.
int64_t lens_position_q48(const struct lens_config *lens, uint32_t focal_um);

/// The inverse, rounded to nearest: exact where the table has at least two positions a micrometre
/// (tests/unit/test_lens.c).
uint32_t lens_focal_at_um(const struct lens_config *lens, int64_t position_q48);

#endif
