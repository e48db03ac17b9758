/// With libapriltag; tags_none.c is in its place without.
#include "detect/tags.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Bits of a code that may be wrong. The families differ in at least 5 bits, most in 11.
enum { CORRECTED_BITS_MAX = 2 };

/// A decision margin, grey levels between black and white bits, that leaves no doubt.
#define MARGIN_SURE 50.0

static const struct family {
    const char *name;
    apriltag_family_t *(*create)(void);
    void (*destroy)(apriltag_family_t *family);
    int corrected_bits; ///< no more than keeps false alarms rare
} families[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy, CORRECTED_BITS_MAX},
    {"tag36h10", tag36h10_create, tag36h10_destroy, CORRECTED_BITS_MAX},
    {"tag25h9", tag25h9_create, tag25h9_destroy, CORRECTED_BITS_MAX},
    {"tag16h5", tag16h5_create, tag16h5_destroy, 0},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy, CORRECTED_BITS_MAX},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy, 1},
};

struct tags {
    const struct family *kind;
    apriltag_family_t *family;
    apriltag_detector_t *detector;
};

const char *tags_missing(void) {
    return NULL;
}

const char *tags_library(void) {
    return "libapriltag";
}

static const struct family *family_named(const char *name) {
    for (size_t i = 0; i < sizeof families / sizeof *families; i++) {
        if (strcmp(families[i].name, name) == 0) {
            return &families[i];
        }
    }
    return NULL;
}

bool tags_family_known(const char *family) {
    return family_named(family) != NULL;
}

struct tags *tags_create(const char *family) {
    struct tags *tags = calloc(1, sizeof *tags);
    if (tags == NULL) {
        return NULL;
    }
    tags->kind = family_named(family);
    tags->family = tags->kind != NULL ? tags->kind->create() : NULL;
    tags->detector = tags->family != NULL ? apriltag_detector_create() : NULL;
    if (tags->detector == NULL) {
        tags_destroy(tags);
        return NULL;
    }
    apriltag_detector_add_family_bits(tags->detector, tags->family, tags->kind->corrected_bits);
    tags->detector->nthreads = 1;
    // Squares are looked for in half the picture, their edges and bits in the whole: five times as
    // fast, and from 30 px of width up as many are found (tests/property/tag_frames.c).
    tags->detector->quad_decimate = 2.0F;
    tags->detector->refine_edges = true;
    return tags;
}

void tags_destroy(struct tags *tags) {
    if (tags == NULL) {
        return;
    }
    if (tags->detector != NULL) {
        apriltag_detector_destroy(tags->detector);
    }
    if (tags->family != NULL) {
        tags->kind->destroy(tags->family);
    }
    free(tags);
}

/// The library counts from the upper left corner of the picture, not from the middle of its first
/// pixel.
static struct detection detection_of(const apriltag_detection_t *found) {
    const double sure = fmin(1.0, fmax(0.0, (double)found->decision_margin) / MARGIN_SURE);
    struct detection detection = {.kind = DETECTION_TAG,
                                  .id = (uint32_t)found->id,
                                  .pixel = {found->c[0] - 0.5, found->c[1] - 0.5},
                                  .confidence = sure / (1 << found->hamming)};
    double *box = detection.box_px;
    for (unsigned i = 0; i < 4U; i++) {
        const double u = found->p[i][0] - 0.5, v = found->p[i][1] - 0.5;
        detection.corner[i][0] = u;
        detection.corner[i][1] = v;
        box[0] = i == 0U ? u : fmin(box[0], u);
        box[1] = i == 0U ? v : fmin(box[1], v);
        box[2] = i == 0U ? u : fmax(box[2], u);
        box[3] = i == 0U ? v : fmax(box[3], v);
        detection.radius_px =
            fmax(detection.radius_px, hypot(u - detection.pixel[0], v - detection.pixel[1]));
    }
    return detection;
}

/// Where the diagonals of the corners meet in space, as the lens shows it.
static bool middle_of(const struct camera_model *model, struct detection *detection) {
    double at[4][2]; // tangents to the right and up
    for (unsigned i = 0; i < 4U; i++) {
        double ray[3];
        if (!camera_model_ray(model, detection->corner[i], ray)) {
            return false;
        }
        at[i][0] = ray[0] / ray[1];
        at[i][1] = ray[2] / ray[1];
    }
    const double a[2] = {at[2][0] - at[0][0], at[2][1] - at[0][1]};
    const double b[2] = {at[3][0] - at[1][0], at[3][1] - at[1][1]};
    const double det = a[0] * b[1] - a[1] * b[0];
    const double part = ((at[1][0] - at[0][0]) * b[1] - (at[1][1] - at[0][1]) * b[0]) / det;
    const double middle[3] = {at[0][0] + part * a[0], 1.0, at[0][1] + part * a[1]};
    return isfinite(part) && camera_model_project(model, middle, detection->pixel);
}

static void append(struct detections *out, const struct detection *detection) {
    for (uint32_t i = 0; i < out->count; i++) {
        struct detection *other = &out->item[i];
        if (other->kind == DETECTION_TAG && other->id == detection->id) {
            if (other->radius_px < detection->radius_px) {
                *other = *detection;
            }
            return;
        }
    }
    if (out->count < DETECTIONS_MAX) {
        out->item[out->count++] = *detection;
    } else {
        out->dropped++;
    }
}

void tags_find(struct tags *tags, const struct hal_camera_luma *frame,
               const struct camera_model *model, struct detections *out) {
    image_u8_t picture = {.width = (int32_t)frame->width_px,
                          .height = (int32_t)frame->height_px,
                          .stride = (int32_t)frame->stride_bytes,
                          .buf = (uint8_t *)(uintptr_t)frame->luma}; // the library only reads it
    zarray_t *found = apriltag_detector_detect(tags->detector, &picture);
    for (int i = 0; i < zarray_size(found); i++) {
        apriltag_detection_t *item;
        zarray_get(found, i, &item);
        struct detection detection = detection_of(item);
        if (model != NULL) {
            (void)middle_of(model, &detection); // else it stays where the library has it
        }
        append(out, &detection);
    }
    apriltag_detections_destroy(found);
}

bool tags_draw(const char *family, uint32_t id, uint8_t texture[TAGS_CELLS_MAX * TAGS_CELLS_MAX],
               uint32_t *cells) {
    const struct family *kind = family_named(family);
    apriltag_family_t *created = kind != NULL ? kind->create() : NULL;
    if (created == NULL) {
        return false;
    }
    // The number's type is int in one version of the library and uint32_t in another; 16 bits fit
    // both.
    const bool known =
        id <= UINT16_MAX && id < created->ncodes && created->total_width <= TAGS_CELLS_MAX;
    if (known) {
        *cells = (uint32_t)created->total_width;
        image_u8_t *picture = apriltag_to_image(created, (uint16_t)id);
        for (uint32_t v = 0; v < *cells; v++) {
            memcpy(texture + (size_t)v * *cells, picture->buf + (size_t)v * (size_t)picture->stride,
                   *cells);
        }
        image_u8_destroy(picture);
    }
    kind->destroy(created);
    return known;
}
