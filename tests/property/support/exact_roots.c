#include "property/support/exact_roots.h"

#include "property/support/exact.h"

#include <mpfr.h>

#define BITS 1200

static struct {
    bool ready;
    mpfr_t sum, term, length, factor;
    mpz_t integer, part;
} r;

static void start(void) {
    if (!r.ready) {
        r.ready = true;
        mpfr_inits2(BITS, r.sum, r.term, r.length, r.factor, (mpfr_ptr)NULL);
        mpz_inits(r.integer, r.part, (mpz_ptr)NULL);
    }
    mpfr_set_zero(r.sum, 1);
}

void exact_roots_free(void) {
    if (r.ready) {
        mpfr_clears(r.sum, r.term, r.length, r.factor, (mpfr_ptr)NULL);
        mpz_clears(r.integer, r.part, (mpz_ptr)NULL);
        r.ready = false;
    }
    mpfr_free_cache();
}

/// r.integer = a . b
static void dot(struct vec3 a, struct vec3 b) {
    mpz_set_si(r.integer, (long)a.x * b.x);
    mpz_set_si(r.part, (long)a.y * b.y);
    mpz_add(r.integer, r.integer, r.part);
    mpz_set_si(r.part, (long)a.z * b.z);
    mpz_add(r.integer, r.integer, r.part);
}

/// r.integer = det(a, b, c)
static void det(struct vec3 a, struct vec3 b, struct vec3 c) {
    const int32_t column[3] = {a.x, a.y, a.z};
    const int32_t bx[3] = {b.x, b.y, b.z}, cx[3] = {c.x, c.y, c.z};
    mpz_set_si(r.integer, 0);
    for (unsigned i = 0; i < 3U; i++) {
        const unsigned j = (i + 1U) % 3U, k = (i + 2U) % 3U;
        mpz_set_si(r.part, bx[j]);
        mpz_mul_si(r.part, r.part, cx[k]);
        mpz_mul_si(r.part, r.part, column[i]);
        mpz_add(r.integer, r.integer, r.part);
        mpz_set_si(r.part, bx[k]);
        mpz_mul_si(r.part, r.part, cx[j]);
        mpz_mul_si(r.part, r.part, column[i]);
        mpz_sub(r.integer, r.integer, r.part);
    }
}

/// r.sum += sign * r.integer * |a| * |b|; b may be NULL.
static void add_term(int sign, struct vec3 a, const struct vec3 *b) {
    mpfr_set_z(r.term, r.integer, MPFR_RNDN);
    mpfr_mul_si(r.term, r.term, sign, MPFR_RNDN);
    dot(a, a);
    mpfr_set_z(r.length, r.integer, MPFR_RNDN);
    if (b != NULL) {
        dot(*b, *b);
        mpfr_mul_z(r.length, r.length, r.integer, MPFR_RNDN);
    }
    mpfr_sqrt(r.length, r.length, MPFR_RNDN);
    mpfr_mul(r.term, r.term, r.length, MPFR_RNDN);
    mpfr_add(r.sum, r.sum, r.term, MPFR_RNDN);
}

static int sign_of_sum(void) {
    if (mpfr_zero_p(r.sum) || mpfr_get_exp(r.sum) < -950) {
        return 0;
    }
    return mpfr_sgn(r.sum) > 0 ? 1 : -1;
}

int exact_plane_sign(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d) {
    start();
    det(b, c, d);
    add_term(1, a, NULL);
    det(a, c, d);
    add_term(-1, b, NULL);
    det(a, b, d);
    add_term(1, c, NULL);
    det(a, b, c);
    add_term(-1, d, NULL);
    return sign_of_sum();
}

int exact_cap_sign(struct vec3 a, struct vec3 b, struct vec3 x) {
    start();
    // |a| |b| |x|: a root of r.integer = |x|^2, as a factor, would need one more; so as |x|^2 |a|
    // |b| / |x|.
    dot(x, x);
    add_term(1, a, &b);
    dot(x, x);
    mpfr_set_z(r.factor, r.integer, MPFR_RNDN);
    mpfr_sqrt(r.factor, r.factor, MPFR_RNDN);
    mpfr_div(r.sum, r.sum, r.factor, MPFR_RNDN);
    dot(a, b);
    add_term(1, x, NULL);
    dot(x, a);
    add_term(-1, b, NULL);
    dot(x, b);
    add_term(-1, a, NULL);
    return sign_of_sum();
}

