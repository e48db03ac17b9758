#include "view/bands.h"

#include "view/markup.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/// The modes of the controller, in the order of their colours; others take the colours after them.
static const char *const known[] = {"starting", "ready",   "settling", "tracking",
                                    "holding",  "stopped", "faulted"};
enum { KNOWN_COUNT = sizeof known / sizeof *known };

static const char *name_of(const struct report_sample *sample) {
    return sample->mode == NULL ? "unknown" : sample->mode;
}

static int index_of(const struct bands *bands, const char *name) {
    for (int i = 0; i < bands->count; i++) {
        if (bands->mode[i].name == name || strcmp(bands->mode[i].name, name) == 0) {
            return i;
        }
    }
    // A name beyond those that were counted: "other", the last.
    return bands->count - 1;
}

static int add(struct bands *bands, const char *name) {
    int index = index_of(bands, name);
    if (index >= 0 && strcmp(bands->mode[index].name, name) == 0) {
        return index;
    }
    if (bands->count == BANDS_MODE_MAX) {
        bands->mode[index].name = "other";
        return index;
    }
    int colour = 0;
    while (colour < KNOWN_COUNT && strcmp(known[colour], name) != 0) {
        colour++;
    }
    if (colour == KNOWN_COUNT) {
        for (int i = 0; i < bands->count; i++) {
            colour += bands->mode[i].colour >= KNOWN_COUNT;
        }
    }
    bands->mode[bands->count] =
        (struct bands_mode){.name = name, .colour = colour % BANDS_MODE_MAX};
    return bands->count++;
}

void bands_survey(const struct report *report, struct bands *bands) {
    *bands = (struct bands){.count = 0};
    for (size_t i = 0; i < report->sample_count; i++) {
        int index = add(bands, name_of(&report->samples[i]));
        if (i + 1 < report->sample_count) {
            double stay_s = report->samples[i + 1].time_s - report->samples[i].time_s;
            bands->mode[index].total_s += isfinite(stay_s) ? stay_s : 0;
        }
    }
}

/// A stay in one mode.
struct stay {
    int mode;
    double from_px, to_px;
};

/// The stay that begins with sample `start`; *next is the first sample behind it. False: its time
/// is not finite.
static bool stay_at(const struct report *report, const struct bands *bands,
                    const struct scale *time, size_t start, size_t *next, struct stay *stay) {
    int mode = index_of(bands, name_of(&report->samples[start]));
    size_t end = start + 1;
    while (end < report->sample_count && index_of(bands, name_of(&report->samples[end])) == mode) {
        end++;
    }
    *next = end;
    size_t last = end < report->sample_count ? end : end - 1;
    stay->from_px = scale_px(time, report->samples[start].time_s);
    stay->to_px = scale_px(time, report->samples[last].time_s);
    stay->mode = mode;
    return isfinite(stay->from_px) && isfinite(stay->to_px);
}

/// Columns of the band, a pixel wide each.
#define COLUMN_MAX 1024

/// What each column shows.
struct columns {
    int count;
    int main[COLUMN_MAX];  ///< mode of most of its time; -1: none
    int brief[COLUMN_MAX]; ///< of the modes that came and went within a pixel, the one of least
                           ///< total time; -1: none
};

static int column_of(const struct columns *columns, double from_left_px) {
    return (int)fmin(fmax(floor(from_left_px), 0), columns->count - 1);
}

