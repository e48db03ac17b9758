#include "aim/rectangle.h"

#include "aim/rectangle_tilt.h"
#include "fixed/trig.h"

#include <stddef.h>

#define NONE UINT32_MAX

/// The parts of the turn that are looked at: the largest, and those that are not divided any more
/// but searched, 2^-13 rad to either side.
#define PART_MOST  (UINT32_C(1) << 29)
#define PART_LEAST (UINT32_C(1) << 17)

/// Steps of a walk: the first from a new place, from one that has moved, from one that all caps
/// were read at; the largest; and the last is this.
#define STEP_FIRST (UINT32_C(1) << 25)
#define STEP_MOVED (UINT32_C(1) << 12)
#define STEP_AGAIN (UINT32_C(1) << 10)
#define STEP_MOST  (UINT32_C(1) << 27)
#define STEP_LEAST 2U

/// A walk that follows caps finds the tilt to this part of its step, but to this much at most.
#define ROUGH_PART 2U
#define ROUGH_MOST (UINT32_C(1) << 15)
/// Its longest step: 350 degrees a second at a call a millisecond.
#define STEP_ROUGH_MOST (UINT32_C(1) << 22)
/// It goes one step in each call, also if that takes so much work more than is allowed.
#define SLACK 300U

/// By this part a picture may grow from one call to the next before another place is looked at.
#define WORSE_SHIFT 3U

/// A walk that adds caps to the working set goes on, at most so often.
#define ROUNDS_MAX 16U

/// Slopes nearer than this are the same: a part of the slope, and units of 2^-32.
#define SAME_PART_SHIFT 28U
#define SAME_Q32        16U

/// A picture's half-angles are widened by this for the rounding of the camera's axes.
#define ANGLE_ROUND_BAM 4U

#define WORK_OF_REPORT 200U

/// While caps move, another place must be better by this part to be gone to.
#define WORTH_SHIFT 8U

struct run {
    const struct rectangle_input *input;
    struct rectangle_search *search;
    struct rectangle_view view;
    struct rectangle_workspace *workspace;
    bool stepped; // a step was done in this call
    bool twice;   // all caps were read twice to begin with
};

static bool is_better(uint64_t slope_q32, uint64_t than_q32) {
    return slope_q32 < than_q32 && than_q32 - slope_q32 > (than_q32 >> SAME_PART_SHIFT) + SAME_Q32;
}

// ---------------------------------------------------------------- the working set

/// Moves a cap to the end of the working set, where the last ones that mattered are. Returns
/// whether it is new there.
static bool keep(struct rectangle_search *search, uint32_t index) {
    uint32_t at = 0;
    while (at < search->working_count && search->working[at] != index) {
        at++;
    }
    const bool added = at == search->working_count;
    if (added && search->working_count == RECTANGLE_WORKING_MAX) {
        at = 0; // the one that has not mattered for longest goes
    } else if (added) {
        search->working_count++;
    }
    for (; at + 1U < search->working_count; at++) {
        search->working[at] = search->working[at + 1U];
    }
    search->working[search->working_count - 1U] = (uint16_t)index;
    return added;
}

static void load(struct run *run) {
    const uint32_t work = run->view.work;
    rectangle_load(&run->view, run->search, run->input, run->workspace);
    run->view.work += work;
}

/// Reads every cap from a place, and keeps those that ask for most. *added: of them some are new.
static uint64_t read_all(struct run *run, const struct rectangle_place *place, bool *added) {
    struct rectangle_sides sides;
    const uint64_t slope = rectangle_read(&run->view, place, &sides);
    run->stepped = true;
    *added = false;
    for (uint32_t i = 0; i < 4U && slope != UINT64_MAX; i++) {
        if (sides.index[i] != NONE && keep(run->search, sides.index[i])) {
            *added = true;
        }
    }
    load(run);
    return slope;
}

// ---------------------------------------------------------------- limits

static bool is_over_limit(const struct run *run, uint32_t more) {
    const uint32_t limit = run->input->work_limit;
    return limit != 0U && run->stepped && run->view.work + more > limit;
}

static uint32_t work_of_reading(const struct run *run) {
    return 4U * (run->input->count + run->view.count) + 300U;
}

// ---------------------------------------------------------------- a walk

static void begin_walk(struct rectangle_walk *walk, struct rectangle_place place,
                       uint32_t step_bam32) {
    *walk = (struct rectangle_walk){.place = place, .step_bam32 = step_bam32, .fresh = true};
}

/// Does a walk follow caps that move? It has the time of one step or two, and need not be exact.
static bool is_rough(const struct run *run, const struct rectangle_walk *walk) {
    return run->input->moved && run->input->work_limit != 0U && walk == &run->search->track;
}

