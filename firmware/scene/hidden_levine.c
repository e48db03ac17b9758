/// The thesis' pipeline: invisibility of a first vertex, then crossings with outlines in the
/// picture, which count it up and down along the edges; it is handed on from edge to edge.
///
/// A pair of an edge and an outline with a vertex of one exactly on the line of the other has no
/// plain crossings; there, and where something reaches the plane of the eye, the edge is clipped by
/// the shadow instead. An object that a vertex is on the border of does not hide the vertex; with
/// that, what is handed on is exact, too.
#include "scene/hidden.h"

#include "fixed/sort.h"

/// Objects that may hide the one in work: in hidden->near. With this bit, by clipping only.
#define CLIP_ONLY UINT32_C(0x80000000)

struct work {
    struct hidden *h;
    const struct separate *separate;
    struct hidden_counters *counters;
    uint32_t object, near_count;
    uint32_t considered; ///< objects that potentially hide this one, by SO
    uint32_t crossing_count;
};

static struct i128 determinant(struct vec3 a, struct vec3 b, struct vec3 c) {
    return vec3_i64_dot_vec3(vec3_cross(a, b), c);
}

/// An edge of an outline, with the inside to the left of the way from a to b as the eye sees it.
struct side {
    const struct hidden_vertex *a, *b;
};

static struct side outline_side(const struct hidden *h, uint32_t object, uint32_t index) {
    const struct shape_set *const set = h->set;
    const struct hidden_object *const o = &h->objects[object];
    const struct shape_edge *const edge = &set->edges[h->extremes[o->first_extreme + index]];
    const uint32_t face = edge->left == SHAPE_NONE ? set->objects[object].first_face : edge->left;
    const bool forward = shape_side(&set->planes[face], h->camera.eye) > 0;
    const struct hidden_vertex *const from = &h->vertices[edge->from], *const to =
                                                                           &h->vertices[edge->to];
    return forward ? (struct side){from, to} : (struct side){to, from};
}

/// Do all pieces of a plane turn the same side to the eye? (A bent one's might not.)
static bool faces_one_way(const struct hidden *h, uint32_t object) {
    const struct shape_object *const o = &h->set->objects[object];
    const int first = shape_side(&h->set->planes[o->first_face], h->camera.eye);
    for (uint32_t f = o->first_face; o->kind == SHAPE_PLANE && f < o->first_face + o->face_count;
         f++) {
        if (shape_side(&h->set->planes[f], h->camera.eye) != first) {
            return false;
        }
    }
    return true;
}

/// Does a place lie in the plane of a polygon? Then that is no depth between the two.
static bool is_in_plane(const struct hidden *h, uint32_t object, const struct hidden_vertex *v) {
    const struct shape_object *const o = &h->set->objects[object];
    const struct vec3 place = h->set->vertices[v - h->vertices];
    for (uint32_t f = o->first_face; o->kind == SHAPE_PLANE && f < o->first_face + o->face_count;
         f++) {
        if (shape_side(&h->set->planes[f], place) == 0) {
            return true;
        }
    }
    return false;
}

static void consider(struct work *w, uint32_t other) {
    struct hidden *const h = w->h;
    const enum separate_order order = separate_order(w->separate, w->object, other);
    if (order == SEPARATE_BEHIND) {
        w->considered++;
    } else if (order != SEPARATE_UNKNOWN) {
        return;
    }
    if (h->objects[other].piece_count != 0U &&
        hidden_windows_meet(&h->objects[w->object].window, &h->objects[other].window)) {
        const bool clip =
            order == SEPARATE_UNKNOWN || !h->objects[other].in_front || !faces_one_way(h, other);
        h->near[w->near_count++] = other | (clip ? CLIP_ONLY : 0U);
    }
}

/// Step 1 for one object: row `object` of SO, and of its entries those whose windows meet.
static void find_hiders(struct work *w) {
    struct hidden *const h = w->h;
    w->near_count = w->considered = 0;
    if (w->counters != NULL) {
        for (uint32_t m = 0; m < h->set->object_count; m++) {
            if (m != w->object && h->objects[m].seen) {
                consider(w, m);
            }
        }
        return;
    }
    const uint32_t count = hidden_neighbours(h, w->object);
    for (uint32_t k = 0; k < count; k++) { // in place: never ahead of k
        consider(w, h->near[k]);
    }
}

