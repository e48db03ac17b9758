#include "sphere/certify.h"

#include "sphere/cone_answer.h"
#include "sphere/site.h"
#include "sphere/witness.h"

static bool is_same_direction(struct vec3 a, struct vec3 b) {
    const struct vec3_i64 cross = vec3_cross(a, b);
    return (cross.x | cross.y | cross.z) == 0 && i128_sign(vec3_dot(a, b)) > 0;
}

static bool is_opposite_direction(struct vec3 a, struct vec3 b) {
    const struct vec3_i64 cross = vec3_cross(a, b);
    return (cross.x | cross.y | cross.z) == 0 && i128_sign(vec3_dot(a, b)) < 0;
}

bool certify_support(const struct vec3 *points, uint32_t count, const uint32_t *support,
                     uint32_t support_count) {
    if (support_count < 1U || support_count > 3U) {
        return false;
    }
    struct site s[3];
    for (uint32_t i = 0; i < support_count; i++) {
        s[i] = site_from(points[support[i]]);
    }
    int outward = 0;
    if (support_count == 2U) {
        if (is_same_direction(s[0].vector, s[1].vector) ||
            is_opposite_direction(s[0].vector, s[1].vector)) {
            return false;
        }
    } else if (support_count == 3U) {
        outward = site_side(&s[0], &s[1], &s[2]);
        if (outward == 0 || site_cap_sign(&s[0], &s[1], &s[2]) < 0 ||
            site_cap_sign(&s[1], &s[2], &s[0]) < 0 || site_cap_sign(&s[2], &s[0], &s[1]) < 0) {
            return false;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct site x = site_from(points[i]);
        const bool inside = support_count == 1U ? is_same_direction(s[0].vector, x.vector)
                            : support_count == 2U
                                ? site_cap_sign(&s[0], &s[1], &x) <= 0
                                : outward * site_plane_sign(&s[0], &s[1], &s[2], &x) >= 0;
        if (!inside) {
            return false;
        }
    }
    return true;
}

bool certify_held(const struct vec3 *points, uint32_t count, const struct min_norm *support) {
    struct min_norm held = *support;
    for (uint32_t i = 0; i < count; i++) {
        const struct min_norm_point point = cone_point(points, i);
        if (min_norm_violated_by(&held, &point)) {
            return false;
        }
    }
    return true;
}

bool certify_witness(const struct vec3 *points, const uint32_t *witness, uint8_t witness_count) {
    uint32_t smallest[4];
    return witness_count >= 2U && witness_count <= 4U &&
           witness_find(points, witness, witness_count, smallest) == witness_count;
}
