#include "regular/circles.h"
#include "regular/primitive.h"
#include "regular/steps.h"
#include "regular/wedge.h"

static struct i128 small(int64_t value) {
    return i128_from_i64(value);
}

static void point_along(struct regular_result *result, int64_t x, int64_t y, int64_t z) {
    result->direction = (struct vec3_i128){small(x), small(y), small(z)};
}

// ---------------------------------------------------------------- points, pairs

/// Steeper than every line between points of different x (and y): (d, 0, D + 1), D the height of
/// the set and d its smallest gap in x or y. The slope must be above D / d, not equal.
static void compute_line(struct steps *steps) {
    const bool planar = steps->input->problem == REGULAR_POINTS2_LINE;
    const struct spread height = order_spread(&steps->order, planar ? 1U : 2U);
    const struct spread x = order_spread(&steps->order, 0);
    const struct spread y = planar ? (struct spread){0, 0} : order_spread(&steps->order, 1);
    const uint32_t gap = x.gap == 0U || (y.gap != 0U && y.gap < x.gap) ? y.gap : x.gap;
    const int64_t rise = gap == 0U ? 0 : (int64_t)height.width + 1;
    // All on one vertical line: along x.
    point_along(steps->result, gap == 0U ? 1 : gap, planar ? rise : 0, planar ? 0 : rise);
}

static int64_t over(uint64_t size, uint32_t gap) {
    return gap == 0U ? 0 : (int64_t)(size / gap) + 1;
}

/// (A, B, 1): B makes y outweigh z, and A makes x outweigh both: the order of the points along it
/// is by x, then y, then z.
static void compute_x(struct steps *steps) {
    const struct spread z = order_spread(&steps->order, 2);
    const struct spread y = order_spread(&steps->order, 1);
    const struct spread x = order_spread(&steps->order, 0);
    const int64_t b = over(z.width, y.gap);
    const int64_t a = over((uint64_t)b * y.width + z.width, x.gap);
    point_along(steps->result, a, b, 1);
}

/// The quaternion (w, 0, 1, c) turns x, y and z so little that each keeps its order, and breaks the
/// ties of each by the two others. With q above width / gap, c = q and w = 2 q (c + 1) + c + 1:
/// docs/regular.md has the nine inequalities.
static void compute_axes(struct steps *steps) {
    uint32_t width = 0, gap = 0;
    for (unsigned axis = 0; axis < 3U; axis++) {
        const struct spread spread = order_spread(&steps->order, axis);
        width = spread.width > width ? spread.width : width;
        gap = spread.gap != 0U && (gap == 0U || spread.gap < gap) ? spread.gap : gap;
    }
    const int64_t q = over(width, gap), c = q, w = 2 * q * (c + 1) + c + 1;
    const struct i128 w2 = i128_mul(w, w), wc = i128_mul(2 * w, c);
    const struct i128 less = i128_sub(w2, small(c * c)), more = i128_add(w2, small(c * c));
    struct vec3_i128 *const rows = steps->result->rotation;
    rows[0] = (struct vec3_i128){i128_sub(less, small(1)), i128_neg(wc), small(2 * w)};
    rows[1] = (struct vec3_i128){wc, i128_add(less, small(1)), small(2 * c)};
    rows[2] = (struct vec3_i128){small(-2 * w), small(2 * c), i128_sub(more, small(1))};
}

// ---------------------------------------------------------------- circles

struct planes {
    struct wedge wedge;
    struct vec3 azimuth;
    struct u128 steepness;
    uint64_t operations;
};

static bool visit_trace(void *context, struct vec3_i64 normal, uint8_t item_count,
                        const uint32_t *items) {
    struct planes *const planes = context;
    (void)item_count;
    (void)items;
    if (normal.z == 0) {
        wedge_add(&planes->wedge, (struct vec3_i64){-normal.y, normal.x, 0});
    }
    return true;
}

static void be_steeper(struct planes *planes, struct u128 than) {
    if (u128_cmp(planes->steepness, than) < 0) {
        planes->steepness = than;
    }
}

static bool visit_steepness(void *context, struct vec3_i64 normal, uint8_t item_count,
                            const uint32_t *items) {
    struct planes *const planes = context;
    (void)item_count;
    (void)items;
    be_steeper(planes, wedge_steepness(normal, planes->azimuth));
    return true;
}

