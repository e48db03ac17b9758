#include "weigh.h"

#include "sphere/cone.h"

#include <math.h>
#include <stdlib.h>

struct real3 {
    long double x, y, z;
};

static struct real3 from_vec3(struct vec3 a) {
    const long double x = a.x, y = a.y, z = a.z, length = sqrtl(x * x + y * y + z * z);
    return (struct real3){x / length, y / length, z / length};
}

static long double dot(struct real3 a, struct real3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct real3 cross(struct real3 a, struct real3 b) {
    return (struct real3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static struct real3 blend(struct real3 a, long double s, struct real3 b, long double t) {
    return (struct real3){a.x * s + b.x * t, a.y * s + b.y * t, a.z * s + b.z * t};
}

static struct real3 unit(struct real3 a) {
    const long double length = sqrtl(dot(a, a));
    return (struct real3){a.x / length, a.y / length, a.z / length};
}

static struct vec3 to_q30(struct real3 a) {
    return vec3((int32_t)lroundl(a.x * Q30_ONE), (int32_t)lroundl(a.y * Q30_ONE),
                (int32_t)lroundl(a.z * Q30_ONE));
}

struct problem {
    const struct vec3 *directions_q30;
    const double *weights;
    uint32_t count;
    enum weigh_cost cost;
};

/// Cost, its derivative by the angle, the second one, and derivative / tan(angle): the curvatures
/// of the sum are the second along the line to the object and the last across.
struct bend {
    long double value, slope, along, across;
};

static struct bend bend_of(enum weigh_cost cost, long double sine, long double cosine) {
    if (cost == WEIGH_ANGLE_SQUARED) {
        const long double angle = atan2l(sine, cosine);
        const long double across = sine > 1e-12L ? 2 * angle * cosine / sine : 2;
        return (struct bend){angle * angle, 2 * angle, 2, across};
    }
    if (cosine <= 0) {
        return (struct bend){HUGE_VALL, 0, 0, 0};
    }
    return (struct bend){1 / cosine, sine / (cosine * cosine),
                         (1 + sine * sine) / (cosine * cosine * cosine), 1 / cosine};
}

static long double cost_at(const struct problem *problem, struct real3 v) {
    long double sum = 0;
    for (uint32_t i = 0; i < problem->count; i++) {
        if (problem->weights[i] > 0) {
            const struct real3 c = from_vec3(problem->directions_q30[i]), n = cross(v, c);
            sum += problem->weights[i] * bend_of(problem->cost, sqrtl(dot(n, n)), dot(v, c)).value;
        }
    }
    return sum;
}

/// Newton's step in the plane across v, downhill where the sum is not convex.
static struct real3 step_from(const struct problem *problem, struct real3 v) {
    const struct real3 aside =
        fabsl(v.x) < 0.6L ? (struct real3){1, 0, 0} : (struct real3){0, 1, 0};
    const struct real3 e1 = unit(cross(v, aside)), e2 = cross(v, e1);
    long double gx = 0, gy = 0, hxx = 0, hxy = 0, hyy = 0;
    for (uint32_t i = 0; i < problem->count; i++) {
        const long double w = problem->weights[i];
        if (!(w > 0)) {
            continue;
        }
        const struct real3 c = from_vec3(problem->directions_q30[i]);
        const long double x = dot(c, e1), y = dot(c, e2), sine = hypotl(x, y);
        const struct bend bend = bend_of(problem->cost, sine, dot(v, c));
        const long double tx = sine > 0 ? x / sine : 1, ty = sine > 0 ? y / sine : 0;
        gx -= w * bend.slope * tx; // toward the object the cost falls
        gy -= w * bend.slope * ty;
        hxx += w * (bend.along * tx * tx + bend.across * ty * ty);
        hxy += w * (bend.along - bend.across) * tx * ty;
        hyy += w * (bend.along * ty * ty + bend.across * tx * tx);
    }
    const long double det = hxx * hyy - hxy * hxy;
    long double dx = -gx, dy = -gy;
    if (det > 0 && hxx > 0) {
        dx = (hxy * gy - hyy * gx) / det;
        dy = (hxy * gx - hxx * gy) / det;
    }
    const long double size = hypotl(dx, dy), most = 0.3L;
    const long double shorten = size > most ? most / size : 1;
    return blend(e1, dx * shorten, e2, dy * shorten);
}

/// Downhill from v until nothing is gained.
static struct real3 descend(const struct problem *problem, struct real3 v) {
    long double cost = cost_at(problem, v);
    for (int i = 0; i < 500; i++) {
        struct real3 step = step_from(problem, v);
        bool lower = false;
        for (int k = 0; k < 60 && !lower; k++) {
            const struct real3 next = unit(blend(v, 1, step, 1));
            const long double found = cost_at(problem, next);
            lower = found < cost;
            if (lower) {
                v = next;
                cost = found;
            }
            step = blend(step, 0.5L, step, 0);
        }
        if (!lower) {
            break;
        }
    }
    return v;
}

/// The weighted sum of the unit vectors. False: they cancel.
static bool sum_up(const struct problem *problem, struct real3 *v) {
    struct real3 sum = {0, 0, 0};
    long double weight = 0;
    for (uint32_t i = 0; i < problem->count; i++) {
        sum = blend(sum, 1, from_vec3(problem->directions_q30[i]), problem->weights[i]);
        weight += problem->weights[i];
    }
    if (dot(sum, sum) <= weight * weight * 1e-18L) {
        return false;
    }
    *v = unit(sum);
    return true;
}

/// The axis of the cone of the objects that count, from which every one of them is ahead.
static enum weigh_status start_ahead(const struct problem *problem, struct real3 *v) {
    struct vec3 *const counted = malloc((problem->count + 1U) * sizeof *counted);
    uint32_t count = 0;
    for (uint32_t i = 0; counted != NULL && i < problem->count; i++) {
        if (problem->weights[i] > 0) {
            counted[count++] = problem->directions_q30[i];
        }
    }
    struct cone_result cone;
    const struct cone_options options = {.lengths = CONE_LENGTHS_UNIT};
    const enum cone_status status = cone_narrowest(counted, count, &options, &cone);
    free(counted);
    if (status != CONE_OK) {
        return WEIGH_INFEASIBLE;
    }
    *v = from_vec3(cone.axis_q30);
    return cost_at(problem, *v) < HUGE_VALL ? WEIGH_OK : WEIGH_INFEASIBLE;
}

/// Beyond half a sphere there may be several minima: downhill from every object, too.
static struct real3 best_descent(const struct problem *problem, struct real3 first) {
    struct real3 best = descend(problem, first);
    long double cost = cost_at(problem, best);
    for (uint32_t i = 0; i < problem->count; i++) {
        for (uint32_t k = 0; k <= i; k++) { // the objects, and the middles between two
            const struct real3 a = from_vec3(problem->directions_q30[i]),
                               b = from_vec3(problem->directions_q30[k]),
                               middle = blend(a, 1, b, 1);
            if (dot(middle, middle) < 1e-12L || problem->count > 12U) {
                continue;
            }
            const struct real3 v = descend(problem, unit(middle));
            const long double found = cost_at(problem, v);
            if (found < cost * (1 - 1e-12L)) {
                best = v;
                cost = found;
            }
        }
    }
    return best;
}

enum weigh_status weigh_directions(const struct vec3 *directions_q30, const double *weights,
                                   uint32_t count, enum weigh_cost cost, struct vec3 near_q30,
                                   struct vec3 *out_q30) {
    const struct problem problem = {directions_q30, weights, count, cost};
    struct real3 v;
    double most = 0;
    for (uint32_t i = 0; i < count; i++) {
        most = fmax(most, weights[i]);
    }
    if (!(most > 0)) {
        return WEIGH_UNDEFINED;
    }
    if (cost == WEIGH_ONE_OVER_COS) {
        const enum weigh_status status = start_ahead(&problem, &v);
        if (status != WEIGH_OK) {
            return status;
        }
        *out_q30 = to_q30(descend(&problem, v));
        return WEIGH_OK;
    }
    const bool summed = sum_up(&problem, &v);
    if (cost == WEIGH_ONE_MINUS_COS) {
        if (!summed) {
            return WEIGH_UNDEFINED;
        }
        *out_q30 = to_q30(v);
        return WEIGH_OK;
    }
    *out_q30 = to_q30(best_descent(&problem, summed ? v : from_vec3(near_q30)));
    return WEIGH_OK;
}
