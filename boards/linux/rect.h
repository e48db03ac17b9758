/// The smallest picture of a given aspect, without roll, that holds every point: pan and tilt.
///
/// Without roll the camera has two angles only, and a rectangle is no circle: of several local
/// optima (above all near the zenith, where panning rolls the picture) this finds the best.
///
/// Why beside firmware/aim/rectangle.h, which boards use: that one decides on Q1.30 vectors, good
/// to 40 nrad, and is made to follow moving caps within a bound of work a tick. A file of points
/// may ask for a picture of a microradian, and then 40 nrad are a twenty-fifth of it.
/// tests/property/rectangle_global.c holds the two against each other on sets that both are for.
#ifndef LINUX_RECT_H
#define LINUX_RECT_H

#include "points.h"

#include <stdbool.h>
#include <stdint.h>

enum { RECT_SUPPORT_MOST = 8 };

struct rect_frame {
    double pan_rad, tilt_rad; ///< world axes; tilt from -90 to +90 degrees
    double slope;             ///< tan(half width) is slope * width, tan(half height) slope * height
    uint32_t support[RECT_SUPPORT_MOST]; ///< points on its border, ascending
    uint32_t support_count;
    uint64_t point_reads;
};

/// width, height: of the picture, in any unit. The points must have a direction that sees all of
/// them (cone_narrowest tells); ahead_q30: one such.
/// Returns: false without memory.
/// Cost:    O(count) for each of a handful of passes; and some 10 ms for the points that matter.
/// Accuracy: the slope is within 1e-9 of the global optimum, as a part of it
///           (tests/property/rect_global.c: against a grid of all directions, refined).
/// Source:  docs/geometry.md, "Framing a rectangle".
bool rect_solve(const struct points *points, double width, double height, struct vec3 ahead_q30,
                struct rect_frame *out);

/// Half width and half height of the picture that holds every point from there: the larger of both
/// counts. slope as above, rounded up: it holds the points as written.
double rect_slope(const struct points *points, double width, double height, double pan_rad,
                  double tilt_rad);

#endif
