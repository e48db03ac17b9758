/// `boresight sim --replay FILE`: a recording in this build's controller.
/// Shown: tests/mcu/cpu/same_bits.sh, tests/scenario/test_recording.c.
#ifndef LINUX_REPLAY_H
#define LINUX_REPLAY_H

#include "command.h"

#include <stdbool.h>

/// Replays the file and prints what came of it. EXIT_STATUS_FAILURE: the outputs differ.
enum exit_status replay_file(const struct command *command, const char *path, bool json);

#endif
