#include "sphere/follow.h"

#include "fixed/trig_fine.h"
#include "sphere/caps_support.h"
#include "sphere/cone_answer.h"
#include "sphere/min_norm.h"

#include <stdbool.h>
#include <stddef.h>

#define NO_CAP UINT32_MAX

/// What a change of the support costs, in reads: of points (where the products of unit vectors in
/// 64 bits tell; close together they don't), of caps.
#define WORK_OF_POINTS       400U
#define WORK_OF_CLOSE_POINTS 1600U
#define WORK_OF_START        700U
#define WORK_OF_CAPS         5500U
#define WORK_OF_LOOK         7U                 // a second look at a cap
#define EXACT_BELOW_Q60      ((int64_t)1 << 47) // 2^-13 rad

/// Measured depths (Q2.60) are good to this: the lengths of two units (2^-29.2 together), the
/// rounding of the axis (2^-30.2) and of a radius' sine and cosine (2^-30.5).
#define BAND ((int64_t)3 << 30)

/// 10 nrad, and 2^-13 rad.
#define FINE_TURN64   UINT64_C(0x6D5ED56C8)
#define COARSE_TURN64 UINT64_C(0x145F306DC9C88)

struct search {
    const struct follow_input *input;
    struct min_norm points;   // the support, if all caps are points
    struct caps_support caps; // the support, else
    struct vec3 axis_q30;
    uint32_t support[3];   // indices; NO_CAP: fewer
    uint64_t reach_turn64; // of the support, from its exact axis
    int64_t cos_q60, sin_q60;
    uint32_t work;
    bool changed;         // since the call began
    uint32_t pending;     // for the next call; NO_CAP: none
    uint8_t pending_step; // of caps_support_enter
};

/// The index of the k-th cap that counts.
static inline uint32_t member(const struct follow_input *input, uint32_t k) {
    return input->member == NULL ? k : input->member[k];
}

static bool are_points(const struct search *search) {
    return search->input->radius == NULL;
}

// ---------------------------------------------------------------- the support

static struct caps_point cap_of(const struct search *search, uint32_t index) {
    const uint64_t radius_turn64 = (uint64_t)search->input->radius[index].angle.bam << 32;
    return (struct caps_point){.index = index,
                               .centre_q61 = vec3_normalise_q61(search->input->centre_q30[index]),
                               .radius_turn64 = radius_turn64,
                               .radius = trig_fine_sincos(radius_turn64)};
}

static uint8_t support_count(const struct search *search) {
    return are_points(search) ? search->points.count : search->caps.count;
}

static uint32_t support_index(const struct search *search, uint8_t i) {
    return are_points(search) ? search->points.point[i].index : search->caps.point[i].index;
}

static inline bool is_in_support(const struct search *search, uint32_t index) {
    return index == search->support[0] || index == search->support[1] ||
           index == search->support[2];
}

enum entrance { ENTERED, INSIDE, SURROUNDED, GO_ON }; // GO_ON: in the next call

/// What taking in a cap costs.
static uint32_t work_of_change(const struct search *search) {
    if (!are_points(search)) {
        return WORK_OF_CAPS;
    }
    return search->sin_q60 < EXACT_BELOW_Q60 ? WORK_OF_CLOSE_POINTS : WORK_OF_POINTS;
}

static enum entrance enter_point(struct search *search, uint32_t index) {
    const struct min_norm_point point = cone_point(search->input->centre_q30, index);
    search->work += work_of_change(search);
    if (!min_norm_violated_by(&search->points, &point)) {
        return INSIDE;
    }
    return min_norm_enter(&search->points, &point) ? ENTERED : SURROUNDED;
}

