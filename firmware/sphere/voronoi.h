/// Spherical Voronoi diagrams, closest-point and farthest-point, on the whole sphere.
///
/// Every different direction among the points is a site and has a region. A vertex is the axis of a
/// circle through three or more sites that has no site inside (closest) or no site outside
/// (farthest); an edge is a part of a great circle, at equal distances from two sites. In general
/// position n sites have 2 n - 4 vertices and 3 n - 6 edges; always V - E + F = 2, but for the
/// cases below. The farthest-point diagram is the antipodal image of the closest-point one
/// (Anderson 1985, Lemma 1, and docs/geometry.md).
///
/// Sites on one circle share a vertex. All sites on one circle, great or not: two opposite
/// vertices, and n edges of half a great circle. Two sites, also opposite ones: one edge, a whole
/// great circle without vertices. One site: neither vertices nor edges.
#ifndef SPHERE_VORONOI_H
#define SPHERE_VORONOI_H

#include "sphere/voronoi_mesh.h"

enum voronoi_status {
    VORONOI_OK = 0,
    VORONOI_EMPTY = -1,
    /// A zero vector has no direction; result->bad_index is the first one.
    VORONOI_ERROR_ZERO_VECTOR = -2,
    /// The workspace is smaller than VORONOI_WORKSPACE_BYTES(count).
    VORONOI_ERROR_WORKSPACE = -3,
    /// Our own bug: the merged diagram is none.
    VORONOI_ERROR_INTERNAL = -4
};

struct voronoi_vertex {
    struct vec3 at_q30;
    uint32_t first, count; ///< its sites in result->vertex_sites: points, ascending
};

struct voronoi_edge {
    uint32_t site[2];   ///< points, ascending
    uint32_t vertex[2]; ///< ascending; VORONOI_NONE: a whole great circle
};

struct voronoi_result {
    /// Points, ascending: of each direction the first.
    const uint32_t *sites;
    uint32_t site_count;
    /// In the order of their lists of sites.
    const struct voronoi_vertex *vertices;
    uint32_t vertex_count;
    const uint32_t *vertex_sites;
    /// In the order of their sites.
    const struct voronoi_edge *edges;
    uint32_t edge_count;
    uint32_t bad_index;
    uint64_t side_tests; ///< what it cost
};

struct voronoi_options {
    bool closest; ///< else farthest
    bool merge;   ///< by Anderson's merge (voronoi_merge), else by insertion; both give the same
};

/// Bytes of workspace for count points, aligned to 8.
#define VORONOI_WORKSPACE_BYTES(count)                                                             \
    (VORONOI_MESH_BYTES(count) + VORONOI_MERGE_BYTES(count) +                                      \
     (size_t)(count) * (2U * sizeof(struct voronoi_vertex) + 3U * sizeof(struct voronoi_edge) +    \
                        7U * sizeof(uint32_t)))

/// The diagram of count directions, components any int32; also without a common hemisphere.
/// Cost:      O(n log n), expected, plus sorting.
/// Accuracy:  combinatorially exact for the true directions; at_q30 within 1 unit a component
///            (tests/property/voronoi_exact.c).
/// Source:    Anderson 1985, section 4; docs/geometry.md, "Voronoi diagrams".
enum voronoi_status voronoi_diagram(const struct vec3 *points, uint32_t count,
                                    const struct voronoi_options *options, void *workspace,
                                    size_t workspace_bytes,
                                    struct voronoi_result *result) MUST_CHECK;

#endif
