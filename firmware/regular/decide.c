#include "regular/steps.h"

#include "fixed/sort.h"
#include "regular/primitive.h"

static void found(struct steps *steps, uint8_t count, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t index[4] = {a, b, c, 0};
    steps->result->regular = false;
    steps_conflict(steps->result, count, index);
}

/// Two points that agree in `same` axes from `first` on.
static void decide_equal(struct steps *steps, unsigned first, unsigned same) {
    struct order *const order = &steps->order;
    order_by(order, first);
    for (uint32_t i = 1; i < order->count; i++) {
        const uint32_t a = order->list[i - 1U], b = order->list[i];
        unsigned equal = 0;
        while (equal < same && order_coordinate(order->points[a], first + equal) ==
                                   order_coordinate(order->points[b], first + equal)) {
            equal++;
        }
        if (equal == same) {
            found(steps, 2, a, b, 0);
            return;
        }
    }
}

/// Three projected points on one line, none of them equal: two of them lie in the same direction
/// from the one with the smallest index.
static void decide_plane(struct steps *steps) {
    const struct vec3 *const points = steps->input->points;
    struct line_table *const lines = &steps->lines;
    line_table_start(lines);
    for (uint32_t i = 0; i < steps->input->count; i++) {
        line_table_next_round(lines);
        for (uint32_t j = i + 1U; j < steps->input->count; j++) {
            struct vec3 d = primitive_between(points[i], points[j]);
            d.z = 0;
            const uint32_t same = line_table_enter(lines, j, vec3_widen(primitive_vec3(d)));
            if (same != LINE_TABLE_NONE) {
                found(steps, 3, i, same, j);
                return;
            }
        }
    }
}

static void decide_segments(struct steps *steps) {
    for (uint32_t i = 0; i < steps->input->count; i++) {
        struct vec3 d = steps_segment(steps->input, i);
        d.y = steps->input->problem == REGULAR_SEGMENTS2_VERTICAL ? 0 : d.y;
        steps->result->operations++;
        if ((d.x | d.y) == 0) {
            found(steps, 1, i, 0, 0);
            return;
        }
    }
}

static bool trace_before(const void *context, uint32_t a, uint32_t b) {
    const struct steps *const steps = context;
    const struct vec3_i64 *const p = &steps->trace[a], *const q = &steps->trace[b];
    steps->result->operations++;
    if (p->x != q->x) {
        return p->x < q->x;
    }
    return p->y != q->y ? p->y < q->y : p->z < q->z;
}

/// Two projected segments on one line: the same direction, and the same offset from the origin.
static void decide_segment_lines(struct steps *steps) {
    const uint32_t count = steps->input->count;
    decide_segments(steps);
    if (!steps->result->regular) {
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 at = steps->input->points[2U * i];
        struct vec3 d = steps_segment(steps->input, i);
        d.z = 0;
        d = primitive_vec3(d);
        steps->trace[i] = (struct vec3_i64){d.x, d.y, (int64_t)at.x * d.y - (int64_t)at.y * d.x};
        steps->list[i] = i;
    }
    sort_indices(steps->list, steps->spare, count, trace_before, steps);
    for (uint32_t i = 1; i < count; i++) {
        const uint32_t a = steps->list[i - 1U], b = steps->list[i];
        if (primitive_equal(steps->trace[a], steps->trace[b])) {
            found(steps, 2, a, b, 0);
            return;
        }
    }
}

static void decide_faces(struct steps *steps) {
    const struct vec3 *const points = steps->input->points;
    for (uint32_t i = 0; i < steps->input->count; i++) {
        const struct vec3 *const face = points + 3U * (size_t)i;
        steps->result->operations++;
        if (steps_normal(face[0], face[1], face[2]).z == 0) {
            found(steps, 1, i, 0, 0);
            return;
        }
    }
}

void steps_decide(struct steps *steps) {
    const struct regular_input *const input = steps->input;
    steps->result->regular = true;
    switch (input->problem) {
    case REGULAR_POINTS2_LINE:
    case REGULAR_POINTS3_X:
        decide_equal(steps, 0, 1);
        break;
    case REGULAR_POINTS3_XY:
    case REGULAR_POINTS3_XYZ:
        for (unsigned axis = 0; axis < (input->problem == REGULAR_POINTS3_XY ? 2U : 3U); axis++) {
            if (steps->result->regular) {
                decide_equal(steps, axis, 1);
            }
        }
        break;
    case REGULAR_POINTS3_LINE:
        decide_equal(steps, 0, 2);
        break;
    case REGULAR_POINTS3_PLANE:
        decide_equal(steps, 0, 2);
        if (steps->result->regular) {
            decide_plane(steps);
        }
        break;
    case REGULAR_POINTS3_COCIRCULAR: {
        struct regular_conflict conflict;
        if (!cocircular_none(input->points, input->count, vec3(0, 0, 1), false, &steps->lines,
                             &conflict)) {
            steps->result->regular = false;
            steps_conflict(steps->result, conflict.count, conflict.index);
        }
        break;
    }
    case REGULAR_SEGMENTS3_PLANE:
        decide_segment_lines(steps);
        break;
    case REGULAR_FACES_VERTICAL:
        decide_faces(steps);
        break;
    default:
        decide_segments(steps);
        break;
    }
    steps->result->operations += steps->order.operations + steps->lines.operations;
    steps->order.operations = 0;
    steps->lines.operations = 0;
}
