/// Where to look, and how wide, for a set of targets: the narrowest cone that holds them, their
/// radii included.
#ifndef AIM_FRAMING_H
#define AIM_FRAMING_H

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
    uint32_t framed_count; ///< targets of positive weight
    /// The work limit was reached: a narrower cone may hold them. Solve again with the same memory,
    /// also if no target has moved.
    bool refining;
    uint32_t work; ///< what the last solution took (follow_narrowest)
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
};

/// Memory of the solver: kept by the caller because a microcontroller's stack is small. All zero to
/// begin with.
struct framing_workspace {
    struct framing_memory memory;    ///< for framing_solve
    uint16_t place[TARGET_CAPACITY]; ///< of the targets that are framed
};

/// Frames a set, or one object of it, within a bound of work per call.
/// memory:     of the last framing of the same choice; updated.
/// work_limit: follow_narrowest's; 0: none.
/// Every target of positive weight counts alike. When the status is not OK, ahead and half_angle
/// stay as they were; so they do while a search that has no cone below 90 degrees yet is refining.
/// Cost:     follow_narrowest, and one pass to choose.
/// Accuracy: follow_narrowest's (tests/property/framing_radii.c).
/// Shown:    tests/unit/test_framing.c.
enum framing_status framing_follow(const struct target_set *set, struct framing_choice choice,
                                   struct framing_memory *memory, uint32_t work_limit,
                                   struct framing_workspace *workspace, struct framing *framing);

/// Frames the whole set to the end.
enum framing_status framing_solve(const struct target_set *set, struct framing_workspace *workspace,
                                  struct framing *framing);

#endif
