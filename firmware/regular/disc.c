#include "regular/disc.h"

#include "fixed/trig_fine.h"
#include "regular/surd.h"

// ---------------------------------------------------------------- small pieces

/// A number of any sign: |value| and sign.
struct whole {
    int sign;
    struct huge size;
};

static struct whole whole_i128(struct i128 a) {
    struct whole to = {.sign = i128_sign(a)};
    const struct i128 size = to.sign < 0 ? i128_neg(a) : a;
    huge_from_u128(&to.size, (struct u128){size.lo, (uint64_t)size.hi});
    return to;
}

static struct whole times(const struct whole *a, const struct whole *b) {
    struct whole to = {.sign = a->sign * b->sign};
    huge_mul(&to.size, &a->size, &b->size);
    return to;
}

static struct whole less(const struct whole *a, const struct whole *b) {
    struct whole to;
    if (a->sign == -b->sign || a->sign == 0 || b->sign == 0) {
        to.sign = a->sign != 0 ? a->sign : -b->sign;
        huge_add(&to.size, &a->size, &b->size);
    } else {
        to.sign = a->sign * huge_difference(&to.size, &a->size, &b->size);
    }
    return to;
}

/// det(a, b, c) of vectors below 2^43: 132 bits.
static struct whole det(struct vec3_i64 a, struct vec3_i64 b, struct vec3_i64 c) {
    struct i256 value = vec3_i128_dot(vec3_i64_cross(a, b), c);
    struct whole to = {.sign = i256_sign(value)};
    value = to.sign < 0 ? i256_neg(value) : value;
    struct huge low, high;
    huge_from_u128(&low, (struct u128){value.word[0], value.word[1]});
    huge_from_u128(&high, (struct u128){value.word[2], value.word[3]});
    for (unsigned i = 0; i < 8U; i++) {
        huge_shift_left(&high, &high, 16);
    }
    huge_add(&to.size, &low, &high);
    return to;
}

static struct whole dot(struct vec3_i64 a, struct vec3_i64 b) {
    return whole_i128(vec3_i64_dot(a, b));
}

static void add(struct surd *surd, const struct whole *factor, const struct whole *radicand) {
    surd_add(surd, factor->sign, &factor->size, &radicand->size);
}

static struct whole one(void) {
    return whole_i128(i128_from_i64(1));
}

// ---------------------------------------------------------------- the cosine

/// cos^2 of a cap = (integer + root part) / (the same): all factors over whole numbers.
struct cosine {
    struct surd above, below;
};

/// Two: (1 + x) / 2 with x = X / root(A B): (A B + X root(A B)) / (2 A B).
static void cosine_of_two(const struct disc *disc, struct cosine *to) {
    const struct vec3_i64 a = disc->support[0], b = disc->support[1];
    const struct whole a2 = dot(a, a), b2 = dot(b, b), x = dot(a, b), unit = one();
    const struct whole both = times(&a2, &b2), two = whole_i128(i128_from_i64(2));
    const struct whole twice = times(&both, &two);
    add(&to->above, &both, &unit);
    add(&to->above, &x, &both);
    add(&to->below, &twice, &unit);
}

/// 2 (X Y - Z B) root(A C), of the pairs' dot products X (a b), Y (b c) and Z (c a).
static void add_pair(struct surd *to, const struct whole *x, const struct whole *y,
                     const struct whole *z, const struct whole *b2, const struct whole *ac) {
    const struct whole xy = times(x, y), zb = times(z, b2), two = whole_i128(i128_from_i64(2));
    const struct whole difference = less(&xy, &zb), factor = times(&difference, &two);
    add(to, &factor, ac);
}

/// Three: det(a, b, c)^2 / |a x b + b x c + c x a|^2 of the unit vectors, times A B C each.
static void cosine_of_three(const struct disc *disc, struct cosine *to) {
    const struct vec3_i64 a = disc->support[0], b = disc->support[1], c = disc->support[2];
    const struct whole a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c), unit = one();
    const struct whole x = dot(a, b), y = dot(b, c), z = dot(c, a);
    const struct whole ab = times(&a2, &b2), bc = times(&b2, &c2), ca = times(&c2, &a2);
    const struct whole volume = det(a, b, c), volume2 = times(&volume, &volume);
    add(&to->above, &volume2, &unit);
    const struct whole three = whole_i128(i128_from_i64(3));
    const struct whole abc = times(&ab, &c2);
    struct whole whole = times(&abc, &three);
    const struct whole *const dots[3] = {&x, &y, &z}, *const others[3] = {&c2, &a2, &b2};
    for (int i = 0; i < 3; i++) {
        const struct whole square = times(dots[i], dots[i]), part = times(&square, others[i]);
        whole = less(&whole, &part);
    }
    add(&to->below, &whole, &unit);
    add_pair(&to->below, &x, &y, &z, &b2, &ca);
    add_pair(&to->below, &y, &z, &x, &c2, &ab);
    add_pair(&to->below, &z, &x, &y, &a2, &bc);
}

