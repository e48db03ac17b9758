/// A scene as a tree of spheres, in a block of bytes that is used where it lies: flash, a mapped
/// file. Levine's Choose-One-Consider-All tree.
///
/// Each node is a sphere that holds all points below it, and a list of descriptions of the same
/// thing, the coarsest first, of which one is chosen by how large the sphere appears, or by how far
/// away it is. A description is a list of nodes (all of them to be considered), of points, or the
/// sphere's centre alone.
///
/// Some nodes have a name: they are objects, which may move and vanish (overlay.h). And some have a
/// shape: faces and lines between the points below, for who draws.
///
/// The block: a header, nodes, descriptions, points, parts, shapes, elements, corners, names; all
/// but the names little-endian 32-bit words; offsets only. Nodes stand level by level, the root
/// first; the descriptions in the order of the nodes, children and points in the order of the
/// descriptions, without gaps; likewise shapes, elements, corners. So whether a block is a tree can
/// be checked in one pass without any memory.
/// Source: Levine 1975, chapter II.F and G, as corrected in docs/geometry.md.
#ifndef SCENE_TREE_H
#define SCENE_TREE_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stddef.h>
#include <stdint.h>

#define TREE_MAGIC        UINT32_C(0x41434F43) // "COCA"
#define TREE_VERSION      2U
#define TREE_HEADER_BYTES 64U
#define TREE_LEVELS_MAX   40U
#define TREE_NONE         UINT32_MAX

/// Coordinates and radii are whole units (tree_header.unit), coordinates within this of 0.
#define TREE_COORDINATE_MAX ((int32_t)((UINT32_C(1) << 30) - 1U))

struct tree_header {
    uint32_t magic, version, size_bytes;
    uint32_t crc32; ///< of all bytes behind it: IEEE 802.3
    uint32_t node_count, description_count, point_count, level_count;
    uint32_t source_count; ///< points as numbered in the source file
    uint32_t
        unit_double[2]; ///< the bits of a double: one unit, in the source's unit; low word first
    uint32_t part_count, shape_count, element_count, corner_count, name_bytes;
};

struct tree_node {
    int32_t x, y, z; ///< centre
    uint32_t radius; ///< rounded up: every point below is inside
    uint32_t first_description, description_count;
    uint32_t part; ///< of the parts; TREE_NONE: it is none
};

enum tree_kind {
    TREE_NODES = 0,
    TREE_POINTS = 1,
    TREE_CENTER = 2 ///< the sphere's centre stands for everything in it
};

/// Beside the kind: the threshold is a distance.
#define TREE_BY_DISTANCE UINT32_C(0x100)

struct tree_description {
    /// Chosen from this projected radius on, in 1/256 pixel, ascending; or with TREE_BY_DISTANCE
    /// while the eye is at most so many units from the sphere's centre, descending. The first one
    /// is chosen always: 0, or 2^32 - 1 of distances. One node's are all of one sort.
    uint32_t threshold;
    uint32_t kind;  ///< enum tree_kind, and TREE_BY_DISTANCE or not
    uint32_t first; ///< node or point; 0 for TREE_CENTER
    uint32_t count;
};

static inline enum tree_kind tree_kind(const struct tree_description *description) {
    return (enum tree_kind)(description->kind & ~TREE_BY_DISTANCE);
}

struct tree_point {
    int32_t x, y, z;
    uint32_t source; ///< its index in the source file
};

/// An object, or a node above objects; in the order of their nodes, so the root comes first.
struct tree_part {
    uint32_t node;
    uint32_t parent; ///< the part just above; TREE_NONE of the root
    uint32_t name;   ///< offset in the names; TREE_NONE: it is no object. No object is below one
    uint32_t line;   ///< of the source file, from 1; 0: unknown
};

enum tree_shape_kind {
    TREE_SOLID = 0, ///< the faces close up and are convex, counter-clockwise as seen from outside
    TREE_FACES = 1, ///< each face for itself: seen from both sides, its outline perhaps concave
    TREE_LINES = 2  ///< lines only: they hide nothing
};

/// What is drawn for a description of an object instead of its points: the shape stands at the node
/// of that description. In the order of the nodes. A solid or faces may have lines, too.
struct tree_shape {
    uint32_t node;
    uint32_t kind; ///< enum tree_shape_kind
    uint32_t first_element, element_count;
};

enum tree_element_kind {
    TREE_FACE = 0, ///< a closed outline of three corners or more, in one plane
    TREE_LINE = 1  ///< from corner to corner: two or more
};

struct tree_element {
    uint32_t kind; ///< enum tree_element_kind
    uint32_t first_corner, corner_count;
};

/// The parts of the block; corners are indices of points.
struct tree {
    const struct tree_header *header;
    const struct tree_node *nodes;
    const struct tree_description *descriptions;
    const struct tree_point *points;
    const struct tree_part *parts;
    const struct tree_shape *shapes;
    const struct tree_element *elements;
    const uint32_t *corners;
    const char *names; ///< each ends with a NUL
};

enum tree_status {
    TREE_OK = 0,
    TREE_ERROR_ALIGNMENT = -1, ///< the block does not begin at a multiple of 4
    TREE_ERROR_SIZE = -2,      ///< not as long as it says, or as its counts say
    TREE_ERROR_FORMAT = -3,    ///< no such file, or another version of it
    TREE_ERROR_CRC = -4,
    TREE_ERROR_STRUCTURE = -5 ///< an index or a value out of place
};

/// Checks everything that a walk relies on; the tree then points into the block.
/// fault_offset: the first byte found wrong (of a part that is; for a CRC its own place).
/// Cost:     one pass over nodes and descriptions, and one for the CRC: about 3 ns a byte on a PC.
/// Accuracy: no block, however damaged, makes a walk of an opened tree leave it or run for ever
///           (tests/property/scene_tree.c: every bit of a file flipped, with the CRC as it was and
///           with the CRC made right again).
enum tree_status tree_open(const void *block, size_t size_bytes, struct tree *out,
                           size_t *fault_offset) MUST_CHECK;

/// CRC-32 (IEEE 802.3) of some bytes, going on from crc; 0 to begin with.
uint32_t tree_crc32(uint32_t crc, const void *bytes, size_t size_bytes);

/// The shape that stands at a node; NULL: none. Cost: a binary search.
const struct tree_shape *tree_shape_at(const struct tree *tree, uint32_t node);

/// The object with that name; TREE_NONE: none. Of several the first. Cost: all names are read.
uint32_t tree_find_part(const struct tree *tree, const char *name);

static inline struct vec3 tree_center(const struct tree_node *node) {
    return vec3(node->x, node->y, node->z);
}

#endif
