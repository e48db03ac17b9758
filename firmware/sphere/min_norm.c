#include "sphere/min_norm.h"

#include "fixed/not_inline.h"

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

#define ONE_Q60 ((int64_t)1 << 60)

/// -1, 1, or 0 if the value is inside the band of error.
static inline int sure_sign(int64_t value) {
    return value > MIN_NORM_BAND ? 1 : (value < -MIN_NORM_BAND ? -1 : 0);
}

/// Half the squared distance of two units, Q60: at most 2, off by less than 2^33.
INLINE_BUT_ON_M0PLUS int64_t apart(struct vec3 a, struct vec3 b) {
    return ONE_Q60 - vec3_dot_unit(a, b);
}

/// Not (nearly) the same or opposite, so that the nearest point of the chord is inside it and not
/// zero.
static inline bool is_sure_chord(int64_t half_square) {
    return half_square > MIN_NORM_BAND && half_square < 2 * ONE_Q60 - MIN_NORM_BAND;
}

/// Is a triangle's corner acute (1) or obtuse (-1)? By the law of cosines, from half the squares of
/// the two sides that meet there and of the opposite one.
static inline int sure_corner(int64_t beside, int64_t other, int64_t opposite) {
    return sure_sign(beside + other - opposite);
}

/// The filter of two points so far apart; one is a chord shrunk to it.
static void set_chord_filter(struct min_norm *support, int64_t half_square) {
    const struct vec3 a = support->point[0].unit_q30,
                      b = support->point[support->count - 1U].unit_q30;
    support->filter = (struct min_norm_filter){.normal = vec3((int32_t)(((int64_t)a.x + b.x) >> 1),
                                                              (int32_t)(((int64_t)a.y + b.y) >> 1),
                                                              (int32_t)(((int64_t)a.z + b.z) >> 1)),
                                               .offset = ONE_Q60 - half_square / 2};
}

static void turn_filter(struct min_norm_filter *filter) {
    filter->normal = vec3_neg(filter->normal);
    filter->offset = -filter->offset;
}

/// The filter of three points. Returns the side to which the cross product of the edges points:
/// away from zero (1), or toward it (-1; the filter's normal is turned), or 0: can't tell.
INLINE_BUT_ON_M0PLUS int set_plane_filter(struct min_norm_filter *filter, struct vec3 a,
                                          struct vec3 b, struct vec3 c) {
    const struct vec3_i64 ab = vec3_i64_sub(vec3_widen(b), vec3_widen(a)),
                          ac = vec3_i64_sub(vec3_widen(c), vec3_widen(a));
    // At most 2^62, since no edge is longer than 2^31.
    filter->normal = vec3((int32_t)((ab.y * ac.z - ab.z * ac.y) >> 32),
                          (int32_t)((ab.z * ac.x - ab.x * ac.z) >> 32),
                          (int32_t)((ab.x * ac.y - ab.y * ac.x) >> 32));
    filter->offset = vec3_dot_unit(filter->normal, a);
    const int side = sure_sign(filter->offset);
    if (side < 0) {
        turn_filter(filter);
    }
    return side;
}

// ---------------------------------------------------------------- exact tests

static struct vec3_i64 exact_point(bool unit, const struct min_norm_point *point) {
    return unit ? vec3_normalise_q61(point->given) : point->exact;
}

static void know_points(struct min_norm *support) {
    for (unsigned i = 0; i < support->count; i++) {
        support->exact[i] = exact_point(support->unit, &support->point[i]);
    }
}

/// Works out what the exact tests of the support need.
static void know_exactly(struct min_norm *support) {
    if (support->exact_known) {
        return;
    }
    support->exact_known = true;
    know_points(support);
    const struct vec3_i64 a = support->exact[0];
    if (support->count == 1U) {
        support->against = vec3_i64_dot(a, a);
    } else if (support->count == 2U) {
        support->chord = vec3_i64_sub(support->exact[1], a);
        support->chord2 = vec3_i64_dot(support->chord, support->chord);
        support->against = vec3_i64_dot(a, support->chord);
    } else {
        support->normal =
            vec3_i64_cross(vec3_i64_sub(support->exact[1], a), vec3_i64_sub(support->exact[2], a));
        support->turned = support->side_known ? support->turned
                                              : i256_sign(vec3_i128_dot(support->normal, a)) < 0;
        if (support->turned) {
            support->normal = negate_i128(support->normal);
        }
    }
}