static void point_in_wedge(struct steps *steps, const struct planes *planes) {
    const struct u128 up = planes->steepness;
    point_along(steps->result, planes->azimuth.x, planes->azimuth.y, 0);
    steps->result->direction.z = (struct i128){up.lo, (int64_t)up.hi};
    steps->result->operations += planes->operations + planes->wedge.operations;
}

static enum regular_status none(struct steps *steps, const struct regular_conflict *conflict) {
    steps->result->regular = false;
    steps_conflict(steps->result, conflict->count, conflict->index);
    return REGULAR_NONE;
}

/// A segment's own direction: not along (h, M) if that is steeper.
static void avoid_segments(const struct steps *steps, struct planes *planes) {
    for (uint32_t i = 0; i < steps->input->count; i++) {
        const struct vec3 d = steps_segment(steps->input, i);
        const struct vec3 h = planes->azimuth;
        const uint64_t run = u64_abs(d.x) + u64_abs(d.y), along = u64_abs(h.x) + u64_abs(h.y);
        planes->operations++;
        if (run != 0U) {
            be_steeper(planes, (struct u128){u64_abs(d.z) * along / run + 1U, 0});
        }
    }
}

/// All circles twice: for the azimuth, and for the slope.
static enum regular_status compute_circles(struct steps *steps) {
    struct planes planes = {.steepness = {1, 0}};
    struct regular_conflict conflict;
    uint64_t tested;
    if (!circles_each(steps->input, visit_trace, &planes, &conflict, &tested)) {
        return none(steps, &conflict);
    }
    planes.azimuth = wedge_azimuth(&planes.wedge);
    if (vec3_is_zero(planes.azimuth)) {
        planes.azimuth = vec3(1, 0, 0); // only segments of their own direction are in the way
    }
    circles_each(steps->input, visit_steepness, &planes, &conflict, &tested);
    if (steps->input->problem == REGULAR_SEGMENTS3_PLANE) {
        avoid_segments(steps, &planes);
    }
    planes.operations += 2U * tested;
    point_in_wedge(steps, &planes);
    return REGULAR_OK;
}

/// Traces of planes through point i and two others behind it, and lines through three points.
/// False: conflict has such a line.
static bool traces_of_point(struct steps *steps, uint32_t i, struct planes *planes,
                            struct regular_conflict *conflict) {
    const struct vec3 *const points = steps->input->points;
    struct line_table *const lines = &steps->lines;
    line_table_next_round(lines);
    for (uint32_t j = i + 1U; j < steps->input->count; j++) {
        const struct vec3 d = primitive_vec3(primitive_between(points[i], points[j]));
        const uint32_t same = line_table_enter(lines, j, vec3_widen(d));
        if (same != LINE_TABLE_NONE) {
            *conflict = (struct regular_conflict){3, {i, same, j, 0}};
            return false;
        }
    }
    line_table_next_round(lines);
    for (uint32_t j = i + 1U; j < steps->input->count; j++) {
        struct vec3 d = primitive_between(points[i], points[j]);
        d.z = 0;
        if (vec3_is_zero(d)) {
            // The plane through a vertical pair and any third point is vertical.
            for (uint32_t k = 0; k < steps->input->count; k++) {
                const struct vec3 to = primitive_between(points[i], points[k]);
                if ((to.x | to.y) != 0) {
                    wedge_add(&planes->wedge, vec3_widen(to));
                }
            }
        } else if (line_table_enter(lines, j, vec3_widen(primitive_vec3(d))) != LINE_TABLE_NONE) {
            wedge_add(&planes->wedge, vec3_widen(d));
        }
    }
    return true;
}

/// In O(n^2): the vertical planes are where projected points are on one line; and a bound on the
/// slope needs no planes. For a normal n, n . h is twice the area of a triangle in the box of the
/// coordinates (h x p, z), and |n_z| is at least 1.
static enum regular_status compute_plane(struct steps *steps) {
    struct planes planes = {.steepness = {1, 0}};
    struct regular_conflict conflict;
    line_table_start(&steps->lines);
    for (uint32_t i = 0; i < steps->input->count; i++) {
        if (!traces_of_point(steps, i, &planes, &conflict)) {
            return none(steps, &conflict);
        }
    }
    planes.azimuth = wedge_azimuth(&planes.wedge);
    int64_t low = INT64_MAX, high = INT64_MIN;
    for (uint32_t i = 0; i < steps->input->count; i++) {
        const struct vec3 at = steps->input->points[i];
        const int64_t across = (int64_t)planes.azimuth.x * at.y - (int64_t)planes.azimuth.y * at.x;
        low = across < low ? across : low;
        high = across > high ? across : high;
    }
    const uint32_t height = order_spread(&steps->order, 2).width;
    be_steeper(&planes, u128_add(u128_mul((uint64_t)(high - low), height), (struct u128){1, 0}));
    point_in_wedge(steps, &planes);
    return REGULAR_OK;
}

