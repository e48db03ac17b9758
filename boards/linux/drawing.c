#include "drawing.h"

#include "view/markup.h"
#include "view/new_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const uint32_t drawing_color[PEN_COUNT] = {0x1b2733, 0x8a94a0, 0xd97706, 0x047857, 0xb91c1c};
const float drawing_width[PEN_COUNT] = {1.0F, 1.0F, 1.5F, 1.5F, 1.0F};

static void *grow(struct drawing *d, void *array, size_t count, size_t *room, size_t size) {
    if (count < *room) {
        return array;
    }
    const size_t wanted = *room == 0U ? 256U : 2U * *room;
    void *const grown = realloc(array, wanted * size);
    if (grown == NULL) {
        d->failed = true;
        return array;
    }
    *room = wanted;
    return grown;
}

void drawing_line(struct drawing *drawing, struct drawing_line line) {
    drawing->lines = grow(drawing, drawing->lines, drawing->line_count, &drawing->line_room,
                          sizeof *drawing->lines);
    if (!drawing->failed) {
        drawing->lines[drawing->line_count++] = line;
    }
}

void drawing_dot(struct drawing *drawing, struct drawing_dot dot) {
    drawing->dots =
        grow(drawing, drawing->dots, drawing->dot_count, &drawing->dot_room, sizeof *drawing->dots);
    if (!drawing->failed) {
        drawing->dots[drawing->dot_count++] = dot;
    }
}

void drawing_free(struct drawing *drawing) {
    free(drawing->lines);
    free(drawing->dots);
    *drawing = (struct drawing){0};
}

bool drawing_clip(const struct drawing *drawing, double from[2], double to[2]) {
    const double size[2] = {drawing->width, drawing->height};
    const double start[2] = {from[0], from[1]}, way[2] = {to[0] - from[0], to[1] - from[1]};
    double low = 0, high = 1;
    for (int axis = 0; axis < 2; axis++) {
        const double first = -start[axis], last = size[axis] - start[axis];
        if (way[axis] == 0) {
            if (first > 0 || last < 0) {
                return false;
            }
            continue;
        }
        const double a = first / way[axis], b = last / way[axis];
        low = (a < b ? a : b) > low ? (a < b ? a : b) : low;
        high = (a < b ? b : a) < high ? (a < b ? b : a) : high;
    }
    for (int axis = 0; axis < 2; axis++) {
        from[axis] = start[axis] + low * way[axis];
        to[axis] = start[axis] + high * way[axis];
    }
    return low <= high;
}

static void write_pair(FILE *out, char command, float x, float y) {
    (void)fputc(command, out);
    markup_px(out, (double)x);
    (void)fputc(' ', out);
    markup_px(out, (double)y);
}

static void write_svg(const struct drawing *d, FILE *out) {
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %u %u\" width=\"%u\" "
            "height=\"%u\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            d->width, d->height, d->width, d->height);
    for (int pen = 0; pen < PEN_COUNT; pen++) {
        bool any = false;
        for (size_t i = 0; i < d->line_count; i++) {
            const struct drawing_line *const l = &d->lines[i];
            if ((int)l->pen != pen) {
                continue;
            }
            if (!any) {
                fprintf(out,
                        "<path fill=\"none\" stroke=\"#%06x\" stroke-width=\"%g\" "
                        "stroke-linecap=\"round\" d=\"",
                        drawing_color[pen], (double)drawing_width[pen]);
                any = true;
            }
            write_pair(out, 'M', l->x0, l->y0);
            write_pair(out, 'L', l->x1, l->y1);
        }
        fprintf(out, "%s", any ? "\"/>\n" : "");
    }
    for (size_t i = 0; i < d->dot_count; i++) {
        const struct drawing_dot *const dot = &d->dots[i];
        fprintf(out, "<circle cx=\"");
        markup_px(out, (double)dot->x);
        fprintf(out, "\" cy=\"");
        markup_px(out, (double)dot->y);
        fprintf(out, "\" r=\"");
        markup_px(out, (double)dot->radius);
        fprintf(out, "\" fill=\"%s", dot->filled ? "" : "none\" stroke=\"");
        fprintf(out, "#%06x\"/>\n", drawing_color[dot->pen]);
    }
    fprintf(out, "</svg>\n");
}

static bool has_ending(const char *path, const char *ending) {
    const size_t size = strlen(path), tail = strlen(ending);
    return size > tail && strcmp(path + size - tail, ending) == 0;
}

enum exit_status drawing_write(const struct drawing *drawing, const char *path) {
    char *text = NULL;
    size_t size = 0;
    void *png = NULL;
    if (has_ending(path, ".png")) {
        if (drawing_png_library() == NULL) {
            message_at(path, 0,
                       "this program was built without cairo: it writes .svg only; "
                       "install libcairo2-dev and build it again");
            return EXIT_STATUS_USAGE;
        }
        png = drawing->failed ? NULL : drawing_png(drawing, &size);
    } else if (has_ending(path, ".svg")) {
        FILE *const out = drawing->failed ? NULL : open_memstream(&text, &size);
        if (out != NULL) {
            write_svg(drawing, out);
            if (fclose(out) != 0) {
                free(text);
                text = NULL;
            }
        }
    } else {
        message_at(path, 0, "the name of a picture ends in .svg or .png");
        return EXIT_STATUS_USAGE;
    }
    const void *const bytes = png != NULL ? png : text;
    enum exit_status status = EXIT_STATUS_OK;
    if (bytes == NULL) {
        message_at(path, 0, "no memory for the picture");
        status = EXIT_STATUS_FAILURE;
    } else if (!new_file_write(path, bytes, size)) {
        message_at(path, 0, "%s", strerror(errno));
        status = EXIT_STATUS_USAGE;
    }
    free(text);
    free(png);
    return status;
}
