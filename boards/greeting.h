/// What a board tells of itself when it starts, beside its build (app/board_config.notes).
#ifndef BOARDS_GREETING_H
#define BOARDS_GREETING_H

#include <stdbool.h>
#include <stdint.h>

struct greeting {
    char clock[80], crash[80];
    const char *notes[4]; ///< lines, the last one NULL
};

/// board: the line that names it.
void greeting_init(struct greeting *greeting, const char *board);

/// The frequency of the core, the state of the clocks in words, and what else there is to say, or
/// "".
void greeting_clock(struct greeting *greeting, uint32_t core_hz, const char *state,
                    const char *more);

/// Tells of a crash that ended the last run, if there was one. nmi: what the chip's non-maskable
/// interrupt means, or NULL if it has none of its own.
void greeting_crash(struct greeting *greeting, const char *nmi);

#endif
