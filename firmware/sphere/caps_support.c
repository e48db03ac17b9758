#include "sphere/caps_support.h"

#include "fixed/real.h"

#include <stddef.h>

/// Two reaches this close are equal: 2^-40 turns, 6e-12 rad.
#define SAME_TURN64 (UINT64_C(1) << 24)
/// What is left to a quarter turn for the answer's own rounding: 2^-30 rad.
#define CLEARANCE_TURN64 (UINT64_C(0x28BE60DB9) >> 2)

struct real3 {
    struct real x, y, z;
};

static struct real minus(int64_t a, int64_t b, int32_t exponent) {
    return real(a - b, exponent);
}

static struct real3 from_q61(struct vec3_i64 a) {
    return (struct real3){real(a.x, -61), real(a.y, -61), real(a.z, -61)};
}

static struct real real_q62(int64_t value) {
    return real(value, -62);
}

static struct real dot(struct real3 a, struct real3 b) {
    return real_add(real_add(real_mul(a.x, b.x), real_mul(a.y, b.y)), real_mul(a.z, b.z));
}

static struct real3 cross(struct real3 a, struct real3 b) {
    return (struct real3){real_sub(real_mul(a.y, b.z), real_mul(a.z, b.y)),
                          real_sub(real_mul(a.z, b.x), real_mul(a.x, b.z)),
                          real_sub(real_mul(a.x, b.y), real_mul(a.y, b.x))};
}

/// a * s + b * t.
static struct real3 blend(struct real3 a, struct real s, struct real3 b, struct real t) {
    return (struct real3){real_add(real_mul(a.x, s), real_mul(b.x, t)),
                          real_add(real_mul(a.y, s), real_mul(b.y, t)),
                          real_add(real_mul(a.z, s), real_mul(b.z, t))};
}

static struct real3 unit(struct real3 a) {
    const struct real scale = real_div(real(1, 0), real_root(dot(a, a)));
    return (struct real3){real_mul(a.x, scale), real_mul(a.y, scale), real_mul(a.z, scale)};
}

static struct vec3_i64 to_q61(struct real3 a) {
    return (struct vec3_i64){real_to_i64(a.x, 61), real_to_i64(a.y, 61), real_to_i64(a.z, 61)};
}

// ---------------------------------------------------------------- candidates

/// An axis that one to three caps ask for, and how far the farthest of all reaches from it.
struct candidate {
    struct vec3_i64 axis_q61;
    uint64_t own_turn64;      // how far those caps reach
    uint64_t reach_turn64;    // and all
    uint8_t count, member[3]; // places in the list of caps
    struct real least_weight; // of three: how far inside their triangle the axis is
};

/// The caps that are to be held; the new one is last.
struct problem {
    struct caps_point cap[4];
    uint8_t count;
    uint64_t least_turn64; // no cap narrower than this holds all
};

uint64_t caps_reach(struct vec3_i64 axis_q61, const struct caps_point *point) {
    return trig_fine_angle(axis_q61, point->centre_q61) + point->radius_turn64;
}

static bool is_member(const struct candidate *candidate, uint8_t i) {
    for (uint8_t k = 0; k < candidate->count; k++) {
        if (candidate->member[k] == i) {
            return true;
        }
    }
    return false;
}

/// How far the caps reach that the candidate is not made of, at least its own; or, if that is more
/// than enough to know that it is not the best, how far the first such one does.
static uint64_t reach_of_all(const struct problem *problem, const struct candidate *candidate,
                             uint64_t enough) {
    uint64_t most = candidate->own_turn64;
    for (uint8_t i = 0; i < problem->count && most <= enough; i++) {
        if (!is_member(candidate, i)) {
            const uint64_t reach = caps_reach(candidate->axis_q61, &problem->cap[i]);
            most = reach > most ? reach : most;
        }
    }
    return most;
}

