/// The largest empty circle among forbidden directions in space. For the files of regular/ only.
#ifndef REGULAR_EMPTY_H
#define REGULAR_EMPTY_H

#include "regular/arena.h"
#include "regular/disc.h"

struct empty {
    const struct vec3 *lines; ///< primitive; each forbids two opposite directions
    uint32_t count;
    struct vec3 *both; ///< those directions
    void *mesh;
    uint32_t *scratch;
    uint64_t operations;
};

void empty_open(struct empty *empty, uint32_t count, struct arena *arena);

/// The cap of the largest circle: on the rim of it the three supports of *disc; or, where all lines
/// are in one plane, its pole: one support. At least one line.
/// Cost:     expected O(count log count) tests (sphere/voronoi_mesh.h).
void empty_largest(struct empty *empty, struct disc *disc);

#endif
