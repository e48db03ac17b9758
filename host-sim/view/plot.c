#include "view/plot.h"

#include "view/bands.h"
#include "view/markup.h"
#include "view/reduce.h"
#include "view/scale.h"

#include <math.h>
#include <stdbool.h>

/// The drawing, in pixels. Panels lie between LEFT and RIGHT.
#define WIDTH_PX     1000.0
#define LEFT_PX      64.0
#define RIGHT_PX     976.0
#define TOP_PX       22.0 ///< the row of picture marks
#define HEADING_PX   26.0 ///< above each panel
#define PANEL_PX     116.0
#define ERROR_PX     150.0
#define ZERO_PX      14.0 ///< of it below the decades: the line of 0
#define BAND_PX      18.0
#define TIME_AXIS_PX 40.0

/// From this length on the time axis counts minutes.
#define MINUTES_FROM_S 300.0

typedef double value_of(const struct report_sample *sample);

static double pan_of(const struct report_sample *sample) {
    return sample->pan_deg;
}

static double pan_setpoint_of(const struct report_sample *sample) {
    return sample->pan_setpoint_deg;
}

static double tilt_of(const struct report_sample *sample) {
    return sample->tilt_deg;
}

static double tilt_setpoint_of(const struct report_sample *sample) {
    return sample->tilt_setpoint_deg;
}

/// 0 is "no zoom" and no focal length.
static double focal_of(const struct report_sample *sample) {
    return sample->focal_mm > 0 ? sample->focal_mm : NAN;
}

static double focal_setpoint_of(const struct report_sample *sample) {
    return sample->focal_setpoint_mm > 0 ? sample->focal_setpoint_mm : NAN;
}

static double error_of(const struct report_sample *sample) {
    return sample->error_deg >= 0 ? sample->error_deg : NAN;
}

struct panel {
    const char *heading;
    value_of *actual, *setpoint;
    enum scale_unit unit;
    double range_min; ///< less is not stretched over the panel: it would look like a movement
};

static const struct panel panels[] = {
    {"Pan (\u00B0)", pan_of, pan_setpoint_of, SCALE_DEGREES, 0.02},
    {"Tilt (\u00B0)", tilt_of, tilt_setpoint_of, SCALE_DEGREES, 0.02},
    {"Focal length (mm)", focal_of, focal_setpoint_of, SCALE_DECIMAL, 0.1},
};
enum { PANEL_COUNT = sizeof panels / sizeof *panels };

/// The smallest and the largest value that is finite and above `above`; *low > *high: none.
static void widen_to(const struct report *report, value_of *value, double above, double *low,
                     double *high) {
    for (size_t i = 0; i < report->sample_count; i++) {
        double got = value(&report->samples[i]);
        if (isfinite(got) && got > above) {
            *low = fmin(*low, got);
            *high = fmax(*high, got);
        }
    }
}

static double time_of(const struct report_sample *sample) {
    return sample->time_s;
}

/// Time in the unit of the axis: seconds, or minutes of a long run.
static struct scale time_scale(const struct report *report, double *unit_s) {
    double low = INFINITY;
    double high = -INFINITY;
    widen_to(report, time_of, -INFINITY, &low, &high);
    scale_widen(&low, &high, 0, 1e-3);
    *unit_s = high - low > MINUTES_FROM_S ? 60 : 1;
    return (struct scale){low, high, LEFT_PX, RIGHT_PX};
}

static bool panel_has_data(const struct report *report, const struct panel *panel) {
    double low = INFINITY;
    double high = -INFINITY;
    widen_to(report, panel->actual, -INFINITY, &low, &high);
    widen_to(report, panel->setpoint, -INFINITY, &low, &high);
    return low <= high;
}

/// The error axis: whole decades from 10^lowest, with only the line of 0 below, to 10^top.
struct decades {
    int lowest;
    double top;
};

