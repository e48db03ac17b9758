#include "sphere/cone.h"

#include "fixed/root.h"
#include "sphere/certify.h"
#include "sphere/cone_answer.h"
#include "sphere/cone_filter.h"
#include "sphere/feasible.h"
#include "sphere/min_norm.h"

#include <stdbool.h>

/// Notes on a block of points, from when it was last read: no point's measure from `axis_q30` was
/// below `least`. With another axis the block is read again only if a point in it could now lie
/// outside.
struct block {
    int64_t least;
    struct vec3 axis_q30;
    uint32_t pivots; // of the search by then, from 1; 0: not read yet
};

/// The search. `units` are the points in Q1.30 with a length within 2^-29 of one: the points
/// themselves, or copies in the workspace. Filters read units; decisions are made on the points,
/// normalised to Q2.61.
struct search {
    const struct vec3 *points;
    const struct vec3 *units;
    uint32_t count;
    struct block *blocks;
    uint32_t block_room, block_step; // how many blocks at most; points from one to the next
    bool swept;                      // the notes are of all points
    struct min_norm support;
    struct vec3 axis_q30;
    uint32_t pivots;       // supports so far
    uint32_t given_pivots; // of them, those of the warm start
    bool all_ahead;        // a pass has seen every point within 2^-7 rad of an axis of this search
    uint64_t point_reads, read_limit;
    uint32_t surrounding; // the point that put zero into the hull of itself and the support
};

#define NO_POINT UINT32_MAX

enum outcome { FOUND, SURROUNDED, OUT_OF_READS };

// ---------------------------------------------------------------- reading points

static struct cone_filter make_filter(const struct search *search) {
    return cone_filter(search->axis_q30, search->units[search->support.point[0].index],
                       search->all_ahead);
}

/// The least measure of the points from, from + stride, ... below `end`. This loop reads every
/// point; all else happens rarely.
static int64_t least_measure(struct search *search, const struct cone_filter *filter, uint32_t from,
                             uint32_t end, uint32_t stride) {
    const struct vec3 *unit = search->units + from, *last = search->units + end;
    int64_t least = INT64_MAX;
    search->point_reads += stride == 1U ? end - from : (end - from + stride - 1U) / stride;
    if (filter->narrow) {
        for (; unit < last; unit += stride) {
            const int64_t measure = cone_measure_narrow(filter, *unit);
            least = measure < least ? measure : least;
        }
        return least;
    }
    const int64_t x = filter->axis_q30.x, y = filter->axis_q30.y, z = filter->axis_q30.z;
    for (; unit < last; unit += stride) {
        const int64_t measure = x * unit->x + y * unit->y + z * unit->z;
        least = measure < least ? measure : least;
    }
    return least;
}

// ---------------------------------------------------------------- pivoting

/// A point as it may enter the support. There its unit vector must be one, or supports could come
/// twice: a broken promise about the lengths is mended here.
static struct min_norm_point point_of(const struct search *search, uint32_t index) {
    const struct vec3 unit = search->units[index];
    const uint64_t near = UINT64_C(1) << 32;
    const bool kept = vec3_norm2(unit) - ((UINT64_C(1) << 60) - near) <= 2U * near;
    return (struct min_norm_point){.index = index,
                                   .given = search->points[index],
                                   .unit_q30 = kept ? unit : vec3_normalise(unit)};
}

static bool is_in_support(const struct search *search, uint32_t index) {
    for (uint8_t i = 0; i < search->support.count; i++) {
        if (search->support.point[i].index == index) {
            return true;
        }
    }
    return false;
}

/// Exact.
static bool violates(struct search *search, uint32_t index) {
    if (is_in_support(search, index)) {
        return false; // its own points lie on the circle
    }
    search->point_reads += 16U * (search->read_limit != 0U); // what it costs, for those who count
    const struct min_norm_point point = point_of(search, index);
    return min_norm_violated_by(&search->support, &point);
}

/// Not before a pivot: a search that stops has come nearer, so repeated calls arrive.
static bool is_over_limit(const struct search *search) {
    return search->read_limit != 0U && search->point_reads >= search->read_limit &&
           search->pivots > search->given_pivots;
}

/// Takes a violating point in. False: it puts zero into the hull.
static bool enter(struct search *search, const struct min_norm_point *point) {
    search->surrounding = point->index;
    search->pivots++;
    return min_norm_enter(&search->support, point);
}

static void turn_axis(struct search *search) {
    search->axis_q30 = vec3_i64_normalise(min_norm_direction(&search->support));
}

