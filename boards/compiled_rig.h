/// The rig that an image is built for: made from a rig file by `boresight config c`.
#ifndef COMPILED_RIG_H
#define COMPILED_RIG_H

#include "control/controller.h"

extern const struct controller_config compiled_rig;

#endif
