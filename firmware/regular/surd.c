#include "regular/surd.h"

void surd_add(struct surd *surd, int sign, const struct huge *factor, const struct huge *radicand) {
    if (sign == 0 || factor->count == 0U || radicand->count == 0U) {
        return;
    }
    surd->term[surd->count++] = (struct surd_term){sign, *factor, *radicand};
}

int surd_value(const struct surd *surd, unsigned shift, struct huge *size) {
    struct huge up = {.count = 0}, down = {.count = 0}, square, root;
    for (uint32_t i = 0; i < surd->count; i++) {
        const struct surd_term *const term = &surd->term[i];
        huge_mul(&square, &term->factor, &term->factor);
        // The largest factors are those of the root of 1; their squares alone fill the limbs.
        if (term->radicand.count != 1U || term->radicand.limb[0] != 1U) {
            huge_mul(&root, &square, &term->radicand);
            square = root;
        }
        huge_root(&root, &square, shift);
        struct huge *const side = term->sign > 0 ? &up : &down;
        huge_add(side, side, &root);
    }
    return huge_difference(size, &up, &down);
}

/// Is a * b a square? Then root is its root.
static bool is_square(const struct huge *a, const struct huge *b, struct huge *root) {
    struct huge product, again;
    huge_mul(&product, a, b);
    huge_root(root, &product, 0);
    huge_mul(&again, root, root);
    return huge_cmp(&again, &product) == 0;
}

/// All terms of one class, with term i, in units of the root of its radicand and times it: is their
/// sum 0? Marks them as seen.
static bool class_is_zero(const struct surd *surd, uint32_t i, bool *seen) {
    struct huge up = {.count = 0}, down = {.count = 0}, root, part;
    for (uint32_t j = i; j < surd->count; j++) {
        const struct surd_term *const term = &surd->term[j];
        if (seen[j] || !is_square(&surd->term[i].radicand, &term->radicand, &root)) {
            continue;
        }
        seen[j] = true;
        huge_mul(&part, &term->factor, &root);
        struct huge *const side = term->sign > 0 ? &up : &down;
        huge_add(side, side, &part);
    }
    return huge_cmp(&up, &down) == 0;
}

static bool is_zero(const struct surd *surd) {
    bool seen[SURD_TERMS_MAX] = {false};
    for (uint32_t i = 0; i < surd->count; i++) {
        if (!seen[i] && !class_is_zero(surd, i, seen)) {
            return false;
        }
    }
    return true;
}

int surd_sign(const struct surd *surd) {
    struct huge size;
    int sign = surd_value(surd, 0, &size);
    if (huge_bit_length(&size) > 4U) {
        return sign; // the error is below SURD_TERMS_MAX
    }
    if (is_zero(surd)) {
        return 0;
    }
    sign = surd_value(surd, 540, &size);
    return huge_bit_length(&size) > 4U ? sign : 0;
}