static struct decades error_decades(const struct report *report) {
    enum { COUNT_MAX = 7, COUNT_MIN = 2, LOWEST = -6 };
    double low = INFINITY;
    double high = -INFINITY;
    widen_to(report, error_of, 0, &low, &high);
    if (low > high) { // nothing above 0
        return (struct decades){-4, -2};
    }
    double top = fmax(log10(high) + 0.08, LOWEST + COUNT_MIN);
    double lowest = fmax(floor(log10(low)), fmax(LOWEST, ceil(top) - COUNT_MAX));
    lowest = fmin(lowest, floor(top) - COUNT_MIN);
    return (struct decades){(int)lowest, top};
}

/// Writes the points that stay as path data. Of a stretch at one height only its ends are needed.
struct path {
    FILE *out;
    long last_tenths_y;
    double held_x_px; ///< the latest point of the stretch, not yet written
    double y_px;
    bool holds;
    int in_line; ///< points in this line: one alone gets a stroke of no length, which shows as a
                 ///< dot
};

static void path_point(struct path *path, char before, double x_px, double y_px) {
    if (before != '\0') {
        fputc(before, path->out);
    }
    markup_px(path->out, x_px);
    fputc(' ', path->out);
    markup_px(path->out, y_px);
}

static void path_flush(struct path *path) {
    if (path->holds) {
        path_point(path, path->in_line == 1 ? 'L' : ' ', path->held_x_px, path->y_px);
        path->in_line++;
        path->holds = false;
    }
}

static void path_end_line(struct path *path) {
    path_flush(path);
    if (path->in_line == 1) {
        fputs("h0", path->out);
    }
}

static void path_sink(void *context, double x_px, double y_px, bool starts) {
    struct path *path = context;
    long tenths_y = lround(y_px * 10);
    if (starts) {
        path_end_line(path);
        path_point(path, 'M', x_px, y_px);
        path->in_line = 1;
    } else if (tenths_y == path->last_tenths_y) {
        path->held_x_px = x_px;
        path->holds = true;
    } else {
        path_flush(path);
        path_point(path, path->in_line == 1 ? 'L' : ' ', x_px, y_px);
        path->in_line++;
    }
    path->last_tenths_y = tenths_y;
    path->y_px = y_px;
}

struct series {
    const char *class;
    value_of *value;
    struct scale scale; ///< of the value; if logarithmic, of its decimal logarithm
    bool logarithmic;
    double foot_px; ///< of a logarithmic scale: where 0 and what is below the scale is drawn
};

static double series_px(const struct series *series, const struct report_sample *sample) {
    double value = series->value(sample);
    if (!series->logarithmic) {
        return scale_px(&series->scale, value);
    }
    // NaN must stay NaN: a gap, no zero.
    if (value < pow(10, series->scale.low) * (1 - 1e-9)) {
        return series->foot_px;
    }
    return scale_px(&series->scale, log10(value));
}

static void draw_series(FILE *out, const struct report *report, const struct series *series,
                        const struct scale *time) {
    struct path path = {.out = out};
    struct reduce reduce;
    fprintf(out, "<path class=\"%s\" d=\"", series->class);
    reduce_start(&reduce, path_sink, &path);
    for (size_t i = 0; i < report->sample_count; i++) {
        const struct report_sample *sample = &report->samples[i];
        reduce_add(&reduce, scale_px(time, sample->time_s), series_px(series, sample));
    }
    reduce_gap(&reduce);
    path_end_line(&path);
    fputs("\"/>\n", out);
}

static void draw_line(FILE *out, const char *class, double x0_px, double y0_px, double x1_px,
                      double y1_px) {
    fprintf(out, "<path class=\"%s\" d=\"M", class);
    markup_px(out, x0_px);
    fputc(' ', out);
    markup_px(out, y0_px);
    fputc('L', out);
    markup_px(out, x1_px);
    fputc(' ', out);
    markup_px(out, y1_px);
    fputs("\"/>\n", out);
}

static void begin_text(FILE *out, const char *class, const char *anchor, double x_px, double y_px) {
    fprintf(out, "<text class=\"%s\" text-anchor=\"%s\" x=\"", class, anchor);
    markup_px(out, x_px);
    fputs("\" y=\"", out);
    markup_px(out, y_px);
    fputs("\">", out);
}

