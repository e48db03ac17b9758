/// Follows a goal that arrives in steps (a new aim now and then) and tells its position and rate at
/// every tick.
///
/// An alpha-beta filter with fading memory (one parameter). Between updates the goal moves on at
/// its rate, for a bounded time, and when there is no news for long it goes back to where it was
/// last seen; a goal that jumps is taken as a new one, at rest, so that a change
/// of subject is a slew and no overshoot. A steady ramp is followed without lag, also between the
/// updates. Shown: tests/unit/test_tracker.c.
#ifndef MOTION_TRACKER_H
#define MOTION_TRACKER_H

#include <stdbool.h>
#include <stdint.h>

/// 4,096 turns: no goal is ever so far from another.
#define TRACKER_JUMP_Q48_MAX (INT64_C(1) << 60)

/// A second at 1 ms a tick: sources that report less often are rare.
#define TRACKER_RETURN_TICKS 1000U

struct tracker_config {
    /// A goal farther than this from its prediction is a new one: 0 to TRACKER_JUMP_Q48_MAX. More
    /// than the fastest target moves between two updates, or it is never given a rate.
    int64_t jump_q48;
    uint32_t memory_q16; ///< 0: each goal is taken as it comes; toward 65535: the past counts more
    /// How long a rate is believed without news. After TRACKER_RETURN_TICKS more the goal is the
    /// one that was last given.
    uint32_t coast_ticks;
};

struct tracker {
    int64_t position_q48; ///< within 4,096 turns of 0
    int64_t rate_q48;     ///< per tick, at most a turn
    int64_t goal_q48;     ///< as last given
    uint32_t age_ticks;   ///< since the last update
    bool valid;
};

void tracker_reset(struct tracker *tracker);

/// A goal, valid now. position_q48 must be on the same turn as the tracker's (axis_unwrap), and
/// within 4,096 turns of 0. A second one in a tick replaces the first and leaves the rate.
void tracker_update(struct tracker *tracker, const struct tracker_config *config,
                    int64_t position_q48);

/// One tick later. Call once a tick, before any update.
void tracker_advance(struct tracker *tracker, const struct tracker_config *config);

#endif
