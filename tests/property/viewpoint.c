/// viewpoint_margins against brute force in rational numbers (GMP), and by moving the viewpoint by
/// a little less and a little more than its margins. ROUNDS=N, SEED=N.
#include "check.h"

#include "regular/viewpoint.h"

#include <gmp.h>
#include <stdio.h>
#include <stdlib.h>

#define COUNT_MAX 14U

static uint64_t seed = 20261123;
static unsigned long rounds = 400;

typedef mpq_t place[3]; ///< a position in rational numbers

static void place_init(place p) {
    for (int k = 0; k < 3; k++) {
        mpq_init(p[k]);
    }
}

static void place_clear(place p) {
    for (int k = 0; k < 3; k++) {
        mpq_clear(p[k]);
    }
}

static void place_set(place p, struct vec3 a) {
    mpq_set_si(p[0], a.x, 1);
    mpq_set_si(p[1], a.y, 1);
    mpq_set_si(p[2], a.z, 1);
}

static void subtract(place out, place a, place b) {
    for (int k = 0; k < 3; k++) {
        mpq_sub(out[k], a[k], b[k]);
    }
}

static void dot(mpq_t out, place a, place b) {
    mpq_t product;
    mpq_init(product);
    mpq_set_ui(out, 0, 1);
    for (int k = 0; k < 3; k++) {
        mpq_mul(product, a[k], b[k]);
        mpq_add(out, out, product);
    }
    mpq_clear(product);
}

static void cross(place out, place a, place b) {
    mpq_t product;
    mpq_init(product);
    for (int k = 0; k < 3; k++) {
        mpq_mul(out[k], a[(k + 1) % 3], b[(k + 2) % 3]);
        mpq_mul(product, a[(k + 2) % 3], b[(k + 1) % 3]);
        mpq_sub(out[k], out[k], product);
    }
    mpq_clear(product);
}

/// out = a + t * b.
static void along(place out, place a, place b, mpq_t t) {
    mpq_t product;
    mpq_init(product);
    for (int k = 0; k < 3; k++) {
        mpq_mul(product, b[k], t);
        mpq_add(out[k], a[k], product);
    }
    mpq_clear(product);
}

// ---------------------------------------------------------------- one line, one plane

/// (a - m) x (b - m): zero if a and b coincide as seen from m.
static void line_turn(place out, struct vec3 a, struct vec3 b, place m) {
    place p, q, to_a, to_b;
    place_init(p), place_init(q), place_init(to_a), place_init(to_b);
    place_set(p, a);
    place_set(q, b);
    subtract(to_a, p, m);
    subtract(to_b, q, m);
    cross(out, to_a, to_b);
    place_clear(p), place_clear(q), place_clear(to_a), place_clear(to_b);
}

/// normal = (b - a) x (c - a), value = normal . (m - a).
static void plane_value(place normal, mpq_t value, const struct vec3 *t, const uint32_t *i,
                        place m) {
    place a, b, c, ab, ac;
    place_init(a), place_init(b), place_init(c), place_init(ab), place_init(ac);
    place_set(a, t[i[0]]);
    place_set(b, t[i[1]]);
    place_set(c, t[i[2]]);
    subtract(ab, b, a);
    subtract(ac, c, a);
    cross(normal, ab, ac);
    subtract(ab, m, a);
    dot(value, normal, ab);
    place_clear(a), place_clear(b), place_clear(c), place_clear(ab), place_clear(ac);
}

/// The step from m to the nearest position on the line or plane of count targets. False: they are
/// on one line and there is no plane.
static bool step_to(place step, const struct vec3 *t, const uint32_t *i, uint32_t count, place m) {
    place a, b, d;
    mpq_t over, length2;
    place_init(a), place_init(b), place_init(d);
    mpq_inits(over, length2, NULL);
    if (count == 2U) { // a + d (m - a) . d / d . d - m
        place_set(a, t[i[0]]);
        place_set(b, t[i[1]]);
        subtract(d, b, a);
        subtract(b, m, a);
        dot(over, b, d);
        dot(length2, d, d);
        mpq_div(over, over, length2);
        along(step, a, d, over);
        subtract(step, step, m);
    } else {
        plane_value(d, over, t, i, m);
        dot(length2, d, d);
        if (mpq_sgn(length2) != 0) {
            mpq_div(over, over, length2);
            mpq_neg(over, over);
            place_set(a, vec3(0, 0, 0));
            along(step, a, d, over);
        }
    }
    const bool any = mpq_sgn(length2) != 0;
    mpq_clears(over, length2, NULL);
    place_clear(a), place_clear(b), place_clear(d);
    return any;
}

