/// Exact places along an edge: fractions of 128-bit integers.
#ifndef SCENE_FRACTION_H
#define SCENE_FRACTION_H

#include "fixed/wide.h"

/// num / den, den > 0; both below 2^96 in size.
struct fraction {
    struct i128 num, den;
};

static inline struct fraction fraction_whole(int32_t value) {
    return (struct fraction){i128_from_i64(value), i128_from_i64(1)};
}

/// -1, 0 or 1. Cost: two products of 128 bits; none where one of them is 0 or both are alike.
int fraction_cmp(struct fraction a, struct fraction b);

/// num / den in 1/2^62, rounded down; 0 <= num <= den.
int64_t fraction_q62(struct fraction a);

/// A part of an edge: from < to, within 0 to 1.
struct span {
    struct fraction from, to;
};

/// Parts of one edge, ascending and apart from each other.
struct span_list {
    struct span *spans;
    uint32_t count, room;
};

/// Adds a part; parts that overlap or touch become one. The caller sees to the room: one a call.
void span_list_add(struct span_list *list, struct span span);

/// Is nothing left of the edge?
bool span_list_is_full(const struct span_list *list);

#endif