/// The narrowest cap of two touches both from inside, its axis on the arc between their centres.
/// False: one of them holds the other, or they are opposite, or it can't hold the old ones.
static bool hold_two(const struct problem *problem, struct candidate *candidate) {
    const struct caps_point *a = &problem->cap[candidate->member[0]],
                            *b = &problem->cap[candidate->member[1]];
    const uint64_t apart = trig_fine_angle(a->centre_q61, b->centre_q61);
    if (apart + a->radius_turn64 <= b->radius_turn64 ||
        apart + b->radius_turn64 <= a->radius_turn64) {
        return false;
    }
    candidate->own_turn64 = (apart + a->radius_turn64 + b->radius_turn64) / 2U;
    if (candidate->own_turn64 >= TURN64_QUARTER || candidate->own_turn64 < problem->least_turn64) {
        return false;
    }
    const uint64_t from_a = candidate->own_turn64 - a->radius_turn64;
    const struct real of_a = real_q62(trig_fine_sincos(apart - from_a).sin_q62),
                      of_b = real_q62(trig_fine_sincos(from_a).sin_q62);
    candidate->axis_q61 =
        to_q61(unit(blend(from_q61(a->centre_q61), of_a, from_q61(b->centre_q61), of_b)));
    return true;
}

/// An axis v with v . c_i = cos(R - r_i) for three caps is cos R (M + N tan R): the equations are
/// linear in v, cos R and sin R.
struct pencil {
    struct real3 m, n;
};

/// Differences from the first cap keep the digits of caps that are close together. With d_i the
/// differences of the centres, e_i and f_i those of cosine and sine of the radii, and g = d_b x
/// d_c: v . d_b = cos R e_b + sin R f_b, v . d_c likewise, and v . c_a as above tells the part
/// along g. False: the centres lie on a great circle.
static bool make_pencil(const struct caps_point *a, const struct caps_point *b,
                        const struct caps_point *c, struct pencil *pencil) {
    const struct real3 centre = from_q61(a->centre_q61);
    const struct real3 db = from_q61(vec3_i64_sub(b->centre_q61, a->centre_q61)),
                       dc = from_q61(vec3_i64_sub(c->centre_q61, a->centre_q61));
    const struct real3 g = cross(db, dc);
    const struct real square = dot(g, g), height = dot(centre, g);
    if (real_sign(square) == 0 || real_sign(height) == 0) {
        return false;
    }
    const struct real per_square = real_div(real(1, 0), square),
                      per_height = real_div(real(1, 0), height);
    const struct real3 along_b = cross(dc, g), along_c = cross(g, db);
    const struct real eb = real_mul(minus(b->radius.cos_q62, a->radius.cos_q62, -62), per_square),
                      ec = real_mul(minus(c->radius.cos_q62, a->radius.cos_q62, -62), per_square),
                      fb = real_mul(minus(b->radius.sin_q62, a->radius.sin_q62, -62), per_square),
                      fc = real_mul(minus(c->radius.sin_q62, a->radius.sin_q62, -62), per_square);
    const struct real3 e = blend(along_b, eb, along_c, ec), f = blend(along_b, fb, along_c, fc);
    const struct real of_e = real_mul(real_sub(real_q62(a->radius.cos_q62), dot(centre, e)),
                                      per_height),
                      of_f = real_mul(real_sub(real_q62(a->radius.sin_q62), dot(centre, f)),
                                      per_height);
    const struct real one = real(1, 0);
    pencil->m = blend(e, one, g, of_e);
    pencil->n = blend(f, one, g, of_f);
    return true;
}

/// tan R from |M + N tan R| = 1 / cos R: at most two values, by the root that does not cancel.
static unsigned solve_pencil(const struct pencil *pencil, struct real tangent[2]) {
    const struct real one = real(1, 0);
    const struct real a = real_sub(dot(pencil->n, pencil->n), one),
                      half_b = dot(pencil->m, pencil->n),
                      c = real_sub(dot(pencil->m, pencil->m), one);
    const struct real under = real_sub(real_mul(half_b, half_b), real_mul(a, c));
    const struct real root = real_root(under);
    const struct real q =
        real_neg(real_sign(half_b) < 0 ? real_sub(half_b, root) : real_add(half_b, root));
    tangent[0] = real_div(q, a); // a quotient by zero is zero
    tangent[1] = real_div(c, q);
    return real_sign(under) < 0 ? 0U : 2U;
}

