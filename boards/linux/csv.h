/// Files of comma-separated columns with a header line, without quotes.
/// Shown: tests/cli/stars.c.
#ifndef LINUX_CSV_H
#define LINUX_CSV_H

#include "lines.h"

#include <stdbool.h>

enum { CSV_COLUMNS_MOST = 16 };

struct csv {
    struct lines lines;
    unsigned columns;
    const char *field[CSV_COLUMNS_MOST]; ///< of the row read last, terminated
    char row[LINES_MOST + 1];
};

/// Opens a file whose header line must be exactly `header`. False: told on stderr why not.
bool csv_open(struct csv *csv, const char *path, const char *header);

/// The next row; every row has as many fields as the header.
enum lines_status csv_next(struct csv *csv);

/// A field as a finite number. False: told on stderr with file and line.
bool csv_number(const struct csv *csv, unsigned column, double *out);

void csv_close(struct csv *csv);

#endif
