#include "view/markup.h"
#include "view/new_file.h"
#include "view/picture.h"
#include "view/plot.h"
#include "view/report.h"
#include "view/style.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

extern const char build_id[];

#define DEGREES    "\u00B0"
#define NARROW_GAP "\u202F" ///< between a number and its unit; the line does not break there

static void write_element(FILE *out, const char *begin, const char *text, const char *end) {
    fputs(begin, out);
    markup_text(out, text);
    fputs(end, out);
}

static void write_facts(FILE *out, const struct report *report) {
    if (report->fact_count == 0) {
        return;
    }
    fputs("<dl class=\"facts\">\n", out);
    for (size_t i = 0; i < report->fact_count; i++) {
        write_element(out, "<div><dt>", report->facts[i].name, "</dt>");
        write_element(out, "<dd>", report->facts[i].value, "</dd></div>\n");
    }
    fputs("</dl>\n", out);
}

static void write_plots(FILE *out, const struct report *report, size_t chapter) {
    if (report->sample_count == 0) {
        fputs("<p>No samples were recorded.</p>\n", out);
        return;
    }
    fputs("<h3>Over time</h3>\n<figure>\n", out);
    plot_write_legend(out, report);
    fputs("<div class=\"wide\">\n", out);
    plot_write(out, report, chapter);
    fputs("</div>\n<figcaption>", out);
    plot_write_note(out, report);
    fputs("</figcaption>\n</figure>\n", out);
}

/// A number of the caption. The same quantity has the same decimals in every caption.
struct caption_item {
    const char *name, *unit;
    double value;
    int decimals;
};

enum { CAPTION_ITEM_COUNT = 6 };

static void caption_items(const struct report_picture *picture,
                          struct caption_item item[CAPTION_ITEM_COUNT]) {
    // Negative and 0 are "not known" and "no zoom": a dash.
    double error_deg = picture->error_deg >= 0 ? picture->error_deg : NAN;
    double focal_mm = picture->focal_mm > 0 ? picture->focal_mm : NAN;
    item[0] = (struct caption_item){"time", NARROW_GAP "s", picture->time_s, 2};
    item[1] = (struct caption_item){"pan", DEGREES, picture->pan_deg, 2};
    item[2] = (struct caption_item){"tilt", DEGREES, picture->tilt_deg, 2};
    item[3] = (struct caption_item){"half-angle", DEGREES, picture->half_angle_deg, 2};
    item[4] = (struct caption_item){"focal", NARROW_GAP "mm", focal_mm, 1};
    item[5] = (struct caption_item){"error", DEGREES, error_deg, 4};
}

static void write_value(FILE *out, const struct caption_item *item) {
    markup_number(out, item->value, item->decimals);
    if (isfinite(item->value)) {
        fputs(item->unit, out);
    }
}

static void write_counts(FILE *out, const struct picture_drawn *drawn) {
    fprintf(out, "<p>%zu target%s", drawn->target_count, drawn->target_count == 1 ? "" : "s");
    if (drawn->target_outside_count > 0) {
        fprintf(out, ", %zu outside the frame", drawn->target_outside_count);
    }
    if (drawn->background_drawn_count < drawn->background_count) {
        fprintf(out, "; the largest %zu of %zu background points", drawn->background_drawn_count,
                drawn->background_count);
    }
    fputs("</p>\n", out);
}

static bool write_picture(FILE *out, const struct report_picture *picture, size_t chapter,
                          size_t number) {
    struct picture_drawn drawn = picture_survey(picture);
    fprintf(out,
            "<figure class=\"picture\" id=\"p%zu-%zu\">\n<svg viewBox=\"0 0 %d %.1f\" "
            "role=\"img\" aria-label=\"",
            chapter, number, PICTURE_WIDTH_PX, drawn.height_px);
    markup_text(out, picture->title);
    fputs("\">\n", out);
    bool complete = picture_draw(out, picture);
    fprintf(out, "</svg>\n<figcaption>\n<h4><span>%zu</span>", number);
    markup_text(out, picture->title);
    fputs("</h4>\n<dl>\n", out);
    struct caption_item item[CAPTION_ITEM_COUNT];
    caption_items(picture, item);
    for (int i = 0; i < CAPTION_ITEM_COUNT; i++) {
        fprintf(out, "<div><dt>%s</dt><dd>", item[i].name);
        write_value(out, &item[i]);
        fputs("</dd></div>\n", out);
    }
    fputs("</dl>\n", out);
    write_counts(out, &drawn);
    fputs("</figcaption>\n</figure>\n", out);
    return complete;
}

static bool write_pictures(FILE *out, const struct report *report, size_t chapter) {
    if (report->picture_count == 0) {
        return true;
    }
    fputs("<h3>What the camera saw</h3>\n<div class=\"pictures\">\n", out);
    for (size_t i = 0; i < report->picture_count; i++) {
        if (!write_picture(out, &report->pictures[i], chapter, i + 1)) {
            return false;
        }
    }
    fputs("</div>\n<p class=\"legend\">"
          "<span><svg viewBox=\"0 0 12 10\"><circle class=\"target\" cx=\"6\" cy=\"5\" r=\"2.6\"/>"
          "</svg>target</span>"
          "<span><svg viewBox=\"0 0 12 10\"><circle class=\"target lost\" cx=\"6\" cy=\"5\" "
          "r=\"3\"/></svg>target outside the frame</span>"
          "<span><svg viewBox=\"0 0 12 10\"><path class=\"background\" stroke-width=\"2.4\" "
          "d=\"M6 5h0\"/></svg>background</span>"
          "<span><svg viewBox=\"0 0 12 10\"><circle class=\"cone\" cx=\"6\" cy=\"5\" r=\"4\"/>"
          "</svg>narrowest cone</span>"
          "<span><svg viewBox=\"0 0 12 10\"><path class=\"boresight\" d=\"M6 0v3.5m0 3v3.5"
          "M1 5h3.5m3 0h3.5\"/></svg>boresight</span>"
          "<span><svg viewBox=\"0 0 16 10\"><path class=\"frame\" d=\"M1 1h13v8h-13z\"/></svg>"
          "sensor</span></p>\n",
          out);
    return true;
}

