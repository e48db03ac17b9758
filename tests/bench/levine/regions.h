/// The three ways of chapter II to find what a camera sees: an octree of the space, a tree of
/// boxes around the data, and a tree of spheres.
///
/// Boxes and spheres are around the same clusters, which scene_build finds. Below a region that is
/// inside of the picture nothing is tested, in each of the three.
#ifndef BENCH_LEVINE_REGIONS_H
#define BENCH_LEVINE_REGIONS_H

#include "scene/shape.h"
#include "scene/tree.h"
#include "scene/view.h"

enum region_tree { REGION_OCTREE, REGION_BOXES, REGION_SPHERES, REGION_TREES };

struct region_box {
    int32_t low[3], high[3];
};

struct regions {
    const struct shape_set *set;
    struct region_box *objects;
    // Clusters: scene_build's, and their boxes by node.
    void *block;
    struct tree tree;
    struct region_box *boxes;
    // Cells: child 0 is the low one on each axis; cells without data are none.
    struct region_cell *cells;
    uint32_t cell_count, cell_room;
    uint32_t *references; ///< objects, by leaf
    uint32_t reference_count, reference_room;
    uint32_t *mark, stamp;
};

/// What a look for the objects in a picture costs.
struct region_counts {
    uint32_t tested;    ///< regions, against the pyramid
    uint32_t distances; ///< signed distances of a corner or a centre from a plane
    uint32_t read;      ///< objects found, each time that a region names one
    uint32_t objects;   ///< different ones
    uint32_t size;      ///< points projected to tell how large the regions appear
};

void regions_open(struct regions *regions, const struct shape_set *set);
void regions_close(struct regions *regions);

/// Nodes or cells, and levels.
uint32_t regions_nodes(const struct regions *regions, enum region_tree tree, uint32_t *levels);

/// Every object that may be in the picture. found: by object, whether it was; the caller clears it.
struct region_counts regions_look(struct regions *regions, enum region_tree tree,
                                  const struct view *view, bool *found);

/// Is the object's own box in the picture, or may it be? The best that a test of boxes can tell.
bool regions_is_near(const struct regions *regions, uint32_t object, const struct view *view);

#endif
