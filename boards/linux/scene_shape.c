#include "scene_shape.h"

#include "solid/side.h"

#include <stdlib.h>

/// An edge of a face, from one vertex to the next.
struct edge {
    uint32_t from, to;
};

struct shape {
    struct scene_text *scene;
    const char *file;
    struct scene_detail *detail;
    struct side_range range;
    uint32_t *vertices; ///< of a solid's faces, each once
    uint32_t vertex_count;
};

static struct vec3 corner(const struct shape *s, const struct scene_element *e, uint32_t k) {
    return s->scene->vertices.directions[s->scene->corners[e->first + k]];
}

/// Three corners of a face that are not on one line. False: there are none.
static bool span(const struct shape *s, const struct scene_element *e, struct vec3 out[3]) {
    out[0] = corner(s, e, 0);
    uint32_t k = 1;
    while (k < e->count && vec3_equal(corner(s, e, k), out[0])) {
        k++;
    }
    if (k == e->count) {
        return false;
    }
    out[1] = corner(s, e, k);
    for (k++; k < e->count; k++) {
        out[2] = corner(s, e, k);
        if (!side_collinear(out[0], out[1], out[2])) {
            return true;
        }
    }
    return false;
}

static bool names_twice(const struct shape *s, const struct scene_element *e) {
    const uint32_t *const list = s->scene->corners + e->first;
    for (uint32_t k = 0; k < e->count; k++) {
        for (uint32_t i = 0; i < k && e->count <= 64U; i++) { // of longer ones only neighbours
            if (list[i] == list[k]) {
                return true;
            }
        }
        if (list[k] == list[(k + 1U) % e->count]) {
            return true;
        }
    }
    return false;
}

/// What is wrong with a face for itself; NULL: nothing.
static const char *fault_of_face(const struct shape *s, const struct scene_element *e) {
    struct vec3 p[3];
    if (names_twice(s, e)) {
        return "the face names a vertex twice";
    }
    if (!span(s, e, p)) {
        return "the face has no area: its corners are on one line";
    }
    for (uint32_t k = 0; k < e->count; k++) {
        if (side_exact(p[0], p[1], p[2], corner(s, e, k)) != 0) {
            return s->scene->vertices.places_exact
                       ? "the face is not planar: cut it into triangles"
                       : "the face is not planar once its coordinates are rounded to 27 bits: cut "
                         "it into triangles, or write fewer digits";
        }
    }
    return NULL;
}

static int by_ends(const void *a, const void *b) {
    const struct edge *const p = a, *const q = b;
    if (p->from != q->from) {
        return p->from < q->from ? -1 : 1;
    }
    return p->to != q->to ? (p->to < q->to ? -1 : 1) : 0;
}

/// Each vertex once. edges: in order.
static bool keep_vertices(struct shape *s, const struct edge *edges, uint32_t count) {
    s->vertices = malloc(count * sizeof *s->vertices);
    for (uint32_t i = 0; i < count && s->vertices != NULL; i++) {
        if (i == 0U || edges[i].from != edges[i - 1U].from) {
            s->vertices[s->vertex_count++] = edges[i].from;
        }
    }
    return s->vertices != NULL;
}

/// Is every edge in two faces, once in each direction? Then s->vertices is set. -1: no memory.
static int closes_up(struct shape *s) {
    const struct scene_text *const t = s->scene;
    uint32_t count = 0, faces = 0;
    for (uint32_t i = 0; i < s->detail->element_count; i++) {
        const struct scene_element *const e = &t->elements[s->detail->first_element + i];
        count += e->kind == TREE_FACE ? e->count : 0U;
        faces += e->kind == TREE_FACE ? 1U : 0U;
    }
    if (faces < 4U) {
        return 0;
    }
    struct edge *const edges = malloc(count * sizeof *edges);
    if (edges == NULL) {
        return -1;
    }
    count = 0;
    for (uint32_t i = 0; i < s->detail->element_count; i++) {
        const struct scene_element *const e = &t->elements[s->detail->first_element + i];
        const uint32_t *const list = t->corners + e->first;
        for (uint32_t k = 0; e->kind == TREE_FACE && k < e->count; k++) {
            edges[count++] = (struct edge){list[k], list[(k + 1U) % e->count]};
        }
    }
    qsort(edges, count, sizeof *edges, by_ends);
    bool closed = true;
    for (uint32_t i = 0; i < count && closed; i++) {
        const struct edge back = {edges[i].to, edges[i].from};
        closed = (i == 0U || by_ends(&edges[i - 1U], &edges[i]) != 0) &&
                 bsearch(&back, edges, count, sizeof *edges, by_ends) != NULL;
    }
    const bool kept = !closed || keep_vertices(s, edges, count);
    free(edges);
    return !kept ? -1 : closed ? 1 : 0;
}

/// On which sides of a face's plane are the solid's vertices: bit 0 above, bit 1 below.
static unsigned sides_of(const struct shape *s, const struct scene_element *e) {
    struct vec3 p[3];
    (void)span(s, e, p);
    const struct side_plane plane = side_plane_through(s->range, p[0], p[1], p[2]);
    const int64_t band = side_band(s->range);
    unsigned sides = 0;
    for (uint32_t i = 0; i < s->vertex_count && sides != 3U; i++) {
        const struct vec3 q = s->scene->vertices.directions[s->vertices[i]];
        const int64_t value = side_value(&plane, q);
        const bool sure = plane.exact || value > band || value < -band;
        const int side = sure ? (value > 0) - (value < 0) : side_exact(p[0], p[1], p[2], q);
        sides |= side > 0 ? 1U : side < 0 ? 2U : 0U;
    }
    return sides;
}