/// The point of a block that is farthest out of those that violate; NO_POINT if none does.
static uint32_t worst_of_block(struct search *search, const struct cone_filter *filter,
                               uint32_t from, uint32_t end, uint32_t stride) {
    int64_t limit = filter->decides ? filter->surely_inside : filter->surely_outside;
    uint32_t worst = NO_POINT;
    search->point_reads += (end - from + stride - 1U) / stride;
    for (uint32_t i = from; i < end; i += stride) {
        const int64_t of_point = cone_measure(filter, search->units[i]);
        if (of_point < limit && (of_point < filter->surely_outside || violates(search, i))) {
            worst = i;
            limit = of_point;
        }
    }
    return worst;
}

/// The point that enters: a filter's worst one, which does violate unless the promise about the
/// lengths is broken; then exact tests are the slow way round. False: no point of these violates.
static bool choose(struct search *search, uint32_t worst, uint32_t from, uint32_t end,
                   uint32_t stride, struct min_norm_point *point) {
    if (worst == NO_POINT) {
        return false;
    }
    *point = point_of(search, worst);
    bool violating = min_norm_violated_by(&search->support, point);
    for (uint32_t i = from; !violating && i < end; i += stride) {
        *point = point_of(search, i);
        violating = min_norm_violated_by(&search->support, point);
    }
    return violating;
}

/// Pivots until no point of the block violates.
static enum outcome settle_block(struct search *search, struct cone_filter *filter,
                                 struct block *block, uint32_t from, uint32_t end,
                                 uint32_t stride) {
    for (;;) {
        block->least = least_measure(search, filter, from, end, stride);
        block->axis_q30 = search->axis_q30;
        block->pivots = search->pivots;
        if (block->least >= (filter->decides ? filter->surely_inside : filter->surely_outside)) {
            return FOUND;
        }
        const uint32_t worst = worst_of_block(search, filter, from, end, stride);
        struct min_norm_point point;
        if (!choose(search, worst, from, end, stride, &point)) {
            return FOUND;
        }
        if (!enter(search, &point)) {
            return SURROUNDED;
        }
        turn_axis(search);
        *filter = make_filter(search);
        if (is_over_limit(search)) {
            return OUT_OF_READS;
        }
    }
}

/// Could a measure in the block be below the limit now? No axis moves a dot product by more than it
/// moves itself.
static bool may_be_below(const struct search *search, const struct block *block, int64_t limit) {
    if (block->least < limit) {
        return true;
    }
    const uint64_t slack_q30 = (uint64_t)(block->least - limit) >> 30;
    const uint64_t x = u64_abs((int64_t)search->axis_q30.x - block->axis_q30.x),
                   y = u64_abs((int64_t)search->axis_q30.y - block->axis_q30.y),
                   z = u64_abs((int64_t)search->axis_q30.z - block->axis_q30.z);
    return x * x + y * y + z * z >= slack_q30 * slack_q30; // both below 2^63: |axes| are 2^30
}

static bool is_doubtful(const struct search *search, const struct cone_filter *filter,
                        const struct block *block) {
    if (block->pivots == search->pivots) {
        return false; // settled with this very support
    }
    return filter->narrow || block->pivots == 0U ||
           may_be_below(search, block,
                        filter->decides ? filter->surely_inside : filter->surely_outside);
}

static uint32_t block_end(const struct search *search, uint32_t from) {
    const uint32_t left = search->count - from;
    return left < search->block_step ? search->count : from + search->block_step;
}

/// Cuts every stride-th point into as many blocks as there is room for notes.
static void cut_blocks(struct search *search, uint32_t stride) {
    const uint32_t members = (search->count - 1U) / stride + 1U;
    // Small blocks save reads, large ones bookkeeping: make bench-cone found these.
    uint32_t per_block = root_u32(search->count) / 4U;
    per_block = per_block < CONE_BLOCK_POINTS ? CONE_BLOCK_POINTS : per_block;
    per_block = per_block > 64U ? 64U : per_block;
    per_block = stride > 1U ? 4U : per_block;
    const uint32_t least = (members - 1U) / search->block_room + 1U;
    per_block = per_block < least ? least : per_block;
    search->block_step = per_block * stride;
    for (uint32_t b = 0; b < (members - 1U) / per_block + 1U; b++) {
        search->blocks[b].pivots = 0;
    }
}

