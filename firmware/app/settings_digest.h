/// A number for the settings of a rig, the same on a board and on the host: so that a program
/// notices when the board was built for another rig than the file that it reads.
#ifndef APP_SETTINGS_DIGEST_H
#define APP_SETTINGS_DIGEST_H

#include "control/controller.h"

/// CRC-32 over every value that is in force; arm_on_start, which a command decides, is left out.
/// Shown: tests/unit/test_board_settings.c (every single value counts).
uint32_t settings_digest(const struct controller_config *config);

#endif
