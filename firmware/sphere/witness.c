#include "sphere/witness.h"

static bool is_zero(struct vec3_i64 a) {
    return (a.x | a.y | a.z) == 0;
}

bool witness_same_sense(struct vec3_i64 a, struct vec3_i64 b) {
    if (a.x != 0) {
        return (a.x > 0) == (b.x > 0);
    }
    return a.y != 0 ? (a.y > 0) == (b.y > 0) : (a.z > 0) == (b.z > 0);
}

static bool surrounded_by_two(struct vec3 a, struct vec3 b) {
    return is_zero(vec3_cross(a, b)) && i128_sign(vec3_dot(a, b)) < 0;
}

/// Three coplanar directions, each strictly inside the angle opposite to the other two.
static bool surrounded_by_three(struct vec3 a, struct vec3 b, struct vec3 c) {
    if (vec3_det_sign(a, b, c) != 0) {
        return false;
    }
    const struct vec3_i64 ab = vec3_cross(a, b), bc = vec3_cross(b, c), ca = vec3_cross(c, a);
    return !is_zero(ab) && !is_zero(bc) && !is_zero(ca) && witness_same_sense(ab, bc) &&
           witness_same_sense(bc, ca);
}

/// Cramer's rule: the weights of a, b, c, d in a sum of zero are these determinants.
static bool surrounded_by_four(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d) {
    const int of_a = vec3_det_sign(b, c, d);
    return of_a != 0 && -vec3_det_sign(a, c, d) == of_a && vec3_det_sign(a, b, d) == of_a &&
           -vec3_det_sign(a, b, c) == of_a;
}

static bool surrounded(const struct vec3 *points, const uint32_t *subset, uint8_t size) {
    const struct vec3 a = points[subset[0]], b = points[subset[1]];
    switch (size) {
    case 2:
        return surrounded_by_two(a, b);
    case 3:
        return surrounded_by_three(a, b, points[subset[2]]);
    default:
        return surrounded_by_four(a, b, points[subset[2]], points[subset[3]]);
    }
}

static void sort_ascending(uint32_t *list, uint8_t count) {
    for (uint8_t i = 1; i < count; i++) {
        const uint32_t value = list[i];
        uint8_t at = i;
        for (; at > 0U && list[at - 1U] > value; at--) {
            list[at] = list[at - 1U];
        }
        list[at] = value;
    }
}

uint8_t witness_find(const struct vec3 *points, const uint32_t *candidates, uint8_t count,
                     uint32_t witness[4]) {
    for (uint8_t size = 2; size <= count; size++) {
        for (uint8_t mask = 1; mask < (1U << count); mask++) {
            uint32_t subset[4];
            uint8_t members = 0;
            for (uint8_t i = 0; i < count; i++) {
                if ((mask >> i & 1U) != 0U) {
                    subset[members++] = candidates[i];
                }
            }
            if (members == size && surrounded(points, subset, size)) {
                sort_ascending(subset, size);
                for (uint8_t i = 0; i < size; i++) {
                    witness[i] = subset[i];
                }
                return size;
            }
        }
    }
    return 0;
}
