/// Where to look, and how wide, for a set of targets: the narrowest cone of the directions, with
/// their radii.
#ifndef AIM_FRAMING_H
#define AIM_FRAMING_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"
#include "fixed/vec3.h"
#include "sphere/cone.h"
#include "target/target_set.h"

#include <stdint.h>

enum framing_status {
    FRAMING_OK = 0,
    FRAMING_EMPTY = -1,     ///< no target of positive weight
    FRAMING_INFEASIBLE = -2 ///< no direction sees every target
};

struct framing {
    enum framing_status status;
    struct vec3 ahead_q30;    ///< world axes, unit
    bam32_t half_angle_bam32; ///< the cone round ahead holds every target, radius included; at most
                              ///< a half turn
    uint32_t framed_count;    ///< targets of positive weight
};

/// Memory of the solver: kept by the caller because a microcontroller's stack is small.
struct framing_workspace {
    struct vec3 direction_q30[TARGET_CAPACITY];
    int64_t notes[CONE_WORKSPACE_UNIT_BYTES(TARGET_CAPACITY) / sizeof(int64_t)]; ///< of the solver
};

/// Solves the framing of a set. Every target of positive weight counts alike.
/// A target's radius widens the cone (half_angle covers each target's angle plus its radius); the
/// axis is that of the centres' narrowest cone. Cost: cone_narrowest over the set, plus one pass
/// for the radii when there are any. Accuracy: at most 3 BAM wider than asked for
/// (tests/property/framing_radii.c). When the status is not OK, ahead and half_angle stay as they
/// were. Shown: tests/unit/test_framing.c.
enum framing_status framing_solve(const struct target_set *set, struct framing_workspace *workspace,
                                  struct framing *framing);

#endif
