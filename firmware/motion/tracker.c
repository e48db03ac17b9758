#include "motion/tracker.h"

#include "fixed/wide.h"
#include "motion/axis.h"

/// Where a goal that coasts stands still at the latest: far outside any limits, and sums don't
/// overflow.
#define POSITION_Q48_MAX (4096 * AXIS_TURN_Q48)

static int64_t clamp(int64_t value, int64_t low, int64_t high) {
    return value < low ? low : (value > high ? high : value);
}

void tracker_reset(struct tracker *tracker) {
    *tracker = (struct tracker){0};
}

/// value * fraction, rounded to nearest; fraction at most 1, |value| below 2^62.
static int64_t scale(int64_t value, uint32_t fraction_q16) {
    const uint64_t size = u64_abs(value);
    const uint64_t low = (size & 0xFFFFU) * fraction_q16 + (1U << 15);
    const int64_t scaled = (int64_t)((size >> 16) * fraction_q16 + (low >> 16));
    return value < 0 ? -scaled : scaled;
}

void tracker_update(struct tracker *tracker, const struct tracker_config *config,
                    int64_t position_q48) {
    const int64_t surprise = position_q48 - tracker->position_q48;
    const uint32_t elapsed = tracker->age_ticks;
    tracker->age_ticks = 0;
    tracker->goal_q48 = position_q48;
    if (!tracker->valid || surprise > config->jump_q48 || surprise < -config->jump_q48) {
        *tracker =
            (struct tracker){.position_q48 = position_q48, .goal_q48 = position_q48, .valid = true};
        return;
    }
    if (elapsed == 0U) { // a second goal in one tick: no time for a rate to show
        tracker->position_q48 = position_q48;
        return;
    }
    // Fading memory m: alpha = 1 - m^2, beta = (1 - m)^2.
    const uint32_t one = UINT32_C(1) << 16, memory = config->memory_q16;
    const uint32_t alpha = one - (uint32_t)(((uint64_t)memory * memory) >> 16);
    const uint32_t beta = (uint32_t)(((uint64_t)(one - memory) * (one - memory)) >> 16);
    tracker->position_q48 += scale(surprise, alpha);
    tracker->rate_q48 = clamp(tracker->rate_q48 + scale(surprise, beta) / (int64_t)elapsed,
                              -AXIS_TURN_Q48, AXIS_TURN_Q48);
}

void tracker_advance(struct tracker *tracker, const struct tracker_config *config) {
    if (!tracker->valid) {
        return;
    }
    if (tracker->age_ticks < UINT32_MAX) {
        tracker->age_ticks++;
    }
    if (tracker->age_ticks > config->coast_ticks) {
        tracker->rate_q48 = 0;
    }
    tracker->position_q48 =
        clamp(tracker->position_q48 + tracker->rate_q48, -POSITION_Q48_MAX, POSITION_Q48_MAX);
    if (tracker->age_ticks > (uint64_t)config->coast_ticks + TRACKER_RETURN_TICKS) {
        tracker->position_q48 = tracker->goal_q48;
    }
}