static void draw_text(FILE *out, const char *class, const char *anchor, double x_px, double y_px,
                      const char *text) {
    begin_text(out, class, anchor, x_px, y_px);
    markup_text(out, text);
    fputs("</text>\n", out);
}

static void draw_level(FILE *out, double y_px, double value, int decimals) {
    draw_line(out, "grid", LEFT_PX, y_px, RIGHT_PX, y_px);
    begin_text(out, "tick", "end", LEFT_PX - 7, y_px + 4);
    markup_number(out, value, decimals);
    fputs("</text>\n", out);
}

static void draw_time_grid(FILE *out, const struct scale *time, const struct ticks *ticks,
                           double unit_s, double top_px, double bottom_px) {
    for (int i = 0; i < ticks->count; i++) {
        double x_px = scale_px(time, scale_tick(ticks, i) * unit_s);
        draw_line(out, "grid", x_px, top_px, x_px, bottom_px);
    }
}

static void draw_panel(FILE *out, const struct report *report, const struct panel *panel,
                       const struct scale *time, double top_px) {
    double low = INFINITY;
    double high = -INFINITY;
    widen_to(report, panel->actual, -INFINITY, &low, &high);
    widen_to(report, panel->setpoint, -INFINITY, &low, &high);
    scale_widen(&low, &high, 0.06, panel->range_min);
    struct scale scale = {low, high, top_px + PANEL_PX, top_px};
    struct ticks ticks = scale_ticks(low, high, 7, panel->unit);
    for (int i = 0; i < ticks.count; i++) {
        double value = scale_tick(&ticks, i);
        draw_level(out, scale_px(&scale, value), value, ticks.decimals);
    }
    draw_text(out, "heading", "start", LEFT_PX, top_px - 7, panel->heading);
    // The setpoint is a broad pale line: where the camera follows, the fine true line lies on it.
    draw_series(out, report, &(struct series){"setpoint", panel->setpoint, scale, false, 0}, time);
    draw_series(out, report, &(struct series){"actual", panel->actual, scale, false, 0}, time);
}

static void draw_error_panel(FILE *out, const struct report *report, const struct scale *time,
                             double top_px) {
    struct decades decades = error_decades(report);
    double foot_px = top_px + ERROR_PX;
    struct scale scale = {decades.lowest, decades.top, foot_px - ZERO_PX, top_px};
    for (int decade = decades.lowest; decade <= decades.top; decade++) {
        draw_level(out, scale_px(&scale, decade), pow(10, decade), decade < 0 ? -decade : 0);
    }
    draw_level(out, foot_px, 0, 0);
    draw_text(out, "heading", "start", LEFT_PX, top_px - 7, "Aim error (\u00B0), log scale");
    draw_series(out, report, &(struct series){"actual", error_of, scale, true, foot_px}, time);
}

/// Numbers where the pictures were taken; one that would touch the one before keeps its line only.
static void draw_marks(FILE *out, const struct report *report, size_t chapter,
                       const struct scale *time, double bottom_px) {
    double free_from_px = 0;
    for (size_t i = 0; i < report->picture_count; i++) {
        double x_px = scale_px(time, report->pictures[i].time_s);
        if (!(x_px >= LEFT_PX - 0.5 && x_px <= RIGHT_PX + 0.5)) {
            continue;
        }
        draw_line(out, "mark", x_px, TOP_PX - 4, x_px, bottom_px);
        if (x_px < free_from_px) {
            continue;
        }
        fprintf(out, "<a href=\"#p%zu-%zu\">", chapter, i + 1);
        begin_text(out, "number", "middle", x_px, TOP_PX - 8);
        fprintf(out, "%zu</text></a>\n", i + 1);
        free_from_px = x_px + 18;
    }
}

static void draw_time_axis(FILE *out, const struct scale *time, const struct ticks *ticks,
                           double unit_s, double y_px) {
    draw_line(out, "axis", LEFT_PX, y_px, RIGHT_PX, y_px);
    for (int i = 0; i < ticks->count; i++) {
        double x_px = scale_px(time, scale_tick(ticks, i) * unit_s);
        draw_line(out, "axis", x_px, y_px, x_px, y_px + 5);
        begin_text(out, "tick", "middle", x_px, y_px + 18);
        markup_number(out, scale_tick(ticks, i), ticks->decimals);
        fputs("</text>\n", out);
    }
    draw_text(out, "heading", "middle", (LEFT_PX + RIGHT_PX) / 2, y_px + 35,
              unit_s > 1 ? "Time (min)" : "Time (s)");
}