// ---------------------------------------------------------------- segments, circles of points

/// Along (1, M) or (1, 0, M), steeper than every segment that is not vertical.
static void compute_vertical(struct steps *steps) {
    const bool planar = steps->input->problem == REGULAR_SEGMENTS2_VERTICAL;
    int64_t steepest = 0;
    for (uint32_t i = 0; i < steps->input->count; i++) {
        const struct vec3 d = steps_segment(steps->input, i);
        steps->result->operations++;
        if (d.x != 0) {
            const int64_t slope = (int64_t)(u64_abs(planar ? d.y : d.z) / u64_abs(d.x));
            steepest = slope > steepest ? slope : steepest;
        }
    }
    point_along(steps->result, 1, planar ? steepest + 1 : 0, planar ? 0 : steepest + 1);
}

/// Small directions, in a fixed order that looks random. What is forbidden is a cone of degree
/// three for each quadruple; one that isn't on any is almost surely among the first.
static enum regular_status compute_cocircular(struct steps *steps) {
    uint32_t state = 1;
    for (uint32_t trial = 0; trial < 65536U; trial++) {
        int32_t at[3];
        for (int k = 0; k < 3; k++) {
            state = state * 1664525U + 1013904223U;
            at[k] = (int32_t)((state >> 16) % (2U * COCIRCULAR_DIRECTION_MAX + 1U)) -
                    COCIRCULAR_DIRECTION_MAX;
        }
        struct vec3 v = vec3(at[0], at[1], at[2]);
        struct regular_conflict conflict;
        if (vec3_is_zero(v)) {
            continue;
        }
        v = primitive_vec3(v);
        if (cocircular_none(steps->input->points, steps->input->count, v, true, &steps->lines,
                            &conflict)) {
            point_along(steps->result, v.x, v.y, v.z);
            return REGULAR_OK;
        }
    }
    return REGULAR_ERROR_OPEN;
}

static void compute_as_given(struct steps *steps) {
    const bool onto_x = steps->input->problem == REGULAR_POINTS3_X;
    const bool planar = regular_is_planar(steps->input->problem);
    point_along(steps->result, onto_x ? 1 : 0, planar ? 1 : 0, onto_x || planar ? 0 : 1);
    for (unsigned k = 0; k < 3U; k++) {
        steps->result->rotation[k] =
            (struct vec3_i128){small(k == 0U), small(k == 1U), small(k == 2U)};
    }
}

static enum regular_status compute_otherwise(struct steps *steps) {
    switch (steps->input->problem) {
    case REGULAR_POINTS3_X:
        compute_x(steps);
        return REGULAR_OK;
    case REGULAR_POINTS3_XY:
    case REGULAR_POINTS3_XYZ:
        compute_axes(steps);
        return REGULAR_OK;
    case REGULAR_POINTS3_PLANE:
        // Two points have no plane: only the line through them is in the way.
        if (steps->input->count < 3U) {
            compute_line(steps);
            return REGULAR_OK;
        }
        return steps->options->small ? compute_circles(steps) : compute_plane(steps);
    case REGULAR_POINTS3_COCIRCULAR:
        return compute_cocircular(steps);
    case REGULAR_SEGMENTS2_VERTICAL:
    case REGULAR_SEGMENTS3_VERTICAL:
        compute_vertical(steps);
        return REGULAR_OK;
    case REGULAR_SEGMENTS3_PLANE:
    case REGULAR_FACES_VERTICAL:
        return compute_circles(steps);
    default:
        compute_line(steps);
        return REGULAR_OK;
    }
}

enum regular_status steps_compute(struct steps *steps) {
    enum regular_status status = REGULAR_OK;
    steps_decide(steps);
    steps->result->conflict.count = 0;
    if (steps->result->regular) {
        compute_as_given(steps);
    } else {
        steps->result->regular = true;
        status = compute_otherwise(steps);
    }
    steps->result->operations += steps->order.operations + steps->lines.operations;
    return status;
}
