/// Tells apart what comes down one serial line: checked lines of a program, keys of a person.
///
/// `$` always begins a checked line, whatever came before it, and CR, LF or CR LF ends one. So no
/// damage costs more than the line that it hits: the next good one is read. What follows damage up
/// to the end of its line is dropped, and never taken for keys. Ctrl-C is a key even inside a line:
/// a stop is never waited for.
/// Shown: tests/unit/test_line_splitter.c (deterministic fuzzing).
#ifndef LINK_LINE_SPLITTER_H
#define LINK_LINE_SPLITTER_H

#include "link/checked_line.h"

#define LINE_SPLITTER_STOP_KEY 3U ///< Ctrl-C

enum line_splitter_event {
    LINE_SPLITTER_NOTHING,
    LINE_SPLITTER_KEY,    ///< the byte is a person's
    LINE_SPLITTER_LINE,   ///< line is valid until the next call
    LINE_SPLITTER_DAMAGED ///< counted
};

enum line_splitter_state {
    LINE_SPLITTER_OUTSIDE,
    LINE_SPLITTER_INSIDE,
    LINE_SPLITTER_DROPPING,
    LINE_SPLITTER_AFTER_CR
};

struct line_splitter {
    enum line_splitter_state state;
    uint32_t size_bytes;
    uint32_t damaged; ///< lines that were no good
    struct checked_line line;
    char text[CHECKED_LINE_BYTES_MAX];
};

void line_splitter_init(struct line_splitter *splitter);

enum line_splitter_event line_splitter_take(struct line_splitter *splitter, uint8_t byte);

#endif
