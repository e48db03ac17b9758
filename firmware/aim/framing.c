#include "aim/framing.h"

#include "fixed/trig.h"
#include "sphere/cone.h"

/// The targets of positive weight, copied out only if there are others.
static const struct vec3 *select_framed(const struct target_set *set,
                                        struct framing_workspace *workspace, uint32_t *count) {
    uint32_t framed = 0;
    for (uint32_t i = 0; i < set->count; i++) {
        framed += set->target[i].weight_q16 != 0U;
    }
    *count = framed;
    if (framed == set->count) {
        return set->direction_q30;
    }
    framed = 0;
    for (uint32_t i = 0; i < set->count; i++) {
        if (set->target[i].weight_q16 != 0U) {
            workspace->direction_q30[framed++] = set->direction_q30[i];
        }
    }
    return workspace->direction_q30;
}

/// Largest angle from the axis to the far rim of any framed target.
static uint32_t widen_by_radii(const struct target_set *set, struct vec3 ahead_q30,
                               uint32_t half_angle) {
    for (uint32_t i = 0; i < set->count; i++) {
        const struct target *target = &set->target[i];
        if (target->weight_q16 == 0U || target->radius_bam32 == 0U) {
            continue;
        }
        const struct vec3 direction = set->direction_q30[i];
        const uint64_t across = vec3_i64_length(vec3_cross(ahead_q30, direction));
        const bam32_t angle = trig_atan2((int64_t)across, vec3_dot_unit(ahead_q30, direction));
        // One BAM up for the two roundings; angle and radius are at most a half and a quarter turn.
        const uint32_t rim = angle.bam + target->radius_bam32 + 1U;
        half_angle = rim > half_angle ? rim : half_angle;
    }
    return half_angle < BAM32_HALF ? half_angle : BAM32_HALF;
}

enum framing_status framing_solve(const struct target_set *set, struct framing_workspace *workspace,
                                  struct framing *framing) {
    uint32_t count;
    const struct vec3 *directions = select_framed(set, workspace, &count);
    struct cone_result cone;
    framing->framed_count = count;
    const struct cone_options options = {.lengths = CONE_LENGTHS_UNIT,
                                         .workspace = workspace->notes,
                                         .workspace_bytes = sizeof workspace->notes};
    switch (cone_narrowest(directions, count, &options, &cone)) {
    case CONE_OK:
        framing->ahead_q30 = cone.axis_q30;
        framing->half_angle_bam32 =
            bam32(widen_by_radii(set, cone.axis_q30, cone.half_angle_bam32.bam));
        framing->status = FRAMING_OK;
        break;
    case CONE_EMPTY:
        framing->status = FRAMING_EMPTY;
        break;
    default:
        framing->status = FRAMING_INFEASIBLE;
        break;
    }
    return framing->status;
}
