#include "aim/rectangle_tilt.h"

#include "fixed/root.h"
#include "fixed/trig.h"

#include <stddef.h>

#define NONE UINT32_MAX

/// Halvings of the tilt by turning from angle to angle, and by small offsets from the last of them.
#define COARSE_STEPS    14U
#define FINE_STEPS      16U
#define FINE_REACH_BAM  (UINT32_C(1) << (FINE_STEPS - 1U))
#define QUARTER_TILT    ((int32_t)BAM32_QUARTER)
#define RAD_PER_BAM_Q52 INT64_C(6588397) // 2 pi 2^52 / 2^32

/// Sine and cosine of 1/8 turn and its halves.
static const struct sincos halves[COARSE_STEPS] = {
    {759250125, 759250125},  {410903207, 992008094}, {209476638, 1053110176},
    {105245103, 1068571464}, {52686014, 1072448455}, {26350943, 1073418433},
    {13176464, 1073660973},  {6588356, 1073721611},  {3294193, 1073736771},
    {1647099, 1073740561},   {823550, 1073741508},   {411775, 1073741745},
    {205887, 1073741804},    {102944, 1073741819},
};

static int32_t q30_from_q60(int64_t value_q60) {
    return (int32_t)round_shift_i64(value_q60, 30U);
}

// ---------------------------------------------------------------- what a cap asks for

/// A slope num / den that a side of the picture has, for the test of a cap: it sticks out if
/// |x| den - ahead num + sin root > 0, with root = |(num, den)|.
struct side {
    int32_t num, den, root;
};

static inline int64_t product(int32_t a, int32_t b) {
    return (int64_t)a * b;
}

static inline bool sticks_out(const struct side *side, int32_t x, int32_t ahead, int32_t sin) {
    return product(x, side->den) - product(ahead, side->num) + product(sin, side->root) > 0;
}

static int32_t length_of(int32_t x, int32_t y) {
    return (int32_t)root_u64((uint64_t)(product(x, x) + product(y, y)));
}

/// The side that just holds a cap which is strictly in front (ahead > sin): tan(b + e) with
/// tan b = x / ahead and sin e = sin / |(x, ahead)|. All Q1.30; without its root.
static struct side side_for(int32_t x, int32_t ahead, int32_t sin) {
    if (sin == 0) {
        return (struct side){x, ahead, 0};
    }
    const int32_t run =
        (int32_t)root_u64((uint64_t)(product(x, x) + product(ahead, ahead) - product(sin, sin)));
    struct side side = {(int32_t)((product(x, run) + product(ahead, sin)) >> 30),
                        (int32_t)((product(ahead, run) - product(x, sin)) >> 30), 0};
    side.den = side.den > 0 ? side.den : 1;
    return side;
}

/// num / den in Q32.32; den > 0.
static uint64_t slope_q32(int32_t num, int32_t den) {
    return ((uint64_t)num << 32) / (uint64_t)den;
}

/// What the working set asks for at a tilt.
struct demand {
    bool behind;            // a cap is not strictly in front ...
    int32_t depth;          // ... and this one is the farthest behind
    int32_t num, den;       // else the slope
    struct side wide, high; // the sides of that slope
    bool upward;            // who asks for most is above the middle
};

static void raise_sides(const struct rectangle_view *view, struct demand *demand, bool sized) {
    struct side *const wide = &demand->wide, *const high = &demand->high;
    wide->num = high->num = demand->num;
    wide->den = (int32_t)(product(demand->den, view->height_q30) >> 30);
    high->den = (int32_t)(product(demand->den, view->width_q30) >> 30);
    if (sized) {
        wide->root = length_of(wide->num, wide->den);
        high->root = length_of(high->num, high->den);
    }
}

