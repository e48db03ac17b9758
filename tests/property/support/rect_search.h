/// The smallest picture without roll by a search of all directions, in doubles: a grid, and the
/// best places of it refined. And random sets for it. Shares nothing with the solvers.
#ifndef TESTS_PROPERTY_SUPPORT_RECT_SEARCH_H
#define TESTS_PROPERTY_SUPPORT_RECT_SEARCH_H

#include "fixed/vec3.h"

#include <stdint.h>

#define RECT_POINTS_MOST 40

struct rect_set {
    uint32_t count;
    struct vec3 direction[RECT_POINTS_MOST]; ///< any length
    double unit[RECT_POINTS_MOST][3];
    double radius_rad[RECT_POINTS_MOST]; ///< of a cap round it
};

/// Points round a random direction (often near the zenith), within up to 50 degrees of it.
void rect_set_draw(struct rect_set *set, uint64_t *seed);

/// The directions are others now.
void rect_set_measure(struct rect_set *set);

/// What the picture must be wide, by the definition: the larger of tan(half width) / width and
/// tan(half height) / height. HUGE_VAL: a cap is not strictly in front.
double rect_set_slope(const struct rect_set *set, double width, double height, double pan,
                      double tilt);

/// The least of it.
double rect_set_search(const struct rect_set *set, double width, double height);

#endif
