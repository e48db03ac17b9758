#include "rect.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/// Points that matter are few: each pass over all adds at most one for each side.
enum { WORKING_MOST = 64, INTERVALS_FIRST = 256, INTERVALS_MOST = 8192 };

/// A pan below this is not divided any more, but searched: 2^-13 rad.
static const double smallest_half_width = 1.0 / 8192;

struct unit {
    double x, y, z;
};

static struct unit unit_of(struct vec3_i64 a) {
    const long double x = (long double)a.x, y = (long double)a.y, z = (long double)a.z;
    const long double length = sqrtl(x * x + y * y + z * z);
    return (struct unit){(double)(x / length), (double)(y / length), (double)(z / length)};
}

/// The working set, seen from one pan: right of the camera, ahead and up on the level.
struct view {
    uint32_t count;
    double right[WORKING_MOST], level[WORKING_MOST], up[WORKING_MOST];
};

struct search {
    const struct points *points;
    double width, height;
    uint32_t count;
    uint32_t index[WORKING_MOST];
    struct unit point[WORKING_MOST];
    double farthest_off_axis; // from the vertical, of the working set: the sine of that angle
    uint64_t point_reads;
};

// ---------------------------------------------------------------- one pan

/// Slope that one point asks for at a tilt; *upward: whether it lies above the middle.
static double slope_of(const struct search *search, double right, double level, double up,
                       double cos_tilt, double sin_tilt, bool *upward) {
    const double ahead = level * cos_tilt + up * sin_tilt, above = up * cos_tilt - level * sin_tilt;
    *upward = above > 0;
    if (ahead <= 0) { // behind: the worse the farther
        return DBL_MAX * (0.5 - ahead / 4);
    }
    const double x = fabs(right) / search->width, y = fabs(above) / search->height;
    return (x > y ? x : y) / ahead;
}

/// The slope that the working set asks for, and whether the one that asks for most lies above.
static double slope_at(const struct search *search, const struct view *view, double tilt,
                       bool *upward) {
    const double cos_tilt = cos(tilt), sin_tilt = sin(tilt);
    double most = -1;
    for (uint32_t i = 0; i < view->count; i++) {
        bool above;
        const double slope = slope_of(search, view->right[i], view->level[i], view->up[i], cos_tilt,
                                      sin_tilt, &above);
        if (slope > most) {
            most = slope;
            *upward = above;
        }
    }
    return most;
}

/// The best tilt for a pan. What a point asks for grows with the tilt's distance from its own
/// elevation in the picture's middle column, so the maximum of all has one minimum, and the one
/// that asks for most tells on which side of it we are.
static double best_tilt(const struct search *search, double pan, double *tilt) {
    struct view view = {.count = search->count};
    const double c = cos(pan), s = sin(pan);
    for (uint32_t i = 0; i < search->count; i++) {
        const struct unit p = search->point[i];
        view.right[i] = p.x * c - p.y * s;
        view.level[i] = p.x * s + p.y * c;
        view.up[i] = p.z;
    }
    double low = -pi / 2, high = pi / 2, slope = 0;
    for (int i = 0; i < 50; i++) {
        bool upward = false;
        *tilt = (low + high) / 2;
        slope = slope_at(search, &view, *tilt, &upward);
        if (upward) {
            low = *tilt;
        } else {
            high = *tilt;
        }
    }
    return slope;
}

// ---------------------------------------------------------------- all pans

struct interval {
    double middle, half_width, slope, tilt;
};

static struct interval measure(const struct search *search, double middle, double half_width) {
    struct interval interval = {.middle = middle, .half_width = half_width};
    interval.slope = best_tilt(search, middle, &interval.tilt);
    return interval;
}

/// No pan in the interval does with less. Panning by an angle moves no point by more than the same
/// on its circle round the vertical; a picture whose sides are all moved out by that still holds
/// it.
static double lower_bound(const struct search *search, const struct interval *interval) {
    const double moved = interval->half_width * search->farthest_off_axis;
    const double wide = interval->slope * search->width, high = interval->slope * search->height;
    const double less_wide = atan(wide) - moved, less_high = atan(high) - moved;
    if (less_wide <= 0 || less_high <= 0) {
        return 0;
    }
    return fmin(tan(less_wide) / search->width, tan(less_high) / search->height);
}

