/// The plots of a chapter over time, one below the other on one time axis, and the band of modes.
#ifndef VIEW_PLOT_H
#define VIEW_PLOT_H

#include "view/report.h"

#include <stdio.h>

/// Writes an <svg> with pan, tilt, focal length (if there is a zoom), aim error and mode, and a
/// mark at the time of each picture that leads to the element `pCHAPTER-PICTURE` (both count from
/// 1). Nothing without samples.
void plot_write(FILE *out, const struct report *report, size_t chapter);

/// Writes what the lines, the colours of the modes and the zero line mean.
void plot_write_legend(FILE *out, const struct report *report);
void plot_write_note(FILE *out, const struct report *report);

#endif
