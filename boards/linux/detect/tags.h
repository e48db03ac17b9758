/// AprilTags: printed squares that carry a number, found by libapriltag (Olson 2011; Wang and Olson
/// 2016).
#ifndef DETECT_TAGS_H
#define DETECT_TAGS_H

#include "detect/camera_model.h"
#include "detect/detection.h"
#include "fixed/must_check.h"
#include "hal/camera.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// NULL if this program was built with libapriltag; else what to tell people.
const char *tags_missing(void);
/// The library's name; NULL: built without it.
const char *tags_library(void);

/// The families that can be asked for, and the one that is meant when none is named.
#define TAGS_FAMILIES       "tag36h11, tag36h10, tag25h9, tag16h5, tagStandard41h12, tagCircle21h7"
#define TAGS_FAMILY_DEFAULT "tag36h11"
bool tags_family_known(const char *family);

struct tags;

/// Returns: NULL: no memory, or tags_missing, or a family that is not known.
struct tags *tags_create(const char *family);
void tags_destroy(struct tags *tags);

/// Appends what it finds to out: ids, middles and corners, with the number of bits that had to be
/// corrected and the decision margin as confidence (1 at a margin of 50 grey levels and no
/// corrected bit; each corrected bit halves it). A number that is seen twice is told once, the
/// larger one.
/// model: the camera's, or NULL. With it a tag's middle is where its diagonals meet in space;
/// without it, in the picture, which a lens with distortion bends: half a pixel for large tags near
/// a corner. Accuracy: 0.3 px rms and 99 % found from 30 px of width up, noise of 4 levels, blur of
/// 1 px,
///           views up to 50 degrees from straight (tests/property/tag_frames.c prints what it
///           measured).
void tags_find(struct tags *tags, const struct hal_camera_luma *frame,
               const struct camera_model *model, struct detections *out);

/// Draws a tag, white border included: a brightness a cell, *cells across, at most
/// TAGS_CELLS_MAX. For the simulator. False: no such tag.
enum { TAGS_CELLS_MAX = 16 };
bool tags_draw(const char *family, uint32_t id, uint8_t texture[TAGS_CELLS_MAX * TAGS_CELLS_MAX],
               uint32_t *cells) MUST_CHECK;

#endif
