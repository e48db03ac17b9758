#include "regular/optimum.h"

#include "fixed/sort.h"
#include "fixed/trig_fine.h"
#include "regular/primitive.h"
#include "regular/turn.h"

static bool has_lines(enum regular_problem problem) {
    return problem == REGULAR_POINTS2_LINE || problem == REGULAR_POINTS3_LINE ||
           regular_points_of(problem) == 2U;
}

static uint32_t pairs(uint32_t count) {
    return (uint32_t)((uint64_t)count * (count - (count != 0U)) / 2U);
}

static uint32_t most_lines(enum regular_problem problem, uint32_t count) {
    if (!has_lines(problem)) {
        // Two points of POINTS3_PLANE have a line, but no plane.
        return problem == REGULAR_POINTS3_PLANE && count == 2U ? 1U : 0U;
    }
    return regular_points_of(problem) == 1U ? pairs(count) : count;
}

static uint32_t most_circles(enum regular_problem problem, uint32_t count) {
    switch (problem) {
    case REGULAR_POINTS3_X:
    case REGULAR_SEGMENTS3_PLANE:
        return pairs(count);
    case REGULAR_POINTS3_PLANE:
        return count < 3U ? 0U : (uint32_t)((uint64_t)count * (count - 1U) * (count - 2U) / 6U);
    case REGULAR_FACES_VERTICAL:
        return count;
    default:
        return 0;
    }
}

void optimum_open(struct optimum *o, enum regular_problem problem, uint32_t count,
                  const struct regular_options *options, struct arena *arena) {
    *o = (struct optimum){.line_room = most_lines(problem, count),
                          .circle_room = most_circles(problem, count)};
    o->lines = arena_take(arena, o->line_room, sizeof *o->lines);
    if (regular_is_planar(problem)) {
        const bool weighted = options->weights != NULL && problem == REGULAR_POINTS2_LINE;
        if (weighted) {
            o->weights = arena_take(arena, o->line_room, sizeof *o->weights);
        }
        gap_open(&o->gap, o->line_room, options->buckets, weighted, arena);
    } else if (o->line_room != 0U) {
        empty_open(&o->empty, o->line_room, arena);
    }
    if (problem == REGULAR_SEGMENTS3_PLANE) {
        o->lone.inside = arena_take(arena, 2U * (uint64_t)count, sizeof *o->lone.inside);
    }
    if (o->circle_room != 0U) {
        o->normals = arena_take(arena, o->circle_room, sizeof *o->normals);
        o->list = arena_take(arena, o->circle_room, sizeof *o->list);
        o->spare = arena_take(arena, o->circle_room, sizeof *o->spare);
        o->circles = arena_take(arena, o->circle_room, sizeof *o->circles);
        if (options->cylinder || options->above) {
            cylinder_open(&o->cylinder, o->circle_room, arena);
        } else {
            arrangement_open(&o->arrangement, o->circle_room, arena);
        }
    }
}

// ---------------------------------------------------------------- answers

static struct vec3_i128 wide(struct vec3_i64 a) {
    return (struct vec3_i128){i128_from_i64(a.x), i128_from_i64(a.y), i128_from_i64(a.z)};
}

/// The angle to the nearest line and circle, rounded down.
static void tell_tolerance(struct steps *steps, const struct optimum *o,
                           struct vec3_i64 direction) {
    uint64_t least = TURN64_QUARTER, of_lines = TURN64_QUARTER;
    for (uint32_t i = 0; i < o->normal_count; i++) {
        const uint64_t across = TURN64_QUARTER - disc_line_angle(direction, o->normals[i]);
        least = across < least ? across : least;
    }
    for (uint32_t i = 0; i < o->line_count; i++) {
        const uint64_t angle = disc_line_angle(direction, vec3_widen(o->lines[i])) /
                               (o->weights == NULL ? 1U : o->weights[i]);
        of_lines = angle < of_lines ? angle : of_lines;
    }
    // The cylinder's search takes no notice of lines.
    steps->result->tolerance_is_bound = o->lone.count != 0U && steps->options->cylinder;
    least = of_lines < least ? of_lines : least;
    steps->result->tolerance_turn64 = least > DISC_ANGLE_ERROR ? least - DISC_ANGLE_ERROR : 0U;
    // Of the two opposite directions the upper one, which `above` has already.
    direction = primitive_reduced(direction);
    const int64_t last =
        direction.z != 0 ? direction.z : (direction.y != 0 ? direction.y : direction.x);
    steps->result->direction =
        wide(last < 0 ? (struct vec3_i64){-direction.x, -direction.y, -direction.z} : direction);
    steps->result->operations += o->normal_count + o->line_count;
}

static void nothing_forbidden(struct steps *steps) {
    const bool onto_x = steps->input->problem == REGULAR_POINTS3_X;
    const bool planar = regular_is_planar(steps->input->problem);
    steps->result->direction = wide((struct vec3_i64){onto_x, planar, !onto_x && !planar});
    steps->result->tolerance_turn64 = TURN64_QUARTER;
}