/// Takes in a cap: out to one side by `aside`, above the middle by `above`.
static void ask(struct rectangle_view *view, struct demand *demand, uint32_t i, int32_t ahead,
                int32_t above) {
    const struct rectangle_cap *cap = &view->cap[i];
    const int32_t aside = cap->aside, off = above < 0 ? -above : above, sin = cap->sin;
    if (ahead <= sin) {
        if (!demand->behind || ahead - sin < demand->depth) {
            demand->behind = true;
            demand->depth = ahead - sin;
            demand->upward = above > 0;
            view->first = i;
        }
        return;
    }
    if (demand->behind) {
        return;
    }
    const bool wide = sticks_out(&demand->wide, aside, ahead, sin),
               high = sticks_out(&demand->high, off, ahead, sin);
    int32_t num = demand->num, den = demand->den;
    if (wide) {
        const struct side side = side_for(aside, ahead, sin);
        num = (int32_t)(product(side.num, view->height_q30) >> 30);
        den = side.den;
    }
    if (high) {
        const struct side side = side_for(off, ahead, sin);
        const int32_t side_num = (int32_t)(product(side.num, view->width_q30) >> 30);
        if (product(side_num, den) > product(num, side.den)) {
            num = side_num;
            den = side.den;
        }
    }
    if (product(num, demand->den) <= product(demand->num, den)) { // it holds, but for a rounding
        return;
    }
    demand->num = num;
    demand->den = den;
    demand->upward = above > 0;
    view->first = i;
    raise_sides(view, demand, view->input->radius != NULL);
}

static struct demand demand_at(struct rectangle_view *view, int32_t cos_tilt, int32_t sin_tilt) {
    struct demand demand = {.den = Q30_ONE};
    raise_sides(view, &demand, false);
    demand.wide.root = demand.wide.den; // of slope 0
    demand.high.root = demand.high.den;
    for (uint32_t k = 0; k <= view->count; k++) { // the last worst one first: it rules out most
        const uint32_t i = k == 0U ? view->first : k - 1U;
        const struct rectangle_cap *cap = &view->cap[i];
        const int32_t ahead =
            (int32_t)((product(cap->level, cos_tilt) + product(cap->up, sin_tilt)) >> 30);
        const int32_t above =
            (int32_t)((product(cap->up, cos_tilt) - product(cap->level, sin_tilt)) >> 30);
        ask(view, &demand, i, ahead, above);
    }
    return demand;
}

// ---------------------------------------------------------------- the best tilt

void rectangle_load(struct rectangle_view *view, const struct rectangle_search *search,
                    const struct rectangle_input *input, struct rectangle_workspace *workspace) {
    const uint64_t larger = input->width > input->height ? input->width : input->height;
    *view = (struct rectangle_view){.input = input,
                                    .cap = workspace->cap,
                                    .working = search->working,
                                    .count = search->working_count,
                                    .height_q30 = (q30_t)(((uint64_t)input->height << 30) / larger),
                                    .width_q30 = (q30_t)(((uint64_t)input->width << 30) / larger),
                                    .work = search->working_count * 5U + 40U};
    for (uint32_t i = 0; i < view->count; i++) {
        const uint32_t index = search->working[i];
        const struct vec3 centre = input->centre_q30[index];
        view->cap[i] = (struct rectangle_cap){
            .right = q30_from_q60(vec3_dot_unit(input->base.right_q30, centre)),
            .ahead = q30_from_q60(vec3_dot_unit(input->base.ahead_q30, centre)),
            .up = q30_from_q60(vec3_dot_unit(input->base.up_q30, centre)),
            .sin = input->radius == NULL ? 0 : input->radius[index].sin_q30};
    }
}

static void turn_to(struct rectangle_view *view, uint32_t pan_bam32) {
    const struct sincos pan = trig_sincos(bam32(pan_bam32));
    for (uint32_t i = 0; i < view->count; i++) {
        struct rectangle_cap *cap = &view->cap[i];
        cap->across =
            q30_from_q60(product(cap->right, pan.cos_q30) - product(cap->ahead, pan.sin_q30));
        cap->aside = cap->across < 0 ? -cap->across : cap->across;
        cap->level =
            q30_from_q60(product(cap->right, pan.sin_q30) + product(cap->ahead, pan.cos_q30));
    }
}

