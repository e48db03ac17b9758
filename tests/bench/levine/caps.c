#include "bench/levine/places.h"

#include "check.h"

#include <stdlib.h>
#include <string.h>

#define D    CAPS_DIMENSIONS
#define NONE UINT32_MAX

struct facet {
    uint32_t vertex[D];
    uint32_t across[D]; ///< the facet that has all vertices but vertex[i]
    wide normal[D];
    wide farthest; ///< height of `head`
    uint32_t head; ///< the highest point above it
    uint32_t mark; ///< 2 * step of the last test, and 1 if the tip is above
    bool in_use, done;
};

struct caps {
    struct places places;
    uint32_t dimension;
    struct facet *facets;
    uint32_t used, room, unused; ///< `across[0]` links those that are free
    uint32_t step;
    uint32_t inside[D + 1U]; ///< the first simplex
    uint32_t *visible, *cap, *bucket, *open_facet, *open_slot, *open_next;
    uint32_t visible_count, cap_count, open_count, list_room;
    struct caps_hull *out;
};

static wide height_above(const struct caps *c, const struct facet *f, uint32_t point) {
    return places_height(&c->places, f->normal, f->vertex[0], point);
}

static wide test(struct caps *c, uint32_t facet, uint32_t point) {
    c->out->tests++;
    return height_above(c, &c->facets[facet], point);
}

// ---------------------------------------------------------------- facets

static uint32_t new_facet(struct caps *c, const uint32_t *vertex) {
    uint32_t at = c->unused;
    if (at != NONE) {
        c->unused = c->facets[at].across[0];
    } else {
        if (c->used == c->room) {
            c->room *= 2U;
            c->facets = realloc(c->facets, c->room * sizeof *c->facets);
        }
        at = c->used++;
    }
    struct facet *const f = &c->facets[at];
    *f = (struct facet){.head = NONE, .in_use = true};
    memcpy(f->vertex, vertex, c->dimension * sizeof *vertex);
    places_normal(&c->places, vertex, f->normal);
    // The first simplex is below: the sum over its corners is, and none of them is above.
    wide sum = 0;
    for (uint32_t i = 0; i <= c->dimension; i++) {
        sum += height_above(c, f, c->inside[i]);
    }
    for (uint32_t k = 0; sum > 0 && k < c->dimension; k++) {
        f->normal[k] = -f->normal[k];
    }
    c->out->facets_made++;
    c->out->facet_count++;
    return at;
}

static void drop_facet(struct caps *c, uint32_t facet) {
    c->facets[facet].in_use = false;
    c->facets[facet].across[0] = c->unused;
    c->unused = facet;
    c->out->facet_count--;
}

static bool has_vertex(const struct caps *c, const struct facet *f, uint32_t vertex) {
    for (uint32_t i = 0; i < c->dimension; i++) {
        if (f->vertex[i] == vertex) {
            return true;
        }
    }
    return false;
}

static uint32_t slot_of(const struct caps *c, const struct facet *f, uint32_t neighbour) {
    uint32_t i = 0;
    while (i < c->dimension && f->across[i] != neighbour) {
        i++;
    }
    return i;
}

/// All vertices of the facet but one, in any order.
static uint32_t ridge_hash(const struct caps *c, const struct facet *f, uint32_t slot) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < c->dimension; i++) {
        const uint32_t mixed = (f->vertex[i] + 1U) * 2654435761U;
        sum += i == slot ? 0U : mixed ^ mixed >> 15;
    }
    return sum;
}

static bool same_ridge(const struct caps *c, const struct facet *f, uint32_t slot,
                       const struct facet *g, uint32_t other_slot) {
    for (uint32_t i = 0; i < c->dimension; i++) {
        if (i != slot &&
            (f->vertex[i] == g->vertex[other_slot] || !has_vertex(c, g, f->vertex[i]))) {
            return false;
        }
    }
    return true;
}

/// Rooms for lists of facets; bucket has 1024 heads.
static void make_room(struct caps *c, uint32_t facets) {
    if (facets > c->list_room) {
        c->list_room = 2U * facets;
        c->visible = realloc(c->visible, c->list_room * sizeof *c->visible);
        c->cap = realloc(c->cap, c->list_room * sizeof *c->cap);
        c->open_facet = realloc(c->open_facet, D * c->list_room * sizeof *c->open_facet);
        c->open_slot = realloc(c->open_slot, D * c->list_room * sizeof *c->open_slot);
        c->open_next = realloc(c->open_next, D * c->list_room * sizeof *c->open_next);
    }
}