// ---------------------------------------------------------------- all of them

struct brute {
    uint64_t through, collinear;
    uint32_t target[3];
    bool any;
    mpq_t distance2;
};

static void brute_try(struct brute *best, const struct vec3 *t, const uint32_t *i, uint32_t count,
                      place m) {
    place step;
    mpq_t distance2;
    place_init(step);
    mpq_init(distance2);
    if (step_to(step, t, i, count, m)) {
        dot(distance2, step, step);
        best->through += mpq_sgn(distance2) == 0 ? 1U : 0U;
        if (!best->any || mpq_cmp(distance2, best->distance2) < 0) {
            best->any = true;
            mpq_set(best->distance2, distance2);
            for (uint32_t k = 0; k < count; k++) {
                best->target[k] = i[k];
            }
        }
    } else {
        best->collinear++;
    }
    mpq_clear(distance2);
    place_clear(step);
}

static void i256_to_mpz(mpz_t out, struct i256 a) {
    mpz_import(out, 4, -1, sizeof a.word[0], 0, 0, a.word); // none is negative
}

static void compare(const struct viewpoint_margin *got, const struct brute *wanted,
                    uint32_t count) {
    CHECK_EQ(got->through, wanted->through);
    CHECK_EQ(i128_sign(got->denominator) > 0, wanted->any);
    if (!wanted->any) {
        return;
    }
    mpq_t distance2;
    mpq_init(distance2);
    i256_to_mpz(mpq_numref(distance2), got->numerator);
    i256_to_mpz(mpq_denref(distance2), i256_from_i128(got->denominator));
    mpq_canonicalize(distance2);
    CHECK(mpq_equal(distance2, wanted->distance2));
    for (uint32_t k = 0; k < count; k++) {
        CHECK_EQ(got->target[k], wanted->target[k]);
    }
    mpq_clear(distance2);
}

/// No line or plane through the moved viewpoint, and every target triple turns as before.
static bool same_view(const struct vec3 *t, uint32_t count, place before, place now) {
    place turn;
    mpq_t was, is;
    place_init(turn);
    mpq_inits(was, is, NULL);
    bool same = true;
    for (uint32_t i = 0; i < count && same; i++) {
        for (uint32_t j = i + 1U; j < count && same; j++) {
            line_turn(turn, t[i], t[j], now);
            same = mpq_sgn(turn[0]) != 0 || mpq_sgn(turn[1]) != 0 || mpq_sgn(turn[2]) != 0;
            for (uint32_t k = j + 1U; k < count && same; k++) {
                const uint32_t triple[3] = {i, j, k};
                plane_value(turn, was, t, triple, before);
                plane_value(turn, is, t, triple, now);
                same = mpq_sgn(was) == mpq_sgn(is);
            }
        }
    }
    mpq_clears(was, is, NULL);
    place_clear(turn);
    return same;
}

/// Moves the viewpoint toward the nearest line or plane by 1 - 10^-9 and 1 + 10^-9 of the way: only
/// the second step changes what is seen.
static void move(const struct vec3 *t, uint32_t count, place m,
                 const struct viewpoint_margin *margin, uint32_t of) {
    place step, moved, turn, turn_now;
    mpq_t part, was, is;
    place_init(step), place_init(moved), place_init(turn), place_init(turn_now);
    mpq_inits(part, was, is, NULL);
    step_to(step, t, margin->target, of, m);
    mpq_set_ui(part, 999999999, 1000000000);
    along(moved, m, step, part);
    if (of == 3U) {
        CHECK(same_view(t, count, m, moved));
        plane_value(turn, was, t, margin->target, m);
    } else {
        line_turn(turn, t[margin->target[0]], t[margin->target[1]], m);
        line_turn(turn_now, t[margin->target[0]], t[margin->target[1]], moved);
        dot(is, turn, turn_now);
        CHECK(mpq_sgn(is) > 0);
    }
    mpq_set_ui(part, 1000000001, 1000000000);
    along(moved, m, step, part);
    if (of == 3U) {
        plane_value(turn, is, t, margin->target, moved);
        CHECK(mpq_sgn(was) * mpq_sgn(is) < 0);
    } else {
        line_turn(turn_now, t[margin->target[0]], t[margin->target[1]], moved);
        dot(is, turn, turn_now);
        CHECK(mpq_sgn(is) < 0);
    }
    mpq_clears(part, was, is, NULL);
    place_clear(step), place_clear(moved), place_clear(turn), place_clear(turn_now);
}

