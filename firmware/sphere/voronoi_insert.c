#include "sphere/voronoi_mesh.h"

#include <stdbool.h>

/// The hull while sites are added. A site that waits is in the list of one triangle that it sees,
/// that is, of one whose circle it lies in; since all sites are corners of the hull, each sees
/// some.
struct insertion {
    struct voronoi_mesh *mesh;
    uint32_t *order;   // the sites, shuffled
    uint32_t *waiting; // by site: the next in the list of its triangle
    uint32_t *at;      // by site: the triangle in whose list it is
    uint32_t *around;  // by site: the new triangle whose side across the new site begins there
    uint32_t *first;   // by triangle: its list
    uint32_t *mark;    // by triangle: the round in which it was seen from the new site
    uint32_t *visit;   // by triangle: the last walk that came by
    uint32_t *sides;   // by triangle seen: where its sides begin in the border
    uint32_t *seen;    // the triangles seen; then also new ones, one for each side of the border
    uint32_t *walk;    // a stack of triangles
    uint32_t *border;  // pairs: a triangle that stays, and which of its sides has a seen one across
    uint32_t seen_count, border_count, walks;
};

static bool sees(const struct insertion *in, uint32_t site, uint32_t triangle) {
    const uint32_t *s = in->mesh->triangle[triangle].site;
    return voronoi_side(in->mesh, s[0], s[1], s[2], site) > 0;
}

static void wait_at(struct insertion *in, uint32_t site, uint32_t triangle) {
    in->waiting[site] = in->first[triangle];
    in->first[triangle] = site;
    in->at[site] = triangle;
}

static void shuffle(uint32_t *order, uint32_t count) {
    uint64_t state = UINT64_C(0x9E3779B97F4A7C15);
    for (uint32_t i = 0; i < count; i++) {
        order[i] = i;
    }
    for (uint32_t i = count; i > 1U; i--) { // xorshift64*
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        const uint64_t random = (state * UINT64_C(0x2545F4914F6CDD1D)) >> 32;
        const uint32_t j = (uint32_t)(random * i >> 32), swap = order[i - 1U];
        order[i - 1U] = order[j];
        order[j] = swap;
    }
}

/// The tetrahedron of the first four.
static void start(struct insertion *in) {
    struct voronoi_mesh *const mesh = in->mesh;
    uint32_t a = in->order[0], b = in->order[1];
    const uint32_t c = in->order[2], d = in->order[3];
    if (voronoi_side(mesh, a, b, c, d) > 0) {
        b = in->order[0];
        a = in->order[1];
    }
    mesh->triangle[0] = (struct voronoi_triangle){{a, b, c}, {2, 3, 1}};
    mesh->triangle[1] = (struct voronoi_triangle){{b, a, d}, {3, 2, 0}};
    mesh->triangle[2] = (struct voronoi_triangle){{c, b, d}, {1, 3, 0}};
    mesh->triangle[3] = (struct voronoi_triangle){{a, c, d}, {2, 1, 0}};
    mesh->triangle_count = 4;
    for (uint32_t t = 0; t < 4U; t++) {
        in->first[t] = VORONOI_NONE;
        in->mark[t] = in->visit[t] = 0;
    }
    for (uint32_t i = 4; i < mesh->site_count; i++) {
        uint32_t t = 0;
        while (t < 3U && !sees(in, in->order[i], t)) {
            t++;
        }
        wait_at(in, in->order[i], t);
    }
}

static unsigned side_toward(const struct voronoi_triangle *triangle, uint32_t neighbour) {
    return triangle->next[0] == neighbour ? 0U : (triangle->next[1] == neighbour ? 1U : 2U);
}

/// All triangles that the site sees: they are connected. `round` marks them; the border is listed.
static void find_seen(struct insertion *in, uint32_t site, uint32_t from, uint32_t round) {
    in->seen[0] = from;
    in->seen_count = 1;
    in->border_count = 0;
    in->mark[from] = round;
    for (uint32_t at = 0; at < in->seen_count; at++) {
        const uint32_t here = in->seen[at];
        in->sides[here] = in->border_count;
        for (unsigned i = 0; i < 3U; i++) {
            const uint32_t next = in->mesh->triangle[here].next[i];
            if (in->mark[next] == round) {
                continue;
            }
            if (sees(in, site, next)) {
                in->mark[next] = round;
                in->seen[in->seen_count++] = next;
            } else {
                in->border[in->border_count++] = next;
                in->border[in->border_count++] = side_toward(&in->mesh->triangle[next], here);
            }
        }
    }
}

/// The ends of a side of the border, as the new triangle has them: behind the site, clockwise of it
/// in the triangle that stays.
static void ends_of(const struct insertion *in, uint32_t side, uint32_t *begin, uint32_t *end) {
    const struct voronoi_triangle *const outer = &in->mesh->triangle[in->border[2U * side]];
    const uint32_t i = in->border[2U * side + 1U];
    *end = outer->site[(i + 1U) % 3U];
    *begin = outer->site[(i + 2U) % 3U];
}

/// Would `other` see the triangle from the site to a side of the border?
static bool would_see(const struct insertion *in, uint32_t other, uint32_t site, uint32_t side) {
    uint32_t begin, end;
    ends_of(in, side, &begin, &end);
    return voronoi_side(in->mesh, site, begin, end, other) > 0;
}

