/// Whether a point is hidden, by following the ray to it in rational numbers. Shares no code with
/// firmware/scene: it knows solids as faces of corners, planes as outlines, and neither silhouettes
/// nor separating planes.
#ifndef TESTS_PROPERTY_SUPPORT_RAY_H
#define TESTS_PROPERTY_SUPPORT_RAY_H

#include <gmp.h>
#include <stdbool.h>
#include <stdint.h>

/// A point: x / w and so on, w > 0.
struct ray_point {
    mpz_t x[3], w;
};

void ray_point_init(struct ray_point *point);
void ray_point_clear(struct ray_point *point);

/// A body of corners: faces[first[f] .. first[f + 1]) are the corners of face f, outside
/// counter-clockwise; of a plane the one outline.
struct ray_body {
    const int32_t (*corners)[3];
    const uint32_t *faces, *first;
    uint32_t face_count;
    bool flat; ///< a polygon
};

/// Does the way from the eye to the point, without its ends, pass the inside of the body?
bool ray_is_stopped(const struct ray_body *body, const int32_t eye[3],
                    const struct ray_point *point);

#endif
