#include "sphere/pyramid.h"

#include "sphere/cone_settle.h"
#include "sphere/witness.h"

struct pyramid {
    const struct vec3 *points;
    struct pyramid_face *face; // a ring, in any order of the array
    struct site *site;         // the edges in order, once the pyramid is complete
    uint32_t face_count, faces_max;
    uint32_t first, free; // heads of the ring and of the list of faces that are not in it
    struct pyramid_result *result;
};

#define NO_FACE UINT32_MAX

static bool is_zero(struct vec3_i64 a) {
    return (a.x | a.y | a.z) == 0;
}

// ---------------------------------------------------------------- until three are not in one plane

/// For a and b in the plane with that normal: 1 if b is counter-clockwise of a by less than a half
/// turn, -1 if clockwise, 0 if parallel.
static int turn(struct vec3 a, struct vec3 b, struct vec3_i64 normal) {
    const struct vec3_i64 cross = vec3_cross(a, b);
    return is_zero(cross) ? 0 : (witness_same_sense(cross, normal) ? 1 : -1);
}

static enum cone_status surrounded(struct pyramid *pyramid, const uint32_t *candidates,
                                   uint8_t count) {
    uint32_t witness[4];
    const uint8_t size = witness_find(pyramid->points, candidates, count, witness);
    return cone_settle_witness(pyramid->points, witness, size, &pyramid->result->cone);
}

/// The ends of the arc that the first points span, arc[0] to arc[1] counter-clockwise about its
/// normal, up to the first point that is not in their plane: *next. A single direction has equal
/// ends.
static enum cone_status span_arc(struct pyramid *pyramid, uint32_t count, uint32_t arc[2],
                                 uint32_t *next) {
    const struct vec3 *p = pyramid->points;
    struct vec3_i64 normal = {0, 0, 0};
    arc[0] = arc[1] = 0;
    for (uint32_t i = 1; i < count; i++) {
        const uint32_t candidates[3] = {arc[0], i, arc[1]};
        if (arc[0] == arc[1]) {
            normal = vec3_cross(p[0], p[i]);
            if (!is_zero(normal)) {
                arc[1] = i;
            } else if (i128_sign(vec3_dot(p[0], p[i])) < 0) {
                return surrounded(pyramid, candidates, 2);
            }
            continue;
        }
        if (i128_sign(vec3_i64_dot_vec3(normal, p[i])) != 0) {
            *next = i;
            return CONE_OK;
        }
        const int after = turn(p[arc[0]], p[i], normal), before = turn(p[i], p[arc[1]], normal);
        if (after > 0 && before < 0) {
            arc[1] = i;
        } else if (after < 0 && before > 0) {
            arc[0] = i;
        } else if (after + before < 0) { // on the opposite arc, or an end's opposite
            return surrounded(pyramid, candidates, 3);
        }
    }
    *next = count;
    return CONE_OK;
}

// ---------------------------------------------------------------- the pyramid

static void set_face(struct pyramid *pyramid, uint32_t at, uint32_t edge, uint32_t next) {
    struct pyramid_face *face = &pyramid->face[at];
    face->edge = edge;
    face->next = next;
    face->normal = vec3_cross(pyramid->points[edge], pyramid->points[pyramid->face[next].edge]);
}

static void start_pyramid(struct pyramid *pyramid, const uint32_t edge[3]) {
    for (uint32_t i = 0; i < 3U; i++) {
        pyramid->face[i].edge = edge[i];
    }
    for (uint32_t i = 0; i < 3U; i++) {
        set_face(pyramid, i, edge[i], (i + 1U) % 3U);
    }
    pyramid->face_count = 3;
    pyramid->first = 0;
    pyramid->free = NO_FACE;
}

/// A slot for one more face; NO_FACE if there is no room.
static uint32_t take_face(struct pyramid *pyramid) {
    const uint32_t at = pyramid->free;
    if (at != NO_FACE) {
        pyramid->free = pyramid->face[at].next;
        return at;
    }
    // Without a free slot the faces fill the array from its beginning.
    return pyramid->face_count < pyramid->faces_max ? pyramid->face_count : NO_FACE;
}

