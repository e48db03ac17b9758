#include "fixed/root_sum.h"

void root_term_set(struct root_term *term, int sign, struct u128 size, struct u128 radicand) {
    struct huge factor, square, under;
    huge_from_u128(&factor, size);
    huge_from_u128(&under, radicand);
    huge_mul(&square, &factor, &factor);
    huge_mul(&term->square, &square, &under);
    term->sign = term->square.count == 0U ? 0 : sign;
}

int root_sum_2(const struct root_term *a, const struct root_term *b) {
    if (a->sign == b->sign || b->sign == 0) {
        return a->sign;
    }
    return a->sign == 0 ? b->sign : a->sign * huge_cmp(&a->square, &b->square);
}

/// 2 a b, as a term.
static void double_product(struct root_term *to, const struct root_term *a,
                           const struct root_term *b) {
    huge_mul(&to->square, &a->square, &b->square);
    huge_shift_left(&to->square, &to->square, 2);
    to->sign = a->sign * b->sign;
}

/// An integer as a term.
static void integer_term(struct root_term *to, int sign, const struct huge *size) {
    huge_mul(&to->square, size, size);
    to->sign = sign;
}

int root_sum_3(const struct root_term *a, const struct root_term *b, const struct root_term *c) {
    const int pair = root_sum_2(b, c);
    if (pair == 0 || a->sign == pair) {
        return a->sign;
    }
    if (a->sign == 0) {
        return pair;
    }
    // Opposite signs: (b + c)^2 - a^2 = (b^2 + c^2 - a^2) + 2 b c tells which is larger. Squares
    // below 2^514, so the difference is below 2^516 and its square below 2^1032.
    struct huge rest;
    huge_add(&rest, &b->square, &c->square);
    const int sign = huge_difference(&rest, &rest, &a->square);
    struct root_term integer, product;
    integer_term(&integer, sign, &rest);
    double_product(&product, b, c);
    return pair * root_sum_2(&integer, &product);
}

int root_sum_4(const struct root_term *a, const struct root_term *b, const struct root_term *c,
               const struct root_term *d) {
    const int first = root_sum_2(a, b), second = root_sum_2(c, d);
    if (second == 0 || first == second) {
        return first;
    }
    if (first == 0) {
        return second;
    }
    // Opposite signs: (a + b)^2 - (c + d)^2 = (a^2 + b^2 - c^2 - d^2) + 2 a b - 2 c d. Squares
    // below 2^256 make three terms with squares below 2^514.
    struct huge left, right;
    huge_add(&left, &a->square, &b->square);
    huge_add(&right, &c->square, &d->square);
    const int sign = huge_difference(&left, &left, &right);
    struct root_term integer, ab, cd;
    integer_term(&integer, sign, &left);
    double_product(&ab, a, b);
    double_product(&cd, c, d);
    cd.sign = -cd.sign;
    return first * root_sum_3(&integer, &ab, &cd);
}
