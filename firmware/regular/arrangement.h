/// The cells between great circles, on the half of the sphere where the first one's normal is; the
/// other half is their mirror image. For the files of regular/ only.
///
/// Each circle is walked through the cells of those before it, and splits them. By the zone theorem
/// that is O(m) a circle, O(m^2) in all, wherever many circles meet in a point, too.
/// Source: Edelsbrunner, O'Rourke, Seidel 1986, for lines.
/// Shown:  tests/property/regular_optimize.c; make bench-regular counts the steps.
#ifndef REGULAR_ARRANGEMENT_H
#define REGULAR_ARRANGEMENT_H

#include "regular/arena.h"
#include "regular/cell.h"

struct arrangement_vertex {
    uint32_t circle[2]; ///< the second one with bit 31: the vertex is -(n0 x n1), not n0 x n1
    uint32_t seen;      ///< 4 * (the circle that asked last) + side + 1
};

/// Half-edges 2 e and 2 e + 1 are the two sides of edge e; each has its cell on its left.
struct arrangement {
    const struct cell_circle *circles;
    uint32_t *next, *origin; ///< of half-edges
    uint32_t *circle;        ///< of edges; bit 31: an even half's cell is on the side of -normal
    struct arrangement_vertex *vertices;
    uint32_t edge_count, vertex_count;
    uint32_t asking;
    cell_side *sides; ///< scratch: of a cell
    uint64_t operations;
};

/// Edges and vertices of so many circles at most. 26 bytes for each pair of circles.
#define ARRANGEMENT_EDGES(count)    ((uint64_t)(count) * (count))
#define ARRANGEMENT_VERTICES(count) (((uint64_t)(count) + 2U) * (count) / 2U)
/// For 32-bit indices of half-edges; the bytes of that many are 26 GB.
#define ARRANGEMENT_COUNT_MAX 32768U

void arrangement_open(struct arrangement *arrangement, uint32_t count, struct arena *arena);

/// The largest disc in a cell. circles: different, the first three not through one point; at least
/// three.
void arrangement_search(struct arrangement *arrangement, const struct cell_circle *circles,
                        uint32_t count, struct cell_best *best);

#endif
