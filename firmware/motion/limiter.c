#include "motion/limiter.h"

#include "fixed/root.h"

/// What lies beyond is as good as this, far outside any limits; sums with it don't overflow.
#define GOAL_Q48_MAX (INT64_C(1) << 60)

static int64_t clamp(int64_t value, int64_t low, int64_t high) {
    return value < low ? low : (value > high ? high : value);
}

void limiter_reset(struct limiter *limiter, const struct limiter_config *config,
                   int64_t position_q48) {
    limiter->config = config;
    limiter->position_q48 = position_q48;
    limiter->speed_q48 = 0;
    for (uint32_t i = 0; i < LIMITER_SMOOTH_TICKS_MAX; i++) {
        limiter->recent_q48[i] = position_q48;
    }
    limiter->recent_sum_q48 = position_q48 * (int64_t)config->smooth_ticks;
    limiter->recent_next = 0;
    limiter->still_ticks = config->smooth_ticks;
    limiter->output_q48 = position_q48;
    limiter->output_speed_q48 = 0;
}

int64_t limiter_brake_speed(int64_t distance_q48, int64_t accel_q48) {
    if (distance_q48 < accel_q48) {
        return distance_q48; // there in one tick; the usual case at rest
    }
    // Braking from v takes q + 1 ticks and the distance (q + 1) v - accel q (q + 1) / 2, where q is
    // the largest number of whole steps with accel q (q + 1) / 2 <= distance.
    const uint64_t ratio = (uint64_t)distance_q48 / (uint64_t)accel_q48;
    const uint64_t root = root_u64(8U * ratio + 1U);
    const int64_t q = (int64_t)((root - 1U) / 2U);
    return (distance_q48 + accel_q48 * (q * (q + 1) / 2)) / (q + 1);
}

/// The speed toward the goal that still allows to arrive at the goal's own speed.
static int64_t approach_speed(int64_t distance_q48, int64_t accel_q48) {
    return distance_q48 >= 0 ? limiter_brake_speed(distance_q48, accel_q48)
                             : -limiter_brake_speed(-distance_q48, accel_q48);
}

/// Bounds a speed so that the axis can stop before the limits. Outside them, only inward motion is
/// left.
static int64_t keep_inside(const struct limiter *limiter, int64_t speed_q48) {
    const struct limiter_config *config = limiter->config;
    if (speed_q48 == 0) {
        return 0;
    }
    if (speed_q48 > 0) {
        const int64_t room = config->max_q48 - limiter->position_q48;
        const int64_t most = room > 0 ? limiter_brake_speed(room, config->accel_max_q48) : 0;
        return speed_q48 < most ? speed_q48 : most;
    }
    const int64_t room = limiter->position_q48 - config->min_q48;
    const int64_t most = room > 0 ? limiter_brake_speed(room, config->accel_max_q48) : 0;
    return speed_q48 > -most ? speed_q48 : -most;
}

/// Rounds down also below zero: with C's rounding toward zero the mean would stumble when it
/// crosses it.
static int64_t floor_divide(int64_t a, int64_t b) {
    return a / b - (a % b < 0 ? 1 : 0);
}

static int64_t advance(struct limiter *limiter, int64_t wanted_speed_q48) {
    const struct limiter_config *config = limiter->config;
    const int64_t most = config->speed_max_q48, step = config->accel_max_q48;
    int64_t speed = clamp(wanted_speed_q48, limiter->speed_q48 - step, limiter->speed_q48 + step);
    speed = keep_inside(limiter, clamp(speed, -most, most));
    limiter->speed_q48 = speed;
    limiter->position_q48 += speed;
    limiter->still_ticks = speed != 0 ? 0U : limiter->still_ticks + 1U;
    if (limiter->still_ticks > config->smooth_ticks) {
        limiter->still_ticks = config->smooth_ticks;
    }

    int64_t *oldest = &limiter->recent_q48[limiter->recent_next];
    limiter->recent_sum_q48 += limiter->position_q48 - *oldest;
    *oldest = limiter->position_q48;
    limiter->recent_next = (limiter->recent_next + 1U) % config->smooth_ticks;
    const int64_t output = floor_divide(limiter->recent_sum_q48, (int64_t)config->smooth_ticks);
    limiter->output_speed_q48 = output - limiter->output_q48;
    limiter->output_q48 = output;
    return output;
}

int64_t limiter_follow(struct limiter *limiter, int64_t goal_q48, int64_t goal_rate_q48) {
    const struct limiter_config *config = limiter->config;
    const int64_t rate = clamp(goal_rate_q48, -config->speed_max_q48, config->speed_max_q48);
    // The mean lags by half of its length; lead the goal by as much.
    const int64_t lead = rate * (int64_t)(config->smooth_ticks - 1U) / 2;
    const int64_t ahead = clamp(goal_q48, -GOAL_Q48_MAX, GOAL_Q48_MAX) + lead;
    const int64_t goal = clamp(ahead, config->min_q48, config->max_q48);
    const int64_t own_speed = goal == ahead ? rate : 0; // a limit does not move
    const int64_t distance = goal - limiter->position_q48;
    return advance(limiter,
                   own_speed + approach_speed(distance - own_speed, config->accel_max_q48));
}

int64_t limiter_stop(struct limiter *limiter) {
    return advance(limiter, 0);
}

bool limiter_at_rest(const struct limiter *limiter) {
    return limiter->still_ticks == limiter->config->smooth_ticks;
}