static void cosine_of(const struct disc *disc, struct cosine *to) {
    const struct whole unit = one();
    to->above.count = 0;
    to->below.count = 0;
    if (disc->count == 1U) {
        add(&to->above, &unit, &unit);
        add(&to->below, &unit, &unit);
    } else if (disc->count == 2U) {
        cosine_of_two(disc, to);
    } else {
        cosine_of_three(disc, to);
    }
}

/// to += sign * a * b, term by term.
static void add_products(struct surd *to, int sign, const struct surd *a, const struct surd *b) {
    for (uint32_t i = 0; i < a->count; i++) {
        for (uint32_t j = 0; j < b->count; j++) {
            struct huge factor, radicand;
            huge_mul(&factor, &a->term[i].factor, &b->term[j].factor);
            huge_mul(&radicand, &a->term[i].radicand, &b->term[j].radicand);
            surd_add(to, sign * a->term[i].sign * b->term[j].sign, &factor, &radicand);
        }
    }
}

/// (1 + x) / 2 of both: the sign of X / root(A B) - Z / root(C D).
static int compare_twos(const struct disc *a, const struct disc *b) {
    const struct whole x = dot(a->support[0], a->support[1]);
    const struct whole z = dot(b->support[0], b->support[1]);
    struct surd surd = {.count = 0};
    const struct disc *const both[2] = {a, b};
    struct whole norms[2];
    for (int i = 0; i < 2; i++) {
        const struct whole p = dot(both[i]->support[0], both[i]->support[0]);
        const struct whole q = dot(both[i]->support[1], both[i]->support[1]);
        norms[i] = times(&p, &q);
    }
    surd_add(&surd, x.sign, &x.size, &norms[1].size);
    surd_add(&surd, -z.sign, &z.size, &norms[0].size);
    return surd_sign(&surd);
}

/// The same cap, turned or mirrored? Symmetric sets have many: the same norms and dot products in
/// some order. False tells nothing.
static bool congruent(const struct disc *a, const struct disc *b) {
    for (unsigned turn = 0; turn < 6U && a->count == b->count; turn++) {
        bool same = true;
        for (unsigned i = 0; i < a->count && same; i++) {
            for (unsigned j = i; j < a->count && same; j++) {
                const unsigned p = turn < 3U ? i + turn : 2U * a->count + turn - i;
                const unsigned q = turn < 3U ? j + turn : 2U * a->count + turn - j;
                same =
                    i128_cmp(vec3_i64_dot(a->support[i], a->support[j]),
                             vec3_i64_dot(b->support[p % a->count], b->support[q % a->count])) == 0;
            }
        }
        if (same) {
            return true;
        }
    }
    return false;
}

int disc_compare(const struct disc *a, const struct disc *b) {
    if (congruent(a, b)) {
        return 0;
    }
    if (a->count == 2U && b->count == 2U) {
        return compare_twos(a, b);
    }
    struct cosine of_a, of_b;
    cosine_of(a, &of_a);
    cosine_of(b, &of_b);
    // At most 2 * 4 + 1 terms, as two pairs are compared above.
    struct surd surd = {.count = 0};
    add_products(&surd, 1, &of_a.above, &of_b.below);
    add_products(&surd, -1, &of_b.above, &of_a.below);
    return surd_sign(&surd);
}

// ---------------------------------------------------------------- inside and outside

/// Sign of (c - a) . (c - b) = 1 - c.a - c.b + a.b of the unit vectors, times A B C.
static int corner(struct vec3_i64 a, struct vec3_i64 b, struct vec3_i64 c) {
    const struct whole a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c), unit = one();
    const struct whole ab = times(&a2, &b2), bc = times(&b2, &c2), ca = times(&c2, &a2);
    const struct whole all = times(&ab, &c2), x = dot(a, b), y = dot(b, c), z = dot(c, a);
    const struct whole xc = times(&x, &c2), ya = times(&y, &a2), zb = times(&z, &b2);
    struct surd surd = {.count = 0};
    add(&surd, &all, &unit);
    add(&surd, &xc, &ab);
    surd_add(&surd, -ya.sign, &ya.size, &bc.size);
    surd_add(&surd, -zb.sign, &zb.size, &ca.size);
    return surd_sign(&surd);
}

bool disc_is_held(const struct disc *disc) {
    const struct vec3_i64 *const s = disc->support;
    return corner(s[0], s[1], s[2]) >= 0 && corner(s[1], s[2], s[0]) >= 0 &&
           corner(s[2], s[0], s[1]) >= 0;
}

