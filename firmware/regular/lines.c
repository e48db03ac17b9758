#include "regular/lines.h"

#include "regular/primitive.h"

void lines_open(struct lines *lines, uint32_t count, struct arena *arena) {
    uint32_t slots = 2;
    while (slots < 2U * count) {
        slots *= 2U;
    }
    *lines = (struct lines){.mask = slots - 1U};
    lines->slot = arena_take(arena, slots, sizeof(uint32_t));
    lines->round_of = arena_take(arena, slots, sizeof(uint32_t));
    lines->key = arena_take(arena, count, sizeof(struct vec3_i64));
}

void lines_start(struct lines *lines) {
    for (uint32_t i = 0; i <= lines->mask; i++) {
        lines->round_of[i] = 0;
    }
    lines->round = 0;
}

void lines_next_round(struct lines *lines) {
    lines->round++;
}

uint32_t lines_enter(struct lines *lines, uint32_t index, struct vec3_i64 key) {
    uint32_t at = primitive_hash(key) & lines->mask;
    for (;;) {
        lines->operations++;
        if (lines->round_of[at] != lines->round) {
            lines->round_of[at] = lines->round;
            lines->slot[at] = index;
            lines->key[index] = key;
            return LINES_NONE;
        }
        const uint32_t there = lines->slot[at];
        if (primitive_equal(lines->key[there], key)) {
            return there;
        }
        at = (at + 1U) & lines->mask;
    }
}
