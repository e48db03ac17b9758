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
    uint32_t *seen; // the triangles seen, and behind them those that the search has yet to look at
    uint32_t *border; // pairs: a triangle that stays, and which of its sides has a seen one across
    uint32_t seen_count, border_count;
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
        in->mark[t] = 0;
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

/// Puts a triangle from the site to each side of the border, in the places of the triangles seen
/// and two new ones.
static void fill(struct insertion *in, uint32_t site) {
    struct voronoi_triangle *const triangle = in->mesh->triangle;
    const uint32_t sides = in->border_count / 2U;
    while (in->seen_count < sides) {
        in->mark[in->mesh->triangle_count] = 0;
        in->seen[in->seen_count++] = in->mesh->triangle_count++;
    }
    for (uint32_t i = 0; i < sides; i++) {
        const uint32_t outer = in->border[2U * i], side = in->border[2U * i + 1U];
        // The side runs from `end` to `begin` in the triangle that stays, so the other way here.
        const uint32_t end = triangle[outer].site[(side + 1U) % 3U],
                       begin = triangle[outer].site[(side + 2U) % 3U];
        const uint32_t here = in->seen[i];
        triangle[here] = (struct voronoi_triangle){{site, begin, end}, {outer, 0, 0}};
        triangle[outer].next[side] = here;
        in->first[here] = VORONOI_NONE;
        in->around[begin] = here;
    }
    for (uint32_t i = 0; i < sides; i++) {
        const uint32_t here = in->seen[i], after = in->around[triangle[here].site[2]];
        triangle[here].next[1] = after; // across site and end
        triangle[after].next[2] = here;
    }
}

/// Joins the lists of the triangles seen, but for the site itself.
static uint32_t take_waiting(struct insertion *in, uint32_t site) {
    uint32_t all = VORONOI_NONE;
    for (uint32_t i = 0; i < in->seen_count; i++) {
        for (uint32_t at = in->first[in->seen[i]]; at != VORONOI_NONE;) {
            const uint32_t next = in->waiting[at];
            if (at != site) {
                in->waiting[at] = all;
                all = at;
            }
            at = next;
        }
    }
    return all;
}

/// A site that saw a triangle that is gone sees one of the new ones.
static void wait_again(struct insertion *in, uint32_t all) {
    while (all != VORONOI_NONE) {
        const uint32_t next = in->waiting[all];
        uint32_t i = 0;
        while (i + 1U < in->seen_count && !sees(in, all, in->seen[i])) {
            i++;
        }
        wait_at(in, all, in->seen[i]);
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
                           .seen = scratch + 8U * n,
                           .border = scratch + 10U * n};
    shuffle(in.order, count);
    start(&in);
    for (uint32_t i = 4; i < count; i++) {
        const uint32_t site = in.order[i];
        find_seen(&in, site, in.at[site], i);
        const uint32_t all = take_waiting(&in, site);
        fill(&in, site);
        wait_again(&in, all);
    }
}