/// To 2^15 BAM, by at most a quarter turn / 2^first to either side.
static int32_t coarse_tilt(struct rectangle_view *view, int32_t tilt, uint32_t first) {
    const struct sincos from = trig_sincos(bam32((uint32_t)tilt));
    int32_t c = from.cos_q30, s = from.sin_q30;
    for (uint32_t i = first; i < COARSE_STEPS; i++) {
        const bool upward = demand_at(view, c, s).upward;
        const int32_t sin = upward ? halves[i].sin_q30 : -halves[i].sin_q30,
                      cos = halves[i].cos_q30;
        const int32_t turned = q30_from_q60(product(c, cos) - product(s, sin));
        s = q30_from_q60(product(s, cos) + product(c, sin));
        c = turned;
        const int32_t step = QUARTER_TILT >> (i + 1U);
        tilt += upward ? step : -step;
    }
    return tilt;
}

/// From a tilt, by at most twice the reach to either side.
static struct demand fine_tilt(struct rectangle_view *view, int32_t *tilt, uint32_t reach_bam32,
                               uint32_t least_bam32) {
    const struct sincos from = trig_sincos(bam32((uint32_t)*tilt));
    int64_t offset = 0;
    for (uint32_t step = reach_bam32;; step /= 2U) {
        const int64_t rad_q40 = offset * RAD_PER_BAM_Q52 >> 12;
        const int64_t half_square_q30 = rad_q40 * rad_q40 >> 51;
        const int64_t c =
            from.cos_q30 - (from.sin_q30 * rad_q40 >> 40) - (from.cos_q30 * half_square_q30 >> 30);
        const int64_t s =
            from.sin_q30 + (from.cos_q30 * rad_q40 >> 40) - (from.sin_q30 * half_square_q30 >> 30);
        const struct demand demand = demand_at(view, (int32_t)c, (int32_t)s);
        if (step < least_bam32) {
            *tilt += (int32_t)offset;
            return demand;
        }
        offset += demand.upward ? (int64_t)step : -(int64_t)step;
    }
}

uint32_t rectangle_tilt_work(const struct rectangle_view *view, uint32_t reach_bam32,
                             uint32_t least_bam32) {
    const uint32_t all =
        reach_bam32 == 0U ? COARSE_STEPS + FINE_STEPS + 1U : 65U - u64_leading_zeros(reach_bam32);
    const uint32_t steps = all + u64_leading_zeros(least_bam32) - 63U;
    return view->input->radius == NULL ? steps * (14U + 3U * (view->count + 1U)) + 70U
                                       : steps * (48U + 6U * (view->count + 1U)) + 90U;
}

bool rectangle_best_tilt(struct rectangle_view *view, struct rectangle_place *place,
                         uint32_t reach_bam32, uint32_t least_bam32) {
    const int64_t from = place->tilt_bam32, most = 2 * ((int64_t)reach_bam32 - least_bam32);
    int32_t tilt = place->tilt_bam32;
    uint32_t reach = reach_bam32;
    turn_to(view, place->pan_bam32);
    view->work += rectangle_tilt_work(view, reach_bam32, least_bam32);
    if (reach_bam32 == 0U || reach_bam32 > FINE_REACH_BAM) {
        tilt = reach_bam32 == 0U ? coarse_tilt(view, 0, 0)
                                 : coarse_tilt(view, tilt, u64_leading_zeros(reach_bam32) - 34U);
        reach = FINE_REACH_BAM;
    }
    const struct demand demand = fine_tilt(view, &tilt, reach, least_bam32);
    const bool beyond = reach_bam32 != 0U && (tilt > QUARTER_TILT || tilt < -QUARTER_TILT);
    place->tilt_bam32 = tilt;
    place->slope_q32 = demand.behind || beyond ? UINT64_MAX : slope_q32(demand.num, demand.den);
    return reach_bam32 == 0U ||
           (!demand.behind && !beyond && tilt - from < most && tilt - from > -most);
}

// ---------------------------------------------------------------- every cap

static struct vec3 in_caps_axes(const struct rectangle_base *base, int32_t right, int32_t ahead,
                                int32_t up) {
    const struct vec3 r = base->right_q30, a = base->ahead_q30, u = base->up_q30;
    return vec3(q30_from_q60(product(r.x, right) + product(a.x, ahead) + product(u.x, up)),
                q30_from_q60(product(r.y, right) + product(a.y, ahead) + product(u.y, up)),
                q30_from_q60(product(r.z, right) + product(a.z, ahead) + product(u.z, up)));
}

