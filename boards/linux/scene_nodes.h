/// A tree of spheres between scene_build.c, which grows it, and scene_block.c, which writes it
/// down.
/// Shown: tests/cli/scene.sh.
#ifndef LINUX_SCENE_NODES_H
#define LINUX_SCENE_NODES_H

#include "scene_build.h"
#include "scene_cluster.h"

/// In build_node.object: the node is no object, but has objects below.
#define BUILD_CLUSTER UINT32_MAX

/// A node while the tree grows. Its points are order[first..first+count) of the build; of a parent
/// only once put_in_order has run.
struct build_node {
    uint32_t first, count;
    uint32_t child, child_count; ///< index of the first of its children, in `kids`
    uint32_t thresholds;         ///< of an object with details: index of its first detail, + 1
    uint32_t object;             ///< index + 1; BUILD_CLUSTER; 0: neither
    uint32_t detail;             ///< of the node of a whole description: index + 1; else 0
};

struct build {
    const struct scene_text *scene;
    const struct scene_build_options *options;
    struct cluster_point *order; ///< of all descriptions; in the end each node's are together
    uint32_t order_count;
    struct build_node *nodes;
    uint32_t *kids; ///< children's node indices, by parent
    uint32_t node_count, node_room, kid_count, kid_room;
    bool failed, too_deep;
};

/// Writes the block; root UINT32_MAX: an empty scene.
enum scene_build_status scene_block_write(const struct build *build, uint32_t root, void **block,
                                          size_t *size_bytes);

#endif