bool disc_excludes(const struct disc *disc, struct vec3_i64 d) {
    const struct vec3_i64 a = disc->support[0], b = disc->support[1], c = disc->support[2];
    if (disc->count == 1U) {
        // Anything but the point itself.
        const struct vec3_i128 across = vec3_i64_cross(a, d);
        return i128_sign(across.x) != 0 || i128_sign(across.y) != 0 || i128_sign(across.z) != 0 ||
               i128_sign(vec3_i64_dot(a, d)) < 0;
    }
    if (disc->count == 2U) {
        return corner(a, b, d) > 0;
    }
    // det(b - a, c - a, d - a) of the unit vectors, times root(A B C D); the cap's side is that of
    // the centre, from which the corners are on the side of det(a, b, c).
    const struct whole abc = det(a, b, c), bcd = det(b, c, d), cad = det(c, a, d),
                       abd = det(a, b, d);
    const struct whole a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c), d2 = dot(d, d);
    struct surd surd = {.count = 0};
    add(&surd, &bcd, &a2);
    add(&surd, &cad, &b2);
    add(&surd, &abd, &c2);
    surd_add(&surd, -abc.sign, &abc.size, &d2.size);
    return surd_sign(&surd) * abc.sign < 0;
}

// ---------------------------------------------------------------- the centre

static struct i128 component(struct vec3_i128 a, unsigned axis) {
    return axis == 0U ? a.x : (axis == 1U ? a.y : a.z);
}

static struct vec3_i128 widen(struct vec3_i64 a) {
    return (struct vec3_i128){i128_from_i64(a.x), i128_from_i64(a.y), i128_from_i64(a.z)};
}

/// One component as a sum of roots: a root(B) + b root(A), or (a x b) root(C) + (b x c) root(A) +
/// (c x a) root(B).
static void centre_terms(const struct disc *disc, unsigned axis, struct surd *to) {
    to->count = 0;
    for (unsigned i = 0; i < disc->count; i++) {
        const struct vec3_i64 next = disc->support[(i + 1U) % disc->count];
        const struct vec3_i64 last = disc->support[(i + disc->count - 1U) % disc->count];
        const struct vec3_i128 along =
            disc->count == 2U ? widen(disc->support[i]) : vec3_i64_cross(disc->support[i], next);
        const struct whole factor = whole_i128(component(along, axis)), norm2 = dot(last, last);
        add(to, &factor, &norm2);
    }
}

struct vec3_i64 disc_centre(const struct disc *disc) {
    if (disc->count == 1U) {
        return disc->support[0];
    }
    struct huge size[3];
    int sign[3];
    // Where the sum is small, as of a small cap, its roots need more digits.
    unsigned bits = 0;
    for (unsigned shift = 0; bits < 66U && shift <= 768U; shift += 128U) {
        bits = 0;
        for (unsigned axis = 0; axis < 3U; axis++) {
            struct surd surd;
            centre_terms(disc, axis, &surd);
            sign[axis] = surd_value(&surd, shift, &size[axis]);
            const unsigned length = huge_bit_length(&size[axis]);
            bits = length > bits ? length : bits;
        }
    }
    const unsigned drop = bits > 61U ? bits - 61U : 0U;
    int64_t to[3];
    for (unsigned axis = 0; axis < 3U; axis++) {
        to[axis] = sign[axis] * (int64_t)huge_shift_right_u64(&size[axis], drop);
    }
    // The supports are on one side of a great circle: the centre is on theirs.
    const struct vec3_i64 centre = {to[0], to[1], to[2]};
    const bool opposite = i128_sign(vec3_i64_dot(centre, disc->support[0])) < 0;
    return opposite ? (struct vec3_i64){-to[0], -to[1], -to[2]} : centre;
}

/// a times a power of two: the largest component gets 61 bits.
static struct vec3_i64 scale_up(struct vec3_i64 a) {
    const unsigned room = u64_leading_zeros(u64_abs(a.x) | u64_abs(a.y) | u64_abs(a.z));
    const int64_t by = (int64_t)1 << (room > 3U ? room - 3U : 0U);
    return (struct vec3_i64){a.x * by, a.y * by, a.z * by};
}

static int64_t over_length(int64_t value, uint64_t length) {
    uint64_t rest;
    const struct u128 scaled = u128_mul(u64_abs(value), UINT64_C(1) << 61);
    const int64_t quotient = (int64_t)u128_div_u64(scaled, length, &rest);
    return value < 0 ? -quotient : quotient;
}

struct vec3_i64 disc_unit_q61(struct vec3_i64 a) {
    a = scale_up(a);
    const uint64_t length = vec3_i64_length(a) + 1U; // rounded up: no component beyond 2^61
    return (struct vec3_i64){over_length(a.x, length), over_length(a.y, length),
                             over_length(a.z, length)};
}

uint64_t disc_line_angle(struct vec3_i64 a, struct vec3_i64 line) {
    const uint64_t angle = trig_fine_angle(scale_up(a), scale_up(line));
    const uint64_t half = 2U * TURN64_QUARTER;
    return angle > TURN64_QUARTER ? half - angle : angle;
}
