/// Where to cut a set of points in two.
/// Shown: tests/cli/scene.sh, tests/property/scene_tree.c.
#ifndef LINUX_SCENE_CLUSTER_H
#define LINUX_SCENE_CLUSTER_H

#include <stdbool.h>
#include <stdint.h>

struct cluster_point {
    int32_t x, y, z;
    uint32_t source;
    uint32_t weight; ///< how many points it stands for
};

struct cluster_box {
    int32_t low[3], high[3];
};

/// count >= 1.
struct cluster_box cluster_box(const struct cluster_point *points, uint32_t count);

/// Reorders the points and returns where to cut, 1 to count - 1: a multiple of `whole` where there
/// are at most 64 times as many. count > whole >= 1. even: in halves, whatever that costs.
uint32_t cluster_cut(struct cluster_point *points, uint32_t count, uint32_t whole, bool even);

#endif
