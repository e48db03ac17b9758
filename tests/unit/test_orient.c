/// firmware/aim/orient against identities that need no arithmetic but integers, so that it runs on
/// boards too; tests/property/orient_reference.c has the accuracy.
#include "check.h"

#include "aim/orient.h"

static uint64_t seed = UINT64_C(0xD1B54A32D192ED03);

static int32_t any_i32(void) {
    return (int32_t)(uint32_t)check_random(&seed) / (1 << (check_random(&seed) % 31U));
}

static struct vec3 any_unit(void) {
    struct vec3 a;
    do {
        a = vec3(any_i32(), any_i32(), any_i32());
    } while (vec3_is_zero(a));
    return vec3_normalise(a);
}

static struct vec3 any_up(void) {
    struct vec3 a;
    do {
        a = vec3(any_i32(), any_i32(), any_i32());
    } while (vec3_is_zero(a));
    return a;
}

static void check_axes(struct vec3 ahead, struct vec3 up, struct vec3 right_wanted,
                       struct vec3 up_wanted) {
    const struct orient_axes axes = orient_axes(ahead, up);
    CHECK_EQ(axes.right_q30.x, right_wanted.x);
    CHECK_EQ(axes.right_q30.y, right_wanted.y);
    CHECK_EQ(axes.right_q30.z, right_wanted.z);
    CHECK_EQ(axes.up_q30.x, up_wanted.x);
    CHECK_EQ(axes.up_q30.y, up_wanted.y);
    CHECK_EQ(axes.up_q30.z, up_wanted.z);
}

enum { ONE = 1 << 30 };

static void the_horizon(void) {
    const struct vec3 z = vec3(0, 0, 1);
    check_axes(vec3(0, ONE, 0), z, vec3(ONE, 0, 0), vec3(0, 0, ONE));
    check_axes(vec3(ONE, 0, 0), z, vec3(0, -ONE, 0), vec3(0, 0, ONE));
    check_axes(vec3(0, -ONE, 0), z, vec3(-ONE, 0, 0), vec3(0, 0, ONE));
    // Upside down, and with a slanting up of any length.
    check_axes(vec3(0, ONE, 0), vec3(0, 0, -7), vec3(-ONE, 0, 0), vec3(0, 0, -ONE));
    check_axes(vec3(0, ONE, 0), vec3(0, INT32_MIN, 3), vec3(ONE, 0, 0), vec3(0, 0, ONE));
}

static void ahead_parallel_to_up(void) {
    const struct vec3 x = vec3(5, 0, 0), z = vec3(0, 0, 1);
    check_axes(vec3(0, 0, ONE), z, vec3(ONE, 0, 0), vec3(0, -ONE, 0));
    check_axes(vec3(0, 0, -ONE), z, vec3(ONE, 0, 0), vec3(0, ONE, 0));
    check_axes(vec3(ONE, 0, 0), x, vec3(0, ONE, 0), vec3(0, 0, -ONE));
    check_axes(vec3(-ONE, 0, 0), x, vec3(0, ONE, 0), vec3(0, 0, ONE));
    // +x made perpendicular to (1, 1, 0) / sqrt 2.
    const struct vec3 diagonal = vec3_normalise(vec3(1, 1, 0));
    check_axes(diagonal, vec3(-9, -9, 0), vec3(diagonal.x, -diagonal.x, 0), vec3(0, 0, ONE));
    // (1, 2, 3) does not fit Q1.30 exactly: its rounded unit vector still counts as parallel.
    const struct vec3 slanting = vec3(1, 2, 3);
    const struct orient_axes axes = orient_axes(vec3_normalise(slanting), slanting);
    CHECK(axes.right_q30.x > ONE / 2);
    CHECK_NEAR(vec3_dot_unit(axes.right_q30, vec3_normalise(slanting)), 0, ONE);
    // One unit beside the zenith is not parallel.
    check_axes(vec3(0, 1, ONE), z, vec3(ONE, 0, 0), vec3(0, -ONE, 1));
    check_axes(vec3(0, 0, 0), z, vec3(0, 0, 0), vec3(0, 0, 0));
}

/// a x b of unit vectors, back in Q1.30.
static struct vec3 cross_q30(struct vec3 a, struct vec3 b) {
    const struct vec3_i64 c = vec3_cross(a, b);
    return vec3((q30_t)round_shift_i64(c.x, 30), (q30_t)round_shift_i64(c.y, 30),
                (q30_t)round_shift_i64(c.z, 30));
}

static bool near(struct vec3 a, struct vec3 b, int64_t ulp) {
    return CHECK_NEAR(a.x, b.x, ulp) && CHECK_NEAR(a.y, b.y, ulp) && CHECK_NEAR(a.z, b.z, ulp);
}

static void right_ahead_up_are_a_right_handed_frame(void) {
    for (int i = 0; i < CHECK_ROUNDS(20000) && check_clean(); i++) {
        const struct vec3 ahead = any_unit(), up = any_up();
        const struct orient_axes axes = orient_axes(ahead, up);
        // det(R, A, U) = +1 and all three perpendicular: U = R x A, R = A x U, A = U x R.
        near(cross_q30(axes.right_q30, ahead), axes.up_q30, 3);
        near(cross_q30(ahead, axes.up_q30), axes.right_q30, 3);
        near(cross_q30(axes.up_q30, axes.right_q30), ahead, 3);
        CHECK_EQ(vec3_det_sign(axes.right_q30, ahead, axes.up_q30), 1);
        // The camera's up leans to the side of the wanted up, and right is level with respect to
        // it.
        CHECK(i128_sign(vec3_dot(axes.up_q30, up)) >= 0 || vec3_equal(vec3_normalise(up), ahead) ||
              vec3_equal(vec3_neg(vec3_normalise(up)), ahead));
    }
}

