#include "solid/mesh.h"

static unsigned after(unsigned edge) {
    return edge == 2U ? 0U : edge + 1U;
}

void mesh_open(struct mesh *mesh, const struct vec3 *points, uint32_t count,
               struct side_range range, void *workspace) {
    _Static_assert(sizeof(struct mesh_face) <= 104U, "MESH_WORKSPACE_BYTES counts on it");
    *mesh = (struct mesh){.points = points, .count = count, .range = range};
    mesh->faces = workspace;
    mesh->slots = (uint32_t)MESH_FACES(count);
    mesh->next = (uint32_t *)(void *)(mesh->faces + mesh->slots);
    mesh->outside = mesh->next + count + 1U;
    mesh->queue_first = MESH_NONE;
    mesh->queue_last = MESH_NONE;
    mesh->unused = MESH_NONE;
}

static uint32_t new_face(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t index = mesh->unused;
    if (index != MESH_NONE) {
        mesh->unused = mesh->faces[index].link;
    } else {
        index = mesh->slots_used++;
    }
    struct mesh_face *const face = &mesh->faces[index];
    face->plane = side_plane_through(mesh->range, mesh_point(mesh, a), mesh_point(mesh, b),
                                     mesh_point(mesh, c));
    face->vertex[0] = a;
    face->vertex[1] = b;
    face->vertex[2] = c;
    face->mark = 0;
    face->link = MESH_NONE;
    face->head = MESH_NONE;
    face->tail = MESH_NONE;
    face->in_use = true;
    mesh->face_count++;
    return index;
}

static void drop_face(struct mesh *mesh, uint32_t index) {
    struct mesh_face *const face = &mesh->faces[index];
    if (face->head != MESH_NONE) {
        if (face->before != MESH_NONE) {
            mesh->faces[face->before].behind = face->behind;
        } else {
            mesh->queue_first = face->behind;
        }
        if (face->behind != MESH_NONE) {
            mesh->faces[face->behind].before = face->before;
        } else {
            mesh->queue_last = face->before;
        }
    }
    face->in_use = false;
    face->link = mesh->unused;
    mesh->unused = index;
    mesh->face_count--;
}

void mesh_start(struct mesh *mesh, const uint32_t corner[4]) {
    mesh->slots_used = 0;
    mesh->unused = MESH_NONE;
    mesh->face_count = 0;
    mesh->step = 0;
    mesh->queue_first = MESH_NONE;
    mesh->queue_last = MESH_NONE;
    const bool above = side_exact(mesh_point(mesh, corner[0]), mesh_point(mesh, corner[1]),
                                  mesh_point(mesh, corner[2]), mesh_point(mesh, corner[3])) > 0;
    const uint32_t a = corner[0], b = corner[above ? 2 : 1], c = corner[above ? 1 : 2],
                   d = corner[3];
    const uint32_t base = new_face(mesh, a, b, c), ab = new_face(mesh, b, a, d),
                   bc = new_face(mesh, c, b, d), ca = new_face(mesh, a, c, d);
    const uint32_t across[4][3] = {{ab, bc, ca}, {base, ca, bc}, {base, ab, ca}, {base, bc, ab}};
    const uint32_t face[4] = {base, ab, bc, ca};
    for (unsigned i = 0; i < 4U; i++) {
        for (unsigned k = 0; k < 3U; k++) {
            mesh->faces[face[i]].across[k] = across[i][k];
        }
        mesh->faces[face[i]].link = i < 3U ? face[i + 1U] : MESH_NONE;
    }
}

static int decide(const struct mesh *mesh, const struct mesh_face *face, uint32_t point,
                  int64_t value) {
    const int64_t band = face->plane.exact ? 0 : side_band(mesh->range);
    if (value > band || value < -band || face->plane.exact) {
        return value > 0 ? 1 : (value < 0 ? -1 : 0);
    }
    return side_exact(mesh_point(mesh, face->vertex[0]), mesh_point(mesh, face->vertex[1]),
                      mesh_point(mesh, face->vertex[2]), mesh_point(mesh, point));
}

int mesh_side(struct mesh *mesh, uint32_t face, uint32_t point) {
    mesh->side_tests++;
    const struct mesh_face *const f = &mesh->faces[face];
    return decide(mesh, f, point, side_value(&f->plane, mesh_point(mesh, point)));
}

int mesh_compare(const struct mesh *mesh, uint32_t face, uint32_t a, int64_t value_a, uint32_t b,
                 int64_t value_b) {
    const struct mesh_face *const f = &mesh->faces[face];
    // Both are off by less than the band.
    const int64_t band = f->plane.exact ? 0 : 2 * side_band(mesh->range);
    const int64_t difference = value_a - value_b;
    if (difference > band || difference < -band || f->plane.exact) {
        return difference > 0 ? 1 : (difference < 0 ? -1 : 0);
    }
    return side_compare(mesh_point(mesh, f->vertex[0]), mesh_point(mesh, f->vertex[1]),
                        mesh_point(mesh, f->vertex[2]), mesh_point(mesh, a), mesh_point(mesh, b));
}

