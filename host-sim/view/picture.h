/// One picture as SVG: the sensor's frame, what stands in it, the cone and the boresight.
#ifndef VIEW_PICTURE_H
#define VIEW_PICTURE_H

#include "view/report.h"

#include <stdio.h>

/// Pixels of the drawing; PICTURE_WIDTH_PX is also the width at which its texts have their own
/// size.
#define PICTURE_WIDTH_PX      400
#define PICTURE_HEIGHT_MIN_PX 160
#define PICTURE_HEIGHT_MAX_PX 440

/// Of more background points than this only the largest are drawn.
#define PICTURE_BACKGROUND_MAX 1500

/// What the drawing shows, for its caption.
struct picture_drawn {
    double height_px;
    size_t target_count, target_outside_count; ///< outside: not on the sensor
    size_t background_count;                   ///< on the sensor or just beside it
    size_t background_drawn_count;
};

/// The height of the drawing and the counts.
struct picture_drawn picture_survey(const struct report_picture *picture);

/// Writes the drawing as children of an <svg> whose viewBox is PICTURE_WIDTH_PX by
/// picture_survey().height_px; the classes it uses are those of PICTURE_CLASSES.
/// False: out of memory.
bool picture_draw(FILE *out, const struct report_picture *picture);

#endif
