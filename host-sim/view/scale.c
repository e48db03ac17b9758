#include "view/scale.h"

#include <math.h>

double scale_px(const struct scale *scale, double value) {
    double part = (value - scale->low) / (scale->high - scale->low);
    return scale->px_low + part * (scale->px_high - scale->px_low);
}

static struct ticks ticks_of_step(double low, double high, double step) {
    // A bound that is a tick but for rounding counts as one.
    const double slack = 1e-9;
    struct ticks ticks = {.first = ceil(low / step - slack), .step = step};
    double count = floor(high / step + slack) - ticks.first + 1;
    ticks.count = (int)fmin(fmax(count, 0), 1e6);
    return ticks;
}

static int decimals_of_step(double step) {
    int decimals = 0;
    while (decimals < 9 && fabs(step - round(step)) > 1e-6 * step) {
        step *= 10;
        decimals++;
    }
    // What was still a fraction after nine decimals shows as many as there are.
    return decimals;
}

/// The round step after `step`; the first is a power of ten.
static double next_step(double step, double *power, int *digit, enum scale_unit unit) {
    static const double degrees[] = {15, 30, 45, 90, 180, 360};
    if (unit == SCALE_DEGREES && step >= 10) {
        for (unsigned i = 0; i < sizeof degrees / sizeof *degrees; i++) {
            if (degrees[i] > step) {
                return degrees[i];
            }
        }
        return 2 * step;
    }
    static const double digits[] = {1, 2, 5};
    *digit = (*digit + 1) % 3;
    if (*digit == 0) {
        *power += 1;
    }
    // The division keeps 0.001 the double nearest to it, which a product of 0.1s is not.
    return *power < 0 ? digits[*digit] / pow(10, -*power) : digits[*digit] * pow(10, *power);
}

struct ticks scale_ticks(double low, double high, int count_max, enum scale_unit unit) {
    double width = high - low;
    double power = floor(log10(width / count_max)) - 1;
    int digit = 0;
    double step = power < 0 ? 1 / pow(10, -power) : pow(10, power);
    if (unit == SCALE_DEGREES && step > 10) {
        power = 1;
        step = 10;
    }
    if (!(width > 0) || step < 1e-12 * fmax(fabs(low), fabs(high))) {
        return (struct ticks){.step = 1};
    }
    struct ticks ticks = ticks_of_step(low, high, step);
    while (ticks.count > count_max) {
        step = next_step(step, &power, &digit, unit);
        ticks = ticks_of_step(low, high, step);
    }
    ticks.decimals = decimals_of_step(step);
    return ticks;
}

double scale_tick(const struct ticks *ticks, int index) {
    return (ticks->first + index) * ticks->step;
}

void scale_widen(double *low, double *high, double part, double width_min) {
    if (!(*low <= *high)) {
        *low = 0;
        *high = 0;
    }
    double width = fmax((*high - *low) * (1 + 2 * part), width_min);
    double middle = *low + (*high - *low) / 2;
    *low = middle - width / 2;
    *high = middle + width / 2;
}