static bool violated_exactly(struct min_norm *support, struct vec3_i64 point) {
    know_exactly(support);
    const struct vec3_i64 a = support->exact[0], from_a = vec3_i64_sub(point, a);
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
        const int64_t depth = min_norm_depth(&support->filter, point->unit_q30);
        if (depth > MIN_NORM_BAND || depth < -MIN_NORM_BAND) {
            return depth < 0;
        }
    }
    return violated_exactly(support, exact_point(support->unit, point));
}

// ---------------------------------------------------------------- which subset holds the nearest
// point

static bool hold_one(struct min_norm *support) {
    if (support->unit) {
        set_chord_filter(support, 0);
        return true;
    }
    know_exactly(support);
    return i128_sign(support->against) != 0;
}

/// Two points hold it if the nearest point of their chord is strictly between them and not zero.
static bool hold_two(struct min_norm *support) {
    if (support->unit) {
        const int64_t half_square = apart(support->point[0].unit_q30, support->point[1].unit_q30);
        set_chord_filter(support, half_square);
        if (is_sure_chord(half_square)) {
            return true;
        }
    }
    know_exactly(support);
    const struct vec3_i64 a = support->exact[0], b = support->exact[1];
    return i128_sign(support->against) < 0 && i128_sign(vec3_i64_dot(b, support->chord)) > 0 &&
           !is_zero_i128(vec3_i64_cross(a, b));
}

/// For unit vectors: 1 if the three points surely hold it, -1 if surely not, 0: can't tell. Sets
/// the filter.
static int holds_three_surely(struct min_norm *support) {
    const struct vec3 a = support->point[0].unit_q30, b = support->point[1].unit_q30,
                      c = support->point[2].unit_q30;
    const int64_t ab = apart(a, b), bc = apart(b, c), ca = apart(c, a);
    const int at_a = sure_corner(ab, ca, bc), at_b = sure_corner(ab, bc, ca),
              at_c = sure_corner(bc, ca, ab);
    if (at_a < 0 || at_b < 0 || at_c < 0) {
        return -1;
    }
    const int side = set_plane_filter(&support->filter, a, b, c);
    support->side_known = side != 0;
    support->turned = side < 0;
    if (side == 0) {
        know_exactly(support);
        if (support->turned) {
            turn_filter(&support->filter);
        }
    }
    return side != 0 && at_a > 0 && at_b > 0 && at_c > 0;
}