/// Moves the viewpoint anywhere by a little less than the margin: nothing changes.
static void move_anywhere(const struct vec3 *t, uint32_t count, place m, mpq_t distance2) {
    place step, moved;
    mpq_t length2, part, wanted;
    place_init(step), place_init(moved);
    mpq_inits(length2, part, wanted, NULL);
    for (int i = 0; i < 4; i++) {
        do {
            int32_t c[3];
            for (int k = 0; k < 3; k++) {
                c[k] = (int32_t)(check_random(&seed) % 2001U) - 1000;
            }
            place_set(step, vec3(c[0], c[1], c[2]));
            dot(length2, step, step);
        } while (mpq_sgn(length2) == 0);
        // The longest part, to 10^-6, whose step is shorter than the margin.
        mpq_div(wanted, distance2, length2);
        const double root = mpq_get_d(wanted);
        double scale = 1;
        while (scale * scale > root) {
            scale /= 2;
        }
        while (4 * scale * scale < root) {
            scale *= 2;
        }
        for (double by = scale / 2; by > scale * 1e-7; by /= 2) {
            scale += (scale + by) * (scale + by) < root * (1 - 1e-12) ? by : 0;
        }
        mpq_set_d(part, scale);
        along(moved, m, step, part);
        CHECK(same_view(t, count, m, moved));
    }
    mpq_clears(length2, part, wanted, NULL);
    place_clear(step), place_clear(moved);
}

// ---------------------------------------------------------------- sets

static struct vec3 draw(uint32_t range) {
    int32_t c[3];
    for (int k = 0; k < 3; k++) {
        c[k] = (int32_t)(check_random(&seed) % (2U * range + 1U)) - (int32_t)range;
    }
    return vec3(c[0], c[1], c[2]);
}

/// Different targets and a viewpoint, the last one: from lattices, on which nearly everything
/// lines up, to the whole range.
static uint32_t draw_set(struct vec3 *t) {
    static const uint32_t ranges[] = {1, 2, 3, 10, 1000, 1 << 15, VIEWPOINT_COORDINATE_MAX};
    const uint32_t range = ranges[check_random(&seed) % 7U];
    const uint32_t count = (uint32_t)(check_random(&seed) % COUNT_MAX);
    for (uint32_t i = 0; i <= count;) {
        t[i] = draw(range);
        bool new = true;
        for (uint32_t j = 0; j < i; j++) {
            new = new && !vec3_equal(t[i], t[j]);
        }
        i += new ? 1U : 0U;
    }
    return count;
}

static void brute_all(struct brute *line, struct brute *plane, const struct vec3 *t, uint32_t count,
                      place m) {
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = i + 1U; j < count; j++) {
            const uint32_t pair[2] = {i, j};
            brute_try(line, t, pair, 2, m);
            for (uint32_t k = j + 1U; k < count; k++) {
                const uint32_t triple[3] = {i, j, k};
                brute_try(plane, t, triple, 3, m);
            }
        }
    }
}