/// The best pan near one, by golden section.
static struct interval refine(const struct search *search, double middle, double half_width) {
    const double golden = 0.61803398874989484820;
    double low = middle - half_width, high = middle + half_width;
    struct interval left = measure(search, high - golden * (high - low), half_width),
                    right = measure(search, low + golden * (high - low), half_width);
    for (int i = 0; i < 64 && high - low > 1e-14; i++) {
        if (left.slope <= right.slope) {
            high = right.middle;
            right = left;
            left = measure(search, high - golden * (high - low), half_width);
        } else {
            low = left.middle;
            left = right;
            right = measure(search, low + golden * (high - low), half_width);
        }
    }
    return left.slope <= right.slope ? left : right;
}

static void keep_better(struct interval *best, struct interval other) {
    if (other.slope < best->slope) {
        *best = other;
    }
}

/// Halves every interval that may hold a better pan than the best so far. Returns how many there
/// are now; all that fit are kept.
static uint32_t divide(const struct search *search, struct interval *intervals, uint32_t count,
                       struct interval *best) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) { // those that stay come first
        if (lower_bound(search, &intervals[i]) < best->slope * (1 - 1e-12)) {
            intervals[kept++] = intervals[i];
        }
    }
    if (kept > INTERVALS_MOST / 2) {
        return 0; // enough: each is searched as it is
    }
    for (uint32_t i = kept; i-- > 0;) {
        const double quarter = intervals[i].half_width / 2, middle = intervals[i].middle;
        intervals[2U * i + 1U] = measure(search, middle + quarter, quarter);
        intervals[2U * i] = measure(search, middle - quarter, quarter);
        keep_better(best, intervals[2U * i]);
        keep_better(best, intervals[2U * i + 1U]);
    }
    return 2U * kept;
}

/// The best pan for the working set: the whole turn is divided until what is left is too small to
/// hold two minima that differ, and that is searched. seen_from: a pan that sees every point.
static struct interval best_pan(const struct search *search, double seen_from,
                                struct interval *intervals) {
    const double first = pi / INTERVALS_FIRST;
    uint32_t count = INTERVALS_FIRST;
    struct interval best = {.slope = HUGE_VAL};
    for (uint32_t i = 0; i < count; i++) {
        intervals[i] = measure(search, -pi + first * (2U * i + 1U), first);
        keep_better(&best, intervals[i]);
    }
    keep_better(&best, refine(search, best.middle, 2 * first));
    // Near 90 degrees the pans that see every point are fewer than any interval is wide.
    keep_better(&best, refine(search, seen_from, first));
    keep_better(&best, refine(search, seen_from, 1e-6));
    keep_better(&best, refine(search, seen_from, 1e-9));
    double half_width = first;
    while (half_width > smallest_half_width) {
        const uint32_t divided = divide(search, intervals, count, &best);
        if (divided == 0) {
            break;
        }
        count = divided;
        half_width /= 2;
    }
    for (uint32_t i = 0; i < count; i++) {
        const bool lowest = (i == 0 || intervals[i].slope <= intervals[i - 1U].slope) &&
                            (i + 1U == count || intervals[i].slope <= intervals[i + 1U].slope);
        if (lowest && lower_bound(search, &intervals[i]) < best.slope) {
            keep_better(&best, refine(search, intervals[i].middle, 2 * intervals[i].half_width));
        }
    }
    return best;
}

// ---------------------------------------------------------------- all points

static void add_point(struct search *search, uint32_t index) {
    for (uint32_t i = 0; i < search->count; i++) {
        if (search->index[i] == index) {
            return;
        }
    }
    if (search->count < WORKING_MOST) {
        const struct unit point = unit_of(search->points->fine[index]);
        search->index[search->count] = index;
        search->point[search->count++] = point;
        search->farthest_off_axis =
            fmax(search->farthest_off_axis, hypot(point.x, point.y) * (1 + 1e-12));
    }
}

