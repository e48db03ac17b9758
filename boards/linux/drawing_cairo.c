/// PNG by cairo.
#include "drawing.h"

#include <cairo/cairo.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *drawing_png_library(void) {
    return "cairo " CAIRO_VERSION_STRING;
}

struct bytes {
    unsigned char *data;
    size_t size;
};

static cairo_status_t append(void *context, const unsigned char *data, unsigned int size) {
    struct bytes *const bytes = context;
    unsigned char *const grown = realloc(bytes->data, bytes->size + size);
    if (grown == NULL) {
        return CAIRO_STATUS_NO_MEMORY;
    }
    memcpy(grown + bytes->size, data, size);
    bytes->data = grown;
    bytes->size += size;
    return CAIRO_STATUS_SUCCESS;
}

static void use_pen(cairo_t *cairo, enum drawing_pen pen) {
    const uint32_t color = drawing_color[pen];
    cairo_set_source_rgb(cairo, (color >> 16) / 255.0, (color >> 8 & 255U) / 255.0,
                         (color & 255U) / 255.0);
    cairo_set_line_width(cairo, (double)drawing_width[pen]);
}

static void paint(const struct drawing *d, cairo_t *cairo) {
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    for (int pen = 0; pen < PEN_COUNT; pen++) {
        use_pen(cairo, (enum drawing_pen)pen);
        for (size_t i = 0; i < d->line_count; i++) {
            const struct drawing_line *const l = &d->lines[i];
            if ((int)l->pen == pen) {
                cairo_move_to(cairo, (double)l->x0, (double)l->y0);
                cairo_line_to(cairo, (double)l->x1, (double)l->y1);
            }
        }
        cairo_stroke(cairo);
    }
    for (size_t i = 0; i < d->dot_count; i++) {
        const struct drawing_dot *const dot = &d->dots[i];
        use_pen(cairo, dot->pen);
        cairo_new_path(cairo);
        cairo_arc(cairo, (double)dot->x, (double)dot->y, (double)dot->radius, 0, 2 * M_PI);
        if (dot->filled) {
            cairo_fill(cairo);
        } else {
            cairo_stroke(cairo);
        }
    }
}

void *drawing_png(const struct drawing *drawing, size_t *size_bytes) {
    struct bytes bytes = {NULL, 0};
    cairo_surface_t *const surface =
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)drawing->width, (int)drawing->height);
    cairo_t *const cairo = cairo_create(surface);
    paint(drawing, cairo);
    cairo_destroy(cairo);
    if (cairo_surface_write_to_png_stream(surface, append, &bytes) != CAIRO_STATUS_SUCCESS) {
        free(bytes.data);
        bytes = (struct bytes){NULL, 0};
    }
    cairo_surface_destroy(surface);
    *size_bytes = bytes.size;
    return bytes.data;
}