/// How far the best tilt may be off after a step: some times as far.
static uint32_t reach_of(const struct run *run, const struct rectangle_walk *walk) {
    return walk->wide || (walk->step_bam32 >= UINT32_C(1) << 13 && !is_rough(run, walk))
               ? 0U
               : 4U * walk->step_bam32;
}

/// How near to the best tilt a step need come.
static uint32_t least_of(const struct run *run, const struct rectangle_walk *walk) {
    const uint32_t part = walk->step_bam32 / ROUGH_PART;
    return !is_rough(run, walk) || part == 0U ? 1U : part < ROUGH_MOST ? part : ROUGH_MOST;
}

static uint32_t larger_step(uint32_t step_bam32, bool rough) {
    const uint32_t most = rough ? STEP_ROUGH_MOST : STEP_MOST;
    return step_bam32 < most ? 2U * step_bam32 : step_bam32;
}

/// One pan.
static void step(struct run *run, struct rectangle_walk *walk) {
    const bool rough = is_rough(run, walk);
    walk->fresh = walk->fresh || (walk->rough && !rough);
    walk->rough = rough;
    struct rectangle_place place = walk->place;
    if (!walk->fresh) {
        place.pan_bam32 += walk->backward ? 0U - walk->step_bam32 : walk->step_bam32;
    }
    run->stepped = true;
    if (!rectangle_best_tilt(&run->view, &place, reach_of(run, walk), least_of(run, walk)) &&
        !rough) {
        walk->wide = true;
        return;
    }
    walk->wide = false;
    if (walk->fresh || place.slope_q32 < walk->place.slope_q32) {
        walk->step_bam32 = walk->fresh ? walk->step_bam32 : larger_step(walk->step_bam32, rough);
        walk->place = place;
        walk->fresh = walk->failed = false;
        return;
    }
    walk->step_bam32 = walk->failed ? walk->step_bam32 / 2U : walk->step_bam32;
    walk->failed = !walk->failed;
    walk->backward = !walk->backward;
}

static uint32_t work_of_step(const struct run *run, const struct rectangle_walk *walk) {
    return rectangle_tilt_work(&run->view, reach_of(run, walk), least_of(run, walk));
}

/// Takes a walk's place for the best one if it is. Returns whether caps were added that ask for
/// more there than the walk knew.
static bool adopt(struct run *run, struct rectangle_walk *walk, uint64_t worth_shift) {
    bool added;
    struct rectangle_place place = walk->place;
    struct rectangle_place *const best = &run->search->best;
    place.slope_q32 = read_all(run, &place, &added);
    const uint64_t worth = worth_shift != 0U ? best->slope_q32 >> worth_shift : 0U;
    if (place.slope_q32 < best->slope_q32 - worth) {
        *best = place;
    }
    walk->fresh = walk->fresh || added; // its slope is that of fewer caps
    return added && is_better(walk->place.slope_q32, place.slope_q32);
}

enum progress { PROGRESS_ENDED, PROGRESS_LIMIT };

/// Walks until the steps are small and no cap is outside the picture. PROGRESS_LIMIT: go on in the
/// next call.
static enum progress go_on(struct run *run, struct rectangle_walk *walk, uint64_t worth_shift,
                           uint32_t reserve) {
    for (bool walked = false;;) {
        while (walk->step_bam32 >= STEP_LEAST) {
            // Else caps that move in every call would leave it behind.
            const bool must = !walked && !run->twice && is_rough(run, walk);
            const uint32_t more = walked ? reserve : 0U, less = must ? SLACK : 0U;
            if (is_over_limit(run, work_of_step(run, walk) + more - less)) {
                if (!must || walk->step_bam32 <= STEP_MOVED) {
                    return PROGRESS_LIMIT;
                }
                walk->step_bam32 /= 2U; // costs less
                continue;
            }
            step(run, walk);
            walked = true;
        }
        if (is_over_limit(run, work_of_reading(run))) {
            return PROGRESS_LIMIT;
        }
        const bool outside = adopt(run, walk, worth_shift);
        if (!outside || walk->rounds == ROUNDS_MAX) {
            return PROGRESS_ENDED;
        }
        walk->rounds++;
        walk->step_bam32 = STEP_AGAIN;
        walk->fresh = true;
    }
}

// ---------------------------------------------------------------- the whole turn

static void begin_turn(struct rectangle_search *search) {
    search->sought = search->descending = search->descended = search->stale = false;
    search->neighbours = 0;
    search->part_bam32 = 0;
    search->width_bam32 = PART_MOST;
}

