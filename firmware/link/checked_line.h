/// A checked line: what a program and a board say to each other, so that damage is noticed.
///
///     $3f1at0a03ff10;7 1.5 2 0.25;8 dir .1 1 .2*9c41
///     | |  | |                                  |
///     | |  | body                               CRC-16 of all between `$` and `*`
///     | |  type
///     | sequence number, two hexadecimal digits
///     | host, two hexadecimal digits
///     start
///
/// Only printable ASCII; `$` and `*` stand nowhere else. LF ends it. docs/link.md has the types.
/// The CRC (polynomial 0x1021, start 0xFFFF, "123456789" gives 0x29b1) finds any one, two or three
/// wrong bits and any burst up to 16 bits in a line, and all but one in 65,536 of the rest.
/// Shown: tests/unit/test_checked_line.c.
#ifndef LINK_CHECKED_LINE_H
#define LINK_CHECKED_LINE_H

#include "fixed/must_check.h"
#include "link/text.h"
#include "link/words.h"

#include <stdbool.h>
#include <stdint.h>

/// From `$` to LF, both included.
#define CHECKED_LINE_BYTES_MAX 200U
/// What a line has besides its body.
#define CHECKED_LINE_BYTES_AROUND 12U

struct checked_line {
    uint8_t host; ///< who speaks, or is spoken to: a number that the host chose
    uint8_t sequence;
    char type;
    struct word body;
};

uint16_t checked_line_crc(const char *text, uint32_t size_bytes);

/// Reads what stands between `$` and LF. False: damaged, or no such line.
bool checked_line_read(const char *text, uint32_t size_bytes, struct checked_line *line) MUST_CHECK;

/// Begins a line in an empty text; the body is then added to it.
void checked_line_begin(struct text *text, uint8_t host, uint8_t sequence, char type);

/// Ends it. False: it does not fit into the text or is longer than CHECKED_LINE_BYTES_MAX.
bool checked_line_end(struct text *text) MUST_CHECK;

#endif
