#include "regular/line_table.h"

#include "regular/primitive.h"

void line_table_open(struct line_table *lines, uint32_t count, struct arena *arena) {
    uint32_t slots = 2;
    while (slots < 2U * count) {
        slots *= 2U;
    }
    *lines = (struct line_table){.mask = slots - 1U};
    lines->slot = arena_take(arena, slots, sizeof(uint32_t));
    lines->round_of = arena_take(arena, slots, sizeof(uint32_t));
    lines->key = arena_take(arena, count, sizeof(struct vec3_i64));
}

void line_table_start(struct line_table *lines) {
    for (uint32_t i = 0; i <= lines->mask; i++) {
        lines->round_of[i] = 0;
    }
    lines->round = 0;
}

void line_table_next_round(struct line_table *lines) {
    lines->round++;
}

uint32_t line_table_enter(struct line_table *lines, uint32_t index, struct vec3_i64 key) {
    uint32_t at = primitive_hash(key) & lines->mask;
    for (;;) {
        lines->operations++;
        if (lines->round_of[at] != lines->round) {
            lines->round_of[at] = lines->round;
            lines->slot[at] = index;
            lines->key[index] = key;
            return LINE_TABLE_NONE;
        }
        const uint32_t there = lines->slot[at];
        if (primitive_equal(lines->key[there], key)) {
            return there;
        }
        at = (at + 1U) & lines->mask;
    }
}
