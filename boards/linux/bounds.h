/// The box round points as written: exact decimals.
/// Shown: tests/cli/picture.sh.
#ifndef LINUX_BOUNDS_H
#define LINUX_BOUNDS_H

#include "decimal.h"

#include <stdbool.h>

/// One side's place, with its own copy of the text, because a decimal's digits stay in it.
struct bounds_side {
    char *text;
    struct decimal value;
};

struct bounds {
    bool any;
    struct bounds_side least[3], most[3];
};

/// Takes in a coordinate: axis 0 to 2. text[0..size) is what value was read from.
/// False: no memory.
bool bounds_add(struct bounds *bounds, int axis, const char *text, size_t size,
                const struct decimal *value);

/// Corner 0 to 7: bit k tells which side of axis k. Only of a box with a point in it.
void bounds_corner(const struct bounds *bounds, int corner, struct decimal out[3]);

void bounds_free(struct bounds *bounds);

#endif
