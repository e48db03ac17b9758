#include "aim/framing.h"

#include "fixed/trig.h"
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

/// One call of the search for the narrowest cone. Where no cone holds the rims it is that of the
/// centres, with a half turn: input->radius is then NULL.
static enum follow_status search_cone(const struct target_set *set, struct framing_choice choice,
                                      struct framing_memory *memory, struct follow_input *input,
                                      struct follow_result *found) {
    uint32_t warm[4];
    recall(set, choice, memory, warm, input);
    enum follow_status status = follow_narrowest(input, found);
    if (status == FOLLOW_INFEASIBLE && input->radius != NULL) { // a picture can't hold them whole
        const uint32_t work = found->work;
        input->radius = NULL;
        status = follow_narrowest(input, found);
        found->work += work;
        found->half_angle = bam32(BAM32_HALF);
    }
    remember(set, found, memory);
    return status;
}

/// Has the search come to a cone that a camera can look along?
static bool is_cone(enum follow_status status, const struct follow_result *found) {
    return status == FOLLOW_OK ||
           (status == FOLLOW_UNFINISHED && found->half_angle.bam < BAM32_QUARTER);
}

/// The status of a search that has come to no cone: as before while it goes on.
static enum framing_status status_without_cone(enum follow_status status,
                                               const struct framing *framing) {
    if (status == FOLLOW_UNFINISHED) {
        return framing->status;
    }
    return status == FOLLOW_EMPTY ? FRAMING_EMPTY : FRAMING_INFEASIBLE;
}

static void frame_by_cone(const struct target_set *set, struct framing_choice choice,
                          struct framing_memory *memory, struct follow_input *input,
                          struct framing *framing) {
    struct follow_result found;
    const enum follow_status status = search_cone(set, choice, memory, input, &found);
    framing->work = found.work;
    framing->refining = status == FOLLOW_UNFINISHED;
    if (!is_cone(status, &found)) {
        framing->status = status_without_cone(status, framing);
        return;
    }
    framing->status = FRAMING_OK;
    framing->ahead_q30 = found.axis_q30;
    framing->half_angle_bam32 = found.half_angle;
    framing->is_picture = false;
}

// ---------------------------------------------------------------- a picture

/// The places of the remembered caps that are still framed, in their order.
static void recall_working(const struct target_set *set, struct framing_choice choice,
                           struct framing_memory *memory) {
    struct rectangle_search *search = &memory->rectangle;
    uint8_t count = 0;
    for (uint8_t i = 0; i < search->working_count; i++) {
        uint32_t place;
        if (target_set_find(set, memory->working_id[i], &place) && is_framed(set, choice, place)) {
            search->working[count++] = (uint16_t)place;
        }
    }
    search->working_count = count;
}

static void remember_working(const struct target_set *set, struct framing_memory *memory) {
    for (uint8_t i = 0; i < memory->rectangle.working_count; i++) {
        memory->working_id[i] = set->target[memory->rectangle.working[i]].id;
    }
}

/// The cone round the middle that holds the picture's corners.
static bam32_t corner_angle(bam32_t half_width, bam32_t half_height) {
    const struct sincos w = trig_sincos(half_width), h = trig_sincos(half_height);
    const struct vec3_i64 corner = {(int64_t)w.sin_q30 * h.cos_q30, (int64_t)w.cos_q30 * h.sin_q30,
                                    0};
    const bam32_t angle =
        trig_atan2((int64_t)vec3_i64_length(corner) + 1, (int64_t)w.cos_q30 * h.cos_q30);
    return bam32(angle.bam + 4U); // the roundings of the sines
}

static void take_picture(const struct rectangle_result *found, bool centres,
                         struct framing *framing) {
    const bam32_t quarter = bam32(BAM32_QUARTER);
    framing->status = FRAMING_OK;
    framing->ahead_q30 = found->ahead_q30;
    framing->is_picture = true;
    framing->pan_bam32 = found->pan_bam32;
    framing->tilt_bam32 = found->tilt_bam32;
    framing->half_width_bam32 = centres ? quarter : found->half_width_bam32;
    framing->half_height_bam32 = centres ? quarter : found->half_height_bam32;
    framing->half_angle_bam32 =
        centres ? bam32(BAM32_HALF)
                : corner_angle(found->half_width_bam32, found->half_height_bam32);
    framing->refining = found->refining;
}

/// What is left of a limit, at least one unit.
static uint32_t rest_of(uint32_t work_limit, uint32_t work) {
    return work_limit == 0U ? 0U : work < work_limit ? work_limit - work : 1U;
}

