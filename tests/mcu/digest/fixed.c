/// Numbers: wide integers, roots, angles, vectors of three.
#include "mcu/digest/digest.h"

#include "fixed/root.h"
#include "fixed/trig.h"

static void wide(void) {
    struct digest d = digest_start(11);
    for (int i = 0; i < 3000; i++) {
        const int64_t a = digest_any_i64(&d), b = digest_any_i64(&d);
        struct i128 q;
        q.lo = digest_any_u64(&d);
        q.hi = digest_any_i64(&d);
        const struct i128 p = i128_mul(a, b);
        const struct i256 product = i256_mul(p, q);
        const struct i256 terms[] = {product, i256_neg(product),
                                     i256_add(product, i256_from_i128(p)),
                                     i256_sub(product, i256_from_i128(q))};
        digest_i128(&d, p);
        digest_i128(&d, i128_sub(p, q));
        digest_i64(&d, i128_cmp(p, q));
        for (unsigned k = 0; k < 4U; k++) {
            for (unsigned w = 0; w < 4U; w++) {
                digest_u64(&d, terms[k].word[w]);
            }
            const unsigned bits = i256_bit_length(terms[k]);
            digest_i64(&d, i256_sign(terms[k]));
            digest_u64(&d, bits);
            digest_i64(&d, i256_shift_right_i64(terms[k], bits > 62U ? bits - 62U : 0U));
        }
        const uint64_t divisor = digest_any_u64(&d) | 1U;
        uint64_t remainder;
        digest_u64(&d, u128_div_u64((struct u128){(uint64_t)a, (uint64_t)b % divisor}, divisor,
                                    &remainder));
        digest_u64(&d, remainder);
    }
    digest_finish(&d, "digest fixed/wide");
}

static void root(void) {
    struct digest d = digest_start(12);
    for (int i = 0; i < 3000; i++) {
        const uint64_t a = digest_any_u64(&d), b = digest_any_u64(&d);
        digest_u64(&d, root_u32((uint32_t)a));
        digest_u64(&d, root_u64(a));
        digest_u64(&d, root_u128((struct u128){a, b}));
    }
    digest_finish(&d, "digest fixed/root");
}

static void trig(void) {
    struct digest d = digest_start(13);
    for (int i = 0; i < 3000; i++) {
        const struct sincos s = trig_sincos(bam32((uint32_t)digest_any_u64(&d)));
        const struct trig_octant o = trig_octant(digest_below(&d, (UINT32_C(1) << 29) + 1U));
        const int64_t y = digest_any_i64(&d), x = digest_any_i64(&d);
        digest_i64(&d, s.sin_q30);
        digest_i64(&d, s.cos_q30);
        digest_u64(&d, o.sin_by_t_q63);
        digest_u64(&d, o.cos_q63);
        digest_u64(&d, trig_atan2(y, x).bam);
        digest_u64(&d, trig_atan2_turn64(u64_abs(y), u64_abs(x)));
    }
    digest_finish(&d, "digest fixed/trig");
}

static void vectors_of_three(void) {
    struct digest d = digest_start(14);
    for (int i = 0; i < 3000; i++) {
        const struct vec3 a = digest_any_direction(&d), b = digest_any_direction(&d),
                          c = digest_any_direction(&d);
        const struct vec3_i64 cross = vec3_cross(a, b);
        struct vec3_i64 far;
        far.x = digest_any_i64(&d);
        far.y = digest_any_i64(&d);
        far.z = digest_any_i64(&d);
        const struct vec3_i64 half = {far.x / 2, far.y / 2, far.z / 2};
        const struct vec3_i128 across = vec3_i64_cross(vec3_widen(a), half);
        const struct i256 dot = vec3_i128_dot(across, far);
        digest_i128(&d, vec3_dot(a, b));
        digest_vec3_i64(&d, cross);
        digest_u64(&d, vec3_norm2(a));
        digest_i128(&d, vec3_i64_dot_vec3(cross, c));
        digest_i64(&d, vec3_det_sign(a, b, c));
        digest_i128(&d, vec3_i64_dot(half, vec3_widen(b)));
        for (unsigned w = 0; w < 4U; w++) {
            digest_u64(&d, dot.word[w]);
        }
        digest_vec3(&d, vec3_normalise(a));
        digest_vec3_i64(&d, vec3_normalise_q61(b));
        digest_vec3(&d, vec3_i64_normalise(far));
        digest_u64(&d, vec3_i64_length(half));
    }
    digest_finish(&d, "digest fixed/vec3");
}

int main(void) {
    TEST(wide);
    TEST(root);
    TEST(trig);
    TEST(vectors_of_three);
    return check_finish();
}
