/// firmware/motion/lens: the table and its inverse. Focal lengths of random cones against long
/// double: tests/property/lens.c.
#include "check.h"

#include "motion/lens.h"

#define TURN (INT64_C(1) << 48)

static uint64_t seed = UINT64_C(0x1E45);

/// 4 to 48 mm over the whole travel, 6 x 4 mm, 10 % of margin.
static struct lens_config zoom_lens(void) {
    return (struct lens_config){.point = {{4000, 0}, {8000, TURN / 4}, {48000, TURN}},
                                .point_count = 3,
                                .sensor_width_um = 6000,
                                .sensor_height_um = 4000,
                                .margin_q16 = 6554};
}

static void tables_that_are_usable(void) {
    struct lens_config lens = zoom_lens();
    CHECK(lens_valid(&lens));
    lens.point_count = 2;
    CHECK(lens_valid(&lens));
    lens.margin_q16 = 10U << 16;
    CHECK(lens_valid(&lens));
    lens.sensor_width_um = lens.sensor_height_um = 1;
    CHECK(lens_valid(&lens));
    lens.sensor_width_um = lens.sensor_height_um = 1000000;
    CHECK(lens_valid(&lens));
    lens.point[0] = (struct lens_point){1, -16 * TURN};
    lens.point[1] = (struct lens_point){UINT32_MAX, 16 * TURN};
    CHECK(lens_valid(&lens));
    lens.point[0] = (struct lens_point){1, 0}; // as close as can be
    lens.point[1] = (struct lens_point){2, 1};
    CHECK(lens_valid(&lens));
    for (uint32_t i = 0; i < LENS_TABLE_MAX; i++) {
        lens.point[i] = (struct lens_point){i + 1U, (int64_t)i * 1000 - 5000};
    }
    lens.point_count = LENS_TABLE_MAX;
    CHECK(lens_valid(&lens));
}

static bool valid_with(struct lens_config lens, uint32_t i, uint32_t focal, int64_t position) {
    lens.point[i] = (struct lens_point){focal, position};
    return lens_valid(&lens);
}

static void tables_that_are_not(void) {
    struct lens_config lens = zoom_lens();
    CHECK(!valid_with(lens, 0, 0, 0));
    CHECK(!valid_with(lens, 1, 4000, TURN / 4));
    CHECK(!valid_with(lens, 1, 48000, TURN / 4));
    CHECK(!valid_with(lens, 1, 8000, 0));
    CHECK(!valid_with(lens, 1, 8000, TURN));
    CHECK(!valid_with(lens, 2, 7000, TURN));
    CHECK(!valid_with(lens, 0, 4000, -16 * TURN - 1)); // differences must not overflow
    CHECK(!valid_with(lens, 0, 4000, INT64_MIN));
    CHECK(!valid_with(lens, 2, 48000, 16 * TURN + 1));
    CHECK(!valid_with(lens, 2, 48000, INT64_MAX));
    const uint32_t counts[] = {0, 1, LENS_TABLE_MAX + 1U, UINT32_MAX};
    for (unsigned i = 0; i < 4U; i++) {
        lens = zoom_lens();
        lens.point_count = counts[i];
        CHECK(!lens_valid(&lens));
    }
    const uint32_t sides[] = {0, 1000001, UINT32_MAX};
    for (unsigned i = 0; i < 3U; i++) {
        lens = zoom_lens();
        lens.sensor_width_um = sides[i];
        CHECK(!lens_valid(&lens));
        lens = zoom_lens();
        lens.sensor_height_um = sides[i];
        CHECK(!lens_valid(&lens));
    }
    lens = zoom_lens();
    lens.margin_q16 = (10U << 16) + 1U;
    CHECK(!lens_valid(&lens));
}

