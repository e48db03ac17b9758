/// Recordings of what a controller was told, tick by tick, and their replay in a controller of this
/// build.
///
/// The same inputs must give the same outputs, bit for bit, whatever processor ran the controller
/// that was recorded. A recording has its settings, every input, and a hash of the outputs; a
/// replay compares.
///
/// The file is text: `start HEX` (a controller begins, with these settings), then a line a tick:
/// `t NOW_US COMMANDS` and any number of ` f ID FLAGS DATA AT_US` (a frame and when it arrived; all
/// but the time in hexadecimal, data may be `-`), ` u HEX` (a target update) and ` p HEX` (a pan);
/// after every 1,000 ticks and at the end `h TICKS HASH`. HEX is the structure as a 32-bit ARM has
/// it in memory (replay/layout.h). Shown: tests/scenario/test_recording.c; on an emulated board
/// tests/mcu/cpu/same_bits.sh.
#ifndef REPLAY_RECORDING_H
#define REPLAY_RECORDING_H

#include "control/controller.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct recorder {
    FILE *file; ///< NULL: not recording
    uint64_t ticks, hash;
};

/// False: errno tells why.
bool recorder_open(struct recorder *recorder, const char *path);
/// Writes the end. False: something could not be written. No matter if it was not open.
bool recorder_close(struct recorder *recorder);

/// A controller begins, the first one or after a reset. recorder may be NULL here and for a tick.
void recorder_start(struct recorder *recorder, const struct controller_config *config);
void recorder_tick(struct recorder *recorder, const struct controller_input *input,
                   const struct controller_output *output);

/// Folds a tick's output into a hash: its index, frames, pulses, mode, faults and setpoints.
uint64_t recording_hash(uint64_t hash, uint64_t tick, const struct controller_output *output);

struct replay {
    uint64_t ticks;
    uint64_t hash;             ///< of this build's outputs
    bool same;                 ///< every hash of the recording was met
    uint64_t differs_by_ticks; ///< if not: the first difference is at most this tick
    unsigned long line;        ///< where the file is wrong
    char wrong[96];            ///< what is wrong with it
};

/// Replays a file. False: it can't be read as a recording (replay->line and wrong tell).
bool recording_replay(FILE *file, struct replay *replay);

#endif
