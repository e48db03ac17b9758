#include "regular/regular.h"

#include "regular/optimum.h"
#include "regular/primitive.h"
#include "regular/steps.h"

static const struct regular_options no_options;

static bool is_points(enum regular_problem problem) {
    return regular_points_of(problem) == 1U;
}

void steps_conflict(struct regular_result *result, uint8_t count, const uint32_t *index) {
    struct regular_conflict *const conflict = &result->conflict;
    *conflict = (struct regular_conflict){.count = 0};
    for (uint8_t i = 0; i < count; i++) {
        uint8_t at = conflict->count++;
        for (; at > 0U && conflict->index[at - 1U] > index[i]; at--) {
            conflict->index[at] = conflict->index[at - 1U];
        }
        conflict->index[at] = index[i];
    }
}

struct vec3 steps_segment(const struct regular_input *input, uint32_t index) {
    const struct vec3 *const end = input->points + 2U * (size_t)index;
    return primitive_between(end[0], end[1]);
}

struct vec3_i64 steps_normal(struct vec3 a, struct vec3 b, struct vec3 c) {
    return vec3_cross(primitive_between(a, b), primitive_between(a, c));
}

// ---------------------------------------------------------------- sizes

/// What fits about a gigabyte; and within hours.
static uint32_t optimize_max(enum regular_problem problem, bool slender) {
    switch (problem) {
    case REGULAR_POINTS2_LINE:
        return 8192;
    case REGULAR_POINTS3_LINE:
        return 2048;
    case REGULAR_POINTS3_X:
    case REGULAR_SEGMENTS3_PLANE:
        return slender ? 512U : 100U;
    case REGULAR_POINTS3_XY:
    case REGULAR_POINTS3_XYZ:
        return 512;
    case REGULAR_POINTS3_PLANE:
        return slender ? 96U : 32U;
    case REGULAR_FACES_VERTICAL:
        return slender ? 131072U : 4960U;
    default:
        return UINT32_C(1) << 21;
    }
}

static uint32_t count_max(enum regular_problem problem, enum regular_step step,
                          const struct regular_options *options) {
    if (problem == REGULAR_POINTS3_COCIRCULAR) {
        return 512;
    }
    if (step == REGULAR_OPTIMIZE) {
        return optimize_max(problem, options->cylinder || options->above);
    }
    if (problem == REGULAR_POINTS3_PLANE) {
        return step == REGULAR_COMPUTE && options->small ? 4096U : 16384U;
    }
    if (problem == REGULAR_SEGMENTS3_PLANE && step == REGULAR_COMPUTE) {
        return 16384;
    }
    return UINT32_C(1) << 24;
}

uint32_t regular_count_max(enum regular_problem problem, enum regular_step step,
                           const struct regular_options *options) {
    return count_max(problem, step, options == NULL ? &no_options : options);
}

/// Lays out what a step needs. optimum: for optimize only.
static void lay_out(struct steps *steps, struct optimum *optimum, enum regular_problem problem,
                    uint32_t count, struct arena *arena) {
    const struct vec3 *const points = steps->input == NULL ? NULL : steps->input->points;
    if (is_points(problem)) {
        order_open(&steps->order, points, count, steps->options->buckets, arena);
    }
    if (problem == REGULAR_POINTS3_PLANE || problem == REGULAR_POINTS3_COCIRCULAR) {
        line_table_open(&steps->lines, count, arena);
    }
    if (problem == REGULAR_SEGMENTS3_PLANE) {
        steps->trace = arena_take(arena, count, sizeof *steps->trace);
        steps->list = arena_take(arena, count, sizeof *steps->list);
        steps->spare = arena_take(arena, count, sizeof *steps->spare);
    }
    if (optimum != NULL) {
        optimum_open(optimum, problem, count, steps->options, arena);
    }
}

uint64_t regular_workspace_bytes(enum regular_problem problem, enum regular_step step,
                                 uint32_t count, const struct regular_options *options) {
    struct arena arena = {NULL, 0};
    struct steps steps = {.options = options == NULL ? &no_options : options};
    struct optimum optimum;
    lay_out(&steps, step == REGULAR_OPTIMIZE ? &optimum : NULL, problem, count, &arena);
    return arena.used;
}

// ---------------------------------------------------------------- the input

static enum regular_status fault(struct regular_result *result, enum regular_status status,
                                 uint32_t item) {
    steps_conflict(result, 1, &item);
    return status;
}

