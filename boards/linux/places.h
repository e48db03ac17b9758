/// Points in space as integers in a common unit.
/// Shown: tests/cli/solid.sh.
#ifndef LINUX_PLACES_H
#define LINUX_PLACES_H

#include "points.h"

/// Sets directions, unit and places_exact of points that have been read as places. If all
/// coordinates are whole multiples of one power of ten of at most `most` in size, they are exact;
/// else the largest is scaled to between most / 2 and most, and all are rounded to nearest.
/// from_text: the coordinates are in place_text; else in directions already, in units of 1.
void places_finish(struct points *points, bool from_text, int32_t most);

/// Takes a finer unit, by a power of two, as far as no coordinate gets beyond `most`: so that what
/// is rounded to whole units is fine.
void places_spread(struct points *points, int32_t most);

#endif
