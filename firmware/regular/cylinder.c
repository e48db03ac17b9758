#include "regular/cylinder.h"

#include "fixed/root.h"
#include "fixed/sort.h"
#include "fixed/trig.h"
#include "fixed/trig_fine.h"

#define ONE_Q61 ((int64_t)1 << 61)
/// What a disc must gain to count, in the sine.
#define GAIN_Q61 ((int64_t)1 << 15)

void cylinder_open(struct cylinder *cylinder, uint32_t count, struct arena *arena) {
    const uint64_t arcs = 2U * (uint64_t)count;
    cylinder->sides = arena_take(arena, count, sizeof *cylinder->sides);
    cylinder->start = arena_take(arena, arcs, sizeof *cylinder->start);
    cylinder->length = arena_take(arena, arcs, sizeof *cylinder->length);
    cylinder->list = arena_take(arena, arcs, sizeof *cylinder->list);
    cylinder->spare = arena_take(arena, arcs, sizeof *cylinder->spare);
}

static int64_t product_q61(int64_t a, int64_t b) {
    const struct i128 p = i128_mul(a, b);
    return (int64_t)((uint64_t)p.hi << 3 | p.lo >> 61);
}

static int64_t dot_q61(struct vec3_i64 a, struct vec3_i64 b) {
    const struct i128 p = vec3_i64_dot(a, b);
    return (int64_t)((uint64_t)p.hi << 3 | p.lo >> 61);
}

/// sqrt(a * b) of non-negative Q2.61 numbers.
static uint64_t mean_q61(int64_t a, int64_t b) {
    return a <= 0 || b <= 0 ? 0U : root_u128(u128_mul((uint64_t)a, (uint64_t)b));
}

static struct vec3_i64 scaled_q61(struct vec3_i64 a, int64_t by_q61) {
    return (struct vec3_i64){product_q61(a.x, by_q61), product_q61(a.y, by_q61),
                             product_q61(a.z, by_q61)};
}

/// Two unit vectors at right angles to n and each other.
struct frame {
    struct vec3_i64 n, right, up;
};

static struct vec3_i64 cross_unit(struct vec3_i64 a, struct vec3_i64 b) {
    const struct vec3_i128 c = vec3_i64_cross(a, b);
    return disc_unit_q61((struct vec3_i64){i256_shift_right_i64(i256_from_i128(c.x), 63),
                                           i256_shift_right_i64(i256_from_i128(c.y), 63),
                                           i256_shift_right_i64(i256_from_i128(c.z), 63)});
}

static struct frame frame_about(struct vec3_i64 n) {
    // The axis that is farthest from n.
    const uint64_t x = u64_abs(n.x), y = u64_abs(n.y), z = u64_abs(n.z);
    const struct vec3_i64 axis = x <= y && x <= z ? (struct vec3_i64){ONE_Q61, 0, 0}
                                 : y <= z         ? (struct vec3_i64){0, ONE_Q61, 0}
                                                  : (struct vec3_i64){0, 0, ONE_Q61};
    const struct vec3_i64 right = cross_unit(n, axis);
    return (struct frame){n, right, cross_unit(n, right)};
}

static uint64_t angle_of(int64_t y, int64_t x) {
    const uint64_t size = trig_atan2_turn64(u64_abs(y), u64_abs(x));
    const uint64_t upper = x < 0 ? 2U * TURN64_QUARTER - size : size;
    return y < 0 ? 0U - upper : upper;
}

/// The point at an angle on the small circle n . v = sine.
static struct vec3_i64 point_at(const struct frame *frame, int64_t sine_q61, uint64_t angle) {
    const struct sincos_q62 turn = trig_fine_sincos(angle);
    const int64_t radius = (int64_t)mean_q61(ONE_Q61 - sine_q61, ONE_Q61 + sine_q61);
    const struct vec3_i64 up = scaled_q61(frame->n, sine_q61);
    const struct vec3_i64 a = scaled_q61(frame->right, product_q61(radius, turn.cos_q62 / 2));
    const struct vec3_i64 b = scaled_q61(frame->up, product_q61(radius, turn.sin_q62 / 2));
    return (struct vec3_i64){up.x + a.x + b.x, up.y + a.y + b.y, up.z + a.z + b.z};
}

