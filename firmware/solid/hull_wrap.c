#include "solid/hull_methods.h"

/// An edge a -> b of a face that is known, whose other face is not.
struct open_edge {
    uint32_t a, b;
};

struct wrap {
    struct mesh *mesh;
    struct open_edge *open;
    uint32_t open_count;
    struct solid_face *faces;
    uint32_t face_count;
};

static int side(struct wrap *w, uint32_t a, uint32_t b, uint32_t c, uint32_t p) {
    const struct vec3 *const points = w->mesh->points;
    return side_exact(points[a], points[b], points[c], points[p]);
}

/// Turns a plane about the edge b -> a until no point is above it; the point that holds it.
static uint32_t turn_about(struct wrap *w, struct open_edge edge) {
    const struct vec3 *const points = w->mesh->points;
    uint32_t c = MESH_NONE;
    for (uint32_t i = 0; i < w->mesh->count; i++) {
        w->mesh->side_tests += 2U;
        if (c == MESH_NONE) {
            c = side_collinear(points[edge.a], points[edge.b], points[i]) ? MESH_NONE : i;
        } else if (side(w, edge.b, edge.a, c, i) > 0) {
            c = i;
        }
    }
    return c;
}

/// The points in the plane of three, as a chain; *below: some point under it.
static uint32_t points_in_plane(struct wrap *w, uint32_t a, uint32_t b, uint32_t c,
                                uint32_t *below) {
    struct mesh *const mesh = w->mesh;
    uint32_t chain = MESH_NONE;
    for (uint32_t i = mesh->count; i-- != 0U;) {
        if (side(w, a, b, c, i) == 0) {
            mesh->next[i] = chain;
            chain = i;
        } else {
            *below = i;
        }
    }
    return chain;
}

/// Seen from above a face with `below` under it: is p right of a -> q, or beyond q on its line?
/// Of equal points the first is meant.
static bool is_better(struct wrap *w, uint32_t a, uint32_t q, uint32_t p, uint32_t below) {
    const struct vec3 *const points = w->mesh->points;
    const int turn = side(w, a, q, p, below);
    if (turn != 0) {
        return turn > 0;
    }
    if (vec3_equal(points[p], points[q])) {
        return p < q;
    }
    // On one line through a, an end of it on this side: the farther one has the same order from q.
    const int out = side_order(points[q], points[a]);
    return side_order(points[p], points[a]) == out && side_order(points[p], points[q]) == out;
}

/// The corner after a on the way around a face.
static uint32_t next_corner(struct wrap *w, uint32_t a, uint32_t chain, uint32_t below) {
    const struct vec3 *const points = w->mesh->points;
    uint32_t q = MESH_NONE;
    for (uint32_t p = chain; p != MESH_NONE; p = w->mesh->next[p]) {
        if (!vec3_equal(points[p], points[a]) && (q == MESH_NONE || is_better(w, a, q, p, below))) {
            q = p;
        }
    }
    return q;
}

/// An edge of a new face: it closes an open one, or is open.
static void enter_edge(struct wrap *w, uint32_t a, uint32_t b) {
    for (uint32_t i = 0; i < w->open_count; i++) {
        if (w->open[i].a == b && w->open[i].b == a) {
            w->open[i] = w->open[--w->open_count];
            return;
        }
    }
    w->open[w->open_count++] = (struct open_edge){a, b};
}

/// The whole face in the plane of a, b and c, counter-clockwise, from the corner a on.
static void enter_face(struct wrap *w, uint32_t a, uint32_t chain, uint32_t below) {
    uint32_t *const is_vertex = w->mesh->outside;
    uint32_t before = a, at = next_corner(w, a, chain, below);
    is_vertex[a] = 1;
    enter_edge(w, a, at);
    while (at != a) {
        is_vertex[at] = 1;
        const uint32_t following = next_corner(w, at, chain, below);
        enter_edge(w, at, following);
        if (before != a) {
            const uint32_t v[3] = {a, before, at};
            const unsigned first = v[0] < v[1] ? (v[0] < v[2] ? 0U : 2U) : (v[1] < v[2] ? 1U : 2U);
            for (unsigned k = 0; k < 3U; k++) {
                w->faces[w->face_count].vertex[k] = v[(first + k) % 3U];
            }
            w->face_count++;
        }
        before = at;
        at = following;
    }
}

/// Where a point is from the first one in side_order: along an upright plane, and up.
struct upright {
    int64_t x, y, along, z;
};

static struct upright upright_from(struct vec3 a, struct vec3 p) {
    const int64_t x = (int64_t)p.x - a.x, y = (int64_t)p.y - a.y;
    // Never negative, since a comes first; among the points of one upright plane comparable.
    return (struct upright){x, y, x != 0 ? x : y, (int64_t)p.z - a.z};
}

/// Sign of the turn from b to p about the upright line through a.
static int turn_of(struct upright b, struct upright p) {
    return i128_sign(i128_sub(i128_mul(b.x, p.y), i128_mul(b.y, p.x)));
}

/// An edge to begin with: on an upright plane that touches the set at its first point.
static struct open_edge first_edge(const struct mesh *mesh) {
    const struct vec3 *const points = mesh->points;
    uint32_t a = 0, b = MESH_NONE;
    for (uint32_t i = 1; i < mesh->count; i++) {
        a = side_order(points[i], points[a]) < 0 ? i : a;
    }
    // The rightmost seen from above, then the lowest slope, then the farthest.
    struct upright best = {0, 0, 0, 0};
    for (uint32_t i = 0; i < mesh->count; i++) {
        const struct upright p = upright_from(points[a], points[i]);
        if (p.along == 0) {
            continue;
        }
        const int turn = b == MESH_NONE ? -1 : turn_of(best, p);
        const int slope = i128_sign(i128_sub(i128_mul(p.z, best.along), i128_mul(best.z, p.along)));
        if (turn < 0 || (turn == 0 && (slope < 0 || (slope == 0 && p.along > best.along)))) {
            b = i;
            best = p;
        }
    }
    return (struct open_edge){a, b};
}

void hull_wrap(struct mesh *mesh, struct solid_hull *result) {
    // The mesh's faces lend their room: at most 2 n triangles, and 3 n open edges.
    struct wrap w = {.mesh = mesh, .faces = (struct solid_face *)(void *)mesh->faces};
    w.open = (struct open_edge *)(void *)(w.faces + MESH_FACES(mesh->count));
    for (uint32_t i = 0; i < mesh->count; i++) {
        mesh->outside[i] = 0;
    }
    struct open_edge edge = first_edge(mesh);
    for (;;) {
        const uint32_t c = turn_about(&w, edge);
        uint32_t below = MESH_NONE;
        const uint32_t chain = points_in_plane(&w, edge.b, edge.a, c, &below);
        enter_face(&w, edge.a, chain, below);
        if (w.open_count == 0U) {
            break;
        }
        edge = w.open[0];
    }
    result->faces = w.faces;
    result->face_count = w.face_count;
    for (uint32_t i = 0; i < mesh->count; i++) {
        if (mesh->outside[i] != 0U) {
            mesh->next[result->vertex_count++] = i;
        }
    }
    result->vertices = mesh->next;
    result->side_tests = mesh->side_tests;
}
