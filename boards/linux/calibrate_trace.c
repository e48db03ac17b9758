#include "calibrate_private.h"

#include <math.h>
#include <stdlib.h>

/// So that a hundredth of a degree, and of a tick, is little.
#define SPEED_OVER_US 40000U
/// What comes so soon after a missed tick still shows it.
#define SETTLED_US 30000U
#define TOP_PART   0.95 ///< of the fastest setpoint: the speed is that of the axis there

void calibrate_trace_begin(struct calibrate_trace *trace) {
    trace->setpoint_count = trace->sight_count = 0;
}

void calibrate_trace_add(struct calibrate_trace *trace, uint64_t now_us, double setpoint_deg,
                         uint64_t sight_us, double sight_deg) {
    if (trace->setpoint_count < CALIBRATE_SETPOINTS) {
        trace->setpoint_us[trace->setpoint_count] = now_us;
        trace->setpoint_deg[trace->setpoint_count++] = setpoint_deg;
    }
    const uint32_t sights = trace->sight_count;
    if (sights < CALIBRATE_SIGHTS && (sights == 0U || trace->sight_us[sights - 1U] != sight_us)) {
        trace->sight_us[sights] = sight_us;
        trace->sight_deg[sights] = sight_deg;
        trace->sight_count++;
    }
}

/// Between the setpoints i - 1 and i: what ticks were missed of it.
static double missed_us(const struct calibrate_trace *trace, uint32_t i, uint32_t tick_us) {
    const double apart_us = (double)(trace->setpoint_us[i] - trace->setpoint_us[i - 1U]);
    return apart_us > 1.5 * tick_us ? apart_us - tick_us : 0.0;
}

double calibrate_trace_took_s(const struct calibrate_trace *trace, uint32_t tick_us,
                              double to_deg) {
    if (trace->setpoint_count == 0U || trace->sight_count == 0U) {
        return 0.0;
    }
    const double start_us = (double)trace->setpoint_us[0] - tick_us;
    uint32_t there = trace->sight_count; // the first of the last ones that are near
    while (there > 0U && fabs(trace->sight_deg[there - 1U] - to_deg) <= CALIBRATE_ARRIVED_DEG) {
        there--;
    }
    if (there == 0U || there == trace->sight_count) {
        return 0.0;
    }
    const double from_us = (double)trace->sight_us[there - 1U], us = (double)trace->sight_us[there];
    const double far = fabs(trace->sight_deg[there - 1U] - to_deg) - CALIBRATE_ARRIVED_DEG;
    const double near = CALIBRATE_ARRIVED_DEG - fabs(trace->sight_deg[there] - to_deg);
    double took_us = from_us + (us - from_us) * far / fmax(far + near, 1e-9) - start_us;
    // Until the setpoint is there it moves a tick's way a tick, whenever that comes.
    uint32_t last = 0;
    while (last + 1U < trace->setpoint_count && (double)trace->setpoint_us[last + 1U] < us &&
           fabs(trace->setpoint_deg[last] - to_deg) > 1e-6) {
        last++;
    }
    took_us -= (double)(trace->setpoint_us[last] - trace->setpoint_us[0]) - (double)last * tick_us;
    return took_us * 1e-6;
}

/// The newest setpoint at that time, from the hint on.
static uint32_t setpoint_at(const struct calibrate_trace *trace, uint64_t at_us, uint32_t hint) {
    while (hint + 1U < trace->setpoint_count && trace->setpoint_us[hint + 1U] <= at_us) {
        hint++;
    }
    return hint;
}

/// How long ago the setpoint was where the axis is at that time; negative: it can't be told.
static double lag_ms(const struct calibrate_trace *trace, uint32_t tick_us, uint32_t newest,
                     double at_deg, uint64_t at_us, double fast_dps) {
    for (uint32_t i = newest + 1U < trace->setpoint_count ? newest + 1U : newest; i > 0U; i--) {
        const double a = trace->setpoint_deg[i - 1U], b = trace->setpoint_deg[i];
        const double step_s = (double)(trace->setpoint_us[i] - trace->setpoint_us[i - 1U]) * 1e-6;
        if (missed_us(trace, i, tick_us) > 0.0) {
            return -1.0;
        }
        if (a == b || (at_deg - a) * (at_deg - b) > 0.0) {
            continue;
        }
        if (fabs(b - a) < fast_dps * step_s) {
            return -1.0;
        }
        const double then_us =
            (double)trace->setpoint_us[i - 1U] + (at_deg - a) / (b - a) * step_s * 1e6;
        return ((double)at_us - then_us) * 1e-3;
    }
    return -1.0;
}

void calibrate_trace_lags(const struct calibrate_trace *trace, uint32_t tick_us, double fast_dps,
                          double *lags_ms, uint32_t *count, uint32_t most) {
    uint32_t newest = 0;
    for (uint32_t i = 0; i < trace->sight_count && *count < most && trace->setpoint_count > 0U;
         i++) {
        const uint64_t at_us = trace->sight_us[i];
        newest = setpoint_at(trace, at_us, newest);
        const double lag = lag_ms(trace, tick_us, newest, trace->sight_deg[i], at_us, fast_dps);
        if (lag >= 0.0) {
            lags_ms[(*count)++] = lag;
        }
    }
}

/// Was a tick missed from then to the newest setpoint?
static bool is_smooth(const struct calibrate_trace *trace, uint32_t tick_us, uint32_t newest,
                      uint64_t from_us) {
    for (uint32_t i = newest; i > 0U && trace->setpoint_us[i] + SETTLED_US > from_us; i--) {
        if (missed_us(trace, i, tick_us) > 0.0) {
            return false;
        }
    }
    return true;
}

/// How far the setpoint goes in the tick before i.
static double pace(const struct calibrate_trace *trace, uint32_t i) {
    return i == 0U ? 0.0 : fabs(trace->setpoint_deg[i] - trace->setpoint_deg[i - 1U]);
}

void calibrate_trace_speeds(const struct calibrate_trace *trace, uint32_t tick_us,
                            double *speeds_dps, uint32_t *count, uint32_t most) {
    uint32_t from = 0, newest = 0;
    double top = 0.0;
    for (uint32_t i = 1; i < trace->setpoint_count; i++) {
        top = fmax(top, pace(trace, i));
    }
    for (uint32_t i = 1; i < trace->sight_count && *count < most && trace->setpoint_count > 0U;
         i++) {
        const uint64_t at_us = trace->sight_us[i];
        while (from + 1U < i && at_us - trace->sight_us[from + 1U] >= SPEED_OVER_US) {
            from++;
        }
        const uint64_t apart_us = at_us - trace->sight_us[from];
        newest = setpoint_at(trace, at_us, newest);
        if (apart_us >= SPEED_OVER_US && apart_us < 2U * SPEED_OVER_US &&
            pace(trace, newest) >= TOP_PART * top &&
            is_smooth(trace, tick_us, newest, trace->sight_us[from])) {
            speeds_dps[(*count)++] =
                fabs(trace->sight_deg[i] - trace->sight_deg[from]) * 1e6 / (double)apart_us;
        }
    }
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

double calibrate_quantile(double *values, uint32_t count, double part) {
    if (count == 0U) {
        return 0.0;
    }
    qsort(values, count, sizeof *values, compare);
    return values[(uint32_t)(part * (double)(count - 1U) + 0.5)];
}