void plot_write(FILE *out, const struct report *report, size_t chapter) {
    if (report->sample_count == 0) {
        return;
    }
    double top_px[PANEL_COUNT];
    double at_px = TOP_PX;
    for (int i = 0; i < PANEL_COUNT; i++) {
        top_px[i] = at_px + HEADING_PX;
        at_px += panel_has_data(report, &panels[i]) ? HEADING_PX + PANEL_PX : 0;
    }
    double error_top_px = at_px + HEADING_PX;
    double band_top_px = error_top_px + ERROR_PX + HEADING_PX;
    double bottom_px = band_top_px + BAND_PX;

    double unit_s;
    struct scale time = time_scale(report, &unit_s);
    struct ticks ticks = scale_ticks(time.low / unit_s, time.high / unit_s, 13, SCALE_DECIMAL);
    fprintf(out,
            "<svg class=\"plot\" viewBox=\"0 0 %g %g\" role=\"img\" "
            "aria-label=\"Pan, tilt, focal length, aim error and mode over time\">\n",
            WIDTH_PX, bottom_px + TIME_AXIS_PX);
    for (int i = 0; i < PANEL_COUNT; i++) {
        if (panel_has_data(report, &panels[i])) {
            draw_time_grid(out, &time, &ticks, unit_s, top_px[i], top_px[i] + PANEL_PX);
        }
    }
    draw_time_grid(out, &time, &ticks, unit_s, error_top_px, error_top_px + ERROR_PX);
    draw_marks(out, report, chapter, &time, bottom_px);
    for (int i = 0; i < PANEL_COUNT; i++) {
        if (panel_has_data(report, &panels[i])) {
            draw_panel(out, report, &panels[i], &time, top_px[i]);
        }
    }
    draw_error_panel(out, report, &time, error_top_px);
    draw_text(out, "heading", "start", LEFT_PX, band_top_px - 7, "Mode");
    struct bands bands;
    bands_survey(report, &bands);
    bands_draw(out, report, &bands, &time, band_top_px, BAND_PX);
    draw_time_axis(out, &time, &ticks, unit_s, bottom_px);
    fputs("</svg>\n", out);
}

void plot_write_legend(FILE *out, const struct report *report) {
    struct bands bands;
    bands_survey(report, &bands);
    fputs("<p class=\"legend\"><span><svg viewBox=\"0 0 28 10\"><path class=\"actual\" "
          "d=\"M1 5h26\"/></svg>true</span> <span><svg viewBox=\"0 0 28 10\"><path "
          "class=\"setpoint\" d=\"M1 5h26\"/></svg>setpoint</span>\n",
          out);
    for (int i = 0; i < bands.count; i++) {
        fprintf(out,
                "<span><svg viewBox=\"0 0 14 10\"><path class=\"mode%d\" "
                "d=\"M1 0h12v10h-12z\"/></svg>",
                bands.mode[i].colour);
        markup_text(out, bands.mode[i].name);
        fputs(" <small>", out);
        markup_number(out, bands.mode[i].total_s, 2);
        fputs(" s</small></span>\n", out);
    }
    fputs("</p>\n", out);
}

void plot_write_note(FILE *out, const struct report *report) {
    struct decades decades = error_decades(report);
    fputs("The aim error is the angle between where the camera looks and the axis of the narrowest "
          "cone. Its scale is logarithmic: 0, and anything below ",
          out);
    markup_number(out, pow(10, decades.lowest), decades.lowest < 0 ? -decades.lowest : 0);
    fputs("\u00B0, is drawn on the line marked 0; gaps are times with nothing to aim at.", out);
    if (report->picture_count > 0) {
        fputs(" The numbers at the top mark the pictures below.", out);
    }
}
