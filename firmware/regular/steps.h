/// What regular.c calls for each step, and what the steps share. For the files of regular/ only.
#ifndef REGULAR_STEPS_H
#define REGULAR_STEPS_H

#include "regular/cocircular.h"
#include "regular/order.h"
#include "regular/regular.h"

/// Everything that a step may need, laid out in the workspace.
struct steps {
    const struct regular_input *input;
    const struct regular_options *options;
    struct regular_result *result;
    struct order order; ///< of the points, if the items are points
    struct line_table lines;
    /// SEGMENTS3_PLANE: the line of each projected segment, and two lists of segments.
    struct vec3_i64 *trace;
    uint32_t *list, *spare;
};

/// The conflict of a result, with the indices ascending.
void steps_conflict(struct regular_result *result, uint8_t count, const uint32_t *index);

/// Two ends of a segment, as a vector.
struct vec3 steps_segment(const struct regular_input *input, uint32_t index);

/// The plane of a face, or of three points: its normal, below 2^43.
struct vec3_i64 steps_normal(struct vec3 a, struct vec3 b, struct vec3 c);

/// Is it regular as it stands? Sets result->regular and conflict.
void steps_decide(struct steps *steps);

/// A regular direction, or axes.
enum regular_status steps_compute(struct steps *steps);

#endif
