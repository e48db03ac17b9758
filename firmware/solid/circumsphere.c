#include "solid/circumsphere.h"

#include "fixed/root.h"
#include "solid/side.h"

static struct i256 times(struct i256 a, struct i128 b) {
    return i256_product(a, i256_from_i128(b));
}

static struct i256 three(struct i256 a, struct i256 b, struct i256 c) {
    return i256_add(i256_add(a, b), c);
}

/// a . b for wide vectors whose product fits.
static struct i256 dot(const struct i256 a[3], struct vec3_i128 b) {
    return three(times(a[0], b.x), times(a[1], b.y), times(a[2], b.z));
}

static struct i128 squared(struct vec3_i64 a) {
    return vec3_i64_dot(a, a);
}

/// For the triangle 0 u v: (|u|^2 v - |v|^2 u) x (u x v), over 2 |u x v|^2, points from 0 to the
/// centre.
static bool through_three(struct vec3_i64 u, struct vec3_i64 v, struct circumsphere *out) {
    const struct vec3_i128 n = vec3_i64_cross(u, v);
    const struct i256 area = three(i256_mul(n.x, n.x), i256_mul(n.y, n.y), i256_mul(n.z, n.z));
    const struct i128 uu = squared(u), vv = squared(v);
    const int64_t us[3] = {u.x, u.y, u.z}, vs[3] = {v.x, v.y, v.z};
    const struct i128 ns[3] = {n.x, n.y, n.z};
    struct i256 w[3];
    for (unsigned i = 0; i < 3U; i++) {
        w[i] = i256_sub(i256_mul(uu, i128_from_i64(vs[i])), i256_mul(vv, i128_from_i64(us[i])));
    }
    for (unsigned i = 0; i < 3U; i++) {
        const unsigned j = (i + 1U) % 3U, k = (i + 2U) % 3U;
        out->numerator[i] = i256_sub(times(w[j], ns[k]), times(w[k], ns[j]));
    }
    out->denominator = i256_add(area, area);
    return i256_sign(area) != 0;
}

/// |u|^2 (v x w) + |v|^2 (w x u) + |w|^2 (u x v), over 2 det(u, v, w).
static bool through_four(struct vec3_i64 u, struct vec3_i64 v, struct vec3_i64 w,
                         struct circumsphere *out) {
    const struct vec3_i128 vw = vec3_i64_cross(v, w), wu = vec3_i64_cross(w, u),
                           uv = vec3_i64_cross(u, v);
    const struct i128 uu = squared(u), vv = squared(v), ww = squared(w);
    const struct i256 det = vec3_i128_dot(vw, u);
    const bool negative = i256_sign(det) < 0;
    out->numerator[0] = three(i256_mul(vw.x, uu), i256_mul(wu.x, vv), i256_mul(uv.x, ww));
    out->numerator[1] = three(i256_mul(vw.y, uu), i256_mul(wu.y, vv), i256_mul(uv.y, ww));
    out->numerator[2] = three(i256_mul(vw.z, uu), i256_mul(wu.z, vv), i256_mul(uv.z, ww));
    for (unsigned i = 0; i < 3U && negative; i++) {
        out->numerator[i] = i256_neg(out->numerator[i]);
    }
    out->denominator = i256_add(det, det);
    if (negative) {
        out->denominator = i256_neg(out->denominator);
    }
    return i256_sign(det) != 0;
}

bool circumsphere_through(const struct vec3 *points, uint8_t count, struct circumsphere *out) {
    *out = (struct circumsphere){.count = count, .origin = points[0]};
    for (unsigned i = 0; i < count; i++) {
        out->point[i] = points[i];
    }
    out->denominator = i256_from_i128(i128_from_i64(2));
    const struct vec3_i64 u = side_between(points[0], points[count > 1U ? 1 : 0]);
    if (count <= 2U) {
        out->numerator[0] = i256_from_i128(i128_from_i64(u.x));
        out->numerator[1] = i256_from_i128(i128_from_i64(u.y));
        out->numerator[2] = i256_from_i128(i128_from_i64(u.z));
        return count == 1U || (u.x | u.y | u.z) != 0;
    }
    const struct vec3_i64 v = side_between(points[0], points[2]);
    return count == 3U ? through_three(u, v, out)
                       : through_four(u, v, side_between(points[0], points[3]), out);
}

/// (center - p) * denominator.
static void from_point(const struct circumsphere *s, struct vec3 p, struct i256 out[3]) {
    const struct vec3_i64 d = side_between(p, s->origin);
    out[0] = i256_add(times(s->denominator, i128_from_i64(d.x)), s->numerator[0]);
    out[1] = i256_add(times(s->denominator, i128_from_i64(d.y)), s->numerator[1]);
    out[2] = i256_add(times(s->denominator, i128_from_i64(d.z)), s->numerator[2]);
}

