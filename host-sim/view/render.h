/// What a camera would see: frames of a scene whose truth is known, for detectors to be measured
/// on.
///
/// Rays are cast from the camera's optical centre through every pixel, 64 through each that an
/// object's edge may cross, so edges are where they belong within 1/100 pixel. The lens is a table
/// of rays, filled by whoever has a model of it: the renderer knows none. Floating point;
/// deterministic: the same bits with gcc and clang.
#ifndef VIEW_RENDER_H
#define VIEW_RENDER_H

#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdint.h>

// ---------------------------------------------------------------- the scene

/// Where the camera is and how it is turned: unit vectors in world axes, and metres.
struct render_view {
    double right[3], ahead[3], up[3];
    double at_m[3];
};

enum render_shape {
    RENDER_PLATE, ///< a flat rectangle: a printed tag, a person's outline
    RENDER_BALL   ///< a lamp: a disc of even brightness from everywhere
};

struct render_object {
    enum render_shape shape;
    double centre_m[3];
    double right_m[3], up_m[3]; ///< plate: from its middle to its right and upper edge
    double radius_m;            ///< ball
    uint8_t luma;
    /// Plate: columns * rows of brightness, row by row from the upper left; NULL: even luma.
    /// 0 is a hole one can see through.
    const uint8_t *texture;
    uint32_t columns, rows;
};

/// Far away all around: three octaves of smooth noise on the sphere of directions.
struct render_backdrop {
    uint32_t seed;
    double luma, contrast; ///< mean, and by how much the noise goes up and down at most
    double grain_deg;      ///< size of the largest patches
};

/// From light to numbers.
struct render_sensor {
    double blur_px;    ///< standard deviation of a Gaussian; 0: none
    double noise_luma; ///< standard deviation; 0: none
    double gain;       ///< 1: as it is
};

// ---------------------------------------------------------------- drawing

struct render {
    uint32_t width_px, height_px;
    float (*corner)[3]; ///< rays through the corners of the pixels, right, ahead, up; ahead is 1
    float *light, *scratch, *backdrop;
    bool has_backdrop;
    struct render_view backdrop_view;
    struct render_backdrop backdrop_of;
    uint64_t random;
};

/// ray(context, pixel, direction): as a lens model has it; pixel (0, 0) is the centre of the upper
/// left one, direction is right, ahead, up with ahead above 0. Returns: false: no memory, or a
/// pixel has no ray.
bool render_create(struct render *render, uint32_t width_px, uint32_t height_px,
                   bool (*ray)(void *context, const double pixel[2], double direction[3]),
                   void *context, uint64_t seed) MUST_CHECK;
void render_destroy(struct render *render);

/// Draws a frame into picture[height][stride_bytes]. Nearer objects hide farther ones (by the
/// distance of their middles). Noise goes on from frame to frame; everything else depends on the
/// arguments only.
/// Accuracy: the centroid of a ball within 0.01 px of the truth, edges of a plate too
///           (tests/scenario/test_render.c, by geometry of its own).
/// Cost:     about 20 ns a pixel, and as much again where edges are and when the view changes.
void render_frame(struct render *render, const struct render_view *view,
                  const struct render_backdrop *backdrop, const struct render_object *objects,
                  uint32_t object_count, const struct render_sensor *sensor, uint8_t *picture,
                  uint32_t stride_bytes);

#endif