/// Notes on which side of each face the point is. Returns whether it is outside of any and inside
/// of any.
static void take_sides(struct pyramid *pyramid, uint32_t index, bool *any_outside,
                       bool *any_inside) {
    *any_outside = *any_inside = false;
    uint32_t at = pyramid->first;
    do {
        struct pyramid_face *face = &pyramid->face[at];
        const int side = i128_sign(vec3_i64_dot_vec3(face->normal, pyramid->points[index]));
        face->side = (int8_t)side;
        *any_outside = *any_outside || side < 0;
        *any_inside = *any_inside || side > 0;
        pyramid->result->face_tests++;
        at = face->next;
    } while (at != pyramid->first);
}

/// The point is in the closed opposite of the pyramid: some triangle of its fan, turned around,
/// holds it.
static enum cone_status surrounded_by_fan(struct pyramid *pyramid, uint32_t index) {
    const struct pyramid_face *face = pyramid->face;
    const uint32_t apex = face[pyramid->first].edge;
    for (uint32_t at = face[pyramid->first].next;; at = face[at].next) {
        const uint32_t candidates[4] = {apex, face[at].edge, face[face[at].next].edge, index};
        uint32_t witness[4];
        const uint8_t size = witness_find(pyramid->points, candidates, 4, witness);
        if (size != 0U || face[at].next == pyramid->first) {
            return cone_settle_witness(pyramid->points, witness, size, &pyramid->result->cone);
        }
    }
}

/// Replaces the faces that have the point outside, and a coplanar one at either end of their run,
/// by two faces with the point between. False: no room.
static bool add_edge(struct pyramid *pyramid, uint32_t index) {
    struct pyramid_face *face = pyramid->face;
    uint32_t before = pyramid->first; // the face that stays, in front of the run
    while (face[before].side <= 0 || face[face[before].next].side > 0) {
        before = face[before].next;
    }
    const uint32_t from = face[before].next;
    uint32_t end = face[from].next;
    while (face[end].side <= 0) { // the run's other faces make room
        const uint32_t gone = end;
        end = face[end].next;
        face[gone].next = pyramid->free;
        pyramid->free = gone;
        pyramid->face_count--;
    }
    const uint32_t added = take_face(pyramid);
    if (added == NO_FACE) {
        return false;
    }
    pyramid->face_count++;
    set_face(pyramid, added, index, end);
    set_face(pyramid, from, face[from].edge, added);
    pyramid->first = before;
    return true;
}

static enum cone_status add_point(struct pyramid *pyramid, uint32_t index) {
    bool outside, inside;
    take_sides(pyramid, index, &outside, &inside);
    if (!inside) {
        return surrounded_by_fan(pyramid, index);
    }
    if (outside && !add_edge(pyramid, index)) {
        return CONE_ERROR_WORKSPACE;
    }
    struct pyramid_result *result = pyramid->result;
    result->edges_most =
        pyramid->face_count > result->edges_most ? pyramid->face_count : result->edges_most;
    return CONE_OK;
}

// ---------------------------------------------------------------- pair or triple

/// Copies the edges into `site`, in order.
static void list_sites(struct pyramid *pyramid) {
    uint32_t at = pyramid->first;
    for (uint32_t i = 0; i < pyramid->face_count; i++) {
        pyramid->site[i] = site_from(pyramid->points[pyramid->face[at].edge]);
        at = pyramid->face[at].next;
    }
}

/// The index of the point that is the edge at a place in the order.
static uint32_t point_of(const struct pyramid *pyramid, uint32_t place) {
    uint32_t at = pyramid->first;
    for (uint32_t i = 0; i < place; i++) {
        at = pyramid->face[at].next;
    }
    return pyramid->face[at].edge;
}

/// The two edges that are farthest apart; does the cone around them hold all others?
static bool solve_pair(const struct pyramid *pyramid, uint32_t place[3]) {
    const struct site *site = pyramid->site;
    place[0] = 0;
    place[1] = 1;
    for (uint32_t i = 0; i < pyramid->face_count; i++) {
        for (uint32_t j = i + 1U; j < pyramid->face_count; j++) {
            if (site_distance_cmp(&site[i], &site[j], &site[place[0]], &site[place[1]]) > 0) {
                place[0] = i;
                place[1] = j;
            }
        }
    }
    for (uint32_t i = 0; i < pyramid->face_count; i++) {
        if (i != place[0] && i != place[1] &&
            site_cap_sign(&site[place[0]], &site[place[1]], &site[i]) > 0) {
            return false;
        }
    }
    return true;
}