static void focal_length_of_a_cone(void) {
    struct lens_config lens = zoom_lens();
    lens.margin_q16 = 0;
    const bam32_t atan_quarter = bam32(167458907); // 14.036 degrees
    CHECK_NEAR(lens_focal_um(&lens, atan_quarter), 8000, 1);
    lens.sensor_width_um = 3000; // now the width is the short side
    CHECK_NEAR(lens_focal_um(&lens, atan_quarter), 6000, 1);
    lens.sensor_width_um = 6000;
    lens.margin_q16 = 1U << 16; // the picture is twice as wide as the cone
    CHECK_NEAR(lens_focal_um(&lens, atan_quarter), 4000, 1);
    CHECK(lens_focal_um(&lens, bam32(atan_quarter.bam - 1000000U)) > 4000);
}

static void focal_lengths_are_clamped(void) {
    struct lens_config lens = zoom_lens();
    CHECK_EQ(lens_focal_um(&lens, bam32(0)), 48000);
    CHECK_EQ(lens_focal_um(&lens, bam32(1)), 48000);
    CHECK_EQ(lens_focal_um(&lens, bam32(BAM32_QUARTER - 1U)), 4000);
    CHECK_EQ(lens_focal_um(&lens, bam32(BAM32_QUARTER)), 4000);
    CHECK_EQ(lens_focal_um(&lens, bam32(BAM32_HALF)), 4000);
    CHECK_EQ(lens_focal_um(&lens, bam32(UINT32_MAX)), 4000);
    lens.point[2].focal_um = UINT32_MAX;
    CHECK_EQ(lens_focal_um(&lens, bam32(0)), UINT32_MAX);
    lens.sensor_width_um = lens.sensor_height_um = 1000000;
    lens.margin_q16 = 0;
    // 0.5 m / 2 pi 2^-32 is 342,000 km.
    CHECK_EQ(lens_focal_um(&lens, bam32(1)), UINT32_MAX);
    lens.point[0].focal_um = 3999;
    CHECK_NEAR(lens_focal_um(&lens, bam32(BAM32_QUARTER / 2U)), 500000, 1);
}

/// The wider the cone, the shorter the focal length, and the position follows.
static void wider_cones_never_zoom_in(void) {
    const struct lens_config lens = zoom_lens();
    uint32_t last = UINT32_MAX;
    int64_t last_position = INT64_MAX;
    for (uint32_t bam = 0; bam < BAM32_QUARTER + 4000000U && check_clean(); bam += 3999971U) {
        const uint32_t focal = lens_focal_um(&lens, bam32(bam));
        const int64_t position = lens_position_q48(&lens, focal);
        CHECK(focal <= last && position <= last_position);
        CHECK(focal >= 4000U && focal <= 48000U);
        last = focal;
        last_position = position;
    }
}

static void positions_between_the_points(void) {
    const struct lens_config lens = zoom_lens();
    CHECK_EQ(lens_position_q48(&lens, 0), 0);
    CHECK_EQ(lens_position_q48(&lens, 4000), 0);
    CHECK_EQ(lens_position_q48(&lens, 6000), TURN / 8);
    CHECK_EQ(lens_position_q48(&lens, 8000), TURN / 4);
    CHECK_EQ(lens_position_q48(&lens, 18000), TURN / 4 + TURN / 4 * 3 / 4);
    CHECK_EQ(lens_position_q48(&lens, 48000), TURN);
    CHECK_EQ(lens_position_q48(&lens, UINT32_MAX), TURN);
    // Rounded to nearest: TURN / 4000 is 70368744177.664, three quarters of TURN / 40000
    // 5277655813.3.
    CHECK_EQ(lens_position_q48(&lens, 4001), INT64_C(17592186044));
    CHECK_EQ(lens_position_q48(&lens, 4002), INT64_C(35184372089));
    CHECK_EQ(lens_position_q48(&lens, 8001), TURN / 4 + INT64_C(5277655813));

    CHECK_EQ(lens_focal_at_um(&lens, INT64_MIN), 4000);
    CHECK_EQ(lens_focal_at_um(&lens, 0), 4000);
    CHECK_EQ(lens_focal_at_um(&lens, TURN / 8), 6000);
    CHECK_EQ(lens_focal_at_um(&lens, TURN / 4), 8000);
    CHECK_EQ(lens_focal_at_um(&lens, TURN), 48000);
    CHECK_EQ(lens_focal_at_um(&lens, INT64_MAX), 48000);
    CHECK_EQ(lens_focal_at_um(&lens, INT64_C(17592186044) / 2 - 10), 4000);
    CHECK_EQ(lens_focal_at_um(&lens, INT64_C(17592186044) / 2 + 10), 4001);
}