/// Pivots on every stride-th point until none violates. Each pivot shortens the norm of the
/// support's nearest point, so no support comes twice and the loop ends.
static enum outcome sweep(struct search *search, uint32_t stride) {
    cut_blocks(search, stride);
    struct cone_filter filter = make_filter(search);
    for (bool doubtful = true; doubtful;) {
        doubtful = false;
        for (uint32_t from = 0, b = 0; from < search->count; from += search->block_step, b++) {
            if (!is_doubtful(search, &filter, &search->blocks[b])) {
                continue;
            }
            doubtful = true;
            const enum outcome outcome = settle_block(search, &filter, &search->blocks[b], from,
                                                      block_end(search, from), stride);
            if (outcome != FOUND || is_over_limit(search)) {
                return outcome != FOUND ? outcome : OUT_OF_READS;
            }
        }
    }
    search->swept = stride == 1U;
    return FOUND;
}

/// The point of least depth of those that violate the support; NO_POINT if none does.
static uint32_t worst_of_few(struct search *search) {
    const struct min_norm_filter filter = min_norm_filter(&search->support);
    int64_t limit = MIN_NORM_BAND;
    uint32_t worst = NO_POINT;
    search->point_reads += search->count;
    for (uint32_t i = 0; i < search->count; i++) {
        const int64_t depth = min_norm_depth(&filter, search->units[i]);
        if (depth < limit && (depth < -MIN_NORM_BAND || violates(search, i))) {
            worst = i;
            limit = depth;
        }
    }
    return worst;
}

/// Up to so many points it is cheaper to read all of them at each pivot than to work out an axis
/// there: half the instructions at 100 points, as many at 400.
#define FEW_POINTS 256U

/// Few points: the 64-bit filters of the support itself decide nearly all, and the axis is worked
/// out once, at the end.
static enum outcome pivot_few(struct search *search) {
    for (;;) {
        const uint32_t worst = worst_of_few(search);
        struct min_norm_point point;
        if (!choose(search, worst, 0, search->count, 1, &point)) {
            turn_axis(search);
            return FOUND;
        }
        if (!enter(search, &point)) {
            return SURROUNDED;
        }
        if (is_over_limit(search)) {
            turn_axis(search);
            return OUT_OF_READS;
        }
    }
}

/// About 2 sqrt(count) points, evenly strided, are solved first: the pivots then happen on a small
/// set, and the whole set is read about once, also when it winds outward.
static uint32_t sample_stride(uint32_t count) {
    return count < 256U ? 1U : count / (2U * root_u32(count));
}

static enum outcome pivot_many(struct search *search) {
    turn_axis(search);
    const uint32_t stride = search->support.count > 1U ? 1U : sample_stride(search->count);
    enum outcome outcome = stride > 1U ? sweep(search, stride) : FOUND;
    if (outcome == FOUND) {
        outcome = sweep(search, 1);
    }
    // Narrow cones: only now is every point known to be ahead, and the finer filter right.
    const struct cone_filter filter = make_filter(search);
    if (outcome == FOUND && !filter.decides) {
        search->all_ahead = true;
        outcome = sweep(search, 1);
    }
    return outcome;
}

// ---------------------------------------------------------------- the answer

/// Settles what the rounded unit vectors leave open.
static enum cone_status settle_feasibility(struct search *search, bool surrounded,
                                           struct cone_result *result) {
    if (surrounded) {
        result->witness_count = feasible_witness(search->points, &search->support,
                                                 search->surrounding, result->witness);
        if (result->witness_count != 0U) {
            return CONE_INFEASIBLE;
        }
    } else {
        // 2^-20 of cosine is far above every rounding: all points are ahead of the axis.
        const struct vec3 on_circle = search->units[search->support.point[0].index];
        if (vec3_dot_unit(search->axis_q30, on_circle) > (int64_t)1 << 40) {
            return CONE_OK;
        }
    }
    struct min_norm support;
    if (!feasible_decide(search->points, search->count, &support, result->witness,
                         &result->witness_count, &search->point_reads)) {
        return CONE_INFEASIBLE;
    }
    if (surrounded) { // any axis that sees all is within 2^-59 rad of the best half-angle
        search->support = support;
        search->axis_q30 = vec3_i64_normalise(min_norm_direction(&support));
    }
    return CONE_OK;
}

/// Of few points, those well inside the support's plane can't be farthest: the band is wider than
/// what rounding the axis does.
static uint32_t farthest_of_few(struct search *search) {
    const struct min_norm_filter inside = min_norm_filter(&search->support);
    uint32_t farthest = search->support.point[0].index;
    search->point_reads += search->count;
    for (uint32_t i = 0; i < search->count; i++) {
        if (min_norm_depth(&inside, search->units[i]) <= MIN_NORM_BAND && i != farthest &&
            cone_is_farther(search->axis_q30, search->points[i], search->points[farthest])) {
            farthest = i;
        }
    }
    return farthest;
}

