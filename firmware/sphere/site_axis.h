/// Where the axis of a circle through given directions points, for directions as close as int32 can
/// tell apart.
#ifndef SPHERE_SITE_AXIS_H
#define SPHERE_SITE_AXIS_H

#include "sphere/site.h"

/// The axis of the circle through three different directions, Q1.30: the normal (b - a) x (c -
/// a) of their plane, which points outward if a, b, c are counter-clockwise seen from outside.
/// Accuracy:  within 1 unit a component (tests/property/site_exact.c). Two int32 directions can
///            be as close as 2^-63 rad; where Q2.61 can't tell the plane well enough, lengths
///            of 200 fractional bits do.
/// Cost:      some 20 products of 64 bits; three square roots of 456 bits in the rare case.
/// Source:    docs/geometry.md, "True directions".
struct vec3 site_circle_axis(const struct site *a, const struct site *b, const struct site *c);

/// The middle of the arc between two directions that are not opposite, Q1.30. Accuracy, cost and
/// source as above.
struct vec3 site_middle(const struct site *a, const struct site *b);

/// The axis of the narrowest cone of one to three directions that hold it (certify_support).
/// Accuracy, cost and source as above.
struct vec3 site_cone_axis(const struct site *support, uint32_t support_count);

#endif