/// Begins with all of these caps, at most three. False: they are not a support now.
static bool begin_with(struct search *search, const uint32_t *indices, uint8_t count) {
    if (are_points(search)) {
        struct min_norm_point point[3];
        for (uint8_t i = 0; i < count; i++) {
            point[i] = cone_point(search->input->centre_q30, indices[i]);
        }
        return min_norm_hold(&search->points, point, count, true);
    }
    struct caps_point cap[3];
    for (uint8_t i = 0; i < count; i++) {
        cap[i] = cap_of(search, indices[i]);
    }
    return caps_support_hold(&search->caps, cap, count);
}

/// Begins with the warm start's support if it still is one, or with as many of its caps as are.
static void begin(struct search *search) {
    const struct follow_input *input = search->input;
    for (uint8_t count = (uint8_t)(input->warm_count - input->pending); count != 0U; count--) {
        search->work += WORK_OF_START;
        if (begin_with(search, input->warm, count)) {
            return;
        }
    }
    const uint32_t first = member(input, 0);
    (void)begin_with(search, &first, 1); // a cap is a support
}

/// Begins with the warm start and takes in the pending cap, with bounded work. Caps are not solved
/// before: their support has a place among the subsets that are tried.
static enum entrance start(struct search *search) {
    const struct follow_input *input = search->input;
    const uint8_t last = (uint8_t)(input->warm_count - input->pending);
    if (!input->pending || last == 0U) {
        begin(search);
        return ENTERED;
    }
    if (are_points(search)) {
        begin(search);
        return enter_point(search, input->warm[last]);
    }
    struct caps_point cap[3];
    for (uint8_t i = 0; i < last; i++) {
        cap[i] = cap_of(search, input->warm[i]);
    }
    caps_support_recall(&search->caps, cap, last);
    const struct caps_point pending = cap_of(search, input->warm[last]);
    search->pending_step = input->pending_step;
    search->work += WORK_OF_CAPS;
    switch (caps_support_enter(&search->caps, &pending, &search->pending_step)) {
    case CAPS_ENTERED:
        return ENTERED;
    case CAPS_GO_ON:
        search->pending = pending.index;
        return GO_ON;
    default: // they have moved, and this is no cap for them to take in: the next call does without
        return GO_ON;
    }
}

/// Takes a cap in. INSIDE: the support's cone holds it already.
static enum entrance enter(struct search *search, uint32_t index) {
    if (are_points(search)) {
        return enter_point(search, index);
    }
    const struct caps_point cap = cap_of(search, index);
    search->work += WORK_OF_CAPS;
    if (caps_reach(search->caps.axis_q61, &cap) <= search->caps.reach_turn64) {
        return INSIDE;
    }
    return caps_support_enter(&search->caps, &cap, NULL) < 0 ? SURROUNDED : ENTERED;
}

/// Axis and reach of the support. False: too near to a quarter turn.
static bool turn_axis(struct search *search) {
    struct vec3_i64 direction;
    for (uint8_t i = 0; i < 3U; i++) {
        search->support[i] = i < support_count(search) ? support_index(search, i) : NO_CAP;
    }
    if (are_points(search)) {
        direction = min_norm_direction(&search->points);
        search->reach_turn64 =
            trig_fine_angle(direction, vec3_normalise_q61(search->points.point[0].given));
    } else {
        direction = search->caps.axis_q61;
        search->reach_turn64 = search->caps.reach_turn64;
    }
    search->axis_q30 = vec3_i64_normalise(direction);
    const struct sincos_q62 reach = trig_fine_sincos(search->reach_turn64);
    search->cos_q60 = reach.cos_q62 >> 2;
    search->sin_q60 = reach.sin_q62 >> 2;
    return search->reach_turn64 + FOLLOW_CLEARANCE_TURN64 < TURN64_QUARTER;
}

// ---------------------------------------------------------------- a pass over the caps

/// What a pass found.
struct reading {
    uint32_t outermost;    // cap that surely reaches out of the cone, by the least depth
    uint32_t sticking_out; // cap that does so as the sine tells, where the depth can't
    int64_t least_depth;
    uint64_t most_excess;
    bool band; // a cap outside the support reaches to the circle
};

