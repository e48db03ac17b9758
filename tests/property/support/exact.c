#include "property/support/exact.h"

#include <gmp.h>
#include <stddef.h>

/// All numbers are made once; GMP's allocator would else be most of the time.
static struct {
    bool ready;
    mpz_t sum, term, cross[3];
} e;

static void start(void) {
    if (!e.ready) {
        e.ready = true;
        mpz_inits(e.sum, e.term, e.cross[0], e.cross[1], e.cross[2], (mpz_ptr)NULL);
    }
}

void exact_free(void) {
    if (e.ready) {
        mpz_clears(e.sum, e.term, e.cross[0], e.cross[1], e.cross[2], (mpz_ptr)NULL);
        e.ready = false;
    }
}

/// e.cross = a x b.
static void cross(struct vec3 a, struct vec3 b) {
    start();
    const int64_t left[3] = {a.y, a.z, a.x}, right[3] = {b.z, b.x, b.y};
    const int64_t left2[3] = {a.z, a.x, a.y}, right2[3] = {b.y, b.z, b.x};
    for (unsigned i = 0; i < 3U; i++) {
        mpz_set_si(e.cross[i], left[i]);
        mpz_mul_si(e.cross[i], e.cross[i], right[i]);
        mpz_set_si(e.term, left2[i]);
        mpz_mul_si(e.term, e.term, right2[i]);
        mpz_sub(e.cross[i], e.cross[i], e.term);
    }
}

/// Sign of e.cross . c.
static int cross_dot_sign(struct vec3 c) {
    mpz_mul_si(e.sum, e.cross[0], c.x);
    mpz_mul_si(e.term, e.cross[1], c.y);
    mpz_add(e.sum, e.sum, e.term);
    mpz_mul_si(e.term, e.cross[2], c.z);
    mpz_add(e.sum, e.sum, e.term);
    return mpz_sgn(e.sum);
}

int exact_det_sign(struct vec3 a, struct vec3 b, struct vec3 c) {
    cross(a, b);
    return cross_dot_sign(c);
}

int exact_dot_sign(struct vec3 a, struct vec3 b) {
    start();
    mpz_set_si(e.cross[0], a.x);
    mpz_set_si(e.cross[1], a.y);
    mpz_set_si(e.cross[2], a.z);
    return cross_dot_sign(b);
}

bool exact_parallel(struct vec3 a, struct vec3 b) {
    cross(a, b);
    return mpz_sgn(e.cross[0]) == 0 && mpz_sgn(e.cross[1]) == 0 && mpz_sgn(e.cross[2]) == 0;
}

/// Sign of the first component of a x b that is not zero: for vectors of one plane, their turn.
static int turn_sign(struct vec3 a, struct vec3 b) {
    cross(a, b);
    for (unsigned i = 0; i < 3U; i++) {
        if (mpz_sgn(e.cross[i]) != 0) {
            return mpz_sgn(e.cross[i]);
        }
    }
    return 0;
}

/// Do these two, three or four vectors, and no fewer of them, sum to zero with positive weights?
/// Two are opposite; three turn the same way in one plane; four see alternate sides of each other's
/// triples. (The weights are, by Cramer's rule, the cross products or determinants of the others.)
static bool positive_circuit(const struct vec3 *p, unsigned count) {
    if (count == 2U) {
        return exact_parallel(p[0], p[1]) && exact_dot_sign(p[0], p[1]) < 0;
    }
    if (count == 3U) {
        const int turn = turn_sign(p[0], p[1]);
        // The same component is the first nonzero one of all three products, for they are parallel.
        return exact_det_sign(p[0], p[1], p[2]) == 0 && turn != 0 &&
               turn_sign(p[1], p[2]) == turn && turn_sign(p[2], p[0]) == turn;
    }
    const int sign = exact_det_sign(p[0], p[1], p[2]);
    return sign != 0 && exact_det_sign(p[0], p[1], p[3]) == -sign &&
           exact_det_sign(p[0], p[2], p[3]) == sign && exact_det_sign(p[1], p[2], p[3]) == -sign;
}

const char *exact_check_witness(const struct vec3 *points, uint32_t count, const uint32_t *witness,
                                unsigned witness_count) {
    if (witness_count < 1U || witness_count > 4U) {
        return "witness does not have one to four points";
    }
    for (unsigned i = 0; i < witness_count; i++) {
        if (witness[i] >= count || (i > 0U && witness[i] <= witness[i - 1U])) {
            return "witness is not ascending, or names a point that is not there";
        }
    }
    // Which of the points take part in some minimal positive sum? Then the sum of all those sums
    // has positive weights for each of them.
    unsigned taking_part = 0;
    for (unsigned subset = 1; subset < 1U << witness_count; subset++) {
        struct vec3 p[4];
        unsigned size = 0;
        for (unsigned i = 0; i < witness_count; i++) {
            if ((subset & (1U << i)) != 0U) {
                p[size++] = points[witness[i]];
            }
        }
        if (size >= 2U && positive_circuit(p, size)) {
            taking_part |= subset;
        }
    }
    if (taking_part == 0U) {
        return "zero is not in the hull of the witness";
    }
    return taking_part == (1U << witness_count) - 1U ? NULL : "witness has a point of no use";
}
