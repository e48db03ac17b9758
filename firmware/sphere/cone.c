#include "sphere/cone.h"

#include "sphere/certify.h"
#include "sphere/cone_answer.h"
#include "sphere/cone_search.h"
#include "sphere/feasible.h"

/// Settles what the rounded unit vectors leave open.
static enum cone_status settle_feasibility(struct cone_search *search, bool surrounded,
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
        search->axis_q30 = min_norm_axis(&support);
    }
    return CONE_OK;
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

/// Begins with the warm start's points, or the first point. False: they surround the viewpoint.
static bool start(struct cone_search *search, const struct cone_options *options) {
    const bool warm = options->warm_count != 0U && options->warm[0] < search->count;
    struct min_norm_point point;
    (void)cone_search_point(search, warm ? options->warm[0] : 0U, &point);
    min_norm_start(&search->support, &point, true);
    search->pivots = 1;
    for (uint8_t i = 1; warm && i < options->warm_count && i < 3U; i++) {
        if (options->warm[i] < search->count) {
            (void)cone_search_point(search, options->warm[i], &point);
            if (min_norm_violated_by(&search->support, &point)) {
                search->surrounding = point.index;
                search->pivots++;
                if (!min_norm_enter(&search->support, &point)) {
                    return false;
                }
            }
        }
    }
    search->given_pivots = search->pivots;
    return true;
}

static enum cone_status solve(struct cone_search *search, const struct cone_options *options,
                              struct cone_result *result) {
    const bool few = search->count <= CONE_FEW_POINTS;
    enum cone_outcome outcome = CONE_SURROUNDED;
    if (start(search, options)) {
        outcome = few ? cone_few_pivot(search) : cone_blocks_pivot(search);
    }
    const struct vec3 *const points = search->points;
    if (outcome == CONE_OUT_OF_READS) {
        cone_report(points, search->axis_q30, &search->support, search->support.point[0].index,
                    result);
        return CONE_UNFINISHED;
    }
    const enum cone_status status = settle_feasibility(search, outcome == CONE_SURROUNDED, result);
    CERTIFY(status != CONE_INFEASIBLE ||
            certify_witness(points, result->witness, result->witness_count));
    CERTIFY(status != CONE_OK || outcome == CONE_SURROUNDED ||
            certify_held(points, search->count, &search->support));
    if (status == CONE_OK) {
        const uint32_t farthest = few ? cone_few_farthest(search) : cone_blocks_farthest(search);
        cone_report(points, search->axis_q30, &search->support, farthest, result);
    }
    return status;
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
    const size_t note_bytes = CONE_WORKSPACE_UNIT_BYTES(count);
    struct vec3 *copies =
        copy ? (struct vec3 *)(void *)((char *)options->workspace + note_bytes) : NULL;
    if (copy && !copy_units(points, count, copies, result)) {
        return CONE_ERROR_ZERO_VECTOR;
    }
    struct cone_block own_block;
    struct cone_search search;
    search.points = points;
    search.units = copy ? copies : points;
    search.count = count;
    search.point_reads = result->point_reads;
    search.read_limit = options->read_limit;
    search.alone = search.swept = search.all_ahead = false;
    search.block_step = count;
    search.blocks = &own_block;
    search.block_room = 1;
    if (options->workspace_bytes >= note_bytes) {
        search.blocks = options->workspace;
        search.block_room = (uint32_t)(note_bytes / sizeof(struct cone_block));
    }
    const enum cone_status status = solve(&search, options, result);
    result->point_reads = search.point_reads;
    return status;
}