/// Links a facet's open side to the one that shares its ridge, or keeps it until that one comes.
static void join(struct caps *c, uint32_t facet, uint32_t slot) {
    const uint32_t head = ridge_hash(c, &c->facets[facet], slot) % 1024U;
    for (uint32_t *link = &c->bucket[head]; *link != NONE; link = &c->open_next[*link]) {
        const uint32_t other = c->open_facet[*link], other_slot = c->open_slot[*link];
        if (same_ridge(c, &c->facets[facet], slot, &c->facets[other], other_slot)) {
            c->facets[facet].across[slot] = other;
            c->facets[other].across[other_slot] = facet;
            *link = c->open_next[*link];
            return;
        }
    }
    c->open_facet[c->open_count] = facet;
    c->open_slot[c->open_count] = slot;
    c->open_next[c->open_count] = c->bucket[head];
    c->bucket[head] = c->open_count++;
}

static void begin_joining(struct caps *c) {
    c->open_count = 0;
    for (uint32_t i = 0; i < 1024U; i++) {
        c->bucket[i] = NONE;
    }
}

// ---------------------------------------------------------------- step 4: a cap

/// The facets that the tip is above, from one of them on, by way of neighbours.
static void find_visible(struct caps *c, uint32_t seed, uint32_t tip) {
    c->step++;
    make_room(c, c->out->facet_count + 1U);
    c->facets[seed].mark = 2U * c->step + 1U;
    c->visible[0] = seed;
    c->visible_count = 1;
    for (uint32_t k = 0; k < c->visible_count; k++) {
        for (uint32_t i = 0; i < c->dimension; i++) {
            const uint32_t next = c->facets[c->visible[k]].across[i];
            if (c->facets[next].mark / 2U == c->step) {
                continue;
            }
            const bool above = test(c, next, tip) > 0;
            c->facets[next].mark = 2U * c->step + (above ? 1U : 0U);
            if (above) {
                c->visible[c->visible_count++] = next;
            }
        }
    }
}

static void add_cap(struct caps *c, uint32_t seed, uint32_t tip) {
    find_visible(c, seed, tip);
    begin_joining(c);
    c->cap_count = 0;
    for (uint32_t k = 0; k < c->visible_count; k++) {
        for (uint32_t i = 0; i < c->dimension; i++) {
            const uint32_t hidden = c->facets[c->visible[k]].across[i];
            if ((c->facets[hidden].mark & 1U) != 0U && c->facets[hidden].mark / 2U == c->step) {
                continue;
            }
            uint32_t vertex[D];
            memcpy(vertex, c->facets[c->visible[k]].vertex, sizeof vertex);
            vertex[i] = tip;
            const uint32_t made = new_facet(c, vertex);
            c->facets[made].across[i] = hidden;
            c->facets[hidden].across[slot_of(c, &c->facets[hidden], c->visible[k])] = made;
            make_room(c, c->cap_count + 1U);
            c->cap[c->cap_count++] = made;
            for (uint32_t j = 0; j < c->dimension; j++) {
                if (j != i) {
                    join(c, made, j);
                }
            }
        }
    }
    for (uint32_t k = 0; k < c->visible_count; k++) {
        drop_facet(c, c->visible[k]);
    }
}

static void add_listed(struct caps *c, const uint32_t *list, uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        for (uint32_t f = 0; f < c->used; f++) {
            if (c->facets[f].in_use && test(c, f, list[k]) > 0) {
                add_cap(c, f, list[k]);
                break;
            }
        }
    }
}

// ---------------------------------------------------------------- step 5: all points left

static uint32_t test_all(struct caps *c, uint32_t *left, uint32_t count) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < count; k++) {
        bool above_any = false;
        for (uint32_t f = 0; f < c->used; f++) {
            struct facet *const facet = &c->facets[f];
            if (!facet->in_use || facet->done) {
                continue;
            }
            const wide height = test(c, f, left[k]);
            if (height > 0) {
                above_any = true;
                if (facet->head == NONE || height > facet->farthest ||
                    (height == facet->farthest &&
                     places_order(&c->places, left[k], facet->head) > 0)) {
                    facet->head = left[k];
                    facet->farthest = height;
                }
            }
        }
        if (above_any) {
            left[kept++] = left[k];
        }
    }
    return kept;
}

