/// What the camera of a simulated gimbal sees of the targets around it: they are dressed up as what
/// the rig's detectors look for, and rendered through the rig's own lens.
///
/// Every target is drawn 10 m away: only its direction is known, and only that matters.
/// Deterministic by seed. Shown: tests/cli/camera_loop.sh, tests/cli/camera_run.sh.
#ifndef LINUX_STAGE_H
#define LINUX_STAGE_H

#include "rig_camera.h"

#include "target/target_set.h"
#include "view/render.h"

/// What targets look like.
enum stage_kind { STAGE_LAMPS, STAGE_TAGS, STAGE_PEOPLE };

struct stage_looks {
    enum stage_kind kind;
    double size_deg; ///< how wide they are, as seen from the gimbal
    struct render_sensor sensor;
    double backdrop_luma, backdrop_contrast;
};

struct stage {
    const struct rig_eye *eye;
    struct stage_looks looks;
    uint64_t seed; ///< of the noise; before the first picture
    // Private from here on.
    struct render render;
    double rendered_zoom; ///< the render's lens; 0: none yet
    struct render_object *objects;
    uint8_t *texture; ///< of all objects
};

/// False: no memory; close it all the same. eye must outlive it.
bool stage_open(struct stage *stage, const struct rig_eye *eye, const struct stage_looks *looks,
                uint64_t seed) MUST_CHECK;
void stage_close(struct stage *stage);

/// Draws width_px * height_px of the rig's lens. view: of the camera; zoom: focal length by that of
/// the lens' calibration. False: no memory.
bool stage_draw(struct stage *stage, const struct camera_view *view, double zoom,
                const struct target_set *world, uint8_t *picture, uint32_t stride_bytes) MUST_CHECK;

#endif
