#include "csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Splits the row at its commas, in place.
static unsigned split(struct csv *csv) {
    unsigned count = 1;
    csv->field[0] = csv->row;
    for (char *at = csv->row; *at != '\0'; at++) {
        if (*at == ',') {
            *at = '\0';
            if (count < CSV_COLUMNS_MOST) {
                csv->field[count] = at + 1;
            }
            count++;
        }
    }
    return count;
}

static enum lines_status read_row(struct csv *csv) {
    const char *text;
    size_t size;
    const enum lines_status status = lines_next(&csv->lines, &text, &size);
    if (status == LINES_OK) {
        memcpy(csv->row, text, size);
        csv->row[size] = '\0';
    }
    return status;
}

bool csv_open(struct csv *csv, const char *path, const char *header) {
    if (!lines_open(&csv->lines, path)) {
        return false;
    }
    const enum lines_status status = read_row(csv);
    if (status == LINES_OK && strcmp(csv->row, header) == 0) {
        csv->columns = split(csv);
        return true;
    }
    if (status != LINES_ERROR) {
        message_at(csv->lines.name, 1, "the first line must be '%s'", header);
    }
    lines_close(&csv->lines);
    return false;
}

enum lines_status csv_next(struct csv *csv) {
    const enum lines_status status = read_row(csv);
    if (status != LINES_OK) {
        return status;
    }
    const unsigned fields = split(csv);
    if (fields != csv->columns) {
        message_at(csv->lines.name, csv->lines.number, "%u columns, not %u", fields, csv->columns);
        return LINES_ERROR;
    }
    return LINES_OK;
}

bool csv_number(const struct csv *csv, unsigned column, double *out) {
    char *end;
    const char *text = csv->field[column];
    *out = strtod(text, &end);
    if (end == text || *end != '\0' || !isfinite(*out)) {
        message_at(csv->lines.name, csv->lines.number, "%s in column %u is no number",
                   message_quoted(text, strlen(text)).text, column + 1U);
        return false;
    }
    return true;
}

void csv_close(struct csv *csv) {
    lines_close(&csv->lines);
}
