/// A picture of lines, dots and texts, written as SVG or PNG.
/// Shown: tests/cli/render.sh, tests/cli/plan.sh.
#ifndef LINUX_DRAWING_H
#define LINUX_DRAWING_H

#include "message.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum drawing_pen {
    PEN_EDGE,   ///< a visible line of a scene
    PEN_FRAME,  ///< the border of the camera's picture, and its middle
    PEN_CONE,   ///< the cone that is aimed along
    PEN_TARGET, ///< a target in sight
    PEN_LOST,   ///< a hidden one
    PEN_COUNT
};

struct drawing_line {
    float x0, y0, x1, y1; ///< pixels; (0, 0) is the top left corner
    enum drawing_pen pen;
};

struct drawing_dot {
    float x, y, radius;
    enum drawing_pen pen;
    bool filled;
};

struct drawing {
    uint32_t width, height; ///< pixels
    struct drawing_line *lines;
    struct drawing_dot *dots;
    size_t line_count, line_room, dot_count, dot_room;
    bool failed; ///< no memory: something is missing
};

/// Colours as 0xRRGGBB and widths in pixels, by pen.
extern const uint32_t drawing_color[PEN_COUNT];
extern const float drawing_width[PEN_COUNT];

void drawing_line(struct drawing *drawing, struct drawing_line line);
void drawing_dot(struct drawing *drawing, struct drawing_dot dot);
void drawing_free(struct drawing *drawing);

/// Writes path; .svg or .png says how. The file appears whole or not at all. A fault is told in one
/// line.
enum exit_status drawing_write(const struct drawing *drawing, const char *path);

/// The library that writes PNG, with its version; NULL: this program was built without it.
const char *drawing_png_library(void);
/// The picture as PNG, to be freed; NULL: not built in, or no memory.
void *drawing_png(const struct drawing *drawing, size_t *size_bytes);

/// Cuts a line to the picture. False: it is outside.
bool drawing_clip(const struct drawing *drawing, double from[2], double to[2]);

#endif