/// The second look at caps whose depth lies in the band. Below 45 degrees by the sine of the angle
/// to the centre, |axis x centre|, cut to 30 bits; below 2^-5 rad by the chord, |centre - axis|,
/// which has few bits there. Both keep their digits when the angle is small.
struct close_look {
    enum { LOOK_IS_USELESS, LOOK_AT_SINE, LOOK_AT_CHORD } kind;
    unsigned shift;     // of the sine
    int64_t margin_q60; // of the sine
    int64_t reach_q34;  // rad, with its margin; for the chord
};

/// Radians in Q34 from BAM: 2 pi 2^34 / 2^32, in Q26.
#define RAD_Q34_PER_BAM_Q26 UINT64_C(1686629713)

static struct close_look make_close_look(const struct search *search) {
    struct close_look look = {.kind = search->sin_q60 >= search->cos_q60    ? LOOK_IS_USELESS
                                      : search->sin_q60 >= (int64_t)1 << 55 ? LOOK_AT_SINE
                                                                            : LOOK_AT_CHORD};
    // The rounding of the axis, of the lengths, and (caps) of the radius' sine and cosine.
    look.margin_q60 = ((int64_t)1 << (are_points(search) ? 31 : 32)) + (search->sin_q60 >> 28);
    while ((search->sin_q60 + look.margin_q60) >> look.shift >= (int64_t)1 << 30) {
        look.shift++;
    }
    // Reach is cut to a BAM (25 units), its product to a unit; the axis is good to 2^-30 rad.
    look.reach_q34 = (int64_t)((search->reach_turn64 >> 32) * RAD_Q34_PER_BAM_Q26 >> 26) + 26 + 32;
    return look;
}

/// How far a cap sticks out of the cone: the difference of the squared sines; 0: not at all.
static uint64_t excess_by_sine(const struct search *search, const struct close_look *look,
                               uint32_t index) {
    int64_t room_q60 = search->sin_q60; // sin(reach - radius)
    if (!are_points(search)) {
        const struct follow_radius *radius = &search->input->radius[index];
        room_q60 =
            (search->sin_q60 >> 30) * radius->cos_q30 - (search->cos_q60 >> 30) * radius->sin_q30;
    }
    room_q60 += look->margin_q60;
    if (room_q60 < 0) {
        return UINT64_MAX;
    }
    const struct vec3_i64 cross = vec3_cross(search->axis_q30, search->input->centre_q30[index]);
    const int64_t x = cross.x >> look->shift, y = cross.y >> look->shift,
                  z = cross.z >> look->shift;
    const uint64_t half = UINT64_C(1) << 30; // room for -2^30 to 2^30 - 1
    if ((((uint64_t)x + half) | ((uint64_t)y + half) | ((uint64_t)z + half)) >> 31 != 0U) {
        return UINT64_MAX;
    }
    const int64_t x2 = (int64_t)(int32_t)x * (int32_t)x, y2 = (int64_t)(int32_t)y * (int32_t)y,
                  z2 = (int64_t)(int32_t)z * (int32_t)z;
    const uint32_t room = (uint32_t)(room_q60 >> look->shift) + 2U;
    const uint64_t sine2 = (uint64_t)(x2 + y2 + z2), room2 = (uint64_t)room * room;
    return sine2 > room2 ? sine2 - room2 : 0U;
}

/// The same by the squared chords, in Q68. In the band the centre is within 2^-4 rad.
static uint64_t excess_by_chord(const struct search *search, const struct close_look *look,
                                uint32_t index) {
    const struct vec3 centre = search->input->centre_q30[index];
    const int32_t x = centre.x - search->axis_q30.x, y = centre.y - search->axis_q30.y,
                  z = centre.z - search->axis_q30.z;
    int32_t room = (int32_t)look->reach_q34;
    if (!are_points(search)) {
        room -= (int32_t)(search->input->radius[index].angle.bam * RAD_Q34_PER_BAM_Q26 >> 26);
        if (room < 0) {
            return UINT64_MAX;
        }
    }
    // The chord 2 sin(a / 2) is a - a^3 / 24, rounded up.
    room -= (int32_t)(((int64_t)room * room >> 34) * room >> 34) / 24 - 1;
    const uint64_t chord2 = (uint64_t)((int64_t)x * x + (int64_t)y * y + (int64_t)z * z) << 8;
    const uint64_t room2 = (uint64_t)((int64_t)room * room);
    return chord2 > room2 ? chord2 - room2 : 0U;
}

