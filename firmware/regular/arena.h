/// Lays arrays out in the caller's workspace, one behind the other. For the files of regular/ only.
#ifndef REGULAR_ARENA_H
#define REGULAR_ARENA_H

#include <stddef.h>
#include <stdint.h>

/// With base NULL it only adds up what would be needed.
struct arena {
    unsigned char *base;
    uint64_t used;
};

/// count elements, aligned to 8. The caller has checked that all of them fit.
static inline void *arena_take(struct arena *arena, uint64_t count, size_t size_bytes) {
    void *const at = arena->base == NULL ? NULL : arena->base + arena->used;
    arena->used += (count * size_bytes + 7U) / 8U * 8U;
    return at;
}

#endif
