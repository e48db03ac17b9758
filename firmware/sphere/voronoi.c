#include "sphere/voronoi.h"

#include "fixed/sort.h"
#include "sphere/site_axis.h"

/// What the triangles become. Lists are cut from the workspace: the result's own, then scratch.
struct drawing {
    struct voronoi_mesh *mesh;
    struct voronoi_vertex *vertices; ///< as found, then in order
    uint32_t *vertex_sites;
    struct voronoi_edge *edges;
    uint32_t vertex_count, edge_count, listed;
    struct voronoi_vertex *found; ///< scratch: vertices before they are in order
    struct voronoi_edge *found_edges;
    uint32_t *class; ///< by triangle: its vertex
    uint32_t *stamp; ///< by site: the last vertex that listed it
    uint32_t *order, *spare, *rank;
};

static bool index_before(const void *context, uint32_t a, uint32_t b) {
    (void)context;
    return a < b;
}

// ---------------------------------------------------------------- vertices

/// Gives a triangle and all that are joined to it one vertex, and lists their sites.
static void flood(struct drawing *d, uint32_t from) {
    struct voronoi_mesh *const mesh = d->mesh;
    const uint32_t vertex = d->vertex_count++, first = d->listed;
    uint32_t waiting = 1;
    d->order[0] = from;
    d->class[from] = vertex;
    while (waiting > 0U) {
        const uint32_t t = d->order[--waiting];
        const struct voronoi_triangle *const triangle = &mesh->triangle[t];
        for (unsigned i = 0; i < 3U; i++) {
            const uint32_t site = triangle->site[i], next = triangle->next[i];
            if (d->stamp[site] != vertex) {
                d->stamp[site] = vertex;
                d->vertex_sites[d->listed++] = mesh->point[site];
            }
            if (d->class[next] == VORONOI_NONE && voronoi_mesh_joined(mesh, t, i)) {
                d->class[next] = vertex;
                d->order[waiting++] = next;
            }
        }
    }
    sort_indices(d->vertex_sites + first, d->spare, d->listed - first, index_before, NULL);
    d->found[vertex].first = first;
    d->found[vertex].count = d->listed - first;
}

static struct vec3 triangle_axis(const struct voronoi_mesh *mesh, uint32_t t) {
    const uint32_t *const s = mesh->triangle[t].site;
    return site_circle_axis(&mesh->site[s[0]], &mesh->site[s[1]], &mesh->site[s[2]]);
}

/// The axis by the three first sites of the vertex, so that it does not depend on which triangles
/// were drawn; on the side that a triangle says.
static struct vec3 vertex_axis(const struct vec3 *points, const uint32_t *sites, struct vec3 side) {
    const struct site a = site_from(points[sites[0]]), b = site_from(points[sites[1]]),
                      c = site_from(points[sites[2]]);
    const struct vec3 axis = site_circle_axis(&a, &b, &c);
    return vec3_dot_unit(axis, side) < 0 ? vec3_neg(axis) : axis;
}

struct list_order {
    const struct voronoi_vertex *vertices;
    const uint32_t *sites;
};

/// By their lists; the two vertices of sites on one circle, whose lists are equal, by where they
/// are.
static bool vertex_before(const void *context, uint32_t a, uint32_t b) {
    const struct list_order *const order = context;
    const struct voronoi_vertex *const va = &order->vertices[a], *const vb = &order->vertices[b];
    for (uint32_t i = 0; i < va->count && i < vb->count; i++) {
        const uint32_t sa = order->sites[va->first + i], sb = order->sites[vb->first + i];
        if (sa != sb) {
            return sa < sb;
        }
    }
    if (va->count != vb->count) {
        return va->count < vb->count;
    }
    const struct vec3 pa = va->at_q30, pb = vb->at_q30;
    return pa.x != pb.x ? pa.x < pb.x : (pa.y != pb.y ? pa.y < pb.y : pa.z < pb.z);
}

static void draw_vertices(struct drawing *d, const struct vec3 *points, bool closest) {
    const struct voronoi_mesh *const mesh = d->mesh;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        d->class[t] = VORONOI_NONE;
    }
    for (uint32_t s = 0; s < mesh->site_count; s++) {
        d->stamp[s] = VORONOI_NONE;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (d->class[t] == VORONOI_NONE) {
            flood(d, t);
            struct voronoi_vertex *const vertex = &d->found[d->class[t]];
            const struct vec3 axis =
                vertex_axis(points, d->vertex_sites + vertex->first, triangle_axis(mesh, t));
            vertex->at_q30 = closest ? axis : vec3_neg(axis);
        }
    }
    const struct list_order order = {d->found, d->vertex_sites};
    for (uint32_t v = 0; v < d->vertex_count; v++) {
        d->order[v] = v;
    }
    sort_indices(d->order, d->spare, d->vertex_count, vertex_before, &order);
    for (uint32_t v = 0; v < d->vertex_count; v++) {
        d->vertices[v] = d->found[d->order[v]];
        d->rank[d->order[v]] = v;
    }
}

