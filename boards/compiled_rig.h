/// The rig that an image is built for: made from a rig file by `boresight config c`.
#ifndef COMPILED_RIG_H
#define COMPILED_RIG_H

#include "control/controller.h"
#include "target/occlusion.h"

extern const struct controller_config compiled_rig;

/// What targets count that a scene in flash hides; OCCLUSION_IGNORE: the rig does not say.
extern const struct occlusion_settings compiled_occlusion;

#endif