static void fill_columns(const struct report *report, const struct bands *bands,
                         const struct scale *time, struct columns *columns) {
    static const struct bands_mode none = {.total_s = INFINITY};
    double share_px[COLUMN_MAX];
    double spent_px[BANDS_MODE_MAX] = {0}; // in the last column so far
    int last = -1;
    columns->count = (int)fmin(time->px_high - time->px_low, COLUMN_MAX);
    for (int i = 0; i < columns->count; i++) {
        columns->main[i] = -1;
        columns->brief[i] = -1;
        share_px[i] = -1;
    }
    size_t next;
    for (size_t at = 0; at < report->sample_count; at = next) {
        struct stay stay;
        if (!stay_at(report, bands, time, at, &next, &stay)) {
            continue;
        }
        double from_px = stay.from_px - time->px_low;
        double to_px = stay.to_px - time->px_low;
        for (int i = column_of(columns, from_px); i <= column_of(columns, to_px); i++) {
            if (i != last) {
                memset(spent_px, 0, sizeof spent_px);
                last = i;
            }
            spent_px[stay.mode] += fmax(fmin(to_px, i + 1) - fmax(from_px, i), 0);
            if (spent_px[stay.mode] > share_px[i]) {
                share_px[i] = spent_px[stay.mode];
                columns->main[i] = stay.mode;
            }
        }
        int *brief = &columns->brief[column_of(columns, from_px)];
        const struct bands_mode *before = *brief < 0 ? &none : &bands->mode[*brief];
        if (to_px - from_px < 1 && bands->mode[stay.mode].total_s < before->total_s) {
            *brief = stay.mode;
        }
    }
}

/// The columns from `at` on that hold the same mode as it does.
static int run_length(const int *mode, int at, int count) {
    int end = at + 1;
    while (end < count && mode[end] == mode[at]) {
        end++;
    }
    return end - at;
}

static void draw_mode(FILE *out, const int *columns, int count, int mode, int colour,
                      double left_px, double top_px, double height_px) {
    bool any = false;
    for (int at = 0; at < count; at += run_length(columns, at, count)) {
        if (columns[at] != mode) {
            continue;
        }
        if (!any) {
            fprintf(out, "<path class=\"mode%d\" d=\"", colour);
        }
        any = true;
        int width_px = run_length(columns, at, count);
        fputc('M', out);
        markup_px(out, left_px + at);
        fputc(' ', out);
        markup_px(out, top_px);
        fprintf(out, "h%dv", width_px);
        markup_px(out, height_px);
        fprintf(out, "h-%dz", width_px);
    }
    if (any) {
        fputs("\"/>\n", out);
    }
}

/// Names go over all colours, where a stay is wide enough for its name.
static void draw_names(FILE *out, const struct report *report, const struct bands *bands,
                       const struct scale *time, double top_px, double height_px) {
    size_t next;
    for (size_t at = 0; at < report->sample_count; at = next) {
        struct stay stay;
        bool usable = stay_at(report, bands, time, at, &next, &stay);
        const char *name = bands->mode[stay.mode].name;
        double wanted_px = 6.6 * (double)markup_length(name) + 6;
        if (!usable || stay.to_px - stay.from_px < wanted_px) {
            continue;
        }
        fputs("<text class=\"stay\" text-anchor=\"middle\" x=\"", out);
        markup_px(out, (stay.from_px + stay.to_px) / 2);
        fputs("\" y=\"", out);
        markup_px(out, top_px + height_px / 2 + 4);
        fputs("\">", out);
        markup_text(out, name);
        fputs("</text>\n", out);
    }
}

void bands_draw(FILE *out, const struct report *report, const struct bands *bands,
                const struct scale *time, double top_px, double height_px) {
    struct columns columns;
    fill_columns(report, bands, time, &columns);
    for (int i = 0; i < columns.count; i++) { // what fills its column has no need of a second mark
        columns.brief[i] = columns.brief[i] == columns.main[i] ? -1 : columns.brief[i];
    }
    for (int i = 0; i < bands->count; i++) {
        draw_mode(out, columns.main, columns.count, i, bands->mode[i].colour, time->px_low, top_px,
                  height_px);
    }
    for (int i = 0; i < bands->count; i++) {
        draw_mode(out, columns.brief, columns.count, i, bands->mode[i].colour, time->px_low,
                  top_px + height_px / 2, height_px / 2);
    }
    draw_names(out, report, bands, time, top_px, height_px);
}
