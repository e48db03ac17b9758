/// What the picture of a few caps, and of all, must be at one place: the parts of rectangle.h.
/// Accuracy: where nothing else is said, some units of 2^-30 of the coordinates
///           (tests/property/rectangle_global.c measures the whole).
/// Source:   docs/geometry.md, "Framing a rectangle", for all of it.
#ifndef AIM_RECTANGLE_TILT_H
#define AIM_RECTANGLE_TILT_H

#include "aim/rectangle.h"

/// The working set, and the aspect: height and width by the longer of both.
struct rectangle_view {
    const struct rectangle_input *input;
    struct rectangle_cap *cap;
    const uint16_t *working; ///< their indices
    uint32_t count;
    q30_t height_q30, width_q30;
    uint32_t first; ///< which cap asked for most last time
    uint32_t work;
};

/// Brings the working set into the axes of the base.
/// Cost:     nine products of 64 bits a cap of the working set.
void rectangle_load(struct rectangle_view *view, const struct rectangle_search *search,
                    const struct rectangle_input *input, struct rectangle_workspace *workspace);

/// The best tilt of a pan for the working set. What a cap asks for grows with the tilt's distance
/// from its own elevation in the picture's middle column, so the maximum of all has one minimum,
/// and the cap that asks for most tells on which side of it we are.
/// place: pan given; tilt: where to begin, if reach is not zero. Tilt and slope are set.
/// Returns: false if it isn't within reach; place is then the one on the way there, at its end.
/// reach_bam32: a power of two up to 2^29: how far the tilt is off at most. 0: any.
/// least_bam32: a power of two up to 2^15, and less than the reach: near enough to the best.
/// Cost:     rectangle_tilt_work: up to 30 halvings, each with four products a cap or more.
/// Accuracy: tilt (but for least_bam32) and slope as the coordinates are, some units of 2^-30.
bool rectangle_best_tilt(struct rectangle_view *view, struct rectangle_place *place,
                         uint32_t reach_bam32, uint32_t least_bam32);

/// About how much work that is, in units of rectangle_input. Cost: a few operations.
uint32_t rectangle_tilt_work(const struct rectangle_view *view, uint32_t reach_bam32,
                             uint32_t least_bam32);

/// Which cap asks for most to the right, left, above, below.
struct rectangle_sides {
    uint32_t index[4]; ///< UINT32_MAX: none
};

/// Reads every cap from a place. Returns the slope that they need there, UINT64_MAX if one is not
/// strictly in front.
/// Cost:     one pass over all caps: 4 units of work each, 10 for caps that reach out.
uint64_t rectangle_read(struct rectangle_view *view, const struct rectangle_place *place,
                        struct rectangle_sides *sides);

struct rectangle_half_angles {
    uint32_t width, height; ///< BAM, up to a quarter turn
};

/// Half of the picture's width and height at a slope. Cost: two arc tangents of 64 bits.
struct rectangle_half_angles rectangle_half_angles(const struct rectangle_view *view,
                                                   uint64_t slope_q32);

#define RECTANGLE_BOUND_WORK 300U

/// Is it certain that no pan within half_part_bam of the middle, where the best tilt was just
/// found, does better than the slope, but for a few BAM? Two bounds: Panning by an angle moves no
/// cap by more than the same on its circle round the pan axis; a picture whose sides are all moved
/// out by that still holds it. And whatever the tilt, the picture is at least as high as the
/// highest and the lowest cap are apart in its middle column; of that the first derivative by the
/// pan is known at the middle, and the second is bounded. This one is needed where the height
/// decides and a turn changes little.
/// Cost:     RECTANGLE_BOUND_WORK units.
/// Accuracy: it errs only by "no", but for those few BAM (tests/property/rectangle_global.c).
bool rectangle_is_no_better(struct rectangle_view *view, const struct rectangle_place *middle,
                            uint32_t half_part_bam, uint64_t best_slope_q32);

/// The direction of a place, in the caps' coordinates. Cost: two sines and cosines, one
/// normalisation.
struct vec3 rectangle_ahead(const struct rectangle_base *base, const struct rectangle_place *place);

#endif
