/// Progress on the terminal: a line for each subject that is done, and, only where someone watches,
/// a status line that is written over and is gone in the end.
///
/// Texts are UTF-8; control characters in them, and what is not valid, become '?', so that a name
/// out of a file cannot steer the terminal. Every character counts as one column. Shown:
/// tests/scenario/test_progress.c.
#ifndef VIEW_PROGRESS_H
#define VIEW_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct progress {
    FILE *lines;      ///< gets the lines that stay
    FILE *live;       ///< gets the status line; NULL: there is none
    int name_columns; ///< names of subjects are padded to so many characters; set it after the
                      ///< start
    bool shown;       ///< a status line stands on the terminal
    int64_t shown_ms; ///< since when
};

/// What is said about a subject: "Ori  23 stars  pan 12.3  tilt 45.6  half-angle 13.2 deg  f 12.0
/// mm settled in 1.2 s  error 0.0040 deg", in columns.
struct progress_subject {
    const char *name;
    size_t count;
    const char *noun; ///< what is counted: "stars"
    double pan_deg, tilt_deg, half_angle_deg;
    double focal_mm;  ///< 0: no zoom, not said
    double settled_s; ///< negative: "not settled"
    double error_deg; ///< negative: nothing to aim at, not said
};

/// `live` is used only if it is a terminal that knows how to erase a line (TERM is set and not
/// "dumb"). `lines` may be the same stream; it is flushed after each line.
void progress_start(struct progress *progress, FILE *lines, FILE *live);

/// Shows how much of the work is done (0 to 1; negative: not known) and a text, cut to the width of
/// the terminal. At most ten times a second: what comes sooner is left out, so call it freely.
void progress_status(struct progress *progress, double done, const char *text);

/// Prints a line that stays; the status line makes way for it.
void progress_subject(struct progress *progress, const struct progress_subject *subject);
void progress_line(struct progress *progress, const char *text);

/// Erases the status line. Call it before anything else writes to the same terminal.
void progress_end(struct progress *progress);

#endif
