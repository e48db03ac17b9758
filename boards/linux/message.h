/// What the program says to a person: one clear line each, on stderr.
/// Shown: tests/scenario/test_aside.c, tests/cli/run_aside.sh.
#ifndef LINUX_MESSAGE_H
#define LINUX_MESSAGE_H

#include <stdio.h>

/// What the program ends with. docs/cli.md explains each to users.
enum exit_status {
    EXIT_STATUS_OK = 0,
    EXIT_STATUS_FAILURE = 1, ///< our own bug, no memory, or the results could not be written
    EXIT_STATUS_USAGE = 2,   ///< a wrong option, or input that can't be read as it stands
    EXIT_STATUS_INFEASIBLE = 3,
    EXIT_STATUS_DEVICE = 4,
    EXIT_STATUS_SAFETY_STOP = 5
};

/// `FILE:LINE: what is wrong`; without the line where line is 0.
void message_at(const char *file, unsigned long line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// `boresight COMMAND: what is wrong`; command may be NULL.
void message_command(const char *command, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// From begin to end a thread of its own writes the messages: whoever has one never waits for a
/// terminal that was stopped or a pipe that is full. They are cut after 1,000 bytes then, and lost
/// when too many wait, which the last line tells. The end waits for the rest. Not nested.
void message_aside_begin(void);
void message_aside_end(void);

/// Where messages go from now on; NULL: stderr again. For tests.
void message_stream(FILE *stream);

/// How much of a word a message quotes, and the buffer for it.
enum { MESSAGE_QUOTE_BYTES = 48 };
struct message_quote {
    char text[MESSAGE_QUOTE_BYTES + 8];
};

/// The word in quotes, fit for a terminal: control characters and broken UTF-8 as `?`, and cut
/// after MESSAGE_QUOTE_BYTES with `...`.
struct message_quote message_quoted(const char *word, size_t size);

#endif