/// The least of the weights with which the centres sum up to the axis, as a part of all: not
/// negative if the axis lies in their triangle, as it must if they hold their narrowest cap there.
static struct real least_weight(struct vec3_i64 axis_q61, const struct caps_point *const cap[3]) {
    const struct real3 axis = from_q61(axis_q61);
    struct real3 from_axis[3];
    for (unsigned i = 0; i < 3U; i++) {
        from_axis[i] = from_q61(vec3_i64_sub(cap[i]->centre_q61, axis_q61));
    }
    struct real weight[3], sum = {0, 0};
    for (unsigned i = 0; i < 3U; i++) {
        // det(A, b, c) = det(A, b - A, c - A): nothing cancels where all are close.
        weight[i] = dot(axis, cross(from_axis[(i + 1U) % 3U], from_axis[(i + 2U) % 3U]));
        sum = real_add(sum, weight[i]);
    }
    const struct real per_sum = real_div(real(1, 0), sum);
    struct real least = real_mul(weight[0], per_sum);
    for (unsigned i = 1; i < 3U; i++) {
        const struct real part = real_mul(weight[i], per_sum);
        least = real_less(part, least) ? part : least;
    }
    return least;
}

static uint64_t apart(uint64_t a, uint64_t b) {
    return a > b ? a - b : b - a;
}

/// Is R, given by its tangent, at least the radius of the cap? Else the two touch, but the cap
/// holds R's.
static bool is_within(const struct caps_point *cap, struct real tangent) {
    return !real_less(real_mul(tangent, real_q62(cap->radius.cos_q62)),
                      real_q62(cap->radius.sin_q62));
}

/// One of the two axes of a pencil. False: it is not one whose cone the three hold.
static bool hold_three_by(const struct problem *problem, const struct pencil *pencil,
                          struct real tangent, struct candidate *candidate) {
    const struct caps_point *const cap[3] = {&problem->cap[candidate->member[0]],
                                             &problem->cap[candidate->member[1]],
                                             &problem->cap[candidate->member[2]]};
    if (real_sign(tangent) <= 0 || !is_within(cap[0], tangent) || !is_within(cap[1], tangent) ||
        !is_within(cap[2], tangent)) {
        return false;
    }
    candidate->axis_q61 = to_q61(unit(blend(pencil->m, real(1, 0), pencil->n, tangent)));
    candidate->least_weight = least_weight(candidate->axis_q61, cap);
    candidate->own_turn64 = caps_reach(candidate->axis_q61, cap[0]);
    return !real_less(candidate->least_weight, real(-1, -20)); // a little: its own rounding
}

/// The narrowest cap of three that touches all from inside. False: there is none.
static bool hold_three(const struct problem *problem, struct candidate *candidate) {
    struct pencil pencil;
    struct real tangent[2];
    if (!make_pencil(&problem->cap[candidate->member[0]], &problem->cap[candidate->member[1]],
                     &problem->cap[candidate->member[2]], &pencil)) {
        return false;
    }
    const unsigned count = solve_pencil(&pencil, tangent);
    for (unsigned i = 0; i < count; i++) {
        if (hold_three_by(problem, &pencil, tangent[i], candidate)) {
            return true;
        }
    }
    return false;
}

/// Do these caps hold their own narrowest cap? Then where and how wide.
static bool hold(const struct problem *problem, struct candidate *candidate) {
    switch (candidate->count) {
    case 1:
        candidate->axis_q61 = problem->cap[candidate->member[0]].centre_q61;
        candidate->own_turn64 = problem->cap[candidate->member[0]].radius_turn64;
        return candidate->own_turn64 >= problem->least_turn64;
    case 2:
        return hold_two(problem, candidate);
    default:
        return hold_three(problem, candidate);
    }
}

// ---------------------------------------------------------------- the support

void caps_support_start(struct caps_support *support, const struct caps_point *point) {
    support->count = 1;
    support->point[0] = *point;
    support->axis_q61 = point->centre_q61;
    support->reach_turn64 = point->radius_turn64;
}

