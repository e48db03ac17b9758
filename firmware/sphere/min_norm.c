#include "sphere/min_norm.h"

static bool is_zero_i128(struct vec3_i128 a) {
    return i128_sign(a.x) == 0 && i128_sign(a.y) == 0 && i128_sign(a.z) == 0;
}

static struct vec3_i128 add_i128(struct vec3_i128 a, struct vec3_i128 b) {
    return (struct vec3_i128){i128_add(a.x, b.x), i128_add(a.y, b.y), i128_add(a.z, b.z)};
}

static struct vec3_i128 negate_i128(struct vec3_i128 a) {
    return (struct vec3_i128){i128_neg(a.x), i128_neg(a.y), i128_neg(a.z)};
}

/// Sign of a . b for two 128-bit vectors of at most 2^124 a component.
static int dot_sign_i128(struct vec3_i128 a, struct vec3_i128 b) {
    return i256_sign(
        i256_add(i256_add(i256_mul(a.x, b.x), i256_mul(a.y, b.y)), i256_mul(a.z, b.z)));
}

// ---------------------------------------------------------------- 64-bit filters, for unit vectors

/// Difference of units.
static struct vec3_i64 between(struct vec3 from, struct vec3 to) {
    return (struct vec3_i64){(int64_t)to.x - from.x, (int64_t)to.y - from.y,
                             (int64_t)to.z - from.z};
}

