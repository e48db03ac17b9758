/// Which points are on one line with a given one, and which segments on one line: by hashing
/// directions. For the files of regular/ only.
#ifndef REGULAR_LINE_TABLE_H
#define REGULAR_LINE_TABLE_H

#include "fixed/vec3.h"
#include "regular/arena.h"

#include <stdbool.h>
#include <stdint.h>

#define LINE_TABLE_NONE UINT32_MAX

/// A hash table of keys, emptied in no time.
struct line_table {
    uint32_t mask; ///< slots - 1; at least twice as many slots as keys
    uint32_t *slot;
    uint32_t *round_of; ///< a slot holds something if this is the current round
    uint32_t round;
    struct vec3_i64 *key; ///< by the index that stands in a slot
    uint64_t operations;
};

/// count: the most keys of a round.
void line_table_open(struct line_table *lines, uint32_t count, struct arena *arena);

/// Clears what was left in the workspace. Once, before the first round.
void line_table_start(struct line_table *lines);

void line_table_next_round(struct line_table *lines);

/// Enters a key under an index, unless it is there. Returns: the index that has it already, or
/// LINE_TABLE_NONE. Cost: expected O(1).
uint32_t line_table_enter(struct line_table *lines, uint32_t index, struct vec3_i64 key);

#endif
