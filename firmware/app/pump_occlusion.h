/// Between the queue of a pump and its controller: what is hidden counts as the policy has it.
///
/// A detour, so that an image without a scene has no code of it. Shown:
/// tests/unit/test_pump_occlusion.c.
#ifndef APP_PUMP_OCCLUSION_H
#define APP_PUMP_OCCLUSION_H

#include "app/pump.h"
#include "target/occlusion.h"

struct pump_occlusion {
    struct pump_detour detour;
    struct occlusion *occlusion;
    bool all;         ///< a frame is worked out in one step
    uint64_t time_us; ///< since it was attached
    uint32_t read_us; ///< the pump's clock then
};

/// From now on what is pushed takes this way. all: each step does all the work that is due; else
/// the caller does it, by occlusion_work in the time that it has. occlusion must outlive the pump.
void pump_occlusion_attach(struct pump_occlusion *stage, struct pump *pump,
                           struct occlusion *occlusion, bool all);

/// Takes what was pushed, and readies what the next tick hears. Before each pump_step, or after
/// each; at least every 70 minutes.
/// Cost: a search by id for each update that was pushed; not `all`: at most 4 reports are taken.
void pump_occlusion_step(struct pump_occlusion *stage, struct pump *pump);

#endif