/// Moves the highest point of each facet to the list; facets without one are final.
static uint32_t take_highest(struct caps *c, uint32_t *left, uint32_t *count, bool *taken,
                             uint32_t *list) {
    uint32_t listed = 0, kept = 0;
    for (uint32_t f = 0; f < c->used; f++) {
        struct facet *const facet = &c->facets[f];
        if (facet->in_use && facet->head != NONE) {
            if (!taken[facet->head]) {
                taken[facet->head] = true;
                list[listed++] = facet->head;
            }
            facet->head = NONE;
        } else if (facet->in_use) {
            facet->done = true;
        }
    }
    for (uint32_t k = 0; k < *count; k++) {
        if (!taken[left[k]]) {
            left[kept++] = left[k];
        }
    }
    *count = kept;
    return listed;
}

static void start(struct caps *c) {
    make_room(c, 64);
    begin_joining(c);
    for (uint32_t left_out = 0; left_out <= c->dimension; left_out++) {
        uint32_t vertex[D], at = 0;
        for (uint32_t i = 0; i <= c->dimension; i++) {
            if (i != left_out) {
                vertex[at++] = c->inside[i];
            }
        }
        const uint32_t made = new_facet(c, vertex);
        for (uint32_t i = 0; i < c->dimension; i++) {
            join(c, made, i);
        }
    }
}

// ---------------------------------------------------------------- the whole

static void verify_hull(const struct caps *c) {
    for (uint32_t f = 0; f < c->used; f++) {
        const struct facet *const facet = &c->facets[f];
        for (uint32_t i = 0; facet->in_use && i < c->places.count; i++) {
            if (!CHECK(height_above(c, facet, i) <= 0)) {
                return;
            }
        }
        for (uint32_t i = 0; facet->in_use && i < c->dimension; i++) {
            const struct facet *const other = &c->facets[facet->across[i]];
            if (!CHECK(other->in_use && same_ridge(c, facet, i, other, slot_of(c, other, f)))) {
                return;
            }
        }
    }
}

static void count_vertices(const struct caps *c, bool *taken) {
    memset(taken, 0, c->places.count * sizeof *taken);
    for (uint32_t f = 0; f < c->used; f++) {
        for (uint32_t i = 0; c->facets[f].in_use && i < c->dimension; i++) {
            c->out->vertex_count += taken[c->facets[f].vertex[i]] ? 0U : 1U;
            taken[c->facets[f].vertex[i]] = true;
        }
    }
}

bool caps_hull_find(const int32_t (*points)[CAPS_DIMENSIONS], uint32_t count, uint32_t dimension,
                    bool verify, struct caps_hull *out) {
    *out = (struct caps_hull){0};
    struct caps c = {.places = {points, count, dimension},
                     .dimension = dimension,
                     .room = 1024,
                     .unused = NONE,
                     .facets = malloc(1024 * sizeof *c.facets),
                     .bucket = malloc(1024 * sizeof *c.bucket),
                     .out = out};
    uint32_t *const list = malloc((count + 64U) * sizeof *list), *const left =
                                                                     malloc(count * sizeof *left);
    bool *const taken = calloc(count, sizeof *taken);
    uint32_t listed = places_extremes(&c.places, list), left_count = 0;
    const bool spans = places_corners(&c.places, list, listed, &out->tests, c.inside);
    if (spans) {
        start(&c);
        for (uint32_t i = 0; i <= dimension; i++) {
            taken[c.inside[i]] = true;
        }
        const uint32_t all = listed;
        listed = 0;
        for (uint32_t k = 0; k < all; k++) {
            if (!taken[list[k]]) {
                taken[list[k]] = true;
                list[listed++] = list[k];
            }
        }
        for (uint32_t i = 0; i < count; i++) {
            if (!taken[i]) {
                left[left_count++] = i;
            }
        }
        do {
            add_listed(&c, list, listed);
            left_count = test_all(&c, left, left_count);
            listed = take_highest(&c, left, &left_count, taken, list);
            out->rounds++;
        } while (listed != 0U);
        count_vertices(&c, taken);
        if (verify) {
            verify_hull(&c);
        }
    }
    free(c.facets);
    free(c.bucket);
    free(c.visible);
    free(c.cap);
    free(c.open_facet);
    free(c.open_slot);
    free(c.open_next);
    free(list);
    free(left);
    free(taken);
    return spans;
}