/// Three points hold it if the foot of the perpendicular from zero to their plane is strictly
/// inside the triangle and not zero: for unit vectors, if the triangle is acute. Exactly: the
/// foot's barycentric weights are n.(b x c), n.(c x a), n.(a x b), each below 2^247.
static bool hold_three(struct min_norm *support) {
    const int surely = support->unit ? holds_three_surely(support) : 0;
    if (surely != 0) {
        return surely > 0;
    }
    know_exactly(support);
    const struct vec3_i64 a = support->exact[0], b = support->exact[1], c = support->exact[2];
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
    if (unit) {
        set_chord_filter(support, 0);
    }
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

/// Old point k and the new one, so far apart, outside of the ball on whose chord no other point is.
INLINE_BUT_ON_M0PLUS bool take_with_one(struct min_norm *support, unsigned k, int64_t half_square,
                                        const struct min_norm_point *point) {
    if (!is_sure_chord(half_square)) {
        return false;
    }
    if (k != 0U) {
        support->point[0] = support->point[k];
    }
    support->point[1] = *point;
    support->count = 2;
    support->exact_known = support->side_known = false;
    set_chord_filter(support, half_square);
    return true;
}

/// Old points i and j and the new one, a surely acute triangle, if the third old point (of three)
/// is surely on the far side of their plane.
INLINE_BUT_ON_M0PLUS bool take_with_two(struct min_norm *support, unsigned i, unsigned j,
                                        const struct min_norm_point *point) {
    struct min_norm_filter filter;
    const int side = set_plane_filter(&filter, support->point[i].unit_q30,
                                      support->point[j].unit_q30, point->unit_q30);
    if (side == 0 ||
        (support->count == 3U &&
         min_norm_depth(&filter, support->point[3U - i - j].unit_q30) <= MIN_NORM_BAND)) {
        return false;
    }
    if (i != 0U) {
        support->point[0] = support->point[i];
    }
    if (j != 1U) {
        support->point[1] = support->point[j];
    }
    support->point[2] = *point;
    support->count = 3;
    support->exact_known = false;
    support->side_known = true;
    support->turned = side < 0;
    support->filter = filter;
    return true;
}

/// Three points are held by two of them if the third sees their chord at an obtuse angle, or else
/// by all.
static bool enter_two(struct min_norm *support, const struct min_norm_point *point) {
    const struct vec3 a = support->point[0].unit_q30, b = support->point[1].unit_q30,
                      x = point->unit_q30;
    const int64_t ab = apart(a, b), ax = apart(a, x), bx = apart(b, x);
    const int at_a = sure_corner(ab, ax, bx), at_b = sure_corner(ab, bx, ax);
    if (at_a < 0 || at_b < 0) {
        return at_a < 0 ? take_with_one(support, 1, bx, point)
                        : take_with_one(support, 0, ax, point);
    }
    return at_a > 0 && at_b > 0 && sure_corner(ax, bx, ab) > 0 &&
           take_with_two(support, 0, 1, point);
}

/// Four: by two if both others see their chord at an obtuse angle; else by three.
static bool enter_three(struct min_norm *support, const struct min_norm_point *point) {
    const struct vec3 a = support->point[0].unit_q30, b = support->point[1].unit_q30,
                      c = support->point[2].unit_q30, x = point->unit_q30;
    const int64_t to[3] = {apart(a, x), apart(b, x), apart(c, x)};
    const int64_t side[3] = {apart(b, c), apart(c, a), apart(a, b)}; // opposite to each
    int at[3][3]; // the corner at old point i of its triangle with old point j and the new one
    for (unsigned i = 0; i < 3U; i++) {
        const unsigned j = (i + 1U) % 3U, third = (i + 2U) % 3U;
        at[i][j] = sure_corner(side[third], to[i], to[j]);
        at[j][i] = sure_corner(side[third], to[j], to[i]);
    }
    for (unsigned k = 0; k < 3U; k++) {
        if (at[(k + 1U) % 3U][k] < 0 && at[(k + 2U) % 3U][k] < 0) {
            return take_with_one(support, k, to[k], point);
        }
    }
    for (unsigned third = 3; third != 0U; third--) {
        const unsigned i = third == 1U ? 1U : 0U, j = third == 3U ? 1U : 2U;
        if (at[i][j] > 0 && at[j][i] > 0 && sure_corner(to[i], to[j], side[third - 1U]) > 0 &&
            take_with_two(support, i, j, point)) {
            return true;
        }
    }
    return false;
}

/// Enters by the 64-bit filters alone. Of the subsets only one can hold the nearest point, so the
/// first that surely does is it. False: none does surely, and the support is left.
static bool enter_surely(struct min_norm *support, const struct min_norm_point *point) {
    switch (support->count) {
    case 1:
        return take_with_one(support, 0, apart(support->point[0].unit_q30, point->unit_q30), point);
    case 2:
        return enter_two(support, point);
    default:
        return enter_three(support, point);
    }
}

bool min_norm_enter(struct min_norm *support, const struct min_norm_point *point) {
    if (support->unit && enter_surely(support, point)) {
        return true;
    }
    struct min_norm_point points[4];
    const unsigned old = support->count, count = old + 1U;
    for (unsigned i = 0; i < old; i++) {
        points[i] = support->point[i];
    }
    points[old] = *point;
    struct min_norm candidate = {.unit = support->unit};
    for (unsigned i = 0; i < sizeof beside; i++) {
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
    const struct vec3_i64 a = support->exact[0], b = support->exact[1];
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
        return support->exact[0];
    case 2:
        return chord_direction(support);
    default:
        return plane_direction(support);
    }
}

// ---------------------------------------------------------------- the same as a unit vector

/// Squared length less one. False: the length isn't within 2^-30 of one.
INLINE_BUT_ON_M0PLUS bool excess_of(struct vec3 a, int64_t *excess) {
    const uint64_t least = (uint64_t)ONE_Q60 - (UINT64_C(1) << 31);
    const uint64_t above = vec3_norm2(a) - least; // of any vector: below that it wraps
    if (above >> 32 != 0U) {
        return false;
    }
    *excess = (int64_t)above - ((int64_t)1 << 31);
    return true;
}

/// Bound of what the two functions below leave out of a component, and of what the directions above
/// round beside them: 42 units for three points (24 of them cut from the products), 10 for two.
#define DIRECTION_ERROR 64U

/// a (1 - excess / 2) + b (1 - excess / 2), Q2.61: what rounding did to the lengths is made good to
/// the first order. False: the given vectors are no unit vectors.
static bool direction_of_two(const struct min_norm *support, struct vec3_i64 *direction) {
    const struct vec3 a = support->point[0].given, b = support->point[1].given;
    int64_t ea, eb;
    if (!excess_of(a, &ea) || !excess_of(b, &eb)) {
        return false;
    }
    const int64_t one = (int64_t)1 << 31;
    *direction = (struct vec3_i64){((int64_t)a.x + b.x) * one - ((a.x * ea + b.x * eb) >> 30),
                                   ((int64_t)a.y + b.y) * one - ((a.y * ea + b.y * eb) >> 30),
                                   ((int64_t)a.z + b.z) * one - ((a.z * ea + b.z * eb) >> 30)};
    return true;
}

/// a x b + b x c + c x a, Q60, each product less half the excesses of its two factors.
static bool direction_of_three(const struct min_norm *support, struct vec3_i64 *direction) {
    const struct vec3 a = support->point[0].given, b = support->point[1].given,
                      c = support->point[2].given;
    int64_t ea, eb, ec;
    if (!excess_of(a, &ea) || !excess_of(b, &eb) || !excess_of(c, &ec)) {
        return false;
    }
    const struct vec3_i64 ab = vec3_cross(a, b), bc = vec3_cross(b, c), ca = vec3_cross(c, a);
    const int64_t eab = ea + eb, ebc = eb + ec, eca = ec + ea;
    const struct vec3_i64 n = {
        ab.x + bc.x + ca.x - (((ab.x >> 32) * eab + (bc.x >> 32) * ebc + (ca.x >> 32) * eca) >> 29),
        ab.y + bc.y + ca.y - (((ab.y >> 32) * eab + (bc.y >> 32) * ebc + (ca.y >> 32) * eca) >> 29),
        ab.z + bc.z + ca.z -
            (((ab.z >> 32) * eab + (bc.z >> 32) * ebc + (ca.z >> 32) * eca) >> 29)};
    *direction = support->turned ? (struct vec3_i64){-n.x, -n.y, -n.z} : n;
    return true;
}

struct vec3 min_norm_axis(struct min_norm *support) {
    struct vec3_i64 direction;
    struct vec3 axis_q30;
    const bool known = support->unit && support->count != 1U &&
                       (support->count == 2U ? direction_of_two(support, &direction)
                                             : direction_of_three(support, &direction));
    if (known && vec3_i64_normalise_within(direction, DIRECTION_ERROR, &axis_q30)) {
        return axis_q30;
    }
    return vec3_i64_normalise(min_norm_direction(support));
}