// ---------------------------------------------------------------- step 5

static bool shadow_hides(const struct hidden *h, uint32_t object, struct vec3 place) {
    const struct hidden_object *const o = &h->objects[object];
    for (uint32_t i = o->first_piece; i < o->first_piece + o->piece_count; i++) {
        if (sight_hides(&h->sight, &h->sight.pieces[i], place)) {
            return true;
        }
    }
    return false;
}

/// Sign of the height of a over b in the picture.
static int above(const struct hidden_vertex *a, const struct hidden_vertex *b) {
    return i128_cmp(i128_mul(a->height, b->depth), i128_mul(b->height, a->depth));
}

static struct hidden_window point_window(const struct hidden_vertex *v) {
    return (struct hidden_window){v->x - HIDDEN_SLACK, v->x + HIDDEN_SLACK, v->y - HIDDEN_SLACK,
                                  v->y + HIDDEN_SLACK};
}

static struct hidden_window side_window(const struct side *side) {
    struct hidden_window a = point_window(side->a);
    const struct hidden_window b = point_window(side->b);
    a.left = b.left < a.left ? b.left : a.left;
    a.right = b.right > a.right ? b.right : a.right;
    a.low = b.low < a.low ? b.low : a.low;
    a.high = b.high > a.high ? b.high : a.high;
    return a;
}

/// Is the vertex inside the outline: does a ray to the right cross it an odd number of times? Sides
/// wholly above the ray are not looked at. A vertex that may be on a side is decided by the shadow.
static bool outline_holds(struct work *w, uint32_t object, const struct hidden_vertex *v) {
    const struct hidden *const h = w->h;
    const struct hidden_window point = point_window(v);
    uint64_t computed = 0;
    bool inside = false, touches = is_in_plane(h, object, v);
    for (uint32_t i = 0; i < h->objects[object].extreme_count; i++) {
        const struct side side = outline_side(h, object, i);
        const bool a_above = above(side.a, v) > 0, b_above = above(side.b, v) > 0;
        if (a_above && b_above) {
            continue;
        }
        computed++;
        const int sign = i128_sign(determinant(side.a->place, side.b->place, v->place));
        const struct hidden_window window = side_window(&side);
        touches = touches || (sign == 0 && hidden_windows_meet(&window, &point));
        // The side passes the ray's height, and the vertex is on its left.
        if (a_above != b_above && (b_above ? sign < 0 : sign > 0)) {
            inside = !inside;
        }
    }
    if (w->counters != NULL) {
        w->counters->start_windows++;
        w->counters->start_edges += h->objects[object].extreme_count;
        w->counters->start_intersections += computed;
    }
    return touches ? shadow_hides(h, object, v->place) : inside;
}

/// How many objects hide a vertex: step 5.
static int32_t invisibility(struct work *w, uint32_t vertex) {
    const struct hidden *const h = w->h;
    const struct hidden_vertex *const v = &h->vertices[vertex];
    int32_t count = 0;
    if (w->counters != NULL) {
        w->counters->start_objects += w->considered;
    }
    for (uint32_t k = 0; k < w->near_count; k++) {
        const uint32_t other = h->near[k] & ~CLIP_ONLY;
        const struct hidden_window point = point_window(v);
        if ((h->near[k] & CLIP_ONLY) != 0U || v->depth <= 0) {
            count += shadow_hides(h, other, v->place) ? 1 : 0;
        } else if (hidden_windows_meet(&point, &h->objects[other].window)) {
            count += outline_holds(w, other, v) ? 1 : 0;
        }
    }
    return count;
}

// ---------------------------------------------------------------- step 6

