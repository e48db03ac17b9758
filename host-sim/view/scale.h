/// Axes: from values to pixels, and where the ticks stand.
#ifndef VIEW_SCALE_H
#define VIEW_SCALE_H

#include <stdbool.h>

/// Values `low` to `high` along pixels `px_low` to `px_high` (which may be the smaller).
struct scale {
    double low, high;
    double px_low, px_high;
};

double scale_px(const struct scale *scale, double value);

enum scale_unit {
    SCALE_DECIMAL, ///< steps 1, 2 or 5 times a power of ten
    SCALE_DEGREES  ///< the same, and 15, 30, 45, 90 and whole turns instead of 20, 50 and above
};

/// Ticks stand at (first + i) step for i below count.
struct ticks {
    double first, step;
    int count;
    int decimals; ///< that the labels need to tell all ticks apart, 0 to 9
};

/// The smallest step that puts at most `count_max` (at least 2) ticks into [low, high], low < high;
/// both are finite. A range too narrow for doubles at that offset gets no tick.
struct ticks scale_ticks(double low, double high, int count_max, enum scale_unit unit);

double scale_tick(const struct ticks *ticks, int index);

/// Widens [*low, *high] by `part` of its width on each side, and to at least `width_min`.
/// *low > *high (no value was seen) becomes a range round 0.
void scale_widen(double *low, double *high, double part, double width_min);

#endif
