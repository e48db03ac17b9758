/// Reads a text file line by line, with what every reader of this program needs: line numbers, a
/// longest line, and one clear message when the file is no text.
///
/// Lines end with LF or CR LF; the last one may lack its end. A UTF-8 byte order mark at the start
/// is skipped.
/// Shown: tests/cli/points.c.
#ifndef LINUX_LINES_H
#define LINUX_LINES_H

#include "message.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/// Longest line, without its end. Three doubles written out exactly fit.
enum { LINES_MOST = 8191 };

struct lines {
    FILE *stream;
    const char *name;     ///< as it stands in messages
    unsigned long number; ///< of the line read last, from 1
    size_t begin, end;    ///< what is in the buffer and not yet read
    bool at_end;
    bool opened;
    char buffer[1 << 16];
};

/// Opens the file at path; NULL or "-": stdin. False: told on stderr why not. path must outlive it.
bool lines_open(struct lines *lines, const char *path);

/// The same on a stream that the caller opened and closes.
void lines_from_stream(struct lines *lines, FILE *stream, const char *name);

enum lines_status {
    LINES_OK,
    LINES_END,
    LINES_ERROR ///< unreadable, too long, or a NUL byte in it: told on stderr
};

/// The next line, without its end, valid until the next call. Not terminated.
enum lines_status lines_next(struct lines *lines, const char **text, size_t *size);

void lines_close(struct lines *lines);

#endif
