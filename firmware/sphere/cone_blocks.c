#include "fixed/not_inline.h"
#include "fixed/root.h"
#include "sphere/cone_filter.h"
#include "sphere/cone_search.h"

static struct cone_filter make_filter(const struct cone_search *search) {
    return cone_filter(search->axis_q30, search->units[search->support.point[0].index],
                       search->all_ahead);
}

/// Below it a measure tells that a point may be outside.
static int64_t limit_of(const struct cone_filter *filter) {
    return filter->decides ? filter->surely_inside : filter->surely_outside;
}

// ---------------------------------------------------------------- reading points

/// The least measure of the points from, from + stride, ... below `end`. This loop reads every
/// point; all else happens rarely. Inside of its callers it would lack registers.
NOT_INLINE static int64_t least_measure(struct cone_search *search,
                                        const struct cone_filter *filter, uint32_t from,
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
    if (stride == 1U) { // a step that the compiler knows saves a quarter of the loop
        for (; unit < last; unit++) {
            const int64_t measure = x * unit->x + y * unit->y + z * unit->z;
            least = measure < least ? measure : least;
        }
        return least;
    }
    for (; unit < last; unit += stride) {
        const int64_t measure = x * unit->x + y * unit->y + z * unit->z;
        least = measure < least ? measure : least;
    }
    return least;
}

/// The same without the support's own points: they are on the circle, and would call for a second
/// look each time.
static int64_t least_of_others(struct cone_search *search, const struct cone_filter *filter,
                               uint32_t from, uint32_t end, uint32_t stride) {
    int64_t least = INT64_MAX;
    while (from < end) {
        uint32_t own = end;
        for (uint8_t i = 0; i < search->support.count; i++) {
            const uint32_t index = search->support.point[i].index;
            own = index >= from && index < own && (index - from) % stride == 0U ? index : own;
        }
        const int64_t measure = least_measure(search, filter, from, own, stride);
        least = measure < least ? measure : least;
        from = own + stride;
    }
    return least;
}

/// The point of a block that is farthest out of those that violate; CONE_NO_POINT if none does.
static uint32_t worst_of_block(struct cone_search *search, const struct cone_filter *filter,
                               uint32_t from, uint32_t end, uint32_t stride) {
    int64_t limit = limit_of(filter);
    uint32_t worst = CONE_NO_POINT;
    search->point_reads += (end - from + stride - 1U) / stride;
    for (uint32_t i = from; i < end; i += stride) {
        const int64_t of_point = cone_measure(filter, search->units[i]);
        if (of_point < limit &&
            (of_point < filter->surely_outside || cone_search_violates(search, i))) {
            worst = i;
            limit = of_point;
        }
    }
    return worst;
}

/// Points that have left the support are points as others again: the notes on their blocks must
/// tell of them.
static void note_those_who_left(struct cone_search *search, const uint32_t old[3], uint8_t count) {
    for (uint8_t i = 0; i < count; i++) {
        struct cone_block *const block = &search->blocks[old[i] / search->block_step];
        if (block->pivots != 0U && !cone_search_has(search, old[i])) {
            const int64_t measure = vec3_dot_unit(block->axis_q30, search->units[old[i]]);
            block->least = measure < block->least ? measure : block->least;
        }
    }
}

/// Pivots until no point of the block violates.
static enum cone_outcome settle_block(struct cone_search *search, struct cone_filter *filter,
                                      struct cone_block *block, uint32_t from, uint32_t end,
                                      uint32_t stride) {
    for (;;) {
        block->least = least_of_others(search, filter, from, end, stride);
        block->axis_q30 = search->axis_q30;
        block->pivots = search->pivots;
        if (block->least >= limit_of(filter)) {
            return CONE_FOUND;
        }
        uint32_t old[3];
        const uint8_t count = search->support.count;
        for (uint8_t i = 0; i < count; i++) {
            old[i] = search->support.point[i].index;
        }
        const uint32_t worst = worst_of_block(search, filter, from, end, stride);
        const enum cone_outcome outcome = cone_search_enter(search, worst, from, end, stride);
        if (outcome == CONE_FOUND || outcome == CONE_SURROUNDED) {
            return outcome;
        }
        search->axis_q30 = min_norm_axis(&search->support);
        *filter = make_filter(search);
        note_those_who_left(search, old, count);
        if (outcome == CONE_OUT_OF_READS) {
            return outcome;
        }
    }
}