/// Looks along the narrowest cone, to go on from there. False: there is none (yet).
static bool start_picture(const struct target_set *set, struct framing_choice choice,
                          const struct framing_picture *picture, struct framing_memory *memory,
                          struct follow_input *input, struct framing *framing) {
    const bool sized = input->radius != NULL;
    struct follow_result cone;
    input->work_limit = rest_of(input->work_limit, framing->work);
    const enum follow_status status = search_cone(set, choice, memory, input, &cone);
    framing->work += cone.work;
    memory->centres = sized && input->radius == NULL;
    if (!is_cone(status, &cone)) {
        framing->refining = status == FOLLOW_UNFINISHED;
        framing->status = status_without_cone(status, framing);
        return false;
    }
    rectangle_begin(&memory->rectangle, &picture->base, cone.axis_q30);
    return true;
}

/// One call of the search for the picture. False: from where it looked some target can't be seen.
static bool go_on_with_picture(const struct framing_picture *picture, bool moved,
                               uint32_t work_limit, struct framing_memory *memory,
                               const struct follow_input *input,
                               struct framing_workspace *workspace, struct framing *framing) {
    const struct rectangle_input rectangle = {.centre_q30 = input->centre_q30,
                                              .radius = memory->centres ? NULL : input->radius,
                                              .member = input->member,
                                              .count = input->count,
                                              .base = picture->base,
                                              .width = picture->width,
                                              .height = picture->height,
                                              .moved = moved,
                                              .work_limit = rest_of(work_limit, framing->work)};
    struct rectangle_result found;
    const bool seen =
        rectangle_follow(&rectangle, &memory->rectangle, &workspace->rectangle, &found);
    framing->work += found.work;
    if (seen) {
        take_picture(&found, memory->centres, framing);
    }
    return seen;
}

/// A call that has done this much goes on in the next one: what follows may be as much again.
static bool is_enough(uint32_t work_limit, uint32_t work) {
    return work_limit != 0U && work > work_limit / 4U;
}

static void frame_by_picture(const struct target_set *set, struct framing_choice choice,
                             const struct framing_picture *picture, struct framing_memory *memory,
                             struct follow_input *input, struct framing_workspace *workspace,
                             struct framing *framing) {
    const uint32_t work_limit = input->work_limit;
    const bool moved = memory->version != set->version;
    struct rectangle_search *const search = &memory->rectangle;
    memory->version = set->version;
    framing->work = 0;
    framing->refining = true;
    recall_working(set, choice, memory);
    if (moved && memory->centres) {
        search->begun = false; // perhaps their rims can be held now
    }
    bool new_start = !moved && search->begun && search->working_count == 0U;
    for (;;) {
        if (!search->begun) {
            if (is_enough(work_limit, framing->work) ||
                !start_picture(set, choice, picture, memory, input, framing)) {
                return;
            }
            new_start = true;
        }
        if (is_enough(work_limit, framing->work)) {
            return;
        }
        if (go_on_with_picture(picture, moved, work_limit, memory, input, workspace, framing)) {
            break;
        }
        if (new_start) { // at the very edge of a half-space
            framing->refining = false;
            framing->status = FRAMING_INFEASIBLE;
            return;
        }
    }
    remember_working(set, memory);
}

// ---------------------------------------------------------------- both

enum framing_status framing_follow(const struct target_set *set, struct framing_choice choice,
                                   const struct framing_picture *picture,
                                   struct framing_memory *memory, uint32_t work_limit,
                                   struct framing_workspace *workspace, struct framing *framing) {
    const uint32_t count = choose(set, choice, workspace);
    struct follow_input input = {.centre_q30 = set->direction_q30,
                                 .radius = set->sized_count != 0U ? set->radius : NULL,
                                 .member = count != set->count ? workspace->place : NULL,
                                 .count = count,
                                 .work_limit = work_limit};
    framing->framed_count = count;
    if (picture == NULL || count == 0U) {
        frame_by_cone(set, choice, memory, &input, framing);
    } else {
        frame_by_picture(set, choice, picture, memory, &input, workspace, framing);
    }
    return framing->status;
}

enum framing_status framing_solve(const struct target_set *set, struct framing_workspace *workspace,
                                  struct framing *framing) {
    const struct framing_choice all = {0};
    return framing_follow(set, all, NULL, &workspace->memory, 0, workspace, framing);
}
