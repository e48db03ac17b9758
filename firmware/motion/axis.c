#include "motion/axis.h"

static int64_t clamp(int64_t value, int64_t low, int64_t high) {
    return value < low ? low : (value > high ? high : value);
}

/// The short way from a position to an angle, round the circle: [-half a turn, half a turn).
static int64_t short_way(bam32_t angle, int64_t from_q48) {
    const uint64_t turn_mask = (uint64_t)AXIS_TURN_Q48 - 1U;
    const uint64_t ahead = (((uint64_t)angle.bam << 16) - (uint64_t)from_q48) & turn_mask;
    return ahead < (uint64_t)AXIS_TURN_Q48 / 2U ? (int64_t)ahead : (int64_t)ahead - AXIS_TURN_Q48;
}

static int64_t size_of(int64_t value) {
    return value < 0 ? -value : value;
}

int64_t axis_unwrap(bam32_t angle, int64_t from_q48, int64_t min_q48, int64_t max_q48) {
    const int64_t start = clamp(from_q48, min_q48, max_q48);
    const int64_t nearest = start + short_way(angle, start);
    if (nearest >= min_q48 && nearest <= max_q48) {
        return nearest;
    }
    const int64_t long_way = nearest > max_q48 ? nearest - AXIS_TURN_Q48 : nearest + AXIS_TURN_Q48;
    if (long_way >= min_q48 && long_way <= max_q48) {
        return long_way;
    }
    const int64_t to_min = size_of(short_way(angle, min_q48));
    const int64_t to_max = size_of(short_way(angle, max_q48));
    return to_min < to_max ? min_q48 : max_q48;
}