/// On to the next part.
static void next_part(struct rectangle_search *search) {
    search->descending = search->descended = false;
    search->neighbours = 0;
    search->part_bam32 += search->width_bam32;
    if (search->part_bam32 != 0U) {
        while (search->width_bam32 < PART_MOST &&
               (search->part_bam32 & search->width_bam32) == 0U) {
            search->width_bam32 *= 2U;
        }
    } else if (search->stale) {
        begin_turn(search);
    } else {
        search->sought = true;
    }
}

static uint64_t slope_at(struct run *run, uint32_t pan_bam32) {
    struct rectangle_place place = {.pan_bam32 = pan_bam32};
    (void)rectangle_best_tilt(&run->view, &place, 0, 1);
    run->stepped = true;
    return place.slope_q32;
}

static void descend(struct rectangle_search *search, struct rectangle_place from) {
    search->descending = true;
    begin_walk(&search->descent, from, search->width_bam32 / 2U);
}

/// Looks at a part. If its middle is better than the best place, goes down from there; if nothing
/// better can be in it, it is done with; else divides it. The smallest parts are gone down from
/// once, if their neighbours are higher.
static void look_at_part(struct run *run, uint64_t worth_shift) {
    struct rectangle_search *const search = run->search;
    const uint32_t width = search->width_bam32;
    const uint64_t best_q32 = search->best.slope_q32,
                   worth_q32 = worth_shift != 0U ? best_q32 >> worth_shift : 0U;
    struct rectangle_place middle = {.pan_bam32 = search->part_bam32 + width / 2U};
    (void)rectangle_best_tilt(&run->view, &middle, 0, 1);
    run->stepped = true;
    if (rectangle_is_no_better(&run->view, &middle, width / 2U, best_q32)) {
        next_part(search);
    } else if (!search->descended && is_better(middle.slope_q32, best_q32 - worth_q32)) {
        descend(search, middle);
    } else if (width > PART_LEAST) {
        search->width_bam32 = width / 2U;
        search->descended = false;
    } else if (search->descended) {
        next_part(search);
    } else {
        search->descent.place = middle;
        search->neighbours = 2;
    }
}

/// Compares one of the smallest parts with a neighbour: from where that is lower we shall come, or
/// came, to here.
static void look_at_neighbour(struct run *run) {
    struct rectangle_search *const search = run->search;
    const struct rectangle_place middle = search->descent.place;
    const bool left = search->neighbours == 2U;
    const uint32_t width = left ? 0U - search->width_bam32 : search->width_bam32;
    const uint64_t slope = slope_at(run, middle.pan_bam32 + width);
    search->neighbours--;
    if (left ? slope <= middle.slope_q32 : slope < middle.slope_q32) {
        next_part(search);
    } else if (search->neighbours == 0U) {
        descend(search, middle);
    }
}

static void seek(struct run *run) {
    struct rectangle_search *const search = run->search;
    const uint32_t worth_shift = run->input->moved ? WORTH_SHIFT : 0U;
    while (!search->sought) {
        if (search->descending) {
            if (go_on(run, &search->descent, worth_shift, 0) == PROGRESS_LIMIT) {
                return;
            }
            search->descending = false; // the part is looked at once more
            search->descended = true;
            continue;
        }
        if (is_over_limit(run, rectangle_tilt_work(&run->view, 0, 1) + RECTANGLE_BOUND_WORK)) {
            return;
        }
        if (search->neighbours != 0U) {
            look_at_neighbour(run);
        } else {
            look_at_part(run, worth_shift);
        }
    }
}

// ---------------------------------------------------------------- one call

void rectangle_begin(struct rectangle_search *search, const struct rectangle_base *base,
                     struct vec3 ahead_q30) {
    const int64_t right = vec3_dot_unit(base->right_q30, ahead_q30),
                  ahead = vec3_dot_unit(base->ahead_q30, ahead_q30),
                  up = vec3_dot_unit(base->up_q30, ahead_q30);
    const uint64_t level = vec3_i64_length((struct vec3_i64){right, ahead, 0});
    *search = (struct rectangle_search){
        .begun = true,
        .tracking = true,
        .best = {.pan_bam32 = trig_atan2(right, ahead).bam,
                 .tilt_bam32 = bam32_signed(trig_atan2(up, (int64_t)level))}};
    begin_walk(&search->track, search->best, STEP_FIRST);
    begin_turn(search);
}

static uint64_t measure(struct run *run, struct rectangle_place *place) {
    bool added;
    place->slope_q32 = read_all(run, place, &added);
    return place->slope_q32;
}

