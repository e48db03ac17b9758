/// Bright markers: LEDs, lamps, retroreflectors; round or oval, brighter than all around them.
///
/// A marker is a component of bright pixels that is compact at a threshold well above its
/// surroundings, so thresholds are tried from high to low: the lowest at which the component is
/// still one compact spot counts. Its middle is the centroid of the brightness above its
/// surroundings, which a symmetric blur does not move.
#ifndef DETECT_MARKERS_H
#define DETECT_MARKERS_H

#include "detect/components.h"
#include "detect/detection.h"
#include "fixed/must_check.h"
#include "hal/camera.h"

#include <stdbool.h>
#include <stdint.h>

struct markers_settings {
    uint8_t contrast_min;   ///< grey levels above the surroundings
    uint32_t area_px_min;   ///< of the spot at its threshold
    double diameter_px_max; ///< of its longer axis
    double elongation_max;  ///< longer axis by shorter
    double form_min; ///< how well an ellipse fits: 1 for one, 0.87 for a square, 0.75 for an L
};

/// 40 levels, from 6 pixels of area to half of the picture's height, at most 2.5 times as long as
/// wide, fitted by an ellipse to 80 %.
struct markers_settings markers_defaults(uint32_t height_px);

enum { MARKERS_MAX = 64 };

struct marker {
    double pixel[2];
    double radius_px; ///< longer half axis
    double box_px[4]; ///< left, top, right, bottom
    /// Contrast by that of the full range, times how well an ellipse fits: what other bright things
    /// score less at. 0 to 1.
    double confidence;
};

struct markers_work {
    struct components components;
    uint32_t count;
    struct marker item[MARKERS_MAX];
    uint8_t threshold[MARKERS_MAX]; ///< at which each was found
};

bool markers_create(struct markers_work *work) MUST_CHECK;
void markers_destroy(struct markers_work *work);

/// Finds the markers of a frame, the topmost first.
/// Accuracy: 0.3 px rms and 99 % found of discs from 6 px diameter (30 pixels of area) up, noise of
///           4 levels, blur of 1 px (tests/property/marker_frames.c prints what it measured).
/// Cost:     a histogram and at most MARKERS_LEVELS passes over the bright part of the picture;
///           make bench-detect prints instructions.
enum { MARKERS_LEVELS = 8 };
void markers_find(struct markers_work *work, const struct markers_settings *settings,
                  const struct hal_camera_luma *frame);

#endif
