/// Where to look, and how wide, for a set of targets: the narrowest cone that holds them, or the
/// smallest picture, their radii included.
#ifndef AIM_FRAMING_H
#define AIM_FRAMING_H

#include "aim/rectangle.h"
#include "fixed/bam32.h"
#include "fixed/vec3.h"
#include "target/target_set.h"

#include <stdbool.h>
#include <stdint.h>

enum framing_status {
    FRAMING_OK = 0,
    FRAMING_EMPTY = -1,     ///< no target of positive weight
    FRAMING_INFEASIBLE = -2 ///< no direction sees every target's centre, with 1e-6 rad to spare
};

struct framing {
    enum framing_status status;
    struct vec3 ahead_q30; ///< world axes, unit
    /// The cone round ahead holds every target, radius included. A half turn where no cone below 90
    /// degrees does: then ahead is that of the centres.
    bam32_t half_angle_bam32;
    /// Of a picture: its half width and height, as angles from the middle (a quarter turn where no
    /// picture holds the rims), and the angles of the base that look ahead: near the pan axis the
    /// direction alone does not tell how the picture stands.
    bool is_picture;
    bam32_t half_width_bam32, half_height_bam32, pan_bam32, tilt_bam32;
    uint32_t framed_count; ///< targets of positive weight
    /// The work limit was reached: a narrower cone, or a smaller picture, may hold them. Solve
    /// again with the same memory, also if no target has moved.
    bool refining;
    uint32_t work; ///< what the last solution took (follow_narrowest, rectangle_follow)
};

/// The picture that frames targets, instead of a cone.
struct framing_picture {
    uint32_t width, height; ///< in any unit (rectangle_input)
    struct rectangle_base base;
};

/// Which targets are framed, of those of positive weight.
struct framing_choice {
    bool one_object; ///< only those of `object`
    uint16_t object;
};

/// The targets that held the last cone: where the next search begins. All zero: from scratch.
struct framing_memory {
    uint8_t count;
    bool pending; ///< the last one did not hold the cone, but shall (follow_input)
    uint8_t pending_step;
    uint32_t id[4];
    // Of a picture, too:
    struct rectangle_search rectangle;
    uint32_t working_id[RECTANGLE_WORKING_MAX];
    uint32_t version; ///< of the target set
    bool centres;     ///< the rims can't all be held
};

/// Memory of the solver: kept by the caller because a microcontroller's stack is small. All zero to
/// begin with.
struct framing_workspace {
    struct framing_memory memory;    ///< for framing_solve
    uint16_t place[TARGET_CAPACITY]; ///< of the targets that are framed
    struct rectangle_workspace rectangle;
};

/// Frames a set, or one object of it, within a bound of work per call.
/// picture:    what frames them; NULL: a cone.
/// memory:     of the last framing of the same choice by the same picture; updated.
/// work_limit: follow_narrowest's and rectangle_follow's; 0: none.
/// Every target of positive weight counts alike. When the status is not OK, ahead and half_angle
/// stay as they were; so they do while a search that has no cone below 90 degrees yet is refining.
/// Cost:     follow_narrowest, and one pass to choose. A picture: rectangle_follow; and the cone at
///           the start, and where the last picture's direction does not see every target any more.
/// Accuracy: follow_narrowest's (tests/property/framing_radii.c), rectangle_follow's.
/// Source:   docs/geometry.md, "From tick to tick" and "Framing a rectangle".
/// Shown:    tests/unit/test_framing.c.
enum framing_status framing_follow(const struct target_set *set, struct framing_choice choice,
                                   const struct framing_picture *picture,
                                   struct framing_memory *memory, uint32_t work_limit,
                                   struct framing_workspace *workspace, struct framing *framing);

/// Frames the whole set with a cone, to the end.
/// Cost:     follow_narrowest without a limit: a few passes.
/// Accuracy: framing_follow's.
/// Source:   framing_follow's.
enum framing_status framing_solve(const struct target_set *set, struct framing_workspace *workspace,
                                  struct framing *framing);

#endif