/// Points so close that few positions lie between them.
static void steep_tables(void) {
    const struct lens_config lens = {
        .point = {{1, 0}, {11, 3}, {4000000000U, 1003}, {4000000001U, 2000}}, .point_count = 4};
    CHECK_EQ(lens_position_q48(&lens, 5), 1);
    CHECK_EQ(lens_position_q48(&lens, 6), 2); // half a step: upward
    CHECK_EQ(lens_focal_at_um(&lens, 1), 4);
    CHECK_EQ(lens_focal_at_um(&lens, 2), 8);
    CHECK_EQ(lens_focal_at_um(&lens, 503), 2000000006);
    CHECK_EQ(lens_position_q48(&lens, 2000000006), 503);
    CHECK_EQ(lens_focal_at_um(&lens, 1501), 4000000000U);
    CHECK_EQ(lens_focal_at_um(&lens, 1502), 4000000001U);
}

/// A random table with at least two positions for every micrometre.
static struct lens_config any_table(void) {
    struct lens_config lens = {.point_count = 2U + (uint32_t)(check_random(&seed) % 15U)};
    int64_t position = -16 * TURN + (int64_t)(check_random(&seed) >> 12);
    uint32_t focal = 1U + (uint32_t)(check_random(&seed) >> 40);
    const unsigned wide = (unsigned)(check_random(&seed) % 28U);
    for (uint32_t i = 0; i < lens.point_count; i++) {
        lens.point[i] = (struct lens_point){focal, position};
        const uint32_t step = 1U + (uint32_t)(check_random(&seed) >> (36U + wide));
        focal += step;
        position += 2 * (int64_t)step + (int64_t)(check_random(&seed) >> 16) / 2;
    }
    lens.sensor_width_um = lens.sensor_height_um = 5000;
    return lens;
}

static void the_inverse_is_exact(void) {
    check_note("seed", (int64_t)seed);
    int64_t tables = 0;
    for (int i = 0; i < 3000 && check_clean(); i++) {
        const struct lens_config lens = any_table();
        if (!lens_valid(&lens)) {
            continue; // ran out of travel
        }
        tables++;
        const uint32_t least = lens.point[0].focal_um,
                       most = lens.point[lens.point_count - 1U].focal_um;
        for (int k = 0; k < 10; k++) {
            const uint32_t focal = least + (uint32_t)(check_random(&seed) % (most - least + 1U));
            const int64_t position = lens_position_q48(&lens, focal);
            CHECK_EQ(lens_focal_at_um(&lens, position), focal);
            CHECK(focal == least || lens_position_q48(&lens, focal - 1U) < position);
        }
        for (uint32_t k = 0; k < lens.point_count; k++) {
            CHECK_EQ(lens_position_q48(&lens, lens.point[k].focal_um), lens.point[k].position_q48);
            CHECK_EQ(lens_focal_at_um(&lens, lens.point[k].position_q48), lens.point[k].focal_um);
        }
    }
    check_note("tables", tables);
    CHECK(tables > 1000);
}

int main(void) {
    TEST(tables_that_are_usable);
    TEST(tables_that_are_not);
    TEST(focal_length_of_a_cone);
    TEST(focal_lengths_are_clamped);
    TEST(wider_cones_never_zoom_in);
    TEST(positions_between_the_points);
    TEST(steep_tables);
    TEST(the_inverse_is_exact);
    return check_finish();
}
