#include "sphere/voronoi_mesh.h"

#include <stdbool.h>

// The diagrams of the paper in their dual form. A Voronoi region is a site with the ring of its
// edges, counter- clockwise; an edge between two regions is a pair of half-edges h and h ^ 1. A
// vertex is a triangle of the rings. The curve P is found as the sequence of its edges: each lies
// between a region of X and one of Y, and ends where P leaves one of the two, at a vertex of the
// merged diagram.

enum { AFTER, BEFORE }; // counter-clockwise, clockwise

struct half_edge {
    uint32_t to;      // the site across the edge
    uint32_t link[2]; // around the site it belongs to; VORONOI_NONE: taken out of the ring
};

/// One of the two sides of P.
struct bank {
    unsigned ahead;    // the way in which P turns around a site: AFTER for X, BEFORE for Y
    uint32_t from, to; // its sites
    uint32_t site, start_site;
    uint32_t arrival; // edge of the ring over which P came to the site; VORONOI_NONE at the start
    uint32_t first;   // the edge that was ahead of it then
    uint32_t edge;    // the one over which P may leave
    uint32_t anchor;  // start site: the edge behind which P starts
    uint32_t last;    // the last edge of P at this site
};

struct merge {
    struct voronoi_mesh *mesh;
    struct half_edge *half;
    uint32_t *any;   // by site: an edge of its ring, or VORONOI_NONE
    uint32_t *dead;  // edges that P cut off, to be taken out once it is closed
    uint32_t *spare; // edges that are free
    uint32_t dead_count, spare_count, edge_count, edges_max;
    struct bank bank[2];
};

static void link_behind(struct merge *m, unsigned way, uint32_t h, uint32_t next) {
    m->half[h].link[way] = next;
    m->half[next].link[1U - way] = h;
}

/// A new edge between two sites, in neither ring; its half at a. VORONOI_NONE: no room, which the
/// bound excludes.
static uint32_t take_edge(struct merge *m, uint32_t a, uint32_t b) {
    uint32_t edge;
    if (m->spare_count != 0U) {
        edge = m->spare[--m->spare_count];
    } else if (m->edge_count < m->edges_max) {
        edge = m->edge_count++;
    } else {
        return VORONOI_NONE;
    }
    const uint32_t h = 2U * edge;
    m->half[h] = (struct half_edge){b, {h, h}};
    m->half[h + 1U] = (struct half_edge){a, {h + 1U, h + 1U}};
    return h;
}

static bool is_of(const struct bank *bank, uint32_t site) {
    return site >= bank->from && site < bank->to;
}

/// Is the vertex of the bank's own diagram that lies between two edges of a ring, the second ahead
/// of the first, beyond P: closer to the site `other` than to its own?
static bool is_cut(struct merge *m, const struct bank *bank, uint32_t edge, uint32_t next,
                   uint32_t other) {
    const uint32_t a = m->half[edge].to, b = m->half[next].to;
    return bank->ahead == AFTER ? voronoi_side(m->mesh, bank->site, a, b, other) > 0
                                : voronoi_side(m->mesh, bank->site, b, a, other) > 0;
}

// ---------------------------------------------------------------- the start of P

/// The site of the range that is nearest to a given one.
static uint32_t nearest(struct merge *m, uint32_t site, const struct bank *bank) {
    const struct site *const s = m->mesh->site;
    uint32_t best = bank->from;
    for (uint32_t i = bank->from + 1U; i < bank->to; i++) {
        m->mesh->side_tests++;
        if (site_distance_cmp(&s[site], &s[i], &s[site], &s[best]) < 0) {
            best = i;
        }
    }
    return best;
}

/// Two sites each of which is the other's nearest beyond P: P passes through the middle of them. By
/// whole scans; walks along the hull in one direction, as the paper proposes, miss it.
static void find_start(struct merge *m) {
    struct bank *const x = &m->bank[0], *const y = &m->bank[1];
    const struct site *const s = m->mesh->site;
    uint32_t a = x->from, b = nearest(m, a, y);
    for (;;) {
        const uint32_t closer_a = nearest(m, b, x);
        if (site_distance_cmp(&s[b], &s[closer_a], &s[b], &s[a]) == 0) {
            break;
        }
        a = closer_a;
        const uint32_t closer_b = nearest(m, a, y);
        if (site_distance_cmp(&s[a], &s[closer_b], &s[a], &s[b]) == 0) {
            break;
        }
        b = closer_b;
    }
    x->site = x->start_site = a;
    y->site = y->start_site = b;
}