/// Crossings of an edge with an outline. False: a vertex is on the line of the other.
static bool cross_outline(struct work *w, uint32_t object, const struct hidden_vertex *from,
                          const struct hidden_vertex *to, const struct hidden_window *window) {
    struct hidden *const h = w->h;
    const uint32_t first = w->crossing_count;
    const struct vec3_i64 line = vec3_cross(from->place, to->place);
    uint64_t computed = 0;
    bool plain = !is_in_plane(h, object, from) && !is_in_plane(h, object, to);
    for (uint32_t i = 0; plain && i < h->objects[object].extreme_count; i++) {
        const struct side side = outline_side(h, object, i);
        const struct hidden_window rectangle = side_window(&side);
        if (!hidden_windows_meet(&rectangle, window)) {
            continue;
        }
        computed++;
        const struct vec3_i64 other = vec3_cross(side.a->place, side.b->place);
        const struct i128 at_from = vec3_i64_dot_vec3(other, from->place),
                          at_to = vec3_i64_dot_vec3(other, to->place);
        const int sign_from = i128_sign(at_from), sign_to = i128_sign(at_to),
                  sign_a = i128_sign(vec3_i64_dot_vec3(line, side.a->place)),
                  sign_b = i128_sign(vec3_i64_dot_vec3(line, side.b->place));
        plain = sign_from != 0 && sign_to != 0 && sign_a != 0 && sign_b != 0;
        if (plain && sign_from != sign_to && sign_a != sign_b) {
            const struct fraction at =
                sign_from > 0 ? (struct fraction){at_from, i128_sub(at_from, at_to)}
                              : (struct fraction){i128_neg(at_from), i128_sub(at_to, at_from)};
            h->crossings[w->crossing_count++] =
                (struct hidden_crossing){at, sign_from > 0 ? 1 : -1};
        }
    }
    if (w->counters != NULL) {
        w->counters->line_edges += h->objects[object].extreme_count;
        w->counters->line_intersections += computed;
        w->counters->line_actual += w->crossing_count - first;
    }
    w->crossing_count = plain ? w->crossing_count : first;
    return plain;
}

static bool is_earlier(const void *context, uint32_t a, uint32_t b) {
    const struct hidden_crossing *const crossings = context;
    return fraction_cmp(crossings[a].at, crossings[b].at) < 0;
}

/// Follows the sorted crossings: what lies where the count is above 0 is hidden. Returns the count
/// at the end.
static int32_t follow(struct work *w, int32_t count) {
    struct hidden *const h = w->h;
    struct fraction since = fraction_whole(0);
    for (uint32_t i = 0; i < w->crossing_count; i++) {
        h->crossing_order[i] = i;
    }
    sort_indices(h->crossing_order, h->crossing_spare, w->crossing_count, is_earlier, h->crossings);
    for (uint32_t i = 0; i <= w->crossing_count; i++) {
        const bool last = i == w->crossing_count;
        const struct hidden_crossing *const crossing =
            last ? NULL : &h->crossings[h->crossing_order[i]];
        const struct fraction at = last ? fraction_whole(1) : crossing->at;
        if (count > 0 && fraction_cmp(since, at) < 0) {
            span_list_add(&h->spans, (struct span){since, at});
        }
        since = at;
        count += last ? 0 : crossing->change;
    }
    return count;
}