static void brute_force(void) {
    unsigned long on_line = 0, on_plane = 0, free_of_both = 0;
    for (unsigned long round = 0; round < rounds && check_clean(); round++) {
        const uint64_t before = seed;
        struct vec3 t[COUNT_MAX + 1U];
        const uint32_t count = draw_set(t);
        struct viewpoint_result result;
        CHECK_EQ(viewpoint_margins(t, count, t[count], true, &result), VIEWPOINT_OK);
        place m;
        place_init(m);
        place_set(m, t[count]);
        struct brute line = {0}, plane = {0};
        mpq_inits(line.distance2, plane.distance2, NULL);
        brute_all(&line, &plane, t, count, m);
        compare(&result.line, &line, 2);
        compare(&result.plane, &plane, 3);
        CHECK_EQ(result.collinear, plane.collinear);
        on_line += line.through != 0U;
        on_plane += plane.through != 0U;
        if (line.any && line.through == 0U) {
            move(t, count, m, &result.line, 2);
        }
        if (plane.any && plane.through == 0U) {
            move(t, count, m, &result.plane, 3);
            // In a plane through a line the two are equally near at most: the plane's margin is
            // the smaller one.
            CHECK(mpq_cmp(plane.distance2, line.distance2) <= 0);
            move_anywhere(t, count, m, plane.distance2);
            free_of_both++;
        }
        struct viewpoint_result lines;
        CHECK_EQ(viewpoint_margins(t, count, t[count], false, &lines), VIEWPOINT_OK);
        CHECK_EQ(lines.line.target[0], result.line.target[0]);
        CHECK_EQ(lines.line.target[1], result.line.target[1]);
        CHECK_EQ(i128_sign(lines.plane.denominator), 0);
        mpq_clears(line.distance2, plane.distance2, NULL);
        place_clear(m);
        if (!check_clean()) {
            printf("  %u targets, SEED=%llu\n", count, (unsigned long long)before);
        }
    }
    printf("# viewpoints on a line %lu, in a plane %lu, free %lu\n", on_line, on_plane,
           free_of_both);
    CHECK(on_line != 0 && on_plane != 0 && free_of_both != 0);
}

// ---------------------------------------------------------------- the ends

static void corners(void) {
    const int32_t c = VIEWPOINT_COORDINATE_MAX;
    const struct vec3 t[4] = {{c, c, c}, {-c, -c, c}, {-c, c, -c}, {c, -c, -c}};
    struct viewpoint_result result;
    CHECK_EQ(viewpoint_margins(t, 4, vec3(-c, -c, -c), true, &result), VIEWPOINT_OK);
    CHECK_EQ(result.plane.through, 0);
    CHECK_EQ(result.line.through, 0);
    // (-1,-1,-1) is at 2 / sqrt 3 from the planes of three, as from x + y + z = -1; the first
    // counts.
    CHECK_EQ(result.plane.target[0], 0);
    CHECK_EQ(result.plane.target[2], 2);
    CHECK_EQ(
        i256_sign(i256_sub(i256_product(result.plane.numerator, i256_from_i128(i128_from_i64(3))),
                           i256_product(i256_from_i128(i128_mul(4 * (int64_t)c, c)),
                                        i256_from_i128(result.plane.denominator)))),
        0);
}

static void refused(void) {
    struct vec3 t[3] = {{0, 0, 0}, {5, 0, 0}, {5, 0, 0}};
    struct viewpoint_result result;
    CHECK_EQ(viewpoint_margins(t, 3, vec3(1, 2, 3), true, &result), VIEWPOINT_ERROR_EQUAL);
    CHECK_EQ(result.bad[0], 1);
    CHECK_EQ(result.bad[1], 2);
    t[2].z = VIEWPOINT_COORDINATE_MAX + 1;
    CHECK_EQ(viewpoint_margins(t, 3, vec3(1, 2, 3), true, &result), VIEWPOINT_ERROR_RANGE);
    CHECK_EQ(result.bad[0], 2);
    CHECK_EQ(viewpoint_margins(t, 2, vec3(INT32_MIN, 2, 3), true, &result), VIEWPOINT_ERROR_RANGE);
    CHECK_EQ(result.bad[0], 2);
    CHECK_EQ(viewpoint_margins(t, 2, vec3(5, 0, 0), true, &result), VIEWPOINT_AT_TARGET);
    CHECK_EQ(result.bad[0], 1);
    CHECK_EQ(viewpoint_margins(t, 0, vec3(5, 0, 0), true, &result), VIEWPOINT_OK);
    CHECK_EQ(i128_sign(result.line.denominator), 0);
}

int main(void) {
    seed = getenv("SEED") != NULL ? strtoull(getenv("SEED"), NULL, 10) : seed;
    rounds = getenv("ROUNDS") != NULL ? strtoul(getenv("ROUNDS"), NULL, 10) : rounds;
    check_note("seed", (int64_t)seed);
    TEST(brute_force);
    TEST(corners);
    TEST(refused);
    return check_finish();
}