/// A cap that may reach the circle.
static void look_closer(struct search *search, const struct close_look *look, uint32_t index,
                        int64_t depth, struct reading *reading) {
    if (depth < -BAND) {
        if (depth < reading->least_depth) {
            reading->least_depth = depth;
            reading->outermost = index;
        }
        return;
    }
    if (is_in_support(search, index)) {
        return;
    }
    reading->band = true;
    if (look->kind != LOOK_IS_USELESS) {
        const bool chord = look->kind == LOOK_AT_CHORD;
        const uint64_t excess =
            chord ? excess_by_chord(search, look, index) : excess_by_sine(search, look, index);
        search->work += chord ? WORK_OF_LOOK / 2U : WORK_OF_LOOK;
        if (excess > reading->most_excess) {
            reading->most_excess = excess;
            reading->sticking_out = index;
        }
    }
}

/// What the depth of every cap is measured against.
struct circle {
    int64_t cos_q30, sin_q30;
    uint32_t widest_bam32; // a cap with a larger radius than this is not held, wherever it is
};

/// cos(angle to the centre) - cos(reach - radius), Q2.60.
static inline int64_t depth_of_cap(const struct circle *circle, const struct follow_radius *radius,
                                   int64_t dot) {
    if (radius->angle.bam > circle->widest_bam32) {
        return INT64_MIN / 2 - (int64_t)radius->angle.bam; // the largest of such caps first
    }
    return dot - circle->cos_q30 * radius->cos_q30 - circle->sin_q30 * radius->sin_q30;
}

static struct reading read_all(struct search *search) {
    const struct follow_input *input = search->input;
    struct reading reading = {.outermost = NO_CAP, .sticking_out = NO_CAP};
    const struct close_look look = make_close_look(search);
    const struct circle circle = {search->cos_q60 >> 30, search->sin_q60 >> 30,
                                  (uint32_t)((search->reach_turn64 + FINE_TURN64) >> 32)};
    const int64_t x = search->axis_q30.x, y = search->axis_q30.y, z = search->axis_q30.z;
    for (uint32_t k = 0; k < input->count; k++) {
        const uint32_t i = member(input, k);
        const struct vec3 centre = input->centre_q30[i];
        const int64_t dot = x * centre.x + y * centre.y + z * centre.z;
        const int64_t depth = input->radius == NULL ? dot - search->cos_q60
                                                    : depth_of_cap(&circle, &input->radius[i], dot);
        if (depth < BAND) {
            look_closer(search, &look, i, depth, &reading);
        }
    }
    search->work += input->count;
    return reading;
}

// ---------------------------------------------------------------- the answer

/// Angle from the axis to the far rim of a cap, rounded up.
static uint64_t reach_of(const struct search *search, uint32_t index) {
    const uint64_t angle =
        trig_fine_angle_q30(search->axis_q30, search->input->centre_q30[index]) + 1024U;
    return angle +
           (are_points(search) ? 0U : (uint64_t)search->input->radius[index].angle.bam << 32);
}

static bam32_t round_up(uint64_t turn64) {
    const uint64_t half = UINT64_C(1) << 63;
    return bam32((uint32_t)(((turn64 < half ? turn64 : half) + UINT32_MAX) >> 32));
}