/// The place in the start site's ring where P starts: behind the anchor, at a vertex that P cuts
/// off.
static bool find_anchor(struct merge *m, struct bank *bank, uint32_t other) {
    bank->arrival = bank->last = VORONOI_NONE;
    bank->anchor = bank->edge = bank->first = m->any[bank->site];
    if (bank->anchor == VORONOI_NONE) {
        return true; // a single site
    }
    for (uint32_t h = bank->anchor;;) {
        const uint32_t next = m->half[h].link[bank->ahead];
        if (next == h || is_cut(m, bank, h, next, other)) {
            bank->anchor = h;
            bank->edge = bank->first = next;
            return true;
        }
        h = next;
        if (h == bank->anchor) {
            return false;
        }
    }
}

// ---------------------------------------------------------------- along P

/// Passes the edges of the region that P has cut off, up to the one over which it may leave.
static void pass_cut(struct merge *m, struct bank *bank, uint32_t other) {
    for (;;) {
        const uint32_t h = bank->edge, next = m->half[h].link[bank->ahead];
        // The vertices behind the anchor, and those between edges of P, are known to be cut off;
        // but then so is a part of the edge, and P leaves over what is left, if it does.
        if ((bank->site == bank->start_site && h == bank->anchor) || next == h ||
            !is_of(bank, m->half[h].to) || !is_of(bank, m->half[next].to) ||
            !is_cut(m, bank, h, next, other)) {
            return;
        }
        bank->edge = next;
    }
}

/// The site to which P may go over on this bank; VORONOI_NONE: none.
static uint32_t next_of(struct merge *m, struct bank *bank, uint32_t other) {
    if (bank->edge == VORONOI_NONE) {
        return VORONOI_NONE;
    }
    pass_cut(m, bank, other);
    const uint32_t site = m->half[bank->edge].to;
    return is_of(bank, site) ? site : VORONOI_NONE;
}

/// Appends an edge of P to the ring of the bank's site.
static void append(struct merge *m, struct bank *bank, uint32_t h) {
    if (bank->last != VORONOI_NONE) {
        link_behind(m, bank->ahead, bank->last, h);
    } else if (bank->arrival != VORONOI_NONE) {
        link_behind(m, bank->ahead, bank->arrival, h);
    }
    bank->last = h;
    m->any[bank->site] = h;
}

/// Takes the half-edges from h up to `end`, exclusive, out of the ring: P has cut their edges off.
static void cut_off(struct merge *m, const struct bank *bank, uint32_t h, uint32_t end) {
    while (h != end) {
        const uint32_t next = m->half[h].link[bank->ahead];
        m->half[h].link[AFTER] = m->half[h].link[BEFORE] = VORONOI_NONE;
        m->dead[m->dead_count++] = h;
        h = next;
    }
}

/// P goes over to the site across the bank's edge.
static void cross(struct merge *m, struct bank *bank) {
    const uint32_t leave = bank->edge;
    cut_off(m, bank, bank->first, leave);
    link_behind(m, bank->ahead, bank->last, leave);
    bank->site = m->half[leave].to;
    bank->arrival = leave ^ 1U;
    bank->first = bank->edge = m->half[bank->arrival].link[bank->ahead];
    if (bank->site == bank->start_site && bank->arrival == bank->anchor) {
        bank->edge = VORONOI_NONE; // next is where P started
    }
    bank->last = VORONOI_NONE;
}

/// P is back at the start site, with `start` its first edge there.
static void close_ring(struct merge *m, struct bank *bank, uint32_t start) {
    const uint32_t behind = bank->last != VORONOI_NONE ? bank->last : bank->arrival;
    if (bank->arrival != VORONOI_NONE && bank->arrival != bank->anchor) {
        cut_off(m, bank, bank->first, bank->anchor);
        cut_off(m, bank, bank->anchor, m->half[bank->anchor].link[bank->ahead]);
    }
    link_behind(m, bank->ahead, behind, start);
}

/// Frees the edges that P cut off: it has taken both halves out of their rings. False: only one.
static bool free_dead(struct merge *m) {
    for (uint32_t i = 0; i < m->dead_count; i++) {
        const uint32_t h = m->dead[i], twin = h ^ 1U;
        if (m->half[h].to == VORONOI_NONE) {
            continue; // freed by way of its other half
        }
        if (m->half[twin].link[AFTER] != VORONOI_NONE) {
            return false;
        }
        m->half[h].to = m->half[twin].to = VORONOI_NONE;
        m->spare[m->spare_count++] = h / 2U;
    }
    m->dead_count = 0;
    return true;
}

/// The next edge of P, between the sites where it is now. Returns its half at X.
static uint32_t lay_edge(struct merge *m) {
    struct bank *const x = &m->bank[0], *const y = &m->bank[1];
    const uint32_t h = take_edge(m, x->site, y->site);
    if (h != VORONOI_NONE) {
        append(m, x, h);
        append(m, y, h ^ 1U);
    }
    return h;
}