struct vec3 rectangle_ahead(const struct rectangle_base *base,
                            const struct rectangle_place *place) {
    const struct sincos pan = trig_sincos(bam32(place->pan_bam32)),
                        tilt = trig_sincos(bam32((uint32_t)place->tilt_bam32));
    return in_caps_axes(base, q30_mul(pan.sin_q30, tilt.cos_q30),
                        q30_mul(pan.cos_q30, tilt.cos_q30), tilt.sin_q30);
}

struct camera {
    struct vec3 right_q30, ahead_q30, up_q30;
};

static struct camera camera_at(const struct rectangle_base *base,
                               const struct rectangle_place *place) {
    const struct sincos pan = trig_sincos(bam32(place->pan_bam32)),
                        tilt = trig_sincos(bam32((uint32_t)place->tilt_bam32));
    return (struct camera){.right_q30 = in_caps_axes(base, pan.cos_q30, -pan.sin_q30, 0),
                           .ahead_q30 = rectangle_ahead(base, place),
                           .up_q30 =
                               in_caps_axes(base, -q30_mul(pan.sin_q30, tilt.sin_q30),
                                            -q30_mul(pan.cos_q30, tilt.sin_q30), tilt.cos_q30)};
}

/// What is read so far: the slopes to the right, left, above, below.
struct reading {
    struct camera camera;
    struct side side[4];
    bool sized, behind;
};

static inline void read_side(struct reading *reading, struct rectangle_sides *sides, uint32_t k,
                             int32_t x, int32_t ahead, int32_t sin, uint32_t index,
                             uint32_t *work) {
    struct side *const side = &reading->side[k];
    if (sticks_out(side, x, ahead, sin)) {
        *side = side_for(x, ahead, sin);
        sides->index[k] = index;
        if (reading->sized) { // also behind one without a radius others may have one
            side->root = length_of(side->num, side->den);
            *work += 8U;
        }
    }
}

static inline void read_cap(struct reading *reading, struct rectangle_sides *sides,
                            const struct rectangle_input *input, uint32_t index, uint32_t *work) {
    const struct vec3 centre = input->centre_q30[index];
    const int32_t ahead = (int32_t)(vec3_dot_unit(reading->camera.ahead_q30, centre) >> 30);
    const int32_t right = (int32_t)(vec3_dot_unit(reading->camera.right_q30, centre) >> 30);
    const int32_t above = (int32_t)(vec3_dot_unit(reading->camera.up_q30, centre) >> 30);
    const int32_t sin = input->radius == NULL ? 0 : input->radius[index].sin_q30;
    if (ahead <= sin) {
        reading->behind = true;
        return;
    }
    read_side(reading, sides, right < 0, right < 0 ? -right : right, ahead, sin, index, work);
    read_side(reading, sides, 2U + (above < 0), above < 0 ? -above : above, ahead, sin, index,
              work);
}

uint64_t rectangle_read(struct rectangle_view *view, const struct rectangle_place *place,
                        struct rectangle_sides *sides) {
    const struct rectangle_input *input = view->input;
    struct reading reading = {.camera = camera_at(&input->base, place),
                              .sized = input->radius != NULL};
    for (uint32_t i = 0; i < 4U; i++) {
        reading.side[i] = (struct side){0, Q30_ONE, Q30_ONE};
        sides->index[i] = NONE;
    }
    for (uint32_t k = 0; k < view->count && !reading.behind; k++) { // they rule out most
        read_cap(&reading, sides, input, view->working[k], &view->work);
    }
    for (uint32_t k = 0; k < input->count && !reading.behind; k++) {
        read_cap(&reading, sides, input, input->member == NULL ? k : input->member[k], &view->work);
    }
    view->work += 4U * (view->count + input->count) + 150U;
    if (reading.behind) {
        return UINT64_MAX;
    }
    uint64_t most = 0;
    for (uint32_t i = 0; i < 4U; i++) {
        const struct side *side = &reading.side[i];
        const q30_t scale_q30 = i < 2U ? view->height_q30 : view->width_q30;
        const uint64_t slope = slope_q32((int32_t)(product(side->num, scale_q30) >> 30), side->den);
        most = slope > most ? slope : most;
    }
    return most;
}