/// A point at the largest true angle from the axis as printed. Only blocks that may reach the
/// circle are read again.
static uint32_t find_farthest(struct search *search) {
    const struct cone_filter filter = make_filter(search);
    uint32_t farthest = search->support.point[0].index;
    for (uint32_t from = 0, b = 0; from < search->count; from += search->block_step, b++) {
        const struct block *block = &search->blocks[b];
        if (search->swept && !filter.narrow && !may_be_below(search, block, filter.surely_inside)) {
            continue;
        }
        const uint32_t end = block_end(search, from);
        search->point_reads += end - from;
        for (uint32_t i = from; i < end; i++) {
            if (cone_measure(&filter, search->units[i]) < filter.surely_inside &&
                cone_is_farther(search->axis_q30, search->points[i], search->points[farthest])) {
                farthest = i;
            }
        }
    }
    return farthest;
}

/// Normalised copies of points of any length.
static bool copy_units(const struct vec3 *points, uint32_t count, struct vec3 *copies,
                       struct cone_result *result) {
    for (uint32_t i = 0; i < count; i++) {
        if (vec3_is_zero(points[i])) {
            result->bad_index = i;
            return false;
        }
        copies[i] = vec3_normalise(points[i]);
    }
    result->point_reads = count;
    return true;
}

/// Begins with the warm start's points, or the first point.
static bool start(struct search *search, const struct cone_options *options) {
    const bool warm = options->warm_count != 0U && options->warm[0] < search->count;
    const struct min_norm_point first = point_of(search, warm ? options->warm[0] : 0U);
    min_norm_start(&search->support, &first, true);
    search->pivots = 1;
    for (uint8_t i = 1; warm && i < options->warm_count && i < 3U; i++) {
        if (options->warm[i] < search->count) {
            const struct min_norm_point next = point_of(search, options->warm[i]);
            if (min_norm_violated_by(&search->support, &next) && !enter(search, &next)) {
                return false;
            }
        }
    }
    search->given_pivots = search->pivots;
    return true;
}

enum cone_status cone_narrowest(const struct vec3 *points, uint32_t count,
                                const struct cone_options *options, struct cone_result *result) {
    *result = (struct cone_result){0};
    const bool copy = options->lengths == CONE_LENGTHS_ANY;
    if (count == 0U) {
        return CONE_EMPTY;
    }
    if (copy && options->workspace_bytes < CONE_WORKSPACE_BYTES(count)) {
        return CONE_ERROR_WORKSPACE;
    }
    struct block own_block;
    const size_t note_bytes = CONE_WORKSPACE_UNIT_BYTES(count);
    const bool notes = options->workspace_bytes >= note_bytes;
    struct vec3 *copies =
        copy ? (struct vec3 *)(void *)((char *)options->workspace + note_bytes) : NULL;
    if (copy && !copy_units(points, count, copies, result)) {
        return CONE_ERROR_ZERO_VECTOR;
    }
    struct search search = {.points = points,
                            .units = copy ? copies : points,
                            .count = count,
                            .blocks = notes ? options->workspace : &own_block,
                            .block_step = count,
                            .block_room =
                                notes ? (uint32_t)(note_bytes / sizeof(struct block)) : 1U,
                            .point_reads = result->point_reads,
                            .read_limit = options->read_limit};
    enum outcome outcome = SURROUNDED;
    if (start(&search, options)) {
        outcome = count <= FEW_POINTS ? pivot_few(&search) : pivot_many(&search);
    }
    enum cone_status status = CONE_UNFINISHED;
    if (outcome == OUT_OF_READS) {
        cone_report(points, search.axis_q30, &search.support, search.support.point[0].index,
                    result);
    } else {
        status = settle_feasibility(&search, outcome == SURROUNDED, result);
    }
    CERTIFY(status != CONE_INFEASIBLE ||
            certify_witness(points, result->witness, result->witness_count));
    CERTIFY(status != CONE_OK || outcome == SURROUNDED ||
            certify_held(points, count, &search.support));
    if (status == CONE_OK) {
        const uint32_t farthest =
            count <= FEW_POINTS ? farthest_of_few(&search) : find_farthest(&search);
        cone_report(points, search.axis_q30, &search.support, farthest, result);
    }
    result->point_reads = search.point_reads;
    return status;
}
