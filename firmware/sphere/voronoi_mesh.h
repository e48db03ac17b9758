/// The dual of a spherical Voronoi diagram: the triangulated 3-D hull of the sites.
///
/// Each triangle's circle holds no other site inside; its axis is a vertex of the closest-point
/// diagram, and the opposite one of the farthest-point diagram. Two constructions make it: by
/// insertion, and Anderson's by merging. Where four sites lie on one circle, or four on one great
/// circle, an infinitesimal displacement of the sites decides which diagonal is drawn, so that both
/// see general position; a reader joins the triangles of one circle again (voronoi_mesh_joined).
/// All tests are exact on the true directions (sphere/site.h).
#ifndef SPHERE_VORONOI_MESH_H
#define SPHERE_VORONOI_MESH_H

#include "fixed/must_check.h"
#include "sphere/site.h"

#include <stddef.h>
#include <stdint.h>

#define VORONOI_NONE UINT32_MAX

/// Counter-clockwise as seen from outside. next[i] is the triangle across the side opposite
/// site[i].
struct voronoi_triangle {
    uint32_t site[3];
    uint32_t next[3];
};

struct voronoi_mesh {
    struct site *site; ///< different directions, in angular order (voronoi_sites)
    uint32_t *point;   ///< which point each site is: the first of its direction
    uint32_t site_count;
    struct voronoi_triangle *triangle; ///< none for one or two sites; two for three
    uint32_t triangle_count;           ///< 2 site_count - 4 from three sites on
    uint64_t side_tests;               ///< what it cost
};

/// Bytes for a mesh of count points, aligned to 8, and of scratch for either construction.
#define VORONOI_MESH_BYTES(count)                                                                  \
    ((size_t)(count) *                                                                             \
     (sizeof(struct site) + 2U * sizeof(uint32_t) + 2U * sizeof(struct voronoi_triangle)))
#define VORONOI_INSERT_BYTES(count) ((size_t)(count)*18U * sizeof(uint32_t))
#define VORONOI_MERGE_BYTES(count)  ((size_t)(count)*52U * sizeof(uint32_t))

/// Lays a mesh into memory of VORONOI_MESH_BYTES(count), and lists the different directions of
/// the points that `list` names (repeated ones ascending; NULL: all of them). None of them may be
/// zero. Order: Anderson's section 4.2 sorts the sites by angle about a point p that is no site,
/// and splits them by a great circle through p that holds none. Here p and the circle are
/// infinitesimally beside -z and the plane of y and z, so that no int32 vector can be on them:
/// first the half in front of the circle, then the other, each by angle about p, equal angles
/// by distance from p.
/// spare:     count words.
/// Cost:      a merge sort.
/// Accuracy:  exact. Source: as above, with the corrections of docs/geometry.md, "The merge of
///            1985".
void voronoi_sites(struct voronoi_mesh *mesh, void *memory, const struct vec3 *points,
                   const uint32_t *list, uint32_t count, uint32_t *spare);

/// Is the site in the half in front of that circle? Cost: three comparisons. Accuracy: exact.
/// Source: as voronoi_sites.
bool voronoi_is_front(struct vec3 vector);

/// The sign of site_plane_sign for four different sites, never 0: the sites are thought to be
/// displaced outward by infinitesimal amounts, the first one most, and then along x, y and z by
/// far smaller ones.
/// Cost:      site_plane_sign; on one circle a determinant more, on a great one a sum of roots.
/// Accuracy:  exact.
/// Source:    Edelsbrunner, Muecke 1990 (simulation of simplicity), for points of a sphere.
int voronoi_side(struct voronoi_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d);

/// Do two neighbours, t and the triangle across its side i, lie on one circle and not back to back?
/// Cost: one site_plane_sign, and on a circle the signs of two normals. Accuracy: exact.
/// Source: docs/geometry.md, "Voronoi diagrams".
bool voronoi_mesh_joined(const struct voronoi_mesh *mesh, uint32_t t, unsigned i);

/// The mesh of three sites: both faces of a triangle. Fewer sites: no triangle. Cost: none.
/// Accuracy: exact. Source: the definition.
void voronoi_mesh_few(struct voronoi_mesh *mesh);

/// Builds the triangles of the sites by inserting them in a random order (a fixed seed).
/// scratch: VORONOI_INSERT_BYTES(site_count).
/// Cost:      expected O(n log n) tests. Each site that waits remembers one triangle whose
///            circle it lies in.
/// Accuracy:  exact: voronoi_side decides (tests/property/voronoi_exact.c).
/// Source:    Clarkson, Shor 1989, for the 3-D hull; Boissonnat, Teillaud 1993 (one conflict a
///            site).
void voronoi_insert(struct voronoi_mesh *mesh, uint32_t *scratch);

/// Builds them as Anderson 1985, section 4.2, does: pairs that are adjacent in angular order,
/// merged along the closed curve of points that are equally far from both sets. False: an
/// internal failure.
/// scratch:   VORONOI_MERGE_BYTES(site_count).
/// Cost:      O(n log n) tests, but for the search of a nearest pair between two sets, which is
///            by whole scans.
/// Accuracy:  exact, as voronoi_insert, which gives the same triangles.
/// Source:    docs/geometry.md, "The merge of 1985", has the corrections.
bool voronoi_merge(struct voronoi_mesh *mesh, uint32_t *scratch) MUST_CHECK;

#endif