/// A side of the border that a seen triangle has, whose new triangle the other site would see.
static bool find_side_of(const struct insertion *in, uint32_t triangle, uint32_t other,
                         uint32_t site, uint32_t *side) {
    unsigned count = 0;
    for (unsigned i = 0; i < 3U; i++) {
        count += in->mark[in->mesh->triangle[triangle].next[i]] != in->mark[triangle];
    }
    for (unsigned i = 0; i < count; i++) {
        *side = in->sides[triangle] / 2U + i;
        if (would_see(in, other, site, *side)) {
            return true;
        }
    }
    return false;
}

/// The side of the border to whose new triangle a waiting site goes: the first that it sees, on a
/// walk over the triangles that both sites see, from the one it waits at. There is one: at a side
/// whose two old triangles the other site both sees, it sees the new one, too, because that lies in
/// their pencil, between them. So if it saw no new triangle beside those of the walk, none beyond
/// their sides would be seen by it: they would be all that it sees, which is connected, and it
/// would see no new triangle at all, since who sees a new one sees one of the two old ones at its
/// side. But every site is a corner of the hull, and sees something.
static uint32_t find_side(struct insertion *in, uint32_t other, uint32_t site) {
    uint32_t count = 1, side = 0;
    const uint32_t round = in->mark[in->at[other]];
    in->walk[0] = in->at[other];
    in->visit[in->walk[0]] = ++in->walks;
    while (count > 0U) {
        const uint32_t here = in->walk[--count];
        if (find_side_of(in, here, other, site, &side)) {
            return side;
        }
        for (unsigned i = 0; i < 3U; i++) {
            const uint32_t next = in->mesh->triangle[here].next[i];
            if (in->mark[next] == round && in->visit[next] != in->walks && sees(in, other, next)) {
                in->visit[next] = in->walks;
                in->walk[count++] = next;
            }
        }
    }
    return side;
}

/// Says where the sites go that wait at the triangles seen, and joins them into one list.
static uint32_t send_on(struct insertion *in, uint32_t site, uint32_t old_count) {
    uint32_t all = VORONOI_NONE;
    for (uint32_t i = 0; i < old_count; i++) {
        for (uint32_t other = in->first[in->seen[i]]; other != VORONOI_NONE;) {
            const uint32_t next = in->waiting[other];
            if (other != site) {
                in->at[other] = in->seen[find_side(in, other, site)];
                in->waiting[other] = all;
                all = other;
            }
            other = next;
        }
    }
    return all;
}

/// Puts a triangle from the site to each side of the border.
static void fill(struct insertion *in, uint32_t site) {
    struct voronoi_triangle *const triangle = in->mesh->triangle;
    const uint32_t sides = in->border_count / 2U;
    for (uint32_t i = 0; i < sides; i++) {
        const uint32_t outer = in->border[2U * i], here = in->seen[i];
        uint32_t begin, end;
        ends_of(in, i, &begin, &end);
        triangle[here] = (struct voronoi_triangle){{site, begin, end}, {outer, 0, 0}};
        triangle[outer].next[in->border[2U * i + 1U]] = here;
        in->first[here] = VORONOI_NONE;
        in->around[begin] = here;
    }
    for (uint32_t i = 0; i < sides; i++) {
        const uint32_t here = in->seen[i], after = in->around[triangle[here].site[2]];
        triangle[here].next[1] = after; // across site and end
        triangle[after].next[2] = here;
    }
}

/// Adds a site: the triangles that it sees give way to triangles from it to their border, in their
/// places and two new ones.
static void insert(struct insertion *in, uint32_t site, uint32_t round) {
    find_seen(in, site, in->at[site], round);
    const uint32_t old_count = in->seen_count;
    while (in->seen_count < in->border_count / 2U) {
        const uint32_t added = in->mesh->triangle_count++;
        in->mark[added] = in->visit[added] = 0;
        in->seen[in->seen_count++] = added;
    }
    uint32_t all = send_on(in, site, old_count);
    fill(in, site);
    while (all != VORONOI_NONE) {
        const uint32_t next = in->waiting[all];
        wait_at(in, all, in->at[all]);
        all = next;
    }
}

void voronoi_insert(struct voronoi_mesh *mesh, uint32_t *scratch) {
    const uint32_t count = mesh->site_count;
    if (count < 4U) {
        voronoi_mesh_few(mesh);
        return;
    }
    const size_t n = count;
    struct insertion in = {.mesh = mesh,
                           .order = scratch,
                           .waiting = scratch + n,
                           .at = scratch + 2U * n,
                           .around = scratch + 3U * n,
                           .first = scratch + 4U * n,
                           .mark = scratch + 6U * n,
                           .visit = scratch + 8U * n,
                           .sides = scratch + 10U * n,
                           .seen = scratch + 12U * n,
                           .walk = scratch + 14U * n,
                           .border = scratch + 16U * n};
    shuffle(in.order, count);
    start(&in);
    for (uint32_t i = 4; i < count; i++) {
        insert(&in, in.order[i], i);
    }
}
