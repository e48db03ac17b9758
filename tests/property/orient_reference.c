/// firmware/aim/orient against MPFR with 256 bits: the accuracy that orient.h states.
#include "check.h"

#include "aim/orient.h"

#include <mpfr.h>
#include <stdio.h>

static uint64_t seed = UINT64_C(0xA0761D6478BD642F);

enum { BITS = 256, AXES_CASES = 30000, ANGLE_CASES = 40000, IMAGE_CASES = 40000 };

static int32_t any_i32(void) {
    return (int32_t)(uint32_t)check_random(&seed) / (1 << (check_random(&seed) % 31U));
}

static struct vec3 any_direction(void) {
    struct vec3 a;
    do {
        a = vec3(any_i32(), any_i32(), any_i32());
    } while (vec3_is_zero(a));
    return a;
}

struct mpfr_vec3 {
    mpfr_t c[3];
};

static void vec_init(struct mpfr_vec3 *a) {
    for (int i = 0; i < 3; i++) {
        mpfr_init2(a->c[i], BITS);
    }
}

static void vec_clear(struct mpfr_vec3 *a) {
    for (int i = 0; i < 3; i++) {
        mpfr_clear(a->c[i]);
    }
}

static void vec_set(struct mpfr_vec3 *a, struct vec3 b) {
    mpfr_set_si(a->c[0], b.x, MPFR_RNDN);
    mpfr_set_si(a->c[1], b.y, MPFR_RNDN);
    mpfr_set_si(a->c[2], b.z, MPFR_RNDN);
}

static void vec_cross(struct mpfr_vec3 *out, const struct mpfr_vec3 *a, const struct mpfr_vec3 *b) {
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        mpfr_fmms(out->c[i], a->c[j], b->c[k], a->c[k], b->c[j], MPFR_RNDN);
    }
}

static void vec_length(mpfr_t out, const struct mpfr_vec3 *a) {
    mpfr_fmma(out, a->c[0], a->c[0], a->c[1], a->c[1], MPFR_RNDN);
    mpfr_fma(out, a->c[2], a->c[2], out, MPFR_RNDN);
    mpfr_sqrt(out, out, MPFR_RNDN);
}

/// |got - reference|, in units of got's last place, kept if it is the largest so far.
static void keep_error(double *worst, int64_t got, mpfr_t reference) {
    mpfr_t error;
    mpfr_init2(error, BITS);
    mpfr_set_sj(error, got, MPFR_RNDN);
    mpfr_sub(error, error, reference, MPFR_RNDN);
    const double size = mpfr_get_d(error, MPFR_RNDA);
    *worst = size > *worst ? size : (-size > *worst ? -size : *worst);
    mpfr_clear(error);
}

/// a / |a| in Q1.30 against what was got.
static void keep_unit_error(double *worst, struct vec3 got, struct mpfr_vec3 *a) {
    mpfr_t length;
    mpfr_init2(length, BITS);
    vec_length(length, a);
    const int32_t components[3] = {got.x, got.y, got.z};
    for (int i = 0; i < 3; i++) {
        mpfr_div(a->c[i], a->c[i], length, MPFR_RNDN);
        mpfr_mul_2ui(a->c[i], a->c[i], 30, MPFR_RNDN);
        keep_error(worst, components[i], a->c[i]);
    }
    mpfr_clear(length);
}

static bool are_parallel(struct vec3 a_q30, struct vec3 b) {
    const struct vec3 b_q30 = vec3_normalise(b);
    return vec3_equal(a_q30, b_q30) || vec3_equal(a_q30, vec3_neg(b_q30));
}

/// Up near ahead in every fourth case: there the products cancel.
static struct vec3 any_up(int i, struct vec3 ahead) {
    if (i % 4 != 0) {
        return any_direction();
    }
    const int32_t spread = 1 << (check_random(&seed) % 20U);
    const struct vec3 near = {ahead.x + (int32_t)(check_random(&seed) % 9U) * spread / 8,
                              ahead.y - (int32_t)(check_random(&seed) % 9U) * spread / 8, ahead.z};
    return (i & 4) != 0 ? near : vec3_neg(near);
}

static void axes_are_correctly_rounded(void) {
    struct mpfr_vec3 ahead, up, right, new_up;
    vec_init(&ahead);
    vec_init(&up);
    vec_init(&right);
    vec_init(&new_up);
    double worst = 0;
    for (int i = 0; i < AXES_CASES; i++) {
        const struct vec3 ahead_q30 = vec3_normalise(any_direction());
        const struct vec3 up_any = any_up(i, ahead_q30);
        const struct orient_axes axes = orient_axes(ahead_q30, up_any);
        const bool along_x = ahead_q30.y == 0 && ahead_q30.z == 0;
        vec_set(&ahead, ahead_q30);
        if (are_parallel(ahead_q30, up_any)) { // A x (aside x A) is aside made perpendicular to A
            vec_set(&up, along_x ? vec3(0, 1, 0) : vec3(1, 0, 0));
            vec_cross(&new_up, &up, &ahead);
            vec_cross(&right, &ahead, &new_up);
        } else {
            vec_set(&up, up_any);
            vec_cross(&right, &ahead, &up);
            vec_cross(&new_up, &right, &ahead);
        }
        keep_unit_error(&worst, axes.right_q30, &right);
        keep_unit_error(&worst, axes.up_q30, &new_up);
    }
    CHECK(worst <= 0.5);
    check_note("worst error of right and up, 1e-9 ulp", (int64_t)(worst * 1e9));
    vec_clear(&ahead);
    vec_clear(&up);
    vec_clear(&right);
    vec_clear(&new_up);
}

