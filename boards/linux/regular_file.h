/// Reads what `boresight regular` works on: whole numbers, so that every answer can be checked.
/// Shown: tests/cli/regular.sh.
#ifndef LINUX_REGULAR_FILE_H
#define LINUX_REGULAR_FILE_H

#include "message.h"

#include "regular/regular.h"

struct regular_items {
    struct vec3 *points;  ///< regular_points_of each
    uint32_t *weights;    ///< of items; NULL: none asked for
    unsigned long *lines; ///< where each item stands
    uint32_t count, room;
    /// From an OBJ: the power of ten of the unit, 0 or below.
    int32_t exponent;
};

/// One item a line: two or three whole numbers for each of its points, apart by blanks, tabs or
/// commas, and with `weighted` a weight. obj: Wavefront OBJ: the vertices as points, the sides of
/// faces and the parts of lines as segments (each once), or the faces; decimals in the unit of
/// their last digit.
/// A fault is told in one line on stderr. Free with regular_file_free in any case.
enum exit_status regular_file_read(const char *path, enum regular_problem problem, bool weighted,
                                   bool obj, struct regular_items *out);

/// The same from an OBJ; for regular_file.c.
enum exit_status regular_obj_read(const char *path, enum regular_problem problem,
                                  struct regular_items *out);

/// Adds room for one more item. False: no memory.
bool regular_items_grow(struct regular_items *items, enum regular_problem problem, bool weighted);

void regular_file_free(struct regular_items *items);

#endif
