/// The program at the other end of the serial line: checked lines in, answers and a status out.
///
/// docs/link.md has the format with examples. One program owns the board at a time; only its lines
/// count, but a stop is obeyed from anybody. An owner that says nothing for half a second has lost
/// the board: it stops, and forgets the targets. A line is obeyed once, however often it comes.
/// The lines of one frame reach the pump together, however long they take to come, and make one
/// aim. Work is bounded: a line of targets is read PROGRAM_LINK_TARGETS_MAX at a time, and the next
/// line only after that. Shown: tests/unit/test_program_link.c.
#ifndef APP_PROGRAM_LINK_H
#define APP_PROGRAM_LINK_H

#include "app/board_commands.h"
#include "link/checked_line.h"

#include <stdbool.h>
#include <stdint.h>

/// A board and a program understand each other if they have the same.
#define PROGRAM_LINK_VERSION 1U

#define PROGRAM_LINK_SILENCE_US  500000U
#define PROGRAM_LINK_STATUS_US   50000U
#define PROGRAM_LINK_TARGETS_MAX 8U

/// A line of targets may be so old; in units of 1024 us, as its stamp. And so far ahead of the
/// board's clock.
#define PROGRAM_LINK_AGE_MAX   250
#define PROGRAM_LINK_AHEAD_MAX 50
#define PROGRAM_LINK_STAMP_HEX 4U

/// Behind the stamp: more lines of this frame follow, or this is the last one.
#define PROGRAM_LINK_MORE '+'
#define PROGRAM_LINK_LAST '.'
/// A frame whose last line does not come is taken as it is.
#define PROGRAM_LINK_FRAME_US 100000U

struct program_link_counts {
    uint32_t taken;    ///< good lines of the owner that were obeyed
    uint32_t stale;    ///< lines of targets that were too old, or stamped ahead of time
    uint32_t repeated; ///< lines that came again, or out of order
    uint32_t refused;  ///< lines that are no good though undamaged, or not from the owner
};

struct program_link {
    bool owned;
    uint8_t host;
    uint64_t heard_us, status_us;
    bool has_command, has_targets;
    uint8_t command_sequence, targets_sequence, status_sequence;
    const char *command_wrong; ///< how the last command was answered
    struct program_link_counts counts;
    // A line of targets that is being read.
    bool is_compact, more, holds;
    uint64_t held_us; ///< time of the frame's first line
    struct word rest;
    uint32_t next_number;
};

/// What a line meets on the board.
struct program_link_board {
    struct board_commands *commands;
    const char *held; ///< why it must not arm, or NULL
    uint32_t digest;  ///< of the settings (settings_digest.h)
    uint64_t now_us;  ///< since the start
};

void program_link_init(struct program_link *link);

/// Takes a good line; its text must stay until program_link_read_targets is done.
/// answer: empty; what to send back is put into it.
void program_link_take(struct program_link *link, const struct checked_line *line,
                       const struct program_link_board *board, struct text *answer);

/// Goes on with a line of targets. True: there is more of it to read, in the next tick.
bool program_link_read_targets(struct program_link *link, const struct program_link_board *board);

/// Once a tick. An owner that fell silent: stops, forgets.
void program_link_tick(struct program_link *link, const struct program_link_board *board);

/// Is a status line due? Then write_status is to be called when there is room.
bool program_link_status_due(const struct program_link *link, uint64_t now_us);
void program_link_write_status(struct program_link *link, const struct program_link_board *board,
                               uint32_t damaged, struct text *text);

#endif
