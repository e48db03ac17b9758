#include "calibrate_private.h"

#include "degrees.h"

#include <math.h>

#define TILT_MOST_DEG   80.0 ///< of moves: near the zenith pan is undefined
#define RANGE_SLACK_DEG 1.0  ///< that a move keeps from the ends, if there is room for it
#define SPEEDS_MIN      5U
#define LAGS_MIN        10U ///< of a round
/// Rounds that are no farther apart agree.
#define AGREE_PART 0.03
#define AGREE_S    0.02
#define AGREE_LAG  0.1
#define AGREE_MS   1.0

static const double amplitudes_deg[CALIBRATE_MOVES] = {10.0, 30.0, 90.0};

/// What the rounds say of an axis.
struct rounds {
    uint32_t count;
    double move_s[CALIBRATE_MOVES][CALIBRATE_ROUNDS];
    double latency_ms[CALIBRATE_ROUNDS], speed_dps[CALIBRATE_ROUNDS];
    uint32_t latency_count, speed_count; ///< rounds that could tell them
};

struct way {
    double from_deg, to_deg;
};

/// Half of the top speed of a move this long: the fast part.
static double fast_dps(const struct calibrate *c, unsigned axis, double way_deg) {
    const struct limiter_config *limits = &c->runner.rig.controller.axis[axis].limits;
    const double ticks = 1e6 / c->runner.rig.controller.tick_us;
    const double accel = degrees(limits->accel_max_q48) * ticks * ticks;
    return 0.5 * fmin(degrees(limits->speed_max_q48) * ticks, sqrt(accel * way_deg));
}

/// One way of a move; what the trace tells of speed and latency is kept.
static bool go_and_look(struct calibrate *c, unsigned axis, double from_deg, double to_deg,
                        double *took_s) {
    const uint32_t tick_us = c->runner.rig.controller.tick_us;
    if (!calibrate_go(c, axis, to_deg)) {
        return false;
    }
    *took_s = fmax(*took_s, calibrate_trace_took_s(&c->trace, tick_us, to_deg));
    calibrate_trace_lags(&c->trace, tick_us, fast_dps(c, axis, fabs(to_deg - from_deg)), c->sorted,
                         &c->sorted_count, 2U * CALIBRATE_SIGHTS);
    calibrate_trace_speeds(&c->trace, tick_us, c->speeds, &c->speed_count, 2U * CALIBRATE_SIGHTS);
    return true;
}

static bool move_there_and_back(struct calibrate *c, unsigned axis, const struct way *way,
                                double *took_s) {
    *took_s = 0.0;
    c->sorted_count = c->speed_count = 0;
    return calibrate_go(c, axis, way->from_deg) &&
           go_and_look(c, axis, way->from_deg, way->to_deg, took_s) &&
           go_and_look(c, axis, way->to_deg, way->from_deg, took_s);
}

/// All amplitudes; latency and speed are those of the last, the longest.
static bool go_round(struct calibrate *c, unsigned axis, const struct way *ways, uint32_t count,
                     const struct way *longest, struct rounds *rounds) {
    double took_s;
    for (uint32_t i = 0; i < count; i++) {
        if (!move_there_and_back(c, axis, &ways[i], &rounds->move_s[i][rounds->count])) {
            return false;
        }
    }
    if (count == 0U && !move_there_and_back(c, axis, longest, &took_s)) {
        return false;
    }
    if (c->sorted_count >= LAGS_MIN) {
        rounds->latency_ms[rounds->latency_count++] =
            calibrate_quantile(c->sorted, c->sorted_count, 0.5);
    }
    if (c->speed_count >= SPEEDS_MIN) {
        rounds->speed_dps[rounds->speed_count++] =
            calibrate_quantile(c->speeds, c->speed_count, 0.5);
    }
    rounds->count++;
    return true;
}

/// How far they are apart, of four and more the middle half; and their median.
static double spread_of(const double *values, uint32_t count, double *median) {
    double sorted[CALIBRATE_ROUNDS];
    for (uint32_t i = 0; i < count; i++) {
        sorted[i] = values[i];
    }
    const double middle = calibrate_quantile(sorted, count, 0.5);
    *median = count == 2U ? 0.5 * (sorted[0] + sorted[1]) : middle;
    return count == 0U ? INFINITY : sorted[count - 1U - count / 4U] - sorted[count / 4U];
}

/// Takes what the rounds say so far. Returns whether they agree.
static bool take_rounds(struct calibrate_axis *result, const struct rounds *rounds) {
    bool agree = rounds->count >= 2U && rounds->latency_count >= 2U;
    result->rounds = rounds->count;
    for (uint32_t i = 0; i < result->move_count; i++) {
        result->move_spread_s[i] = spread_of(rounds->move_s[i], rounds->count, &result->move_s[i]);
        result->move_s[i] = rint(result->move_s[i] * 1e4) * 1e-4;
        result->move_spread_s[i] = rint(result->move_spread_s[i] * 1e4) * 1e-4;
        agree = agree && result->move_spread_s[i] <= fmax(AGREE_S, AGREE_PART * result->move_s[i]);
    }
    result->latency_spread_ms =
        spread_of(rounds->latency_ms, rounds->latency_count, &result->latency_ms);
    (void)spread_of(rounds->speed_dps, rounds->speed_count, &result->speed_dps);
    // The speed is for the person, and on a busy machine there may be no telling it.
    return agree && result->latency_spread_ms <= fmax(AGREE_MS, AGREE_LAG * result->latency_ms);
}

bool calibrate_moves(struct calibrate *c, unsigned axis) {
    struct calibrate_axis *const result = &c->axis[axis];
    const double most = axis == AXIS_TILT ? TILT_MOST_DEG : 3600.0;
    const double slack = fmin(RANGE_SLACK_DEG, 0.25 * (result->end_deg[1] - result->end_deg[0]));
    const double low = calibrate_clamp(result->end_deg[0] + slack, -most, most);
    const double high = calibrate_clamp(result->end_deg[1] - slack, -most, most);
    const struct way whole = {low, high};
    struct way ways[CALIBRATE_MOVES];
    struct rounds rounds = {0};
    result->move_count = 0;
    while (result->move_count < CALIBRATE_MOVES &&
           amplitudes_deg[result->move_count] <= high - low) {
        const double way_deg = amplitudes_deg[result->move_count];
        const double from_deg = 0.5 * (low + high - way_deg);
        result->move_deg[result->move_count] = way_deg;
        ways[result->move_count++] = (struct way){from_deg, from_deg + way_deg};
    }
    do {
        if (!go_round(c, axis, ways, result->move_count, &whole, &rounds)) {
            return false;
        }
        result->noisy = !take_rounds(result, &rounds);
    } while (result->noisy && rounds.count < CALIBRATE_ROUNDS);
    if (rounds.latency_count == 0U) {
        return calibrate_give_up(c, axis, "has too little room to measure its latency");
    }
    return calibrate_go(c, axis, calibrate_clamp(0.0, low, high));
}