/// The arcs of the small circle n . v = t on which |m . v| < t. With a = m . n, it is where the
/// cosine of the angle from m's azimuth is below root((1 - a) / (1 + a)) t / root(1 - t^2), and
/// above minus the same with a and -a exchanged. A little too short, for rounding: what is close to
/// n or -n has no certain azimuth.
static void arcs_of(const struct cylinder *c, uint32_t arc, const struct frame *frame,
                    struct vec3_i64 m, int64_t sine_q61) {
    const int64_t a = dot_q61(m, frame->n), square = product_q61(sine_q61, sine_q61);
    const int64_t x = dot_q61(m, frame->right), y = dot_q61(m, frame->up);
    const uint64_t azimuth = angle_of(y, x);
    const uint64_t near = trig_atan2_turn64(mean_q61(ONE_Q61 + a - 2 * square, ONE_Q61),
                                            mean_q61(square, ONE_Q61 - a));
    const uint64_t far =
        2U * TURN64_QUARTER - trig_atan2_turn64(mean_q61(ONE_Q61 - a - 2 * square, ONE_Q61),
                                                mean_q61(square, ONE_Q61 + a));
    const uint64_t distance = (u64_abs(x) | u64_abs(y)) >> 20;
    const uint64_t error =
        (UINT64_C(1) << 12) + (distance == 0U ? TURN64_QUARTER : (UINT64_C(1) << 50) / distance);
    const uint64_t width = far - near;
    const uint64_t length = width > 2U * error ? width - 2U * error : 0U;
    c->start[arc] = azimuth + near + error;
    c->start[arc + 1U] = azimuth - far + error;
    c->length[arc] = length;
    c->length[arc + 1U] = length;
}

static bool start_before(const void *context, uint32_t a, uint32_t b) {
    const struct cylinder *const c = context;
    return c->start[a] < c->start[b];
}

/// The cell around a point.
static void consider_at(struct cylinder *c, const struct cell_circle *circles, uint32_t count,
                        struct vec3_i64 at, struct cell_best *best) {
    for (uint32_t i = 0; i < count; i++) {
        c->sides[i] = 2U * i + (i128_sign(vec3_i64_dot(circles[i].unit_q61, at)) < 0 ? 1U : 0U);
    }
    best->operations += count;
    cell_consider(best, circles, c->sides, count);
}

/// Goes through what the arcs leave free. True: the best got better.
static bool improve(struct cylinder *c, const struct cell_circle *circles, uint32_t count,
                    const struct frame *frame, uint32_t arcs, struct cell_best *best) {
    const int64_t sine = best->sine_q61 + GAIN_Q61;
    const int64_t before = best->sine_q61;
    uint64_t reach = 0; // everything below is taken
    for (uint32_t i = 0; i < arcs; i++) {
        c->list[i] = i;
        const uint64_t end = c->start[i] + c->length[i];
        if (end < c->start[i] && end > reach) {
            reach = end;
        }
    }
    sort_indices(c->list, c->spare, arcs, start_before, c);
    best->operations += (uint64_t)arcs * (64U - u64_leading_zeros(arcs)); // about
    for (uint32_t i = 0; i <= arcs; i++) {
        const uint64_t next = i == arcs ? UINT64_MAX : c->start[c->list[i]];
        if (next > reach) {
            consider_at(c, circles, count, point_at(frame, sine, reach + (next - reach) / 2U),
                        best);
            if (best->sine_q61 > before + GAIN_Q61 / 2) {
                return true;
            }
        }
        if (i < arcs) {
            const uint64_t end = next + c->length[c->list[i]];
            if (end < next) {
                return false; // taken up to the whole turn
            }
            reach = end > reach ? end : reach;
        }
    }
    return false;
}

void cylinder_search(struct cylinder *c, const struct cell_circle *circles, uint32_t count,
                     struct cell_best *best) {
    consider_at(c, circles, count, (struct vec3_i64){3, 5, 7}, best);
    for (uint32_t i = 0; i < count; i++) {
        const struct frame frame = frame_about(circles[i].unit_q61);
        bool better = true;
        while (better && best->sine_q61 + GAIN_Q61 < ONE_Q61) {
            uint32_t arcs = 0;
            for (uint32_t j = 0; j < count; j++) {
                if (j != i) {
                    arcs_of(c, arcs, &frame, circles[j].unit_q61, best->sine_q61 + GAIN_Q61);
                    arcs += 2U;
                }
            }
            best->operations += arcs;
            better = improve(c, circles, count, &frame, arcs, best);
        }
    }
}