/// Reads every point from there and adds the outermost to each side to the working set. Returns the
/// slope that they ask for.
static double read_all(struct search *search, double pan, double tilt) {
    const double cp = cos(pan), sp = sin(pan), ct = cos(tilt), st = sin(tilt);
    double most[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, slope = 0;
    uint32_t outermost[4] = {0};
    for (uint32_t i = 0; i < search->points->count; i++) {
        const struct unit p = unit_of(search->points->fine[i]);
        const double right = p.x * cp - p.y * sp, level = p.x * sp + p.y * cp;
        const double ahead = level * ct + p.z * st, above = p.z * ct - level * st;
        const double scale = ahead > 0 ? 1 / ahead : DBL_MAX * (0.5 - ahead / 4);
        const double side[4] = {right * scale, -right * scale, above * scale, -above * scale};
        for (int k = 0; k < 4; k++) {
            if (side[k] > most[k]) {
                most[k] = side[k];
                outermost[k] = i;
            }
        }
    }
    search->point_reads += search->points->count;
    for (int k = 0; k < 4; k++) {
        add_point(search, outermost[k]);
        slope = fmax(slope, most[k] / (k < 2 ? search->width : search->height));
    }
    return slope;
}

static int compare_indices(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static void report(const struct search *search, const struct interval *best,
                   struct rect_frame *out) {
    out->pan_rad = remainder(best->middle, 2 * pi);
    out->tilt_rad = best->tilt;
    out->slope = best->slope;
    out->point_reads = search->point_reads;
    out->support_count = 0;
    const double c = cos(best->middle), s = sin(best->middle);
    for (uint32_t i = 0; i < search->count && out->support_count < RECT_SUPPORT_MOST; i++) {
        const struct unit p = search->point[i];
        bool above;
        if (slope_of(search, p.x * c - p.y * s, p.x * s + p.y * c, p.z, cos(best->tilt),
                     sin(best->tilt), &above) >= best->slope * (1 - 1e-9)) {
            out->support[out->support_count++] = search->index[i];
        }
    }
    qsort(out->support, out->support_count, sizeof *out->support, compare_indices);
}

bool rect_solve(const struct points *points, double width, double height, struct vec3 ahead_q30,
                struct rect_frame *out) {
    struct interval *const intervals = malloc(INTERVALS_MOST * sizeof *intervals);
    if (intervals == NULL) {
        return false;
    }
    // Only their ratio counts; the larger becomes 1, so that slopes are those of the longer side.
    const double larger = fmax(width, height);
    struct search search = {.points = points, .width = width / larger, .height = height / larger};
    struct interval best = {.middle = atan2(ahead_q30.x, ahead_q30.y),
                            .tilt = atan2(ahead_q30.z, hypot(ahead_q30.x, ahead_q30.y))};
    const double seen_from = best.middle;
    double slope = read_all(&search, best.middle, best.tilt);
    // What a working set asks for, all points ask for at least. So once no point asks for more at
    // its optimum, that is the optimum of all.
    for (uint32_t before = 0; before != search.count;) {
        before = search.count;
        best = best_pan(&search, seen_from, intervals);
        slope = read_all(&search, best.middle, best.tilt);
        if (slope <= best.slope * (1 + 1e-12)) {
            break;
        }
    }
    best.slope = slope;
    report(&search, &best, out);
    out->slope /= larger;
    free(intervals);
    return true;
}

double rect_slope(const struct points *points, double width, double height, double pan_rad,
                  double tilt_rad) {
    const long double cp = cosl((long double)pan_rad), sp = sinl((long double)pan_rad),
                      ct = cosl((long double)tilt_rad), st = sinl((long double)tilt_rad);
    long double most = 0;
    for (uint32_t i = 0; i < points->count; i++) {
        const struct vec3_i64 p = points->fine[i];
        const long double x = (long double)p.x, y = (long double)p.y, z = (long double)p.z;
        const long double right = x * cp - y * sp, level = x * sp + y * cp;
        const long double ahead = level * ct + z * st, above = z * ct - level * st;
        if (ahead <= 0) {
            return HUGE_VAL;
        }
        most = fmaxl(most,
                     fmaxl(fabsl(right) / (long double)width, fabsl(above) / (long double)height) /
                         ahead);
    }
    // Sixteen roundings, how the points were rounded on reading, and that of the reader.
    const long double smaller = fminl((long double)width, (long double)height);
    const long double steep = 1 + most * (long double)fmax(width, height);
    return (double)(most * (1 + 16 * LDBL_EPSILON + 2 * DBL_EPSILON) +
                    points->fine_error_rad * steep * steep / smaller);
}