/// Of differences of units: at most 2^62, since neither is longer than 2^31; off by less than
/// MIN_NORM_BAND.
static int64_t dot_between(struct vec3_i64 a, struct vec3_i64 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// -1, 1, or 0 if the value is inside the band of error.
static int sure_sign(int64_t value) {
    return value > MIN_NORM_BAND ? 1 : (value < -MIN_NORM_BAND ? -1 : 0);
}

/// Is the angle at a, in the triangle a b c of unit vectors, acute (1) or obtuse (-1)? 0: can't
/// tell.
static int sure_angle(struct vec3 a, struct vec3 b, struct vec3 c) {
    return sure_sign(dot_between(between(a, b), between(a, c)));
}

struct min_norm_filter min_norm_filter(const struct min_norm *support) {
    const struct vec3 a = support->point[0].unit_q30;
    if (support->count == 3U) {
        const struct vec3_i64 n = support->rough_normal;
        const struct vec3 normal =
            vec3((int32_t)(n.x >> 32), (int32_t)(n.y >> 32), (int32_t)(n.z >> 32));
        return (struct min_norm_filter){normal, vec3_dot_unit(normal, a)};
    }
    // One point is a chord shrunk to it.
    const struct vec3 b = support->point[support->count - 1U].unit_q30;
    const struct vec3_i64 sum = between(vec3_neg(a), b);
    return (struct min_norm_filter){
        vec3((int32_t)(sum.x >> 1), (int32_t)(sum.y >> 1), (int32_t)(sum.z >> 1)),
        (vec3_dot_unit(a, b) + ((int64_t)1 << 60)) / 2};
}

// ---------------------------------------------------------------- exact tests

static struct vec3_i64 exact_point(const struct min_norm *support, unsigned i) {
    return support->point[i].exact;
}

/// Normalises what the filters did without so far.
static void know_points(struct min_norm *support) {
    for (unsigned i = 0; support->unit && i < support->count; i++) {
        support->point[i].exact = vec3_normalise_q61(support->point[i].given);
    }
}

/// Works out what the exact tests of the support need.
static void know_exactly(struct min_norm *support) {
    if (support->exact_known) {
        return;
    }
    support->exact_known = true;
    know_points(support);
    const struct vec3_i64 a = exact_point(support, 0);
    if (support->count == 1U) {
        support->against = vec3_i64_dot(a, a);
    } else if (support->count == 2U) {
        support->chord = vec3_i64_sub(exact_point(support, 1), a);
        support->chord2 = vec3_i64_dot(support->chord, support->chord);
        support->against = vec3_i64_dot(a, support->chord);
    } else {
        support->normal = vec3_i64_cross(vec3_i64_sub(exact_point(support, 1), a),
                                         vec3_i64_sub(exact_point(support, 2), a));
        support->turned = support->side_known ? support->turned
                                              : i256_sign(vec3_i128_dot(support->normal, a)) < 0;
        if (support->turned) {
            support->normal = negate_i128(support->normal);
        }
    }
}

static bool violated_exactly(struct min_norm *support, struct vec3_i64 point) {
    know_exactly(support);
    const struct vec3_i64 a = exact_point(support, 0), from_a = vec3_i64_sub(point, a);
    switch (support->count) {
    case 1: // nearest point a: a . (x - a) < 0
        return i128_cmp(vec3_i64_dot(a, point), support->against) < 0;
    case 2: { // nearest point (a (d.d) - d (a.d)) / (d.d), times (d.d): 2^123 * 2^124 each, below
              // 2^249
        const struct i256 along = i256_mul(vec3_i64_dot(a, from_a), support->chord2);
        const struct i256 across = i256_mul(vec3_i64_dot(support->chord, from_a), support->against);
        return i256_sign(i256_sub(along, across)) < 0;
    }
    default: // the plane's normal: 2^125 * 2^62, three times
        return i256_sign(vec3_i128_dot(support->normal, from_a)) < 0;
    }
}

bool min_norm_violated_by(struct min_norm *support, const struct min_norm_point *point) {
    if (support->unit) {
        const struct min_norm_filter filter = min_norm_filter(support);
        const int64_t depth = min_norm_depth(&filter, point->unit_q30);
        if (depth > MIN_NORM_BAND || depth < -MIN_NORM_BAND) {
            return depth < 0;
        }
    }
    return violated_exactly(support,
                            support->unit ? vec3_normalise_q61(point->given) : point->exact);
}

// ---------------------------------------------------------------- which subset holds the nearest
// point

static bool hold_one(struct min_norm *support) {
    if (support->unit) {
        return true;
    }
    know_exactly(support);
    return i128_sign(support->against) != 0;
}

/// Two points hold it if the nearest point of their chord is strictly between them and not zero.
/// For unit vectors that is so unless they are (nearly) the same or opposite.
static bool hold_two(struct min_norm *support) {
    if (support->unit) {
        const struct vec3 a = support->point[0].unit_q30, b = support->point[1].unit_q30;
        const struct vec3_i64 chord = between(a, b), sum = between(vec3_neg(a), b);
        if (dot_between(chord, chord) > MIN_NORM_BAND && dot_between(sum, sum) > MIN_NORM_BAND) {
            return true;
        }
    }
    know_exactly(support);
    const struct vec3_i64 a = exact_point(support, 0), b = exact_point(support, 1);
    return i128_sign(support->against) < 0 && i128_sign(vec3_i64_dot(b, support->chord)) > 0 &&
           !is_zero_i128(vec3_i64_cross(a, b));
}

/// Sets the plane that the filter uses. Returns whether its side of zero was plain without the
/// exact plane.
static bool set_rough_normal(struct min_norm *support) {
    const struct vec3 a = support->point[0].unit_q30;
    const struct vec3_i64 b = between(a, support->point[1].unit_q30),
                          c = between(a, support->point[2].unit_q30);
    struct vec3_i64 n = {b.y * c.z - b.z * c.y, b.z * c.x - b.x * c.z, b.x * c.y - b.y * c.x};
    const int64_t height = (n.x >> 32) * a.x + (n.y >> 32) * a.y + (n.z >> 32) * a.z;
    const int side = sure_sign(height);
    support->side_known = side != 0;
    support->turned = side < 0;
    if (side == 0) {
        know_exactly(support);
    }
    if (support->turned) {
        n = (struct vec3_i64){-n.x, -n.y, -n.z};
    }
    support->rough_normal = n;
    return side != 0;
}

/// Three points hold it if the foot of the perpendicular from zero to their plane is strictly
/// inside the triangle and not zero: for unit vectors, if the triangle is acute. Exactly: the
/// foot's barycentric weights are n.(b x c), n.(c x a), n.(a x b), each below 2^247.
static bool hold_three(struct min_norm *support) {
    if (support->unit) {
        const struct vec3 a = support->point[0].unit_q30, b = support->point[1].unit_q30,
                          c = support->point[2].unit_q30;
        const int at_a = sure_angle(a, b, c), at_b = sure_angle(b, c, a),
                  at_c = sure_angle(c, a, b);
        if (at_a < 0 || at_b < 0 || at_c < 0) {
            return false;
        }
        if (set_rough_normal(support) && at_a > 0 && at_b > 0 && at_c > 0) {
            return true;
        }
    }
    know_exactly(support);
    const struct vec3_i64 a = exact_point(support, 0), b = exact_point(support, 1),
                          c = exact_point(support, 2);
    const struct vec3_i128 bc = vec3_i64_cross(b, c), ca = vec3_i64_cross(c, a),
                           ab = vec3_i64_cross(a, b);
    const struct vec3_i128 normal = add_i128(add_i128(bc, ca), ab); // (b - a) x (c - a)
    if (dot_sign_i128(normal, bc) <= 0 || dot_sign_i128(normal, ca) <= 0 ||
        dot_sign_i128(normal, ab) <= 0) {
        return false;
    }
    // The foot is not zero: strictly positive weights and a plane through zero would put zero
    // inside.
    return i256_sign(vec3_i128_dot(normal, a)) != 0;
}

/// Tries the subset of the `count` points that `mask` names.
static bool hold_subset(struct min_norm *support, const struct min_norm_point *points,
                        unsigned count, unsigned mask) {
    support->count = 0;
    support->exact_known = support->side_known = false;
    for (unsigned i = 0; i < count; i++) {
        if ((mask >> i & 1U) != 0U) {
            support->point[support->count++] = points[i];
        }
    }
    bool held = support->count == 1U   ? hold_one(support)
                : support->count == 2U ? hold_two(support)
                                       : hold_three(support);
    for (unsigned i = 0; held && i < count; i++) {
        held = (mask >> i & 1U) != 0U || !min_norm_violated_by(support, &points[i]);
    }
    return held;
}

void min_norm_start(struct min_norm *support, const struct min_norm_point *point, bool unit) {
    support->unit = unit;
    support->count = 1;
    support->point[0] = *point;
    support->exact_known = support->side_known = false;
}

bool min_norm_hold(struct min_norm *support, const struct min_norm_point *points, unsigned count,
                   bool unit) {
    support->unit = unit;
    return hold_subset(support, points, count, (1U << count) - 1U);
}

/// The subsets that can hold the nearest point once a new point has entered, which is in every one
/// of them, since it violates the old support: which of the old points are beside it. Pairs first:
/// they are the cheapest to refuse. Bit k is old point k.
static const uint8_t beside[] = {1, 2, 4, 3, 5, 6, 0};

/// For unit vectors, in 64 bits: 1 if the pair surely holds, -1 if surely not, 0: can't tell.
static int pair_holds(const struct min_norm *old, unsigned k, struct vec3 x) {
    const struct vec3 a = old->point[k].unit_q30;
    const struct vec3_i64 chord = between(a, x), sum = between(vec3_neg(a), x);
    int verdict =
        dot_between(chord, chord) > MIN_NORM_BAND && dot_between(sum, sum) > MIN_NORM_BAND;
    for (unsigned i = 0; i < old->count; i++) {
        if (i != k) {
            const struct vec3 y = old->point[i].unit_q30;
            const int outside = sure_sign(dot_between(between(a, y), between(x, y)));
            if (outside > 0) {
                return -1;
            }
            verdict = outside < 0 ? verdict : 0;
        }
    }
    return verdict;
}

/// Enters by the 64-bit filters alone, if they can tell: the common case. Only pairs are taken this
/// way; *mask gets the first subset that they leave open.
static bool enter_pair(struct min_norm *support, const struct min_norm_point *point,
                       unsigned *first_open) {
    for (unsigned k = 0; k < support->count; k++) {
        const int verdict = pair_holds(support, k, point->unit_q30);
        if (verdict == 0) {
            *first_open = k;
            return false;
        }
        if (verdict > 0) {
            support->point[0] = support->point[k];
            support->point[1] = *point;
            support->count = 2;
            support->exact_known = support->side_known = false;
            return true;
        }
    }
    *first_open = 3; // all pairs are out
    return false;
}

bool min_norm_enter(struct min_norm *support, const struct min_norm_point *point) {
    unsigned open = 0;
    if (support->unit && enter_pair(support, point, &open)) {
        return true;
    }
    struct min_norm_point points[4];
    const unsigned old = support->count, count = old + 1U;
    for (unsigned i = 0; i < old; i++) {
        points[i] = support->point[i];
    }
    points[old] = *point;
    struct min_norm candidate = {.unit = support->unit};
    for (unsigned i = open; i < sizeof beside; i++) {
        if (beside[i] < (1U << old) &&
            hold_subset(&candidate, points, count, beside[i] | (1U << old))) {
            *support = candidate;
            return true;
        }
    }
    return false;
}

// ---------------------------------------------------------------- its direction

struct vec3_i256 {
    struct i256 x, y, z;
};

static unsigned largest(unsigned a, unsigned b, unsigned c) {
    const unsigned ab = a > b ? a : b;
    return ab > c ? ab : c;
}

/// Scaled by one power of two so that the largest component has 61 bits.
static struct vec3_i64 scale_to_i64(struct vec3_i256 a) {
    const unsigned bits = largest(i256_bit_length(a.x), i256_bit_length(a.y), i256_bit_length(a.z));
    const unsigned shift = bits <= 61U ? 0U : bits - 61U;
    return (struct vec3_i64){i256_shift_right_i64(a.x, shift), i256_shift_right_i64(a.y, shift),
                             i256_shift_right_i64(a.z, shift)};
}

/// a * at_b - b * at_a, one component: the nearest point of the chord, times chord . chord.
static struct i256 blend(int64_t a, struct i128 at_b, int64_t b, struct i128 at_a) {
    return i256_sub(i256_mul(i128_from_i64(a), at_b), i256_mul(i128_from_i64(b), at_a));
}

static struct vec3_i64 chord_direction(struct min_norm *support) {
    if (!support->exact_known) {
        know_points(support);
    }
    const struct vec3_i64 a = exact_point(support, 0), b = exact_point(support, 1);
    const struct vec3_i64 sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    const int64_t large = (int64_t)1 << 50;
    if (support->unit && (sum.x > large || sum.x < -large || sum.y > large || sum.y < -large ||
                          sum.z > large || sum.z < -large)) {
        return sum; // of unit vectors, good to 2^-61 of its length
    }
    know_exactly(support);
    const struct i128 at_b = vec3_i64_dot(b, support->chord), at_a = support->against;
    return scale_to_i64((struct vec3_i256){blend(a.x, at_b, b.x, at_a), blend(a.y, at_b, b.y, at_a),
                                           blend(a.z, at_b, b.z, at_a)});
}

static struct vec3_i64 plane_direction(struct min_norm *support) {
    know_exactly(support);
    const struct vec3_i128 n = support->normal;
    return scale_to_i64(
        (struct vec3_i256){i256_from_i128(n.x), i256_from_i128(n.y), i256_from_i128(n.z)});
}

struct vec3_i64 min_norm_direction(struct min_norm *support) {
    switch (support->count) {
    case 1:
        know_exactly(support);
        return exact_point(support, 0);
    case 2:
        return chord_direction(support);
    default:
        return plane_direction(support);
    }
}
