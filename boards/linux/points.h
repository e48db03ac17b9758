/// Reads a file of points: one a line, columns apart by blanks, tabs or one comma; `#` starts a
/// comment.
#ifndef LINUX_POINTS_H
#define LINUX_POINTS_H

#include "bounds.h"
#include "direction.h"
#include "message.h"

#include <stdio.h>

enum points_input {
    POINTS_XYZ,  ///< three decimals in any one unit
    POINTS_Q30,  ///< three int32, a direction in Q1.30, used as given
    POINTS_RADEC ///< right ascension and declination in degrees
};

struct points_format {
    enum points_input input;
    bool named;                  ///< a name stands before the numbers
    struct decimal viewpoint[3]; ///< for POINTS_XYZ
    /// The points themselves, not their directions from a viewpoint: POINTS_XYZ and POINTS_Q30.
    bool places;
    bool segments;         ///< two points a line
    struct bounds *bounds; ///< gets the box of the points; NULL: not wanted; for POINTS_XYZ
};

struct points {
    uint32_t count;
    /// What the solvers take: directions, or with format.places the points in units of `unit`.
    struct vec3 *directions;
    struct vec3_i64 *fine;      ///< the same directions for measuring (direction.h)
    uint32_t *lines;            ///< of places: the line each stands in
    size_t *names;              ///< where each name starts in name_text; NULL unless named
    char *name_text;            ///< the names, each ending with a NUL
    bool fine_exact;            ///< of all points
    long double fine_error_rad; ///< how far a `fine` direction can be from the true one
    long double unit;           ///< of places
    bool places_exact; ///< they are as written; else each coordinate is off by up to half a unit
    uint32_t room;
    size_t name_used, name_room;
    char *place_text; ///< while reading: the coordinates as written, each with a NUL
    size_t place_used, place_room;
};

/// Reads the file at path; NULL or "-": stdin. A fault is told in one line on stderr.
/// Returns: EXIT_STATUS_OK, EXIT_STATUS_USAGE (the file, or a line in it, can't be read),
///          EXIT_STATUS_FAILURE (no memory). Free with points_free in any case.
/// Cost:    below 1 us a line of ordinary numbers (tests/cli/points.c prints it); 36 bytes a point.
enum exit_status points_read(const char *path, const struct points_format *format,
                             struct points *out);

/// The same from an open stream; name stands in the messages.
enum exit_status points_read_stream(FILE *stream, const char *name,
                                    const struct points_format *format, struct points *out);

/// The name of a point; NULL unless the points are named.
const char *points_name(const struct points *points, uint32_t index);

void points_free(struct points *points);

/// A part of a line.
struct points_word {
    const char *text;
    size_t size;
};

/// The next word of a line, between blanks and tabs; *at moves behind it. False: there is none.
bool points_next_word(const char **at, const char *end, struct points_word *out);
bool points_word_is(struct points_word word, const char *text);

/// One more than any format has, so that a line with too many is noticed.
enum { POINTS_COLUMNS_MOST = 11 };

/// Splits a line without its comment. Returns the number of columns, which may exceed what
/// columns[] holds; -1: an empty column (a comma with no value on one side).
int points_split(const char *at, const char *end, struct points_word columns[POINTS_COLUMNS_MOST]);

/// Adds a point as three coordinates that decimal_read takes, for places_finish. False: no memory.
bool points_add_place(struct points *points, const struct points_word word[3]);

/// X,Y,Z on the command line.
struct triple {
    struct decimal component[3];
    bool given;
};

/// Reads three decimals; text must outlive the result. Returns: NULL, or what is wrong.
const char *points_read_triple(const char *text, struct triple *out);

#endif
