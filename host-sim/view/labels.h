/// Where the names of dots stand, so that no name covers another name or a dot.
#ifndef VIEW_LABELS_H
#define VIEW_LABELS_H

#include <stdbool.h>
#include <stddef.h>

/// Pixels; x to the right, y down.
struct labels_box {
    double left, top, right, bottom;
};

struct labels_dot {
    double x_px, y_px, radius_px;
};

/// What to keep clear of. All dots count, named or not; ring_radius_px 0: no ring.
struct labels_surroundings {
    struct labels_box picture; ///< names stay inside
    const struct labels_dot *dot;
    size_t dot_count;
    double ring_x_px, ring_y_px, ring_radius_px; ///< crossed only where there is no other way
    struct labels_box *placed;                   ///< boxes of the names so far
    size_t placed_count;
};

/// Finds a box of that size beside the dot, tries eight places. False: each covers something; the
/// name is better left out. The caller adds the box to `placed`. Cost: O(dots + placed).
bool labels_place(const struct labels_surroundings *around, const struct labels_dot *dot,
                  double width_px, double height_px, struct labels_box *box);

#endif