/// Marks the faces that the point sees, linked from seed on; some edge between a visible and a
/// hidden face.
static void find_visible(struct mesh *mesh, uint32_t seed, uint32_t point, uint32_t *rim_face,
                         unsigned *rim_edge) {
    struct mesh_face *const faces = mesh->faces;
    const uint32_t hidden = 2U * ++mesh->step, visible = hidden + 1U;
    faces[seed].mark = visible;
    faces[seed].link = MESH_NONE;
    uint32_t last = seed;
    for (uint32_t f = seed; f != MESH_NONE; f = faces[f].link) {
        for (unsigned e = 0; e < 3U; e++) {
            const uint32_t g = faces[f].across[e];
            if (faces[g].mark < hidden) {
                faces[g].mark = mesh_side(mesh, g, point) > 0 ? visible : hidden;
                if (faces[g].mark == visible) {
                    faces[last].link = g;
                    faces[g].link = MESH_NONE;
                    last = g;
                }
            }
            if (faces[g].mark == hidden) {
                *rim_face = f;
                *rim_edge = e;
            }
        }
    }
}

/// Follows the rim of the visible faces once around; `next` and `outside` of its points tell it.
static uint32_t follow_rim(struct mesh *mesh, uint32_t face, unsigned edge) {
    struct mesh_face *const faces = mesh->faces;
    const uint32_t visible = 2U * mesh->step + 1U;
    const uint32_t first = faces[face].vertex[edge];
    uint32_t at = first;
    do {
        const uint32_t end = faces[face].vertex[after(edge)];
        mesh->next[at] = end;
        mesh->outside[at] = faces[face].across[edge];
        at = end;
        edge = after(edge);
        // Around `at`, through the visible faces, to the next edge of the rim.
        for (uint32_t g = faces[face].across[edge]; faces[g].mark == visible;
             g = faces[face].across[edge]) {
            unsigned back = 0;
            while (faces[g].vertex[back] != at) {
                back++;
            }
            face = g;
            edge = back;
        }
    } while (at != first);
    return first;
}

/// The lists of the visible faces as one chain, and the faces free again.
static uint32_t take_visible(struct mesh *mesh, uint32_t seed) {
    uint32_t chain = MESH_NONE;
    for (uint32_t f = seed; f != MESH_NONE;) {
        struct mesh_face *const face = &mesh->faces[f];
        const uint32_t following = face->link;
        if (face->head != MESH_NONE) {
            mesh->next[face->tail] = chain;
            chain = face->head;
        }
        drop_face(mesh, f);
        f = following;
    }
    return chain;
}

struct mesh_cap mesh_add(struct mesh *mesh, uint32_t seed, uint32_t point) {
    uint32_t rim_face = seed;
    unsigned rim_edge = 0;
    find_visible(mesh, seed, point, &rim_face, &rim_edge);
    const uint32_t first = follow_rim(mesh, rim_face, rim_edge);
    struct mesh_cap cap = {MESH_NONE, take_visible(mesh, seed)};
    struct mesh_face *const faces = mesh->faces;
    uint32_t last = MESH_NONE, a = first;
    do {
        const uint32_t b = mesh->next[a], beyond = mesh->outside[a];
        const uint32_t f = new_face(mesh, a, b, point);
        faces[f].across[0] = beyond;
        unsigned edge = 0;
        while (faces[beyond].vertex[edge] != b) {
            edge++;
        }
        faces[beyond].across[edge] = f;
        if (last == MESH_NONE) {
            cap.first_face = f;
        } else {
            faces[last].across[1] = f;
            faces[last].link = f;
            faces[f].across[2] = last;
        }
        last = f;
        a = b;
    } while (a != first);
    faces[last].across[1] = cap.first_face;
    faces[cap.first_face].across[2] = last;
    return cap;
}

static void enter_queue(struct mesh *mesh, uint32_t index) {
    struct mesh_face *const face = &mesh->faces[index];
    face->before = mesh->queue_last;
    face->behind = MESH_NONE;
    if (mesh->queue_last != MESH_NONE) {
        mesh->faces[mesh->queue_last].behind = index;
    } else {
        mesh->queue_first = index;
    }
    mesh->queue_last = index;
}

void mesh_hang(struct mesh *mesh, uint32_t index, uint32_t point, int64_t value) {
    struct mesh_face *const face = &mesh->faces[index];
    if (face->head == MESH_NONE) {
        enter_queue(mesh, index);
        face->head = point;
        face->tail = point;
        face->farthest = value;
        mesh->next[point] = MESH_NONE;
        return;
    }
    bool first = value > face->farthest;
    if (value == face->farthest) {
        const int order = side_order(mesh_point(mesh, point), mesh_point(mesh, face->head));
        first = order > 0 || (order == 0 && point < face->head);
    }
    if (first) {
        mesh->next[point] = face->head;
        face->head = point;
        face->farthest = value;
    } else {
        mesh->next[point] = mesh->next[face->head];
        mesh->next[face->head] = point;
        if (face->tail == face->head) {
            face->tail = point;
        }
    }
}

void mesh_share_out(struct mesh *mesh, uint32_t chain, uint32_t first_face, uint32_t skip) {
    const int64_t band = side_band(mesh->range);
    uint64_t tests = 0;
    for (uint32_t q = chain; q != MESH_NONE;) {
        const uint32_t following = mesh->next[q];
        const struct vec3 p = mesh_point(mesh, q);
        for (uint32_t f = first_face; f != MESH_NONE && q != skip; f = mesh->faces[f].link) {
            const struct mesh_face *const face = &mesh->faces[f];
            const int64_t value = side_value(&face->plane, p);
            tests++;
            if (value > band || (value >= -band && decide(mesh, face, q, value) > 0)) {
                mesh_hang(mesh, f, q, value);
                break;
            }
        }
        q = following;
    }
    mesh->side_tests += tests;
}
