/// Connected components of the pixels of a picture that are at least so bright.
///
/// Pixels are connected by edges and corners. One pass over the picture finds the runs of each row,
/// a union-find over runs joins them; sums for centroid and second moments come from the runs'
/// ends, so that wide areas cost no more than narrow ones.
#ifndef DETECT_COMPONENTS_H
#define DETECT_COMPONENTS_H

#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdint.h>

struct component {
    uint32_t area_px;
    uint32_t left, top, right, bottom; ///< both ends belong to it
    uint64_t sum_u, sum_v, sum_uu, sum_uv, sum_vv;
};

struct component_run {
    uint32_t left, right, row; ///< both ends belong to it
    uint32_t parent;           ///< in the union-find; a root is its own
    uint32_t index;            ///< of a root: which component
};

struct components {
    uint32_t run_capacity, component_capacity;
    struct component_run *runs;
    uint32_t count;
    struct component *item;
    bool complete; ///< false: there were more than fit
};

/// Room for so many runs and components. False: no memory.
bool components_create(struct components *components, uint32_t run_capacity,
                       uint32_t component_capacity) MUST_CHECK;
void components_destroy(struct components *components);

struct component_picture {
    const uint8_t *luma;
    uint32_t width_px, height_px, stride_bytes;
};

/// Fills components->item with those of at least area_px_min pixels, by their topmost run.
/// Pictures of up to 8192 x 8192 pixels.
/// Returns: false if there are more runs or components than fit: then the first ones are there.
/// Cost:    O(pixels + runs). Shown: tests/scenario/test_components.c, against flood filling.
bool components_find(struct components *components, const struct component_picture *picture,
                     uint8_t luma_min, uint32_t area_px_min);

/// The ellipse with the same area-normalised second moments as the component.
struct component_shape {
    double middle[2];
    double long_axis_px, short_axis_px; ///< half lengths
    /// Area of the component by that of the ellipse: 1 for discs and ellipses, 0.955 for squares,
    /// less for what is bent or has holes.
    double fill;
};
struct component_shape component_shape_of(const struct component *component);

#endif
