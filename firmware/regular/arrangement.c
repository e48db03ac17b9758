#include "regular/arrangement.h"

#define FLAG (UINT32_C(1) << 31)
#define NONE UINT32_MAX

void arrangement_open(struct arrangement *a, uint32_t count, struct arena *arena) {
    const uint64_t edges = ARRANGEMENT_EDGES(count);
    *a = (struct arrangement){.edge_count = 0};
    a->next = arena_take(arena, 2U * edges, sizeof *a->next);
    a->origin = arena_take(arena, 2U * edges, sizeof *a->origin);
    a->circle = arena_take(arena, edges, sizeof *a->circle);
    a->vertices = arena_take(arena, ARRANGEMENT_VERTICES(count), sizeof *a->vertices);
    a->sides = arena_take(arena, 2U * (uint64_t)count, sizeof *a->sides);
}

// ---------------------------------------------------------------- sides of vertices

/// Sign of det(a, b, c): from the units in Q1.30, rounded down, if that is certain. Each is off by
/// less than root(3) units, so the product by less than 3 root(3) 2^60 and change, below 2^63.
static int det_sign(const struct cell_circle *a, const struct cell_circle *b,
                    const struct cell_circle *c) {
    const struct i128 rough = vec3_i64_dot_vec3(vec3_cross(a->unit_q30, b->unit_q30), c->unit_q30);
    if (rough.hi > 0 || rough.hi < -1) {
        return rough.hi > 0 ? 1 : -1;
    }
    return i256_sign(vec3_i128_dot(vec3_i64_cross(a->normal, b->normal), c->normal));
}

/// On which side of the circle that asks: -1, 0 or 1.
static int side(struct arrangement *a, uint32_t vertex) {
    struct arrangement_vertex *const v = &a->vertices[vertex];
    if (v->seen / 4U == a->asking) {
        return (int)(v->seen % 4U) - 1;
    }
    a->operations++;
    const struct cell_circle *const c = a->circles;
    const int sign = det_sign(&c[v->circle[0]], &c[v->circle[1] & ~FLAG], &c[a->asking]) *
                     ((v->circle[1] & FLAG) != 0U ? -1 : 1);
    v->seen = 4U * a->asking + (uint32_t)(sign + 1);
    return sign;
}

static uint32_t tip(const struct arrangement *a, uint32_t half) {
    return a->origin[half ^ 1U];
}

static bool is_outside(const struct arrangement *a, uint32_t half) {
    return (half & 1U) != 0U && (a->circle[half / 2U] & ~FLAG) == 0U;
}

// ---------------------------------------------------------------- changes

static uint32_t add_vertex(struct arrangement *a, uint32_t first, uint32_t second, bool opposite) {
    a->vertices[a->vertex_count] =
        (struct arrangement_vertex){{first, second | (opposite ? FLAG : 0U)}, 4U * a->asking + 1U};
    return a->vertex_count++;
}

/// Splits an edge at a new vertex on the circle that asks. half: one side of it, which keeps the
/// part behind the vertex; before: what leads to it. Returns: the new half-edge that ends there, on
/// that side.
static uint32_t split(struct arrangement *a, uint32_t half, uint32_t before) {
    const uint32_t circle = a->circle[half / 2U] & ~FLAG;
    // Counter-clockwise about n, as its left half-edges go, a circle crosses another one to its -
    // side at n x asking. On the rim, circle 0, the left is inside.
    const bool left = ((half & 1U) != 0U) == ((a->circle[half / 2U] & FLAG) != 0U);
    const bool falls = side(a, a->origin[half]) > 0;
    const uint32_t vertex = add_vertex(a, circle, a->asking, left != falls);
    const uint32_t fresh = 2U * a->edge_count | (half & 1U), twin = half ^ 1U;
    a->circle[a->edge_count++] = a->circle[half / 2U];
    a->origin[fresh] = a->origin[half];
    a->origin[fresh ^ 1U] = vertex;
    a->origin[half] = vertex;
    a->next[fresh] = half;
    a->next[before] = fresh;
    a->next[fresh ^ 1U] = a->next[twin];
    a->next[twin] = fresh ^ 1U;
    return fresh;
}

/// Where the circle stands: at the start of `leaving`, into whose cell it goes, and at the tip of
/// `arriving`, which leads to it.
struct gate {
    uint32_t leaving, arriving;
};

/// The cell that the circle goes on into from a vertex: its neighbours there are on both sides.
/// around: a half-edge that starts there.
static struct gate gate_from(struct arrangement *a, uint32_t around) {
    uint32_t last = around;
    for (;;) {
        const uint32_t arriving = last ^ 1U, leaving = a->next[arriving];
        a->operations++;
        if (!is_outside(a, leaving) && side(a, tip(a, last)) * side(a, tip(a, leaving)) < 0) {
            return (struct gate){leaving, arriving};
        }
        last = leaving;
    }
}