int exact_distance_cmp(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d) {
    start();
    dot(c, d);
    add_term(1, a, &b);
    dot(a, b);
    add_term(-1, c, &d);
    return sign_of_sum();
}

/// n / |n| in Q1.30. False: it is zero.
static bool round_unit(mpfr_t n[3], struct vec3 *axis_q30) {
    mpfr_set_zero(r.sum, 1);
    for (unsigned i = 0; i < 3U; i++) {
        mpfr_sqr(r.term, n[i], MPFR_RNDN);
        mpfr_add(r.sum, r.sum, r.term, MPFR_RNDN);
    }
    const bool any = !mpfr_zero_p(r.sum) && mpfr_get_exp(r.sum) > -900;
    mpfr_rec_sqrt(r.sum, r.sum, MPFR_RNDN);
    long component[3] = {0, 0, 0};
    for (unsigned i = 0; any && i < 3U; i++) {
        mpfr_mul(n[i], n[i], r.sum, MPFR_RNDN);
        mpfr_mul_2ui(n[i], n[i], 30, MPFR_RNDN);
        component[i] = mpfr_get_si(n[i], MPFR_RNDN);
    }
    *axis_q30 = vec3((int32_t)component[0], (int32_t)component[1], (int32_t)component[2]);
    return any;
}

static const struct vec3 unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

bool exact_circle_axis(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 *axis_q30) {
    mpfr_t n[3];
    mpfr_inits2(BITS, n[0], n[1], n[2], (mpfr_ptr)NULL);
    for (unsigned i = 0; i < 3U; i++) { // (a x b) |c| + (b x c) |a| + (c x a) |b|
        start();
        det(unit[i], a, b);
        add_term(1, c, NULL);
        det(unit[i], b, c);
        add_term(1, a, NULL);
        det(unit[i], c, a);
        add_term(1, b, NULL);
        mpfr_set(n[i], r.sum, MPFR_RNDN);
    }
    const bool any = round_unit(n, axis_q30);
    mpfr_clears(n[0], n[1], n[2], (mpfr_ptr)NULL);
    return any;
}

bool exact_middle(struct vec3 a, struct vec3 b, struct vec3 *axis_q30) {
    mpfr_t n[3];
    mpfr_inits2(BITS, n[0], n[1], n[2], (mpfr_ptr)NULL);
    for (unsigned i = 0; i < 3U; i++) { // a |b| + b |a|
        start();
        dot(unit[i], a);
        add_term(1, b, NULL);
        dot(unit[i], b);
        add_term(1, a, NULL);
        mpfr_set(n[i], r.sum, MPFR_RNDN);
    }
    const bool any = round_unit(n, axis_q30);
    mpfr_clears(n[0], n[1], n[2], (mpfr_ptr)NULL);
    return any;
}

static bool is_inside(const struct vec3 *s, unsigned support_count, int outward, struct vec3 x) {
    if (support_count == 1U) {
        return exact_parallel(s[0], x) && exact_dot_sign(s[0], x) > 0;
    }
    return support_count == 2U ? exact_cap_sign(s[0], s[1], x) <= 0
                               : outward * exact_plane_sign(s[0], s[1], s[2], x) >= 0;
}

bool exact_holds_cone(const struct vec3 *points, uint32_t count, const uint32_t *support,
                      unsigned support_count) {
    struct vec3 s[3];
    int outward = 0;
    for (unsigned i = 0; i < support_count; i++) {
        s[i] = points[support[i]];
    }
    if (support_count == 2U && exact_parallel(s[0], s[1])) {
        return false;
    }
    if (support_count == 3U) {
        outward = exact_det_sign(s[0], s[1], s[2]);
        if (outward == 0 || exact_cap_sign(s[0], s[1], s[2]) < 0 ||
            exact_cap_sign(s[1], s[2], s[0]) < 0 || exact_cap_sign(s[2], s[0], s[1]) < 0) {
            return false;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (!is_inside(s, support_count, outward, points[i])) {
            return false;
        }
    }
    return support_count >= 1U && support_count <= 3U;
}