/// Without an obtuse angle, and with all other edges inside the circle: then its cone is the
/// narrowest. The edges are in counter-clockwise order, so inside is the positive side.
static bool triple_holds_all(const struct pyramid *pyramid, uint32_t i, uint32_t j, uint32_t k) {
    const struct site *site = pyramid->site;
    pyramid->result->triples++;
    if (site_cap_sign(&site[i], &site[j], &site[k]) < 0 ||
        site_cap_sign(&site[j], &site[k], &site[i]) < 0 ||
        site_cap_sign(&site[k], &site[i], &site[j]) < 0) {
        return false;
    }
    for (uint32_t other = 0; other < pyramid->face_count; other++) {
        if (other != i && other != j && other != k &&
            site_plane_sign(&site[i], &site[j], &site[k], &site[other]) < 0) {
            return false;
        }
    }
    return true;
}

static bool solve_triple(const struct pyramid *pyramid, uint32_t place[3]) {
    for (uint32_t i = 0; i < pyramid->face_count; i++) {
        for (uint32_t j = i + 1U; j < pyramid->face_count; j++) {
            for (uint32_t k = j + 1U; k < pyramid->face_count; k++) {
                if (triple_holds_all(pyramid, i, j, k)) {
                    place[0] = i;
                    place[1] = j;
                    place[2] = k;
                    return true;
                }
            }
        }
    }
    return false; // does not happen: the narrowest cone has two or three such edges
}

/// The support of the complete pyramid, as indices of points; its size.
static uint8_t solve_pyramid(struct pyramid *pyramid, uint32_t support[3]) {
    uint32_t place[3];
    list_sites(pyramid);
    pyramid->result->edges = pyramid->face_count;
    pyramid->result->by_pair = solve_pair(pyramid, place);
    uint8_t size = 2;
    if (!pyramid->result->by_pair) {
        size = solve_triple(pyramid, place) ? 3 : 0;
    }
    for (uint8_t i = 0; i < size; i++) {
        support[i] = point_of(pyramid, place[i]);
    }
    return size;
}

static enum cone_status solve(struct pyramid *pyramid, uint32_t count, uint32_t support[3],
                              uint8_t *size) {
    uint32_t next = count;
    const enum cone_status spanned = span_arc(pyramid, count, support, &next);
    if (spanned != CONE_OK) {
        return spanned;
    }
    if (next == count) {
        *size = support[0] == support[1] ? 1 : 2;
        pyramid->result->edges = pyramid->result->edges_most = *size;
        pyramid->result->by_pair = *size == 2U;
        return CONE_OK;
    }
    if (pyramid->faces_max < 3U) {
        return CONE_ERROR_WORKSPACE;
    }
    const struct vec3 *p = pyramid->points;
    const bool ahead = vec3_det_sign(p[support[0]], p[support[1]], p[next]) > 0;
    const uint32_t edge[3] = {support[ahead ? 0 : 1], support[ahead ? 1 : 0], next};
    start_pyramid(pyramid, edge);
    pyramid->result->edges_most = 3;
    for (uint32_t i = next + 1U; i < count; i++) {
        const enum cone_status added = add_point(pyramid, i);
        if (added != CONE_OK) {
            return added;
        }
    }
    *size = solve_pyramid(pyramid, support);
    return CONE_OK;
}

enum cone_status pyramid_narrowest(const struct vec3 *points, uint32_t count, void *workspace,
                                   size_t workspace_bytes, struct pyramid_result *result) {
    *result = (struct pyramid_result){0};
    const enum cone_status start = cone_settle_start(points, count, &result->cone);
    if (start != CONE_OK) {
        return start;
    }
    const size_t room = workspace_bytes / PYRAMID_WORKSPACE_BYTES(1);
    result->edges_max = room > UINT32_MAX ? UINT32_MAX : (uint32_t)room;
    struct site *site = workspace;
    struct pyramid pyramid = {.points = points,
                              .site = site,
                              .face = (struct pyramid_face *)(void *)(site + result->edges_max),
                              .faces_max = result->edges_max,
                              .free = NO_FACE,
                              .result = result};
    uint32_t support[3] = {0, 0, 0};
    uint8_t size = 0;
    const enum cone_status status = solve(&pyramid, count, support, &size);
    result->cone.point_reads += count;
    return status == CONE_OK ? cone_settle_support(points, count, support, size, &result->cone)
                             : status;
}