/// Radians to BAM.
static void to_bam(mpfr_t a) {
    mpfr_t pi;
    mpfr_init2(pi, BITS);
    mpfr_const_pi(pi, MPFR_RNDN);
    mpfr_div(a, a, pi, MPFR_RNDN);
    mpfr_mul_2ui(a, a, 31, MPFR_RNDN);
    mpfr_clear(pi);
}

static void pan_and_tilt(void) {
    mpfr_t x, y, z, angle;
    mpfr_inits2(BITS, x, y, z, angle, (mpfr_ptr)0);
    double worst_pan = 0, worst_tilt = 0;
    for (int i = 0; i < ANGLE_CASES; i++) {
        const struct vec3 ahead = vec3_normalise(any_direction());
        const struct orient_angles got = orient_pan_tilt(ahead);
        mpfr_set_si(x, ahead.x, MPFR_RNDN);
        mpfr_set_si(y, ahead.y, MPFR_RNDN);
        mpfr_set_si(z, ahead.z, MPFR_RNDN);
        mpfr_atan2(angle, x, y, MPFR_RNDN);
        to_bam(angle);
        int64_t pan = bam32_signed(got.pan_bam32);
        pan = pan == INT32_MIN && mpfr_sgn(angle) > 0 ? -pan : pan; // the half turn, from the left
        keep_error(&worst_pan, pan, angle);
        mpfr_hypot(x, x, y, MPFR_RNDN);
        mpfr_atan2(angle, z, x, MPFR_RNDN);
        to_bam(angle);
        keep_error(&worst_tilt, bam32_signed(got.tilt_bam32), angle);
    }
    CHECK(worst_pan <= 0.501);
    CHECK(worst_tilt <= 0.501);
    check_note("worst error of pan, 1e-6 BAM", (int64_t)(worst_pan * 1e6));
    check_note("worst error of tilt, 1e-6 BAM", (int64_t)(worst_tilt * 1e6));
    mpfr_clears(x, y, z, angle, (mpfr_ptr)0);
}

/// The error of a Q32.32 number beside what the header allows: 1 unit and 2^-58 of the value.
static void keep_image_error(double *worst, uint64_t got, mpfr_t reference) {
    mpfr_t allowed, error;
    mpfr_inits2(BITS, allowed, error, (mpfr_ptr)0);
    mpfr_mul_2ui(reference, reference, 32, MPFR_RNDN);
    mpfr_set_uj(error, got, MPFR_RNDN);
    mpfr_sub(error, error, reference, MPFR_RNDN);
    mpfr_div_2ui(allowed, reference, 58, MPFR_RNDN);
    mpfr_add_ui(allowed, allowed, 1, MPFR_RNDN);
    mpfr_div(error, error, allowed, MPFR_RNDN);
    mpfr_abs(error, error, MPFR_RNDN);
    const double size = mpfr_get_d(error, MPFR_RNDA);
    *worst = size > *worst ? size : *worst;
    mpfr_clears(allowed, error, (mpfr_ptr)0);
}

/// Half of the angles crowd at 0, 45 and 90 degrees.
static uint32_t any_half_angle(int i) {
    const uint32_t random = (uint32_t)check_random(&seed) % BAM32_QUARTER;
    const uint32_t distance = random >> (check_random(&seed) % 30U);
    switch (i % 8) {
    case 0:
        return distance;
    case 1:
        return BAM32_QUARTER - 1U - distance;
    case 2:
        return BAM32_QUARTER / 2U + distance / 2U;
    case 3:
        return BAM32_QUARTER / 2U - distance / 2U;
    default:
        return random;
    }
}

static void the_picture_of_a_cone(void) {
    mpfr_t angle, value;
    mpfr_inits2(BITS, angle, value, (mpfr_ptr)0);
    double worst_radius = 0, worst_distortion = 0;
    for (int i = 0; i < IMAGE_CASES; i++) {
        const uint32_t bam = any_half_angle(i);
        struct orient_image image = {0, 0};
        CHECK_EQ(orient_image_of_cone(bam32(bam), &image), ORIENT_IMAGE_OK);
        mpfr_const_pi(angle, MPFR_RNDN);
        mpfr_mul_ui(angle, angle, bam, MPFR_RNDN);
        mpfr_div_2ui(angle, angle, 31, MPFR_RNDN);
        mpfr_tan(value, angle, MPFR_RNDN);
        keep_image_error(&worst_radius, image.radius_q32, value);
        mpfr_sec(value, angle, MPFR_RNDN);
        keep_image_error(&worst_distortion, image.distortion_q32, value);
    }
    CHECK(worst_radius <= 1);
    CHECK(worst_distortion <= 1);
    check_note("worst error of the radius, percent of what is stated",
               (int64_t)(worst_radius * 100));
    check_note("worst error of the distortion, percent of what is stated",
               (int64_t)(worst_distortion * 100));
    mpfr_clears(angle, value, (mpfr_ptr)0);
}

int main(void) {
    printf("# seed 0x%016llx\n", (unsigned long long)seed);
    TEST(axes_are_correctly_rounded);
    TEST(pan_and_tilt);
    TEST(the_picture_of_a_cone);
    return check_finish();
}
