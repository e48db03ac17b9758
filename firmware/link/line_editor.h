/// Editing a line on a terminal, for a person: keys in, what the terminal shows out.
///
/// Arrows, Home, End, Delete, Backspace, Ctrl-A -B -E -F -H -D -K -U -W -L, the last lines with up
/// and down (Ctrl-P -N), Enter, Ctrl-C. It needs a terminal that knows the usual ANSI sequences;
/// one that does not shows a few odd characters after a cursor key. Shown:
/// tests/unit/test_line_editor.c (golden transcripts).
#ifndef LINK_LINE_EDITOR_H
#define LINK_LINE_EDITOR_H

#include "link/text.h"

#include <stdbool.h>
#include <stdint.h>

#define LINE_EDITOR_BYTES   80U
#define LINE_EDITOR_HISTORY 4U

/// At most so much comes out for one key.
#define LINE_EDITOR_ECHO_BYTES 112U

enum line_editor_event {
    LINE_EDITOR_NOTHING,
    LINE_EDITOR_LINE, ///< Enter: it is in line, until line_editor_clear
    LINE_EDITOR_STOP  ///< Ctrl-C
};

enum line_editor_escape { LINE_EDITOR_PLAIN, LINE_EDITOR_ESCAPE, LINE_EDITOR_SEQUENCE };

struct line_editor_text {
    uint32_t size_bytes;
    char text[LINE_EDITOR_BYTES];
};

struct line_editor {
    struct line_editor_text line;
    uint32_t cursor;
    enum line_editor_escape escape;
    uint32_t parameter;
    bool ended;                         ///< the next key begins a new line
    bool after_cr;                      ///< a LF then belongs to that Enter
    uint32_t history_count, history_at; ///< history_at: 0 is the line itself, 1 the last one
    struct line_editor_text history[LINE_EDITOR_HISTORY]; ///< the newest first
};

void line_editor_init(struct line_editor *editor);

/// One key. echo: what to show is added to it.
enum line_editor_event line_editor_take(struct line_editor *editor, uint8_t key, struct text *echo);

/// Begins a new line.
void line_editor_clear(struct line_editor *editor);

/// Shows prompt and line anew on a line of their own.
void line_editor_show(const struct line_editor *editor, struct text *echo);

#endif
