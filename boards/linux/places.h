/// Points in space as integers in a common unit.
#ifndef LINUX_PLACES_H
#define LINUX_PLACES_H

#include "points.h"

/// Sets directions, unit and places_exact of points that have been read as places. If all
/// coordinates are whole multiples of one power of ten that fit int32, they are exact; else the
/// largest gets 30 or 31 bits, and all are rounded to nearest.
/// from_text: the coordinates are in place_text; else in directions already, in units of 1.
void places_finish(struct points *points, bool from_text);

#endif