/// Where the circle comes in over the rim.
static struct gate gate_on_rim(struct arrangement *a) {
    uint32_t before = 1, half = a->next[1];
    for (;;) {
        a->operations++;
        const int from = side(a, a->origin[half]), to = side(a, tip(a, half));
        if (from == 0) {
            return gate_from(a, half);
        }
        if (from * to < 0) {
            const uint32_t fresh = split(a, half, before);
            return (struct gate){fresh ^ 1U, half ^ 1U};
        }
        before = half;
        half = a->next[half];
    }
}

/// Draws the edge through a cell, from the gate to the tip of `arriving`. Returns its far
/// half-edge, which starts there.
static uint32_t draw(struct arrangement *a, struct gate gate, uint32_t arriving, int first_side) {
    const uint32_t there = 2U * a->edge_count, back = there + 1U;
    // The cell of `back` is the one with the gate's first corner.
    a->circle[a->edge_count++] = a->asking | (first_side > 0 ? FLAG : 0U);
    a->origin[there] = a->origin[gate.leaving];
    a->origin[back] = tip(a, arriving);
    a->next[there] = a->next[arriving];
    a->next[gate.arriving] = there;
    a->next[arriving] = back;
    a->next[back] = gate.leaving;
    return back;
}

/// Crosses one cell. False: it has reached the rim.
static bool cross(struct arrangement *a, struct gate *gate) {
    const int first = side(a, tip(a, gate->leaving));
    uint32_t before = gate->leaving, half = a->next[before];
    // The first edge ends beside the circle; another one ends on it, or on its other side.
    for (;;) {
        a->operations++;
        const int at = side(a, tip(a, half));
        if (at == 0) {
            const uint32_t back = draw(a, *gate, half, first);
            const uint32_t vertex = a->origin[back];
            if (a->vertices[vertex].circle[0] == 0U) {
                return false;
            }
            *gate = gate_from(a, back);
            return true;
        }
        if (at != first) {
            const bool rim = (a->circle[half / 2U] & ~FLAG) == 0U;
            const uint32_t fresh = split(a, half, before);
            draw(a, *gate, fresh, first);
            *gate = (struct gate){fresh ^ 1U, half ^ 1U};
            return !rim;
        }
        before = half;
        half = a->next[half];
    }
}

/// Circle 0 as the rim, and circle 1 across: two cells with two corners each.
static void start(struct arrangement *a) {
    a->asking = 1;
    a->operations += 3;
    a->vertex_count = 0;
    const uint32_t from = add_vertex(a, 0, 1, false), to = add_vertex(a, 0, 1, true);
    // Edge 0: counter-clockwise from `from`, beside the -n1 cell; edge 1: the other half of the
    // rim; edge 2: circle 1 with its -n1 cell on the side that leads back.
    const uint32_t origins[6] = {from, to, to, from, from, to};
    const uint32_t nexts[6] = {5, 3, 4, 1, 2, 0};
    for (uint32_t h = 0; h < 6U; h++) {
        a->origin[h] = origins[h];
        a->next[h] = nexts[h];
    }
    a->circle[0] = 0;
    a->circle[1] = 0;
    a->circle[2] = 1;
    a->edge_count = 3;
}

// ---------------------------------------------------------------- cells

/// Lists the sides of the cell on a half-edge's left, and marks them as seen.
static uint32_t list_sides(struct arrangement *a, uint32_t half) {
    uint32_t count = 0;
    for (uint32_t h = half; a->origin[h] != NONE; h = a->next[h]) {
        const uint32_t circle = a->circle[h / 2U];
        const bool minus = ((circle & FLAG) != 0U) != ((h & 1U) != 0U);
        a->sides[count++] = 2U * (circle & ~FLAG) + (minus ? 1U : 0U);
        a->origin[h] = NONE;
        a->operations++;
    }
    return count;
}

void arrangement_search(struct arrangement *a, const struct cell_circle *circles, uint32_t count,
                        struct cell_best *best) {
    a->circles = circles;
    start(a);
    for (uint32_t i = 2; i < count; i++) {
        a->asking = i;
        struct gate gate = gate_on_rim(a);
        while (cross(a, &gate)) {
        }
    }
    for (uint32_t h = 0; h < 2U * a->edge_count; h++) {
        if (a->origin[h] != NONE && !is_outside(a, h)) {
            cell_consider(best, circles, a->sides, list_sides(a, h));
        }
    }
}
