/// The modes of a run as a coloured band.
#ifndef VIEW_BANDS_H
#define VIEW_BANDS_H

#include "view/report.h"
#include "view/scale.h"

#include <stdio.h>

/// Different modes that a band tells apart; further ones share the last place, as "other".
#define BANDS_MODE_MAX 12

struct bands_mode {
    const char *name;
    int colour;     ///< class `mode0` to `mode11`
    double total_s; ///< time spent in it
};

struct bands {
    struct bands_mode mode[BANDS_MODE_MAX];
    int count; ///< in order of first appearance
};

/// The modes of a report's samples. A sample's mode lasts until the next sample.
void bands_survey(const struct report *report, struct bands *bands);

/// Draws the band. Each column a pixel wide has the colour of the mode that holds most of its time.
/// A mode that came and went within a pixel shows in the lower half of its column; of several such
/// the one that is rarest in the run, so that a single sample of a fault shows in a run of any
/// length. Stays wide enough carry their name. Not more than 1024 pixels wide.
void bands_draw(FILE *out, const struct report *report, const struct bands *bands,
                const struct scale *time, double top_px, double height_px);

#endif