static void write_head(FILE *out, const struct report *const *chapters, size_t chapter_count) {
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
          "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n<title>",
          out);
    if (chapter_count > 0) {
        write_element(out, "", chapters[0]->title, " \u00B7 ");
    }
    fputs("Boresight</title>\n<style>\n", out);
    fputs(style_page, out);
    fputs("</style>\n</head>\n<body>\n<header>\n<h1>Report of a run</h1>\n", out);
    write_element(out, "<p>Boresight ", build_id, "</p>\n");
    if (chapter_count == 0) {
        fputs("<p>Nothing was recorded.</p>\n", out);
    }
    if (chapter_count > 1) {
        fputs("<nav><ol>\n", out);
        for (size_t i = 0; i < chapter_count; i++) {
            fprintf(out, "<li><a href=\"#c%zu\">", i + 1);
            write_element(out, "", chapters[i]->title, "</a></li>\n");
        }
        fputs("</ol></nav>\n", out);
    }
    fputs("</header>\n", out);
}

static bool write_page(FILE *out, const struct report *const *chapters, size_t chapter_count) {
    write_head(out, chapters, chapter_count);
    for (size_t i = 0; i < chapter_count; i++) {
        fprintf(out, "<section id=\"c%zu\">\n", i + 1);
        write_element(out, "<h2>", chapters[i]->title, "</h2>\n");
        if (chapters[i]->subtitle[0] != '\0') {
            write_element(out, "<p class=\"subtitle\">", chapters[i]->subtitle, "</p>\n");
        }
        write_facts(out, chapters[i]);
        write_plots(out, chapters[i], i + 1);
        if (!write_pictures(out, chapters[i], i + 1)) {
            return false;
        }
        fputs("</section>\n", out);
    }
    fputs("<footer>Angles are in degrees, as the simulator knows them: what the camera really saw, "
          "not what the encoders told the controller.</footer>\n</body>\n</html>\n",
          out);
    return true;
}

/// Title, drawing and caption below one another on a card.
static bool write_card(FILE *out, const struct report_picture *picture) {
    enum { MARGIN = 12, TITLE = 34, ROW = 19, COLUMN = 128 };
    struct picture_drawn drawn = picture_survey(picture);
    double height_px = TITLE + drawn.height_px + 2 * ROW + MARGIN;
    double title_px =
        fmin(15, (PICTURE_WIDTH_PX - 2 * MARGIN) / (0.58 * (double)markup_length(picture->title)));
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" height=\"%.0f\" "
            "viewBox=\"0 0 %d %.1f\">\n<title>",
            2 * height_px, PICTURE_WIDTH_PX, height_px);
    markup_text(out, picture->title);
    fprintf(out,
            "</title>\n<style>\n%s</style>\n<rect class=\"card\" x=\".5\" y=\".5\" width=\"%d\" "
            "height=\"%.1f\" rx=\"8\"/>\n<text class=\"title\" font-size=\"%.1f\" x=\"%d\" "
            "y=\"22\">",
            style_picture, PICTURE_WIDTH_PX - 1, height_px - 1, title_px, MARGIN);
    markup_text(out, picture->title);
    fprintf(out, "</text>\n<svg y=\"%d\" width=\"%d\" height=\"%.1f\" viewBox=\"0 0 %d %.1f\">\n",
            TITLE, PICTURE_WIDTH_PX, drawn.height_px, PICTURE_WIDTH_PX, drawn.height_px);
    if (!picture_draw(out, picture)) {
        return false;
    }
    fputs("</svg>\n", out);
    struct caption_item item[CAPTION_ITEM_COUNT];
    caption_items(picture, item);
    for (int i = 0; i < CAPTION_ITEM_COUNT; i++) {
        fprintf(out, "<text class=\"fact\" x=\"%d\" y=\"%.1f\"><tspan class=\"name\">%s</tspan> ",
                MARGIN + i % 3 * COLUMN, TITLE + drawn.height_px + 15 + i / 3 * ROW, item[i].name);
        write_value(out, &item[i]);
        fputs("</text>\n", out);
    }
    // Last, so that the drawing does not cover the edge.
    fprintf(out,
            "<rect class=\"edge\" x=\".5\" y=\".5\" width=\"%d\" height=\"%.1f\" "
            "rx=\"8\"/>\n</svg>\n",
            PICTURE_WIDTH_PX - 1, height_px - 1);
    return true;
}

/// Puts what `stream` has gathered into the file and frees it.
static bool finish(FILE *stream, bool complete, char **text, const size_t *size, const char *path) {
    // The stream writes to memory only: its one way to fail is to run out of it.
    complete = ferror(stream) == 0 && complete;
    complete = fclose(stream) == 0 && complete;
    bool written = false;
    if (complete) {
        written = new_file_write(path, *text, *size);
    } else {
        errno = ENOMEM;
    }
    int why = errno;
    free(*text);
    errno = why;
    return written;
}

bool report_write(const struct report *const *chapters, size_t chapter_count, const char *path) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL) {
        return false;
    }
    bool complete = write_page(stream, chapters, chapter_count);
    return finish(stream, complete, &text, &size, path);
}

bool report_picture_svg(const struct report_picture *picture, const char *path) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL) {
        return false;
    }
    bool complete = write_card(stream, picture);
    return finish(stream, complete, &text, &size, path);
}
