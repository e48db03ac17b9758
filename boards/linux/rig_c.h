/// A rig as C: how a rig file gets into the image of a microcontroller board.
/// Shown: tests/cli/rig_c.sh.
#ifndef LINUX_RIG_C_H
#define LINUX_RIG_C_H

#include "rig.h"

/// Writes `compiled_rig` (boards/compiled_rig.h) with the settings of a rig that was read from
/// path. The same file gives the same text everywhere.
void rig_write_c(const struct rig *rig, const char *path, FILE *stream);

#endif
