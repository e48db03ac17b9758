/// The smallest picture of a given aspect, without roll, that holds moving caps, from tick to tick.
///
/// Without roll a camera on a gimbal has two angles, pan and tilt, and of several places where a
/// small change makes the picture larger (above all near the pan axis, where panning rolls it) this
/// finds the best. For a pan the best tilt is found by halving; pans are searched by dividing the
/// turn, with a bound on what any pan of a part can do. A call does bounded work and leaves a
/// picture that holds every cap; the next goes on, also if the caps have moved on meanwhile. Then
/// it first follows the best place so far, and three calls in four do only that: by a rough step of
/// pan at least in each, so that caps that move in every call don't leave it behind.
///
/// `boresight aim --frame rect` has a solver of its own, in floating point, for pictures too narrow
/// for Q1.30 (boards/linux/rect.h).
#ifndef AIM_RECTANGLE_H
#define AIM_RECTANGLE_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"
#include "fixed/vec3.h"
#include "sphere/follow.h"

#include <stdbool.h>
#include <stdint.h>

/// The base that pan and tilt count from: its axes in the caps' coordinates, unit, Q1.30. Pan turns
/// about up, clockwise; tilt lifts the camera.
struct rectangle_base {
    struct vec3 right_q30, ahead_q30, up_q30;
};

/// No side of a picture is longer than this many of the other.
#define RECTANGLE_ASPECT_MAX 64

struct rectangle_input {
    const struct vec3 *centre_q30;      ///< unit, as vec3_normalise gives
    const struct follow_radius *radius; ///< NULL: points
    const uint16_t *member;             ///< indices of the caps that count; NULL: the first `count`
    uint32_t count;                     ///< of those, at least 1
    struct rectangle_base base;
    uint32_t width, height; ///< of the picture, in any unit; 1 to 2^20
    bool moved; ///< the caps, the base or the aspect may be others than in the last call
    /// About how much work is allowed, in units of 20 instructions of a Cortex-M4. A call takes at
    /// least one step. 0: no limit, to the end.
    uint32_t work_limit;
};

/// Points that matter are few: each pass over all adds at most one for each side.
#define RECTANGLE_WORKING_MAX  12U
#define RECTANGLE_WORKING_KEPT 6U ///< of those, when they have moved

/// A place of the camera, and the picture that it needs.
struct rectangle_place {
    uint32_t pan_bam32;
    int32_t tilt_bam32;
    uint64_t slope_q32; ///< tan(half width) * height / the longer side; UINT64_MAX: none holds them
};

/// A walk downhill from a place, by steps of pan.
struct rectangle_walk {
    struct rectangle_place place; ///< slope: of the working set
    uint32_t step_bam32;
    bool backward, failed, fresh; ///< fresh: the place's own tilt and slope are to be found yet
    bool wide;                    ///< the next tilt is looked for everywhere
    bool rough;                   ///< the place's tilt is near the best one
    uint8_t rounds;
};

/// Kept from call to call; all zero to begin with.
struct rectangle_search {
    bool begun, tracking, sought, descending, descended, stale;
    uint8_t turn, working_count;
    uint8_t neighbours;                      ///< of the part that are to be compared with it yet
    struct rectangle_place best;             ///< as measured on every cap
    struct rectangle_walk track, descent;    ///< from the best place; from a part of the turn
    uint32_t part_bam32, width_bam32;        ///< of the turn that is looked at
    uint16_t working[RECTANGLE_WORKING_MAX]; ///< indices of caps that matter
};

/// A cap of the working set. Of a call only.
struct rectangle_cap {
    int32_t right, ahead, up, sin; ///< in the base's axes, Q1.30; sine of the radius
    int32_t across, aside, level;  ///< at the pan that is looked at: right of it, |that|, along it
};

struct rectangle_workspace {
    struct rectangle_cap cap[RECTANGLE_WORKING_MAX];
};

struct rectangle_result {
    bam32_t pan_bam32, tilt_bam32;
    struct vec3 ahead_q30; ///< in the caps' coordinates
    /// Half of the picture's width and height, as angles from its middle; rounded up.
    bam32_t half_width_bam32, half_height_bam32;
    bool refining; ///< a smaller picture may hold them: call again
    uint32_t work;
};

/// Begins at a direction that has every cap strictly in front: that of cone.h or follow.h.
/// Cost:     three dot products, a root and two arc tangents.
/// Accuracy: no matter: the search leaves from there.
/// Source:   as rectangle_follow.
void rectangle_begin(struct rectangle_search *search, const struct rectangle_base *base,
                     struct vec3 ahead_q30);

/// One call's part of the search; rectangle_begin comes before the first.
/// Returns:  false if from the best place so far some cap isn't strictly in front now: begin again.
/// Cost:     work_limit units, or one step: a pass over all caps (4 units each, 10 for caps that
///           reach out) or one pan (30 halvings of the tilt, 3 units for each cap of the working
///           set); 300 units more where caps move. tests/gate/tick.sh counts it. Until the end some
///           500 pans.
/// Accuracy: of caps that go round at 30 degrees a second, in 1,000 calls of 2,500 units, the half
///           width stays within 0.1 degrees of the best (100 caps and more: 0.35). The picture
///           holds every cap. At the end its half width and height exceed those of the best by at
///           most 40 nrad (tests/property/rectangle_global.c, against a grid of all directions,
///           refined).
/// Source:   docs/geometry.md, "Framing a rectangle".
bool rectangle_follow(const struct rectangle_input *input, struct rectangle_search *search,
                      struct rectangle_workspace *workspace,
                      struct rectangle_result *result) MUST_CHECK;

#endif