static void take(struct caps_support *support, const struct problem *problem,
                 const struct candidate *candidate) {
    support->count = candidate->count;
    support->axis_q61 = candidate->axis_q61;
    support->reach_turn64 = candidate->own_turn64;
    for (uint8_t i = 0; i < candidate->count; i++) {
        support->point[i] = problem->cap[candidate->member[i]];
    }
}

bool caps_support_hold(struct caps_support *support, const struct caps_point *points,
                       uint8_t count) {
    struct problem problem = {.count = count};
    struct candidate candidate = {.count = count, .member = {0, 1, 2}};
    for (uint8_t i = 0; i < count; i++) {
        problem.cap[i] = points[i];
    }
    if (!hold(&problem, &candidate)) {
        return false;
    }
    take(support, &problem, &candidate);
    return true;
}

/// Is a the better of the two? Of equal reach: the one whose caps hold it most plainly. A set on
/// one circle has triples that do not hold it at all.
static bool is_better(const struct candidate *a, const struct candidate *b) {
    if (apart(a->reach_turn64, b->reach_turn64) > SAME_TURN64) {
        return a->reach_turn64 < b->reach_turn64;
    }
    return real_less(b->least_weight, a->least_weight);
}

/// The subsets that can hold the narrowest cap once a new one has entered, which is in every one of
/// them: which of the old ones are beside it. Bit k is old cap k.
static const uint8_t beside[] = {0, 1, 2, 4, 3, 5, 6};

/// What the subsets cost: an arc is one, an axis of three caps is three of these.
#define SUBSET_COST(count) ((count) == 3U ? 3U : (count)-1U)
#define SUBSET_COST_MAX    5U

void caps_support_recall(struct caps_support *support, const struct caps_point *points,
                         uint8_t count) {
    support->count = count;
    support->reach_turn64 = 0;
    for (uint8_t i = 0; i < count; i++) {
        support->point[i] = points[i];
    }
}

static struct candidate subset(const struct caps_support *support, unsigned mask) {
    struct candidate candidate = {.count = 1, .member = {support->count}};
    for (uint8_t k = 0; k < support->count; k++) {
        if ((mask >> k & 1U) != 0U) {
            candidate.member[candidate.count++] = k;
        }
    }
    return candidate;
}

enum caps_entry caps_support_enter(struct caps_support *support, const struct caps_point *point,
                                   uint8_t *step) {
    // Their own rounding may make the old ones' reach a little too large.
    struct problem problem = {.count = (uint8_t)(support->count + 1U),
                              .least_turn64 = support->reach_turn64 > SAME_TURN64
                                                  ? support->reach_turn64 - SAME_TURN64
                                                  : 0U};
    for (uint8_t i = 0; i < support->count; i++) {
        problem.cap[i] = support->point[i];
    }
    problem.cap[support->count] = *point;
    struct candidate best = {.reach_turn64 = UINT64_MAX / 2U};
    unsigned cost = 0;
    for (uint8_t i = step == NULL ? 0U : *step; i < sizeof beside; i++) {
        if (beside[i] >= 1U << support->count) {
            continue;
        }
        struct candidate candidate = subset(support, beside[i]);
        cost += SUBSET_COST(candidate.count);
        if (step != NULL && cost > SUBSET_COST_MAX) {
            *step = i;
            return CAPS_GO_ON;
        }
        if (!hold(&problem, &candidate)) {
            continue;
        }
        candidate.reach_turn64 = reach_of_all(&problem, &candidate, best.reach_turn64);
        const bool holds_all = candidate.reach_turn64 <= candidate.own_turn64 + SAME_TURN64;
        if (holds_all || is_better(&candidate, &best)) {
            best = candidate;
        }
        if (holds_all &&
            (candidate.count < 3U || real_less(real(1, -20), candidate.least_weight))) {
            break; // nothing narrower can
        }
    }
    if (best.reach_turn64 + CLEARANCE_TURN64 >= TURN64_QUARTER) {
        return CAPS_SURROUNDED;
    }
    const bool loose = best.reach_turn64 > best.own_turn64 + SAME_TURN64;
    best.own_turn64 = best.reach_turn64;
    take(support, &problem, &best);
    return loose ? CAPS_LOOSE : CAPS_ENTERED;
}
