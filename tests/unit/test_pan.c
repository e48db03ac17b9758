/// firmware/aim/pan: weights and blends.
#include "check.h"

#include "aim/pan.h"
#include "fixed/trig.h"
#include "fixed/trig_fine.h"

static struct vec3 at(uint32_t bam) {
    const struct sincos s = trig_sincos(bam32(bam));
    return vec3(s.sin_q30, s.cos_q30, 0);
}

static void weights(void) {
    CHECK_EQ(pan_weight_q30(0, 1000000), 0);
    CHECK_EQ(pan_weight_q30(1000000, 1000000), Q30_ONE);
    CHECK_EQ(pan_weight_q30(UINT64_MAX, 1), Q30_ONE);
    CHECK_EQ(pan_weight_q30(0, 0), Q30_ONE);
    CHECK_NEAR(pan_weight_q30(500000, 1000000), Q30_ONE / 2, 8);
    // 10/64 - 15/256 + 6/1024 = 0.103515625, and the rest.
    CHECK_NEAR(pan_weight_q30(250000, 1000000), 111149056, 8);
    CHECK_NEAR(pan_weight_q30(750000, 1000000), Q30_ONE - 111149056, 8);
    q30_t last = 0;
    for (uint32_t t = 0; t <= 1000U; t++) {
        const q30_t w = pan_weight_q30((uint64_t)t * 4294967U, UINT32_MAX - 295U);
        CHECK(w >= last);
        last = w;
    }
    CHECK_EQ(last, Q30_ONE);
}

/// By angle the weight is the part of the way; by sum the tangent of the angle is w / (1 - w)
/// across a right angle.
static void blends(void) {
    struct vec3 v;
    for (uint32_t part = 0; part <= 16U; part++) {
        const q30_t w = (q30_t)(part << 26);
        CHECK(pan_blend(at(0), at(BAM32_QUARTER), w, PAN_BY_ANGLE, &v));
        const struct vec3 want = at(part << 26);
        CHECK_NEAR(v.x, want.x, 3);
        CHECK_NEAR(v.y, want.y, 3);
        CHECK(pan_blend(at(0), at(BAM32_QUARTER), w, PAN_BY_SUM, &v));
        const struct vec3 sum = vec3_normalise(vec3(w, Q30_ONE - w, 0));
        CHECK_NEAR(v.x, sum.x, 1);
        CHECK_NEAR(v.y, sum.y, 1);
        // Small ways, and nearly half a turn.
        CHECK(pan_blend(at(5), at(5 + 16000), w, PAN_BY_ANGLE, &v));
        CHECK_NEAR(trig_fine_angle_q30(v, at(5)) >> 32, part * 1000U, 2);
        CHECK(pan_blend(at(0), at(BAM32_HALF - (1U << 26)), w, PAN_BY_ANGLE, &v));
        CHECK_NEAR(trig_fine_angle_q30(v, at(0)) >> 32,
                   (uint64_t)(BAM32_HALF - (1U << 26)) * part / 16U, 30);
    }
}

static void opposite(void) {
    struct vec3 v = vec3(1, 2, 3);
    CHECK(!pan_blend(at(77), vec3_neg(at(77)), Q30_ONE / 3, PAN_BY_SUM, &v));
    CHECK(!pan_blend(at(77), vec3_neg(at(77)), Q30_ONE / 3, PAN_BY_ANGLE, &v));
    CHECK(vec3_equal(v, vec3(1, 2, 3)));
}

int main(void) {
    TEST(weights);
    TEST(blends);
    TEST(opposite);
    return check_finish();
}
