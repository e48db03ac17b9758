/// Follows a goal that arrives in steps (a new aim now and then) and tells its position and rate at
/// every tick.
///
/// An alpha-beta filter with fading memory (one parameter). Between updates the goal moves on at
/// its rate, for a bounded time; a goal that jumps is taken as a new one, at rest, so that a change
/// of subject is a slew and no overshoot.
#ifndef MOTION_TRACKER_H
#define MOTION_TRACKER_H

#include <stdbool.h>
#include <stdint.h>

struct tracker_config {
    int64_t jump_q48;     ///< a goal farther than this from its prediction is a new one
    uint32_t memory_q16;  ///< 0: each goal is taken as it comes; toward 65536: the past counts more
    uint32_t coast_ticks; ///< how long a rate is believed without news
};

struct tracker {
    int64_t position_q48;
    int64_t rate_q48;   ///< per tick
    uint32_t age_ticks; ///< since the last update
    bool valid;
};

void tracker_reset(struct tracker *tracker);

/// A goal, valid now. position_q48 must be on the same turn as the tracker's (axis_unwrap).
void tracker_update(struct tracker *tracker, const struct tracker_config *config,
                    int64_t position_q48);

/// One tick later. Call once a tick, before any update.
void tracker_advance(struct tracker *tracker, const struct tracker_config *config);

#endif