/// A cone that surely holds every cap: of a search that is not at its end.
static bam32_t cover(struct search *search) {
    uint32_t farthest = member(search->input, 0), largest = 0;
    int64_t least = INT64_MAX;
    for (uint32_t k = 0; k < search->input->count; k++) {
        const uint32_t i = member(search->input, k);
        const int64_t dot = vec3_dot_unit(search->axis_q30, search->input->centre_q30[i]);
        farthest = dot < least ? i : farthest;
        least = dot < least ? dot : least;
        if (!are_points(search) && search->input->radius[i].angle.bam > largest) {
            largest = search->input->radius[i].angle.bam;
        }
    }
    search->work += search->input->count;
    // Of dot products this close the larger may belong to the larger angle, by at most 2^-13 rad.
    return round_up(trig_fine_angle_q30(search->axis_q30, search->input->centre_q30[farthest]) +
                    ((uint64_t)largest << 32) + COARSE_TURN64);
}

static bam32_t rim_of(const struct search *search, bool band) {
    uint64_t reach = band ? search->reach_turn64 + FINE_TURN64 : 0U;
    for (uint8_t i = 0; i < support_count(search); i++) {
        const uint64_t of_cap = reach_of(search, support_index(search, i));
        reach = of_cap > reach ? of_cap : reach;
    }
    return round_up(reach);
}

/// Would this much more be more than is allowed?
static bool is_over_limit(const struct search *search, uint32_t more) {
    const uint32_t limit = search->input->work_limit;
    return limit != 0U && search->work + more > limit;
}

/// Changes the support until it holds every cap. Each change widens the support's cone, so that no
/// support comes twice.
static enum follow_status search_cone(struct search *search, struct follow_result *result) {
    for (;;) {
        if (!turn_axis(search)) {
            return FOLLOW_INFEASIBLE;
        }
        // A second look at every cap is what a pass can cost.
        if (search->changed && is_over_limit(search, search->input->count * WORK_OF_LOOK)) {
            result->half_angle = cover(search);
            return FOLLOW_UNFINISHED;
        }
        const uint32_t before = search->work;
        const struct reading reading = read_all(search);
        const uint32_t outside =
            reading.outermost != NO_CAP ? reading.outermost : reading.sticking_out;
        if (outside == NO_CAP) {
            result->half_angle = rim_of(search, reading.band);
            return FOLLOW_OK;
        }
        if (is_over_limit(search, work_of_change(search) + search->work - before)) {
            result->half_angle = cover(search);
            search->pending = outside;
            return FOLLOW_UNFINISHED;
        }
        search->changed = true;
        switch (enter(search, outside)) {
        case ENTERED:
            break;
        case INSIDE: // vectors that are no units misled the reading
            result->half_angle = cover(search);
            return FOLLOW_OK;
        default:
            return FOLLOW_INFEASIBLE;
        }
    }
}

static void report_support(const struct search *search, struct follow_result *result) {
    result->support_count = support_count(search);
    for (uint8_t i = 0; i < result->support_count; i++) {
        result->support[i] = support_index(search, i);
    }
    if (search->pending != NO_CAP) {
        result->pending = true;
        result->pending_step = search->pending_step;
        result->support[result->support_count] = search->pending;
    }
}

enum follow_status follow_narrowest(const struct follow_input *input,
                                    struct follow_result *result) {
    *result = (struct follow_result){0};
    if (input->count == 0U) {
        return FOLLOW_EMPTY;
    }
    struct search search;
    search.input = input;
    search.axis_q30 = vec3(0, 0, 0);
    search.sin_q60 = EXACT_BELOW_Q60;
    search.work = 0;
    search.pending = NO_CAP;
    search.pending_step = 0;
    search.changed = input->pending;
    enum follow_status status = FOLLOW_INFEASIBLE;
    switch (start(&search)) {
    case SURROUNDED:
        break;
    case GO_ON:
        result->half_angle = bam32(BAM32_HALF);
        status = FOLLOW_UNFINISHED;
        break;
    default:
        status = search_cone(&search, result);
        break;
    }
    report_support(&search, result);
    result->axis_q30 = search.axis_q30;
    result->work = search.work;
    return status;
}
