/// The results of `boresight plan`, as text or JSON.
/// Shown: tests/cli/plan.sh.
#ifndef LINUX_PLAN_REPORT_H
#define LINUX_PLAN_REPORT_H

#include "plan.h"

struct plan_ranking {
    struct points targets, mounts; ///< as read; no mounts if they are proposed
    bool proposed;
    struct plan_view *views; ///< by mount
    uint32_t *order;         ///< mounts, the best first
    uint32_t count;
};

/// Prints all of it to stdout. sphere: of the best mount.
void plan_report(const struct plan_ranking *ranking, struct plan *plan,
                 const struct plan_sphere *sphere, bool as_json);

#endif
