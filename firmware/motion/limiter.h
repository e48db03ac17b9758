/// The one limiter that every motion passes: position, speed, acceleration and jerk of one axis.
///
/// Two stages. The first moves toward a goal as fast as speed and acceleration allow and can always
/// stop before the position limits. The second is the mean of the last `smooth_ticks` positions of
/// the first: a mean of allowed positions, speeds and accelerations is allowed, and its
/// acceleration changes by at most 2 accel_max / smooth_ticks a tick, which bounds the jerk. It
/// costs half of smooth_ticks of delay, which the first stage makes up for while the goal moves
/// steadily. Everything is an integer per tick (_q48, motion/axis.h). The output keeps position and
/// speed exactly; because the mean is rounded to a whole unit (2^-48 turns), its acceleration may
/// exceed the bound by 1 unit and its jerk by 3. The first stage keeps all exactly.
/// Shown: tests/unit/test_limiter.c, which drives it with random and hostile goals, checks every
/// tick, and finds that a resting goal is reached in the fewest ticks possible.
#ifndef MOTION_LIMITER_H
#define MOTION_LIMITER_H

#include <stdbool.h>
#include <stdint.h>

#define LIMITER_SMOOTH_TICKS_MAX 256U

struct limiter_config {
    int64_t min_q48, max_q48; ///< position limits, min <= max, within 16 turns of 0
    int64_t speed_max_q48;    ///< per tick, 1 to a turn
    int64_t accel_max_q48;    ///< per tick^2, 1 to a turn
    uint32_t smooth_ticks;    ///< 1 (jerk unlimited) to LIMITER_SMOOTH_TICKS_MAX
};

struct limiter {
    const struct limiter_config *config;
    int64_t position_q48, speed_q48; ///< first stage
    int64_t recent_q48[LIMITER_SMOOTH_TICKS_MAX];
    int64_t recent_sum_q48; ///< at most 256 * 2^54
    uint32_t recent_next;
    uint32_t still_ticks;     ///< how long the first stage has been at rest, at most smooth_ticks
    int64_t output_q48;       ///< second stage: what goes to the drive
    int64_t output_speed_q48; ///< its change in the last tick
};

/// At rest at a position within 64 turns of 0 (also one outside the limits: it can then only move
/// inward).
void limiter_reset(struct limiter *limiter, const struct limiter_config *config,
                   int64_t position_q48);

/// One tick toward a goal that is at goal_q48 now and moves by goal_rate_q48 a tick. Returns the
/// output position. A goal outside the limits is approached as far as they allow. Any goal and
/// rate. Cost: two square roots and up to six 64-bit divisions.
int64_t limiter_follow(struct limiter *limiter, int64_t goal_q48, int64_t goal_rate_q48);

/// One tick of deceleration to standstill. Returns the output position.
int64_t limiter_stop(struct limiter *limiter);

/// Has the output come to rest? Then it stands as long as the goal does.
bool limiter_at_rest(const struct limiter *limiter);

/// The greatest speed from which braking by accel a tick stops within distance: the largest v with
/// v + (v - accel) + (v - 2 accel) + ... <= distance. distance: 0 to 2^60,
/// accel: 1 to 2^60.
int64_t limiter_brake_speed(int64_t distance_q48, int64_t accel_q48);

#endif