/// Step 6 for an edge, from a vertex whose invisibility is known. Returns that of the other end.
static int32_t draw_edge(struct work *w, uint32_t edge_index, bool backwards, int32_t count,
                         const struct hidden_sink *sink) {
    struct hidden *const h = w->h;
    const struct shape_edge *const edge = &h->set->edges[edge_index];
    const struct hidden_vertex *const from = &h->vertices[edge->from], *const to =
                                                                           &h->vertices[edge->to];
    const struct hidden_window window = hidden_edge_window(h, edge);
    const bool whole = from->depth > 0 && to->depth > 0;
    const bool some = hidden_begin_edge(h, edge);
    int32_t clipped_at_end = 0;
    w->crossing_count = 0;
    for (uint32_t k = 0; k < w->near_count; k++) {
        const uint32_t other = h->near[k] & ~CLIP_ONLY;
        if (!hidden_windows_meet(&window, &h->objects[other].window)) {
            continue;
        }
        if (w->counters != NULL) {
            w->counters->line_windows++;
        }
        if (whole && (h->near[k] & CLIP_ONLY) == 0U && cross_outline(w, other, from, to, &window)) {
            continue;
        }
        // The count goes on without this one.
        count -= shadow_hides(h, other, backwards ? to->place : from->place) ? 1 : 0;
        clipped_at_end += shadow_hides(h, other, backwards ? from->place : to->place) ? 1 : 0;
        if (some) {
            (void)hidden_add_shadow(h, other, edge);
        }
        if (w->counters != NULL) {
            w->counters->clipped_pairs++;
        }
    }
    if (backwards) { // the crossings are counted from the edge's own beginning
        for (uint32_t i = 0; i < w->crossing_count; i++) {
            count -= h->crossings[i].change;
        }
    }
    const int32_t at_begin = count, at_end = follow(w, count);
    if (some && edge->drawn) {
        hidden_end_edge(h, w->object, edge_index, sink);
    }
    if (w->counters != NULL) {
        w->counters->edges++;
        w->counters->line_objects += w->considered;
    }
    return (backwards ? at_begin : at_end) + clipped_at_end;
}

// ---------------------------------------------------------------- an object

#define UNKNOWN (-1)

/// Draws the edges that begin or end where the invisibility is known; in one direction through the
/// list. `start`: the first edge of which neither is known gets it worked out. False: none was
/// drawn.
static bool draw_some(struct work *w, uint8_t *done, bool start, bool upwards,
                      const struct hidden_sink *sink) {
    struct hidden *const h = w->h;
    const struct shape_object *const o = &h->set->objects[w->object];
    bool any = false;
    for (uint32_t i = 0; i < o->edge_count; i++) {
        const uint32_t e = upwards ? i : o->edge_count - 1U - i;
        const struct shape_edge *const edge = &h->set->edges[o->first_edge + e];
        int32_t *const from = &h->invisible[edge->from - o->first_vertex],
                       *const to = &h->invisible[edge->to - o->first_vertex];
        if (done[o->first_edge + e] != 0U) {
            continue;
        }
        if (*from == UNKNOWN && *to == UNKNOWN) {
            if (!start) {
                continue;
            }
            *from = invisibility(w, edge->from);
            start = false;
        }
        const bool backwards = *from == UNKNOWN;
        const int32_t end =
            draw_edge(w, o->first_edge + e, backwards, backwards ? *to : *from, sink);
        *(backwards ? from : to) = end;
        done[o->first_edge + e] = 1;
        any = true;
    }
    return any;
}

static void draw_object(struct work *w, const struct hidden_sink *sink) {
    struct hidden *const h = w->h;
    const struct shape_object *const o = &h->set->objects[w->object];
    uint8_t *const done = h->edge_done;
    for (uint32_t e = o->first_edge; e < o->first_edge + o->edge_count; e++) {
        const struct hidden_window window = hidden_edge_window(h, &h->set->edges[e]);
        done[e] =
            h->edge_class[e] == HIDDEN_BACK || !hidden_windows_meet(&window, &h->border) ? 1 : 0;
    }
    for (uint32_t v = 0; v < o->vertex_count; v++) {
        h->invisible[v] = UNKNOWN;
    }
    find_hiders(w);
    for (bool upwards = true; draw_some(w, done, true, upwards, sink); upwards = !upwards) {
        // Step 6 goes on from vertex to vertex; where the edges are not connected, step 5 again.
        while (draw_some(w, done, false, !upwards, sink)) {
            upwards = !upwards;
        }
    }
}

void hidden_levine(struct hidden *hidden, const struct separate *separate,
                   const struct hidden_sink *sink, struct hidden_counters *counters) {
    struct work work = {.h = hidden, .separate = separate, .counters = counters};
    if (counters != NULL) {
        counters->front_faces += hidden->front_faces;
    }
    for (work.object = 0; work.object < hidden->set->object_count; work.object++) {
        if (hidden->objects[work.object].seen) {
            draw_object(&work, sink);
        }
    }
}