/// Lays P from its start until it is closed.
static bool lay_curve(struct merge *m) {
    struct bank *const x = &m->bank[0], *const y = &m->bank[1];
    find_start(m);
    if (!find_anchor(m, x, y->site) || !find_anchor(m, y, x->site)) {
        return false;
    }
    const uint32_t start = lay_edge(m);
    if (start == VORONOI_NONE || (x->anchor == VORONOI_NONE && y->anchor == VORONOI_NONE)) {
        return start != VORONOI_NONE; // of two single sites P is a great circle and meets nothing
    }
    do {
        const uint32_t to_x = next_of(m, x, y->site), to_y = next_of(m, y, x->site);
        if (to_x == VORONOI_NONE && to_y == VORONOI_NONE) {
            return false;
        }
        // The first of the two that P meets: the other is then not inside the circle through it.
        const bool over_y =
            to_x == VORONOI_NONE ||
            (to_y != VORONOI_NONE && voronoi_side(m->mesh, x->site, y->site, to_x, to_y) > 0);
        struct bank *const bank = over_y ? y : x;
        cross(m, bank);
        if (x->site == x->start_site && y->site == y->start_site) {
            break;
        }
    } while (lay_edge(m) != VORONOI_NONE);
    if (x->site != x->start_site || y->site != y->start_site) {
        return false;
    }
    close_ring(m, x, start);
    close_ring(m, y, start ^ 1U);
    return free_dead(m);
}

// ---------------------------------------------------------------- all sets

static bool merge_blocks(struct merge *m, uint32_t from, uint32_t middle, uint32_t end) {
    m->bank[0] = (struct bank){.ahead = AFTER, .from = from, .to = middle};
    m->bank[1] = (struct bank){.ahead = BEFORE, .from = middle, .to = end};
    return from == middle || middle == end || lay_curve(m);
}

/// The sites of one half: pairs of neighbours in angle, then pairs of pairs, and so on.
static bool merge_half(struct merge *m, uint32_t from, uint32_t end) {
    for (uint32_t i = from; i < end; i++) {
        m->any[i] = VORONOI_NONE;
    }
    for (uint32_t width = 1; width < end - from; width *= 2U) {
        for (uint32_t at = from; end - at > width; at += 2U * width) {
            const uint32_t rest = end - at - width;
            if (!merge_blocks(m, at, at + width, at + width + (rest < width ? rest : width))) {
                return false;
            }
            if (rest <= width) {
                break;
            }
        }
    }
    return true;
}

/// The triangles of the rings. False: the rings do not make 2 n - 4 triangles.
static bool collect(struct merge *m, uint32_t *triangle_of) {
    struct voronoi_mesh *const mesh = m->mesh;
    const uint32_t halves = 2U * m->edge_count, count = 2U * mesh->site_count - 4U;
    for (uint32_t h = 0; h < halves; h++) {
        triangle_of[h] = VORONOI_NONE;
    }
    mesh->triangle_count = 0;
    for (uint32_t h = 0; h < halves; h++) {
        if (m->half[h].to == VORONOI_NONE || triangle_of[h] != VORONOI_NONE) {
            continue;
        }
        if (mesh->triangle_count == count) {
            return false;
        }
        uint32_t side = h;
        for (unsigned i = 0; i < 3U; i++) { // left of the edge; then the one before its other half
            mesh->triangle[mesh->triangle_count].site[i] = m->half[side ^ 1U].to;
            mesh->triangle[mesh->triangle_count].next[(i + 2U) % 3U] = side ^ 1U;
            triangle_of[side] = mesh->triangle_count;
            side = m->half[side ^ 1U].link[BEFORE];
        }
        if (side != h) {
            return false;
        }
        mesh->triangle_count++;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (unsigned i = 0; i < 3U; i++) {
            mesh->triangle[t].next[i] = triangle_of[mesh->triangle[t].next[i]];
        }
    }
    return mesh->triangle_count == count;
}

bool voronoi_merge(struct voronoi_mesh *mesh, uint32_t *scratch) {
    const uint32_t count = mesh->site_count;
    if (count < 4U) {
        voronoi_mesh_few(mesh);
        return true;
    }
    // Edges at most: 3 n of the two diagrams, and as many on P as it has vertices, below 2 n.
    const size_t n = count;
    struct merge m = {.mesh = mesh,
                      .half = (struct half_edge *)(void *)scratch,
                      .any = scratch + 30U * n,
                      .dead = scratch + 31U * n,
                      .spare = scratch + 37U * n,
                      .edges_max = 5U * count};
    uint32_t front = 0;
    while (front < count && voronoi_is_front(mesh->site[front].vector)) {
        front++;
    }
    return merge_half(&m, 0, front) && merge_half(&m, front, count) &&
           merge_blocks(&m, 0, front, count) && collect(&m, scratch + 42U * n);
}