// ---------------------------------------------------------------- lines

static void list_lines(const struct steps *steps, struct optimum *o) {
    const struct regular_input *const input = steps->input;
    if (regular_points_of(input->problem) == 2U) {
        for (uint32_t i = 0; i < input->count; i++) {
            o->lines[o->line_count++] = primitive_vec3(steps_segment(input, i));
        }
        return;
    }
    const uint32_t *const weights = steps->options->weights;
    for (uint32_t i = 0; i < input->count; i++) {
        for (uint32_t j = i + 1U; j < input->count; j++) {
            if (o->weights != NULL) {
                o->weights[o->line_count] = weights[i] > weights[j] ? weights[i] : weights[j];
            }
            o->lines[o->line_count++] =
                primitive_vec3(primitive_between(input->points[i], input->points[j]));
        }
    }
}

/// The middle of the widest gap. A gap of half a turn: at right angles to its line.
static struct vec3_i64 middle_of(const struct gap *gap) {
    const struct vec3_i64 from = vec3_widen(gap->from);
    if (vec3_equal(gap->to, vec3_neg(gap->from))) {
        return (struct vec3_i64){-from.y, from.x, 0};
    }
    const struct disc disc = {2, {from, vec3_widen(gap->to)}};
    return disc_centre(&disc);
}

static void find_beside_lines(struct steps *steps, struct optimum *o) {
    struct vec3_i64 direction;
    if (regular_is_planar(steps->input->problem)) {
        o->gap.lines = o->lines;
        o->gap.count = o->line_count;
        if (o->weights != NULL) {
            gap_weighted(&o->gap, o->weights, &direction);
            steps->result->tolerance_is_bound = false;
        } else {
            gap_widest(&o->gap, steps->options->buckets);
            direction = middle_of(&o->gap);
        }
        steps->result->operations += o->gap.operations;
    } else {
        struct disc disc;
        o->empty.lines = o->lines;
        o->empty.count = o->line_count;
        empty_largest(&o->empty, &disc);
        direction = disc_centre(&disc);
        steps->result->operations += o->empty.operations;
    }
    tell_tolerance(steps, o, direction);
}

// ---------------------------------------------------------------- circles

static bool visit_list(void *context, struct vec3_i64 normal, uint8_t item_count,
                       const uint32_t *items) {
    struct optimum *const o = context;
    o->normals[o->normal_count++] = primitive_vec3_i64(normal);
    if (normal.z == 0 && !o->vertical) {
        o->vertical = true;
        for (uint8_t i = 0; i < item_count; i++) {
            o->conflict.index[i] = items[i];
        }
        o->conflict.count = item_count;
    }
    return true;
}

static bool normal_before(const void *context, uint32_t a, uint32_t b) {
    const struct optimum *const o = context;
    const struct vec3_i64 *const p = &o->normals[a], *const q = &o->normals[b];
    if (p->x != q->x) {
        return p->x < q->x;
    }
    return p->y != q->y ? p->y < q->y : p->z < q->z;
}

/// The different circles; in an order that looks random, the same every time.
static void different_circles(struct optimum *o) {
    for (uint32_t i = 0; i < o->normal_count; i++) {
        o->list[i] = i;
    }
    sort_indices(o->list, o->spare, o->normal_count, normal_before, o);
    o->circle_count = 0;
    uint64_t state = 1;
    for (uint32_t i = 0; i < o->normal_count; i++) {
        const struct vec3_i64 normal = o->normals[o->list[i]];
        if (i != 0U && primitive_equal(normal, o->normals[o->list[i - 1U]])) {
            continue;
        }
        state = state * UINT64_C(6364136223846793005) + 1442695040888963407U;
        const uint32_t at = (uint32_t)((state >> 32) % (o->circle_count + 1U));
        o->circles[o->circle_count++] = o->circles[at];
        o->circles[at] = cell_circle_from(normal);
    }
}

static bool independent(struct vec3_i64 a, struct vec3_i64 b, struct vec3_i64 c) {
    return i256_sign(vec3_i128_dot(vec3_i64_cross(a, b), c)) != 0;
}

/// Brings three circles that don't go through one point to the front. False: all do.
static bool start_in_general_position(struct optimum *o) {
    for (uint32_t i = 2; i < o->circle_count; i++) {
        if (independent(o->circles[0].normal, o->circles[1].normal, o->circles[i].normal)) {
            const struct cell_circle swap = o->circles[2];
            o->circles[2] = o->circles[i];
            o->circles[i] = swap;
            return true;
        }
    }
    return false;
}

/// By angle about the pole: primitive normals in one plane are within half a turn.
struct pencil {
    struct optimum *optimum;
    struct vec3_i128 pole;
};