/// Measures the best place on every cap: where a walk has come to, unless that turns out to be much
/// worse than where it left from (which is not looked at again if there is no time for it).
static void measure_best(struct run *run) {
    struct rectangle_search *const search = run->search;
    struct rectangle_place walked = search->track.place;
    struct rectangle_place *const best = &search->best;
    if (search->tracking && !search->track.fresh) {
        const uint64_t most_q32 = best->slope_q32 + (best->slope_q32 >> WORSE_SHIFT);
        const uint64_t slope_q32 = measure(run, &walked);
        const bool late = is_over_limit(run, work_of_reading(run));
        if (slope_q32 <= most_q32 || (late && slope_q32 != UINT64_MAX)) {
            *best = walked;
            return;
        }
        run->twice = true;
    }
    if (measure(run, best) > walked.slope_q32 && run->twice) {
        *best = walked;
    }
}

/// The caps have moved: the best place is measured anew, and followed from there.
static bool take_motion(struct run *run) {
    struct rectangle_search *const search = run->search;
    if (search->working_count > RECTANGLE_WORKING_KEPT) {
        const uint32_t dropped = search->working_count - RECTANGLE_WORKING_KEPT;
        for (uint32_t i = 0; i < RECTANGLE_WORKING_KEPT; i++) {
            search->working[i] = search->working[i + dropped];
        }
        search->working_count = RECTANGLE_WORKING_KEPT;
        load(run);
    }
    measure_best(run);
    if (search->working_count == 0U) { // all in the middle
        (void)keep(search, run->input->member == NULL ? 0U : run->input->member[0]);
        load(run);
    }
    if (search->best.slope_q32 == UINT64_MAX) {
        search->begun = false;
        return false;
    }
    if (search->sought) {
        begin_turn(search);
    }
    search->stale = true;
    search->descent.fresh = true;
    if (search->tracking) { // goes on from there; what it needs there is known
        struct rectangle_walk *const track = &search->track;
        track->place = search->best;
        track->fresh = track->wide = false;
        track->rounds = 0;
        track->step_bam32 = track->step_bam32 < 64U               ? 64U
                            : track->step_bam32 > STEP_ROUGH_MOST ? STEP_ROUGH_MOST
                                                                  : track->step_bam32;
    } else {
        search->tracking = true;
        begin_walk(&search->track, search->best, STEP_MOVED);
    }
    return true;
}

/// Follows the best place. While caps move, a walk that is not at its end may have found a better
/// one all the same.
static void follow(struct run *run) {
    struct rectangle_search *const search = run->search;
    const bool moved = run->input->moved;
    if (go_on(run, &search->track, 0, moved ? work_of_reading(run) : 0U) == PROGRESS_ENDED) {
        search->tracking = false;
    } else if (moved && is_better(search->track.place.slope_q32, search->best.slope_q32) &&
               !is_over_limit(run, work_of_reading(run))) {
        (void)adopt(run, &search->track, 0);
    }
}

static void report(const struct run *run, struct rectangle_result *result) {
    const struct rectangle_search *search = run->search;
    const struct rectangle_half_angles half =
        rectangle_half_angles(&run->view, search->best.slope_q32 + SAME_Q32);
    *result =
        (struct rectangle_result){.pan_bam32 = bam32(search->best.pan_bam32),
                                  .tilt_bam32 = bam32((uint32_t)search->best.tilt_bam32),
                                  .ahead_q30 = rectangle_ahead(&run->input->base, &search->best),
                                  .half_width_bam32 = bam32(half.width + ANGLE_ROUND_BAM),
                                  .half_height_bam32 = bam32(half.height + ANGLE_ROUND_BAM),
                                  .refining = search->tracking || !search->sought,
                                  .work = run->view.work};
}

bool rectangle_follow(const struct rectangle_input *input, struct rectangle_search *search,
                      struct rectangle_workspace *workspace, struct rectangle_result *result) {
    struct run run = {.input = input, .search = search, .workspace = workspace};
    const bool first = search->working_count == 0U;
    load(&run);
    run.view.work += WORK_OF_REPORT;
    *result = (struct rectangle_result){0};
    if ((input->moved || first) && !take_motion(&run)) {
        result->work = run.view.work;
        return false;
    }
    if (first) { // that was no motion
        search->stale = false;
        search->track.step_bam32 = STEP_FIRST;
    }
    search->turn++;
    if (search->tracking && (!input->moved || search->turn % 4U != 0U)) {
        follow(&run);
    }
    if (!search->tracking || (input->moved && search->turn % 4U == 0U)) {
        seek(&run);
    }
    report(&run, result);
    return true;
}