static void the_length_of_up_changes_no_bit(void) {
    for (int i = 0; i < CHECK_ROUNDS(20000) && check_clean(); i++) {
        const struct vec3 ahead = any_unit();
        const struct vec3 a = any_up(), up = vec3(a.x / 256, a.y / 256, a.z / 256);
        const int32_t factor = 1 + (int32_t)(check_random(&seed) % 255U);
        const struct vec3 longer = vec3(up.x * factor, up.y * factor, up.z * factor);
        const struct orient_axes short_axes = orient_axes(ahead, up);
        const struct orient_axes long_axes = orient_axes(ahead, longer);
        CHECK(vec3_equal(short_axes.right_q30, long_axes.right_q30));
        CHECK(vec3_equal(short_axes.up_q30, long_axes.up_q30));
    }
}

static void pan_and_tilt_of_the_main_directions(void) {
    static const struct {
        struct vec3 ahead;
        uint32_t pan, tilt;
    } cases[] = {
        {{0, ONE, 0}, 0, 0},
        {{ONE, 0, 0}, BAM32_QUARTER, 0},
        {{0, -ONE, 0}, BAM32_HALF, 0},
        {{-ONE, 0, 0}, 0U - BAM32_QUARTER, 0},
        {{0, 0, ONE}, 0, BAM32_QUARTER},
        {{0, 0, -ONE}, 0, 0U - BAM32_QUARTER},
        {{ONE, ONE, 0}, BAM32_QUARTER / 2U, 0},
        {{0, ONE, ONE}, 0, BAM32_QUARTER / 2U},
        {{0, -ONE, -ONE}, BAM32_HALF, 0U - BAM32_QUARTER / 2U},
        // One unit beside the zenith the pan counts, and the tilt is short of a quarter by 0.64
        // BAM.
        {{1, 0, ONE}, BAM32_QUARTER, BAM32_QUARTER - 1U},
        {{0, -1, -ONE}, BAM32_HALF, 0U - BAM32_QUARTER + 1U},
        {{0, 0, 0}, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct orient_angles angles = orient_pan_tilt(cases[i].ahead);
        CHECK_EQ(angles.pan_bam32.bam, cases[i].pan);
        CHECK_EQ(angles.tilt_bam32.bam, cases[i].tilt);
    }
}

static void the_picture_of_a_cone(void) {
    struct orient_image image;
    CHECK_EQ(orient_image_of_cone(bam32(0), &image), ORIENT_IMAGE_OK);
    CHECK_EQ(image.radius_q32, 0);
    CHECK_EQ(image.distortion_q32, INT64_C(1) << 32);
    CHECK_EQ(orient_image_of_cone(bam32(BAM32_QUARTER / 2U), &image), ORIENT_IMAGE_OK);
    CHECK_EQ(image.radius_q32, INT64_C(1) << 32);
    CHECK_EQ(image.distortion_q32, INT64_C(6074001000)); // sqrt 2
    CHECK_EQ(orient_image_of_cone(bam32(BAM32_QUARTER - 1U), &image), ORIENT_IMAGE_OK);
    // 2^31 / pi; the true tangent is that less 5e-10.
    CHECK_NEAR(image.radius_q32, INT64_C(2935890503282001226), 16);
    CHECK_NEAR(image.distortion_q32, INT64_C(2935890503282001226), 16);
}

static void no_picture_from_90_degrees_on(void) {
    static const uint32_t wide[] = {BAM32_QUARTER, BAM32_QUARTER + 1U, BAM32_HALF, UINT32_MAX};
    for (size_t i = 0; i < sizeof wide / sizeof *wide; i++) {
        struct orient_image image = {0, 0};
        CHECK_EQ(orient_image_of_cone(bam32(wide[i]), &image), ORIENT_IMAGE_UNBOUNDED);
        CHECK(image.radius_q32 == UINT64_MAX && image.distortion_q32 == UINT64_MAX);
    }
}

static void a_wider_cone_has_a_larger_picture(void) {
    for (int i = 0; i < CHECK_ROUNDS(20000) && check_clean(); i++) {
        const uint32_t angle = (uint32_t)check_random(&seed) % (BAM32_QUARTER - 1U);
        struct orient_image image = {0, 0}, next = {0, 0};
        CHECK_EQ(orient_image_of_cone(bam32(angle), &image), ORIENT_IMAGE_OK);
        CHECK_EQ(orient_image_of_cone(bam32(angle + 1U), &next), ORIENT_IMAGE_OK);
        CHECK(next.radius_q32 > image.radius_q32);
        CHECK(next.distortion_q32 >= image.distortion_q32);
        CHECK(image.distortion_q32 >= image.radius_q32);
    }
}

int main(void) {
    TEST(the_horizon);
    TEST(ahead_parallel_to_up);
    TEST(right_ahead_up_are_a_right_handed_frame);
    TEST(the_length_of_up_changes_no_bit);
    TEST(pan_and_tilt_of_the_main_directions);
    TEST(the_picture_of_a_cone);
    TEST(no_picture_from_90_degrees_on);
    TEST(a_wider_cone_has_a_larger_picture);
    return check_finish();
}