/// Could a measure in the block be below the limit now? No axis moves a dot product by more than it
/// moves itself.
static bool may_be_below(const struct cone_search *search, const struct cone_block *block,
                         int64_t limit) {
    if (block->least < limit) {
        return true;
    }
    const uint64_t slack_q30 = (uint64_t)(block->least - limit) >> 30;
    const uint64_t x = u64_abs((int64_t)search->axis_q30.x - block->axis_q30.x),
                   y = u64_abs((int64_t)search->axis_q30.y - block->axis_q30.y),
                   z = u64_abs((int64_t)search->axis_q30.z - block->axis_q30.z);
    return x * x + y * y + z * z >= slack_q30 * slack_q30; // both below 2^63: |axes| are 2^30
}

static bool is_doubtful(const struct cone_search *search, const struct cone_filter *filter,
                        const struct cone_block *block) {
    if (block->pivots == search->pivots) {
        return false; // settled with this very support
    }
    return filter->narrow || block->pivots == 0U || may_be_below(search, block, limit_of(filter));
}

static uint32_t block_end(const struct cone_search *search, uint32_t from) {
    const uint32_t left = search->count - from;
    return left < search->block_step ? search->count : from + search->block_step;
}

/// Cuts every stride-th point into as many blocks as there is room for notes.
static void cut_blocks(struct cone_search *search, uint32_t stride) {
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
static enum cone_outcome sweep(struct cone_search *search, uint32_t stride) {
    cut_blocks(search, stride);
    struct cone_filter filter = make_filter(search);
    for (bool doubtful = true; doubtful;) {
        doubtful = false;
        for (uint32_t from = 0, b = 0; from < search->count; from += search->block_step, b++) {
            if (!is_doubtful(search, &filter, &search->blocks[b])) {
                continue;
            }
            doubtful = true;
            const enum cone_outcome outcome = settle_block(search, &filter, &search->blocks[b],
                                                           from, block_end(search, from), stride);
            if (outcome != CONE_FOUND || cone_search_is_over(search)) {
                return outcome != CONE_FOUND ? outcome : CONE_OUT_OF_READS;
            }
        }
    }
    search->swept = stride == 1U;
    return CONE_FOUND;
}

/// About 2 sqrt(count) points, evenly strided, are solved first: the pivots then happen on a small
/// set, and the whole set is read about once, also when it winds outward.
static uint32_t sample_stride(uint32_t count) {
    return count < 256U ? 1U : count / (2U * root_u32(count));
}

enum cone_outcome cone_blocks_pivot(struct cone_search *search) {
    search->axis_q30 = min_norm_axis(&search->support);
    const uint32_t stride = search->support.count > 1U ? 1U : sample_stride(search->count);
    enum cone_outcome outcome = stride > 1U ? sweep(search, stride) : CONE_FOUND;
    if (outcome == CONE_FOUND) {
        outcome = sweep(search, 1);
    }
    // Narrow cones: only now is every point known to be ahead, and the finer filter right.
    const struct cone_filter filter = make_filter(search);
    if (outcome == CONE_FOUND && !filter.decides) {
        search->all_ahead = true;
        outcome = sweep(search, 1);
    }
    return outcome;
}

/// May a point in the block, other than the support's own, reach to the circle?
static bool may_reach(const struct cone_search *search, const struct cone_filter *filter,
                      const struct cone_block *block) {
    if (!search->swept) {
        return true;
    }
    return filter->narrow ? block->least < filter->surely_inside // read with this very filter
                          : may_be_below(search, block, filter->surely_inside);
}

/// Only blocks that may reach to the circle are read again.
uint32_t cone_blocks_farthest(struct cone_search *search) {
    const struct cone_filter filter = make_filter(search);
    struct cone_farthest farthest;
    cone_search_own(search, &farthest);
    for (uint32_t from = 0, b = 0; from < search->count; from += search->block_step, b++) {
        if (!may_reach(search, &filter, &search->blocks[b])) {
            continue;
        }
        const uint32_t end = block_end(search, from);
        search->point_reads += end - from;
        for (uint32_t i = from; i < end; i++) {
            if (cone_measure(&filter, search->units[i]) < filter.surely_inside) {
                cone_farthest_add(&farthest, i);
            }
        }
    }
    return farthest.index;
}