// ---------------------------------------------------------------- edges

static void add_edge(struct drawing *d, uint32_t a, uint32_t b, uint32_t v, uint32_t w) {
    d->found_edges[d->edge_count++] =
        (struct voronoi_edge){{a < b ? a : b, a < b ? b : a}, {v < w ? v : w, v < w ? w : v}};
}

static bool edge_before(const void *context, uint32_t a, uint32_t b) {
    const struct voronoi_edge *const edges = context;
    return edges[a].site[0] != edges[b].site[0] ? edges[a].site[0] < edges[b].site[0]
                                                : edges[a].site[1] < edges[b].site[1];
}

static void draw_edges(struct drawing *d) {
    const struct voronoi_mesh *const mesh = d->mesh;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const struct voronoi_triangle *const triangle = &mesh->triangle[t];
        for (unsigned i = 0; i < 3U; i++) {
            const uint32_t next = triangle->next[i];
            if (t < next && d->class[t] != d->class[next]) {
                add_edge(d, mesh->point[triangle->site[(i + 1U) % 3U]],
                         mesh->point[triangle->site[(i + 2U) % 3U]], d->rank[d->class[t]],
                         d->rank[d->class[next]]);
            }
        }
    }
    if (mesh->site_count == 2U) {
        add_edge(d, mesh->point[0], mesh->point[1], VORONOI_NONE, VORONOI_NONE);
    }
    for (uint32_t e = 0; e < d->edge_count; e++) {
        d->order[e] = e;
    }
    sort_indices(d->order, d->spare, d->edge_count, edge_before, d->found_edges);
    for (uint32_t e = 0; e < d->edge_count; e++) {
        d->edges[e] = d->found_edges[d->order[e]];
    }
}

// ---------------------------------------------------------------- the whole

/// Cuts up the workspace behind the mesh; the scratch is the merge's. Its words, of count: vertices
/// found 10, edges found 12, class 2, stamp 1, order 3, spare 3, rank 2.
static struct drawing lay_out(struct voronoi_mesh *mesh, void *behind_mesh, uint32_t count) {
    const size_t n = count;
    uint32_t *const scratch = behind_mesh;
    struct drawing d = {.mesh = mesh};
    d.vertices = (struct voronoi_vertex *)(void *)(scratch + 52U * n);
    d.edges = (struct voronoi_edge *)(void *)(d.vertices + 2U * n);
    d.vertex_sites = (uint32_t *)(void *)(d.edges + 3U * n);
    d.found = (struct voronoi_vertex *)(void *)scratch;
    d.found_edges = (struct voronoi_edge *)(void *)(d.found + 2U * n);
    d.class = (uint32_t *)(void *)(d.found_edges + 3U * n);
    d.stamp = d.class + 2U * n;
    d.order = d.stamp + n;
    d.spare = d.order + 3U * n;
    d.rank = d.spare + 3U * n;
    return d;
}

enum voronoi_status voronoi_diagram(const struct vec3 *points, uint32_t count,
                                    const struct voronoi_options *options, void *workspace,
                                    size_t workspace_bytes, struct voronoi_result *result) {
    *result = (struct voronoi_result){0};
    if (count == 0U) {
        return VORONOI_EMPTY;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (vec3_is_zero(points[i])) {
            result->bad_index = i;
            return VORONOI_ERROR_ZERO_VECTOR;
        }
    }
    if (workspace_bytes < VORONOI_WORKSPACE_BYTES(count)) {
        return VORONOI_ERROR_WORKSPACE;
    }
    uint32_t *const scratch = (uint32_t *)(void *)((char *)workspace + VORONOI_MESH_BYTES(count));
    struct voronoi_mesh mesh;
    voronoi_sites(&mesh, workspace, points, NULL, count, scratch);
    if (!options->merge) {
        voronoi_insert(&mesh, scratch);
    } else if (!voronoi_merge(&mesh, scratch)) {
        return VORONOI_ERROR_INTERNAL;
    }
    struct drawing d = lay_out(&mesh, scratch, count);
    draw_vertices(&d, points, options->closest);
    draw_edges(&d);
    uint32_t *const sites = mesh.point;
    sort_indices(sites, d.spare, mesh.site_count, index_before, NULL);
    *result = (struct voronoi_result){.sites = sites,
                                      .site_count = mesh.site_count,
                                      .vertices = d.vertices,
                                      .vertex_count = d.vertex_count,
                                      .vertex_sites = d.vertex_sites,
                                      .edges = d.edges,
                                      .edge_count = d.edge_count,
                                      .side_tests = mesh.side_tests};
    return VORONOI_OK;
}