/// Does a face turn left at every corner about the normal of three of its corners? If it turns both
/// ways its outline is concave, and three corners of it don't tell which side is out.
static bool turns_one_way(const struct shape *s, const struct scene_element *e, int *way) {
    struct vec3 p[3];
    (void)span(s, e, p);
    const struct vec3_i128 n = vec3_i64_cross(side_between(p[0], p[1]), side_between(p[0], p[2]));
    const int along_x = i128_sign(n.x), along_y = i128_sign(n.y), along_z = i128_sign(n.z);
    *way = 0;
    for (uint32_t k = 0; k < e->count; k++) {
        const struct vec3 a = corner(s, e, k), b = corner(s, e, (k + 1U) % e->count),
                          c = corner(s, e, (k + 2U) % e->count);
        const struct vec3_i128 m = vec3_i64_cross(side_between(a, b), side_between(b, c));
        const int turn = along_x != 0   ? i128_sign(m.x) * along_x
                         : along_y != 0 ? i128_sign(m.y) * along_y
                                        : i128_sign(m.z) * along_z;
        if (turn != 0 && *way != 0 && turn != *way) {
            return false;
        }
        *way = turn != 0 ? turn : *way;
    }
    return true;
}

static void turn_around(const struct shape *s) {
    for (uint32_t i = 0; i < s->detail->element_count; i++) {
        const struct scene_element *const e = &s->scene->elements[s->detail->first_element + i];
        uint32_t *const list = s->scene->corners + e->first;
        for (uint32_t low = 0, high = e->count - 1U; e->kind == TREE_FACE && low < high;
             low++, high--) {
            const uint32_t kept = list[low];
            list[low] = list[high];
            list[high] = kept;
        }
    }
}

/// Convex if every face has all points of the solid on one side, the same for all faces.
static enum exit_status check_solid(struct shape *s) {
    unsigned first = 0;
    for (uint32_t i = 0; i < s->detail->element_count; i++) {
        const struct scene_element *const e = &s->scene->elements[s->detail->first_element + i];
        if (e->kind != TREE_FACE) {
            continue;
        }
        int way;
        unsigned sides = turns_one_way(s, e, &way) ? sides_of(s, e) : 3U;
        if (sides == 1U || sides == 2U) {
            sides = way < 0 ? 3U - sides : sides;
        }
        first = first == 0U ? sides : first;
        if (sides == 0U || sides == 3U || sides != first) {
            message_at(s->file, e->line,
                       sides == 0U ? "the solid is flat"
                                   : "the solid is not convex: this face has corners on both "
                                     "sides; --points leaves faces out");
            return EXIT_STATUS_USAGE;
        }
    }
    if (first == 1U) {
        turn_around(s);
    }
    return EXIT_STATUS_OK;
}

static struct side_range range_of(const struct shape *s) {
    struct vec3 low = vec3(INT32_MAX, INT32_MAX, INT32_MAX),
                high = vec3(INT32_MIN, INT32_MIN, INT32_MIN);
    for (uint32_t i = 0; i < s->vertex_count; i++) {
        const struct vec3 p = s->scene->vertices.directions[s->vertices[i]];
        low = vec3(p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z);
        high = vec3(p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y,
                    p.z > high.z ? p.z : high.z);
    }
    return side_range_of(low, high);
}

/// Faces or only lines? False: told that a face is none.
static bool check_faces(const struct shape *s) {
    s->detail->shape = TREE_LINES;
    for (uint32_t k = 0; k < s->detail->element_count; k++) {
        const struct scene_element *const e = &s->scene->elements[s->detail->first_element + k];
        if (e->kind == TREE_FACE) {
            const char *const fault = fault_of_face(s, e);
            if (fault != NULL) {
                message_at(s->file, e->line, "%s", fault);
                return false;
            }
            s->detail->shape = TREE_FACES;
        }
    }
    return true;
}

static enum exit_status check_detail(struct shape *s) {
    if (!check_faces(s)) {
        return EXIT_STATUS_USAGE;
    }
    const int closed = s->detail->shape == TREE_FACES ? closes_up(s) : 0;
    if (closed < 0) {
        message_at(s->file, s->detail->line, "no memory for this object");
        return EXIT_STATUS_FAILURE;
    }
    if (closed == 0) {
        return EXIT_STATUS_OK;
    }
    s->detail->shape = TREE_SOLID;
    s->range = range_of(s);
    return check_solid(s);
}

enum exit_status scene_shape_check(struct scene_text *scene, const char *file) {
    for (uint32_t i = 0; i < scene->detail_count; i++) {
        struct shape s = {.scene = scene, .file = file, .detail = &scene->details[i]};
        const enum exit_status status =
            s.detail->element_count != 0U ? check_detail(&s) : EXIT_STATUS_OK;
        free(s.vertices);
        if (status != EXIT_STATUS_OK) {
            return status;
        }
    }
    return EXIT_STATUS_OK;
}