static bool turned_before(const void *context, uint32_t a, uint32_t b) {
    const struct pencil *const pencil = context;
    const struct cell_circle *const circles = pencil->optimum->circles;
    const struct vec3_i128 cross = vec3_i64_cross(circles[a].normal, circles[b].normal);
    // Both are along the pole's axis: a component tells.
    const int sign = i128_sign(pencil->pole.x) != 0 ? i128_sign(pencil->pole.x) * i128_sign(cross.x)
                     : i128_sign(pencil->pole.y) != 0
                         ? i128_sign(pencil->pole.y) * i128_sign(cross.y)
                         : i128_sign(pencil->pole.z) * i128_sign(cross.z);
    return sign > 0;
}

/// All circles through one pole. Between those of neighbouring normals a and b, in the order of
/// their angles, is the cell on the side of -a and b; past the last one, b is minus the first.
static void search_pencil(struct optimum *o, struct cell_best *best) {
    const uint32_t count = o->circle_count;
    struct pencil pencil = {.optimum = o};
    if (count == 1U) {
        const cell_side only = 0;
        cell_consider(best, o->circles, &only, 1);
        return;
    }
    pencil.pole = vec3_i64_cross(o->circles[0].normal, o->circles[1].normal);
    for (uint32_t i = 0; i < count; i++) {
        o->list[i] = i;
    }
    sort_indices(o->list, o->spare, count, turned_before, &pencil);
    for (uint32_t i = 0; i < count; i++) {
        const bool last = i + 1U == count;
        const cell_side sides[2] = {2U * o->list[i] + 1U,
                                    last ? 2U * o->list[0] + 1U : 2U * o->list[i + 1U]};
        cell_consider(best, o->circles, sides, 2);
    }
}

/// The cell of the vertical direction.
static void search_above(struct optimum *o, struct cell_best *best) {
    for (uint32_t i = 0; i < o->circle_count; i++) {
        o->list[i] = 2U * i + (o->circles[i].normal.z < 0 ? 1U : 0U);
    }
    cell_consider(best, o->circles, o->list, o->circle_count);
}

static enum regular_status none(struct steps *steps, const struct regular_conflict *conflict) {
    steps->result->regular = false;
    steps_conflict(steps->result, conflict->count, conflict->index);
    return REGULAR_NONE;
}

/// Of a line on a circle the circle is nearer.
static void keep_lone_lines(struct optimum *o) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < o->line_count; i++) {
        bool on_circle = false;
        for (uint32_t c = 0; c < o->circle_count && !on_circle; c++) {
            on_circle = lone_is_on(o->lines[i], o->circles[c].normal);
        }
        if (!on_circle) {
            o->lines[kept++] = o->lines[i];
        }
    }
    o->line_count = kept;
    o->lone.lines = o->lines;
    o->lone.count = kept;
}

static enum regular_status find_between_circles(struct steps *steps, struct optimum *o) {
    const bool above = steps->options->above;
    struct cell_best best = {.operations = 0};
    if (above && o->vertical) {
        return none(steps, &o->conflict);
    }
    different_circles(o);
    keep_lone_lines(o);
    best.lone = o->lone.count != 0U && !steps->options->cylinder ? &o->lone : NULL;
    if (above) {
        search_above(o, &best);
    } else if (!start_in_general_position(o)) {
        search_pencil(o, &best);
    } else if (steps->options->cylinder) {
        cylinder_search(&o->cylinder, o->circles, o->circle_count, &best);
    } else {
        arrangement_search(&o->arrangement, o->circles, o->circle_count, &best);
        best.operations += o->arrangement.operations;
    }
    steps->result->regular = true;
    steps->result->operations += best.operations;
    tell_tolerance(steps, o, best.beside_points ? best.at : disc_centre(&best.disc));
    return REGULAR_OK;
}

// ---------------------------------------------------------------- the step

enum regular_status optimum_find(struct steps *steps, struct optimum *o) {
    const enum regular_problem problem = steps->input->problem;
    if (problem == REGULAR_POINTS3_XY || problem == REGULAR_POINTS3_XYZ) {
        const enum regular_status status = steps_compute(steps);
        if (status == REGULAR_OK) {
            turn_search(steps->input, steps->result);
        }
        return status;
    }
    struct regular_conflict conflict;
    uint64_t planes = 0;
    if (o->circle_room != 0U && !circles_each(steps->input, visit_list, o, &conflict, &planes)) {
        return none(steps, &conflict);
    }
    steps->result->operations += planes;
    if (has_lines(problem)) {
        list_lines(steps, o);
    } else if (problem == REGULAR_POINTS3_PLANE && steps->input->count == 2U) {
        // Two points have no plane, but their line is in the way: the plane at right angles to it.
        o->lines[o->line_count++] =
            primitive_vec3(primitive_between(steps->input->points[0], steps->input->points[1]));
    }
    steps->result->regular = true;
    if (o->normal_count != 0U) {
        return find_between_circles(steps, o);
    }
    if (o->line_count != 0U) {
        find_beside_lines(steps, o);
    } else {
        nothing_forbidden(steps);
    }
    return REGULAR_OK;
}
