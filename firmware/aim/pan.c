#include "aim/pan.h"

#include "fixed/trig_fine.h"

/// 2^-20 rad, of 2^64 units a turn.
#define OPPOSITE_TURN64 UINT64_C(0x28BE60DB939)

q30_t pan_weight_q30(uint64_t elapsed_us, uint32_t duration_us) {
    if (elapsed_us >= duration_us) {
        return Q30_ONE;
    }
    const int64_t s = (int64_t)((elapsed_us << 30) / duration_us); // elapsed < 2^32
    const int64_t s2 = s * s >> 30, s3 = s2 * s >> 30;
    const int64_t rest = 10 * (int64_t)Q30_ONE - 15 * s + 6 * s2; // 1 to 10
    const int64_t weight = s3 * rest >> 30;
    return (q30_t)(weight < Q30_ONE ? weight : Q30_ONE);
}

static struct vec3_i64 blend(struct vec3 a, int64_t of_a, struct vec3 b, int64_t of_b) {
    return (struct vec3_i64){a.x * of_a + b.x * of_b, a.y * of_a + b.y * of_b,
                             a.z * of_a + b.z * of_b};
}

bool pan_blend(struct vec3 from_q30, struct vec3 to_q30, q30_t weight_q30, enum pan_path path,
               struct vec3 *out_q30) {
    int64_t of_from = Q30_ONE - weight_q30, of_to = weight_q30;
    const uint64_t apart = trig_fine_angle_q30(from_q30, to_q30);
    if (apart + OPPOSITE_TURN64 >= UINT64_C(1) << 63) {
        return false;
    }
    // Closer than 1e-4 rad the arc is straight to 1e-9 of its length.
    if (path == PAN_BY_ANGLE && apart > UINT64_C(1) << 48) {
        const uint64_t part = u64_mul_high(apart << 1, (uint64_t)weight_q30 << 33);
        of_from = trig_fine_sincos(apart - part).sin_q62 >> 31;
        of_to = trig_fine_sincos(part).sin_q62 >> 31;
    }
    *out_q30 = vec3_i64_normalise(blend(from_q30, of_from, to_q30, of_to));
    return true;
}
