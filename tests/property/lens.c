/// Focal lengths of random cones and lenses against long double: how exact, and that the cone fits
/// the picture.
#include "check.h"

#include "motion/lens.h"

#include <math.h>

static const long double radian_per_bam = 6.283185307179586476925286766559005768L / 4294967296.0L;
static uint64_t seed = UINT64_C(0x5EED0004);

static struct lens_config any_lens(void) {
    struct lens_config lens = {.point = {{1, 0}, {UINT32_MAX, 1000}}, .point_count = 2};
    lens.sensor_width_um = 1U + (uint32_t)(check_random(&seed) % 1000000U);
    lens.sensor_height_um = 1U + (uint32_t)(check_random(&seed) % 1000000U);
    lens.margin_q16 = (uint32_t)(check_random(&seed) % ((10U << 16) + 1U));
    return lens;
}

static void focal_lengths_are_as_exact_as_they_say(void) {
    check_note("seed", (int64_t)seed);
    long double most = 0.0L;
    for (int i = 0; i < 400000 && check_clean(); i++) {
        const struct lens_config lens = any_lens();
        const unsigned shift = 34U + (unsigned)(check_random(&seed) % 30U);
        uint32_t bam = (uint32_t)(check_random(&seed) >> shift);
        if (check_random(&seed) % 4U == 0U) {
            bam = BAM32_QUARTER - bam;
        }
        if (bam == 0U || bam >= BAM32_QUARTER) {
            continue;
        }
        const long double half = bam * radian_per_bam;
        const long double side = lens.sensor_width_um < lens.sensor_height_um
                                     ? lens.sensor_width_um
                                     : lens.sensor_height_um;
        const long double wanted =
            side / 2.0L / tanl(half) / (1.0L + (long double)lens.margin_q16 / 65536.0L);
        const long double got = lens_focal_um(&lens, bam32(bam));
        if (wanted < 1.0L || wanted >= 4294967295.0L) {
            CHECK(wanted < 1.0L ? got == 1.0L : got > 4294967295.0L * (1.0L - 1.0L / bam));
            continue;
        }
        const long double relative = 0x1p-29L / sinl(2.0L * half);
        CHECK(fabsl(got - wanted) <= 1.0L + wanted * relative);
        most = fmaxl(most, (fabsl(got - wanted) - 1.0L) / (wanted * relative));
    }
    check_note("error beyond 1 um, in 1/1000 of what is allowed, most", (int64_t)(most * 1000.0L));
}

/// A picture's focal length is the shorter one of those that a cone of each half-angle needs on a
/// square sensor of that side.
static void pictures_hold_both_sides(void) {
    for (int i = 0; i < 100000 && check_clean(); i++) {
        struct lens_config lens = any_lens(), square = lens;
        const bam32_t wide = bam32((uint32_t)(check_random(&seed) >> 34)),
                      high = bam32((uint32_t)(check_random(&seed) >> 34));
        square.sensor_width_um = lens.sensor_height_um;
        const uint32_t by_height = lens_focal_um(&square, high);
        square.sensor_width_um = square.sensor_height_um = lens.sensor_width_um;
        const uint32_t by_width = lens_focal_um(&square, wide);
        CHECK_EQ(lens_focal_of_picture_um(&lens, wide, high),
                 by_width < by_height ? by_width : by_height);
    }
}

int main(void) {
    TEST(focal_lengths_are_as_exact_as_they_say);
    TEST(pictures_hold_both_sides);
    return check_finish();
}
