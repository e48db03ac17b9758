#include "aim/framing.h"

#include "sphere/follow.h"

#include <stddef.h>

static bool is_framed(const struct target_set *set, struct framing_choice choice, uint32_t place) {
    const struct target *target = &set->target[place];
    return target->weight_q16 != 0U && (!choice.one_object || target->object == choice.object);
}

/// Fills workspace->place, unless all are framed; returns how many are.
static uint32_t choose(const struct target_set *set, struct framing_choice choice,
                       struct framing_workspace *workspace) {
    uint32_t framed = 0;
    if (set->muted_count == 0U && !choice.one_object) {
        return set->count;
    }
    for (uint32_t i = 0; i < set->count; i++) {
        if (is_framed(set, choice, i)) {
            workspace->place[framed++] = (uint16_t)i;
        }
    }
    return framed;
}

/// The places of the remembered targets that are still framed.
static void recall(const struct target_set *set, struct framing_choice choice,
                   const struct framing_memory *memory, uint32_t place[4],
                   struct follow_input *input) {
    input->warm = place;
    input->pending_step = memory->pending_step;
    for (uint8_t i = 0; i < memory->count; i++) {
        uint32_t *next = &place[input->warm_count];
        if (target_set_find(set, memory->id[i], next) && is_framed(set, choice, *next)) {
            input->warm_count++;
            input->pending = memory->pending && i + 1U == memory->count;
        }
    }
}

static void remember(const struct target_set *set, const struct follow_result *found,
                     struct framing_memory *memory) {
    memory->pending = found->pending;
    memory->pending_step = found->pending_step;
    memory->count = (uint8_t)(found->support_count + found->pending);
    for (uint8_t i = 0; i < memory->count; i++) {
        memory->id[i] = set->target[found->support[i]].id;
    }
}

enum framing_status framing_follow(const struct target_set *set, struct framing_choice choice,
                                   struct framing_memory *memory, uint32_t work_limit,
                                   struct framing_workspace *workspace, struct framing *framing) {
    uint32_t warm[4];
    const uint32_t count = choose(set, choice, workspace);
    struct follow_input input = {.centre_q30 = set->direction_q30,
                                 .radius = set->sized_count != 0U ? set->radius : NULL,
                                 .member = count != set->count ? workspace->place : NULL,
                                 .count = count,
                                 .work_limit = work_limit};
    struct follow_result found;
    recall(set, choice, memory, warm, &input);
    enum follow_status status = follow_narrowest(&input, &found);
    framing->work = found.work;
    if (status == FOLLOW_INFEASIBLE && input.radius != NULL) { // a picture can't hold them whole
        input.radius = NULL;
        status = follow_narrowest(&input, &found);
        framing->work += found.work;
        found.half_angle = bam32(BAM32_HALF);
    }
    remember(set, &found, memory);
    framing->framed_count = count;
    framing->refining = status == FOLLOW_UNFINISHED;
    if (status == FOLLOW_OK ||
        (status == FOLLOW_UNFINISHED && found.half_angle.bam < BAM32_QUARTER)) {
        framing->status = FRAMING_OK;
        framing->ahead_q30 = found.axis_q30;
        framing->half_angle_bam32 = found.half_angle;
    } else if (status != FOLLOW_UNFINISHED) {
        framing->status = status == FOLLOW_EMPTY ? FRAMING_EMPTY : FRAMING_INFEASIBLE;
    }
    return framing->status;
}

enum framing_status framing_solve(const struct target_set *set, struct framing_workspace *workspace,
                                  struct framing *framing) {
    const struct framing_choice all = {0};
    return framing_follow(set, all, &workspace->memory, 0, workspace, framing);
}
