/// What a detector found in a frame.
/// Shown: tests/property/tag_frames.c, marker_frames.c and motion_frames.c beside it.
#ifndef DETECT_DETECTION_H
#define DETECT_DETECTION_H

#include <stdbool.h>
#include <stdint.h>

enum detection_kind { DETECTION_TAG, DETECTION_MARKER, DETECTION_MOVING, DETECTION_KINDS };

/// Ids of the kinds don't meet: a tag's is its number, the others count from here.
#define DETECTION_MARKER_ID UINT32_C(1000000)
#define DETECTION_MOVING_ID UINT32_C(2000000)

struct detection {
    enum detection_kind kind;
    uint32_t id;
    double pixel[2];     ///< its middle, as in detect/camera_model.h
    double radius_px;    ///< of a circle round that which holds it
    double box_px[4];    ///< left, top, right, bottom
    double confidence;   ///< 0 to 1; each detector says what it means
    double corner[4][2]; ///< tags only: counterclockwise as seen on the tag, from its bottom left
};

enum { DETECTIONS_MAX = 128 };

struct detections {
    uint32_t count, gone_count;
    uint32_t dropped; ///< found beyond DETECTIONS_MAX
    struct detection item[DETECTIONS_MAX];
    uint32_t gone[DETECTIONS_MAX]; ///< ids that were followed and are no more
};

/// A name for a kind: "tag", "marker", "moving".
const char *detection_kind_name(enum detection_kind kind);

#endif