static bool in_range(struct vec3 a, bool planar) {
    const int32_t most = REGULAR_COORDINATE_MAX;
    return a.x >= -most && a.x <= most && a.y >= -most && a.y <= most && a.z >= -most &&
           a.z <= most && (!planar || a.z == 0);
}

static enum regular_status check_items(const struct regular_input *input,
                                       struct regular_result *result) {
    const uint32_t of = regular_points_of(input->problem);
    for (uint32_t i = 0; i < input->count; i++) {
        const struct vec3 *const item = input->points + (size_t)of * i;
        for (uint32_t k = 0; k < of; k++) {
            if (!in_range(item[k], regular_is_planar(input->problem))) {
                return fault(result, REGULAR_ERROR_RANGE, i);
            }
        }
        if ((of == 2U && vec3_equal(item[0], item[1])) ||
            (of == 3U && primitive_is_zero(steps_normal(item[0], item[1], item[2])))) {
            return fault(result, REGULAR_ERROR_DEGENERATE, i);
        }
    }
    return REGULAR_OK;
}

static enum regular_status check_repeated(struct order *order, struct regular_result *result) {
    order_by(order, 0);
    for (uint32_t i = 1; i < order->count; i++) {
        const uint32_t pair[4] = {order->list[i - 1U], order->list[i]};
        if (vec3_equal(order->points[pair[0]], order->points[pair[1]])) {
            steps_conflict(result, 2, pair);
            return REGULAR_ERROR_REPEATED;
        }
    }
    return REGULAR_OK;
}

static enum regular_status open(struct steps *steps, struct optimum *optimum,
                                const struct regular_input *input, enum regular_step step,
                                const struct regular_options *options, void *workspace,
                                size_t workspace_bytes, struct regular_result *result) {
    *result = (struct regular_result){.regular = false};
    *steps = (struct steps){
        .input = input, .options = options == NULL ? &no_options : options, .result = result};
    if (input->count > count_max(input->problem, step, steps->options)) {
        return REGULAR_ERROR_COUNT;
    }
    if (workspace_bytes <
        regular_workspace_bytes(input->problem, step, input->count, steps->options)) {
        return REGULAR_ERROR_WORKSPACE;
    }
    struct arena arena = {workspace, 0};
    lay_out(steps, optimum, input->problem, input->count, &arena);
    enum regular_status status = check_items(input, result);
    const uint32_t *const weights = steps->options->weights;
    for (uint32_t i = 0; weights != NULL && status == REGULAR_OK && i < input->count; i++) {
        if (weights[i] == 0U || weights[i] > REGULAR_WEIGHT_MAX) {
            status = fault(result, REGULAR_ERROR_RANGE, i);
        }
    }
    if (status != REGULAR_OK || !is_points(input->problem)) {
        return status;
    }
    return check_repeated(&steps->order, result);
}

// ---------------------------------------------------------------- the steps

enum regular_status regular_decide(const struct regular_input *input,
                                   const struct regular_options *options, void *workspace,
                                   size_t workspace_bytes, struct regular_result *result) {
    struct steps steps;
    const enum regular_status status =
        open(&steps, NULL, input, REGULAR_DECIDE, options, workspace, workspace_bytes, result);
    if (status == REGULAR_OK) {
        steps_decide(&steps);
    }
    return status;
}

enum regular_status regular_compute(const struct regular_input *input,
                                    const struct regular_options *options, void *workspace,
                                    size_t workspace_bytes, struct regular_result *result) {
    struct steps steps;
    const enum regular_status status =
        open(&steps, NULL, input, REGULAR_COMPUTE, options, workspace, workspace_bytes, result);
    return status == REGULAR_OK ? steps_compute(&steps) : status;
}

enum regular_status regular_optimize(const struct regular_input *input,
                                     const struct regular_options *options, void *workspace,
                                     size_t workspace_bytes, struct regular_result *result) {
    struct steps steps;
    struct optimum optimum;
    const enum regular_status status = open(&steps, &optimum, input, REGULAR_OPTIMIZE, options,
                                            workspace, workspace_bytes, result);
    if (status != REGULAR_OK) {
        return status;
    }
    return input->problem == REGULAR_POINTS3_COCIRCULAR ? REGULAR_ERROR_OPEN
                                                        : optimum_find(&steps, &optimum);
}
