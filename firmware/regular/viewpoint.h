/// How far is a viewpoint from one that two targets hide behind each other, or three line up from?
///
/// In the picture of a camera two targets coincide if the camera lies on the line through them, and
/// three are on one line if it lies in the plane through them. A parallel projection has forbidden
/// directions instead, those of the lines and planes; a camera near its targets is a perspective
/// view, whose forbidden places are the lines and planes themselves. Whether it is on one is
/// decided exactly, and the distances to the nearest ones are ratios of integers.
///
/// A line counts whole, also between and behind the two targets. Three targets on one line line up
/// from everywhere; they are counted apart and have no plane.
#ifndef REGULAR_VIEWPOINT_H
#define REGULAR_VIEWPOINT_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Largest size of a coordinate. Distances squared are compared in 250 bits.
#define VIEWPOINT_COORDINATE_MAX ((INT32_C(1) << 23) - 1)

enum viewpoint_status {
    VIEWPOINT_OK = 0,
    /// A coordinate is beyond VIEWPOINT_COORDINATE_MAX: of target bad[0], or of the viewpoint
    /// (bad[0] = count).
    VIEWPOINT_ERROR_RANGE = -1,
    /// Targets bad[0] < bad[1] are at the same place, so that no line goes through them.
    VIEWPOINT_ERROR_EQUAL = -2,
    /// The viewpoint is at target bad[0].
    VIEWPOINT_AT_TARGET = -3
};

/// The nearest forbidden line or plane.
struct viewpoint_margin {
    /// Of several nearest ones the first, in the order of the indices. Ascending.
    uint32_t target[3];
    /// The squared distance is numerator / denominator. numerator 0: the viewpoint is on it;
    /// denominator 0: there is none, for lack of targets.
    struct i256 numerator;
    struct i128 denominator;
    uint64_t through; ///< how many pairs or triples have the viewpoint on their line or plane
};

struct viewpoint_result {
    struct viewpoint_margin line;  ///< target[0], target[1]
    struct viewpoint_margin plane; ///< all three; not set without options->planes
    uint64_t collinear;            ///< triples of targets on one line
    uint32_t collinear_first[3];   ///< the first of them, if any
    uint32_t bad[2];
};

/// The nearest line through two of the targets and, if `planes`, the nearest plane through three.
/// targets:  count, different, coordinates within VIEWPOINT_COORDINATE_MAX; not modified.
/// Cost:     count^2 / 2 distances, and count^3 / 6 determinants with `planes`: 20 ns each on a PC.
///           No workspace.
/// Accuracy: exact (tests/property/viewpoint.c: brute force in rational numbers, and by moving the
///           viewpoint by a little less and a little more).
/// Source:   Gomez, Ramaswami, Toussaint 1996, sections 3 and 5, for perspective; docs/regular.md.
enum viewpoint_status viewpoint_margins(const struct vec3 *targets, uint32_t count,
                                        struct vec3 viewpoint, bool planes,
                                        struct viewpoint_result *result) MUST_CHECK;

#endif
