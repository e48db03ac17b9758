#include "scene/units.h"

#include "fixed/wide.h"
#include "scene/shape.h"

#define FAR         (INT64_C(1) << 62)
#define FINE_UM     125U ///< units of so many micrometres, or shorter ones, are fine enough
#define FINER_MOST  28U
#define MICRO       UINT64_C(1000000)
#define DOUBLE_LAST UINT64_C(0x7FF)

struct units units_of_um(uint32_t unit_um) {
    const unsigned log2 = 63U - u64_leading_zeros(unit_um);
    const uint64_t one = UINT64_C(1) << 63;
    uint64_t rest;
    const uint64_t quotient =
        u128_div_u64((struct u128){log2 == 0U ? one : 0U, log2 == 0U ? 0U : (one >> (64U - log2))},
                     unit_um, &rest);
    return (struct units){quotient + (rest != 0U), 63U + log2};
}

bool units_of_tree(const struct tree *tree, unsigned finer, struct units *out) {
    const uint64_t bits =
        (uint64_t)tree->header->unit_double[1] << 32 | tree->header->unit_double[0];
    const uint64_t exponent = bits >> 52,
                   mantissa = (bits & ((UINT64_C(1) << 52) - 1U)) | UINT64_C(1) << 52;
    if (exponent == 0U || exponent >= DOUBLE_LAST) {
        return false; // no number above 0
    }
    // A unit is mantissa * 2^(exponent - 1075) metres; the divisor has the mantissa's first 44
    // bits.
    uint64_t rest;
    const uint64_t divisor = (mantissa >> 9) * MICRO;
    const uint64_t quotient = u128_div_u64((struct u128){0, UINT64_C(1) << 62}, divisor, &rest);
    const int shift = (int)exponent - 940 - (int)finer;
    *out = (struct units){quotient + (rest != 0U), (uint32_t)shift};
    return shift > 0;
}

/// The distance from the origin within which all of a tree is, on each axis.
static uint64_t reach_of(const struct tree *tree) {
    const struct tree_node *const root = &tree->nodes[0];
    const uint64_t x = u64_abs(root->x), y = u64_abs(root->y), z = u64_abs(root->z);
    const uint64_t most = x > y ? (x > z ? x : z) : (y > z ? y : z);
    return most + root->radius;
}

unsigned units_finer(const struct tree *tree) {
    unsigned finer = 0;
    struct units units;
    if (tree->header->node_count == 0U) {
        return 0;
    }
    const uint64_t reach = reach_of(tree);
    while (finer < FINER_MOST && reach << (finer + 1U) <= (uint64_t)SHAPE_COORDINATE_MAX &&
           (!units_of_tree(tree, finer, &units) || units_from_um(units, FINE_UM) == 0)) {
        finer++;
    }
    return finer;
}

int64_t units_from_um(struct units units, int64_t um) {
    const struct u128 product = u128_mul(u64_abs(um), units.multiplier);
    const unsigned shift = units.shift;
    uint64_t size = (uint64_t)FAR;
    if (shift >= 64U) {
        size = shift < 128U ? product.hi >> (shift - 64U) : 0U;
    } else if (product.hi >> (shift - 1U) == 0U) { // fits in 64 bits, and more
        size = product.hi << (64U - shift) | product.lo >> shift;
    }
    size = size < (uint64_t)FAR ? size : (uint64_t)FAR;
    return um < 0 ? -(int64_t)size : (int64_t)size;
}