bool circumsphere_is_smallest(const struct circumsphere *sphere) {
    const struct vec3 *const p = sphere->point;
    if (sphere->count <= 2U) {
        return true;
    }
    if (sphere->count == 3U) { // no angle above 90 degrees
        for (unsigned i = 0; i < 3U; i++) {
            const struct vec3 a = p[i], b = p[(i + 1U) % 3U], c = p[(i + 2U) % 3U];
            if (i128_sign(vec3_i64_dot(side_between(a, b), side_between(a, c))) < 0) {
                return false;
            }
        }
        return true;
    }
    for (unsigned i = 0; i < 4U; i++) { // on the same side of each face as the corner beyond it
        const struct vec3 a = p[i], b = p[(i + 1U) % 4U], c = p[(i + 2U) % 4U],
                          d = p[(i + 3U) % 4U];
        const struct vec3_i128 n = vec3_i64_cross(side_between(b, c), side_between(b, d));
        struct i256 center[3];
        from_point(sphere, b, center);
        const int corner_side = i256_sign(vec3_i128_dot(n, side_between(b, a)));
        if (i256_sign(dot(center, n)) * corner_side < 0) {
            return false;
        }
    }
    return true;
}

int circumsphere_side(const struct circumsphere *sphere, struct vec3 p) {
    // |p - c|^2 - |o - c|^2, with d = p - o and c = o + N / D: (|d|^2 D - 2 d . N) / D.
    const struct vec3_i64 d = side_between(sphere->origin, p);
    const struct vec3_i128 twice = {i128_from_i64(2 * d.x), i128_from_i64(2 * d.y),
                                    i128_from_i64(2 * d.z)};
    return i256_sign(
        i256_sub(times(sphere->denominator, squared(d)), dot(sphere->numerator, twice)));
}

static struct i256 shifted_left(struct i256 a, unsigned shift) {
    struct i256 out = a;
    for (unsigned i = 4; i-- != 0U;) {
        const unsigned from = shift / 64U, bits = shift % 64U;
        const uint64_t high = i >= from ? a.word[i - from] : 0U;
        const uint64_t low = i >= from + 1U ? a.word[i - from - 1U] : 0U;
        out.word[i] = bits == 0U ? high : (high << bits) | (low >> (64U - bits));
    }
    return out;
}

static struct i256 halved(struct i256 a) {
    return (struct i256){{(a.word[0] >> 1) | (a.word[1] << 63),
                          (a.word[1] >> 1) | (a.word[2] << 63),
                          (a.word[2] >> 1) | (a.word[3] << 63), a.word[3] >> 1}};
}

/// numerator * 2^30 / denominator, rounded to nearest, halves away from zero; below 2^63 in size.
static int64_t quotient_q30(struct i256 numerator, struct i256 denominator) {
    const bool negative = i256_sign(numerator) < 0;
    // The half is added as numerator + denominator / 2: twice both keeps it whole.
    const struct i256 size = negative ? i256_neg(numerator) : numerator;
    struct i256 rest = i256_add(shifted_left(size, 31), denominator);
    const struct i256 divisor = i256_add(denominator, denominator);
    const unsigned length = i256_bit_length(rest), least = i256_bit_length(divisor);
    uint64_t quotient = 0;
    if (length >= least) { // digit by digit, in base 2
        struct i256 part = shifted_left(divisor, length - least);
        for (unsigned bit = length - least + 1U; bit-- != 0U;) {
            const struct i256 left = i256_sub(rest, part);
            quotient *= 2U;
            if ((left.word[3] >> 63) == 0U) {
                rest = left;
                quotient++;
            }
            part = halved(part);
        }
    }
    return negative ? -(int64_t)quotient : (int64_t)quotient;
}

struct vec3_i64 circumsphere_center_q30(const struct circumsphere *s) {
    const int64_t one = (int64_t)1 << 30;
    return (struct vec3_i64){s->origin.x * one + quotient_q30(s->numerator[0], s->denominator),
                             s->origin.y * one + quotient_q30(s->numerator[1], s->denominator),
                             s->origin.z * one + quotient_q30(s->numerator[2], s->denominator)};
}

uint64_t circumsphere_radius_q30(const struct circumsphere *sphere, struct vec3_i64 center_q30) {
    if (sphere->count == 1U) {
        return 0;
    }
    const int64_t one = (int64_t)1 << 30;
    const struct vec3 p = sphere->point[0];
    const struct vec3_i64 d =
        vec3_i64_sub((struct vec3_i64){p.x * one, p.y * one, p.z * one}, center_q30);
    const struct i128 square = squared(d);
    // The rounded centre is within 0.87 units of the true one: that point may be nearer by it than
    // the radius, another one farther. And the root is rounded down.
    return root_u128((struct u128){square.lo, (uint64_t)square.hi}) + 3U;
}
