#include "motion/lens.h"

#include "fixed/trig.h"
#include "fixed/wide.h"
#include "motion/axis.h"

bool lens_valid(const struct lens_config *lens) {
    const uint32_t metre_um = 1000000;
    const int64_t reach = 16 * AXIS_TURN_Q48;
    if (lens->point_count < 2U || lens->point_count > LENS_TABLE_MAX ||
        lens->point[0].focal_um == 0U || lens->sensor_width_um == 0U ||
        lens->sensor_height_um == 0U || lens->sensor_width_um > metre_um ||
        lens->sensor_height_um > metre_um || lens->margin_q16 > 10U << 16) {
        return false;
    }
    if (lens->point[0].position_q48 < -reach ||
        lens->point[lens->point_count - 1U].position_q48 > reach) {
        return false;
    }
    for (uint32_t i = 1; i < lens->point_count; i++) {
        if (lens->point[i].focal_um <= lens->point[i - 1U].focal_um ||
            lens->point[i].position_q48 <= lens->point[i - 1U].position_q48) {
            return false;
        }
    }
    return true;
}

/// At which half of a side, widened by the margin, is seen under the half-angle.
static uint32_t focal_for_side_um(const struct lens_config *lens, uint32_t side_um,
                                  bam32_t half_angle) {
    const uint32_t shortest = lens->point[0].focal_um;
    const uint32_t longest = lens->point[lens->point_count - 1U].focal_um;
    if (half_angle.bam >= BAM32_QUARTER) {
        return shortest;
    }
    // side / 2 = focal * tan(half angle) * (1 + margin), times 2^15; rounded down, to the wide
    // side.
    const struct sincos half = trig_sincos(half_angle);
    const uint64_t opposite = (uint64_t)half.sin_q30 * ((1U << 16) + lens->margin_q16) / 2U;
    const uint64_t adjacent = (uint64_t)half.cos_q30 * side_um << 14; // below 2^30 * 2^20 * 2^14
    if (opposite == 0U || adjacent / opposite >= longest) {
        return longest;
    }
    const uint32_t focal_um = (uint32_t)(adjacent / opposite);
    return focal_um > shortest ? focal_um : shortest;
}

uint32_t lens_focal_um(const struct lens_config *lens, bam32_t half_angle) {
    const bool upright = lens->sensor_width_um < lens->sensor_height_um;
    return focal_for_side_um(lens, upright ? lens->sensor_width_um : lens->sensor_height_um,
                             half_angle);
}

uint32_t lens_focal_of_picture_um(const struct lens_config *lens, bam32_t half_width,
                                  bam32_t half_height) {
    const uint32_t wide_um = focal_for_side_um(lens, lens->sensor_width_um, half_width);
    const uint32_t high_um = focal_for_side_um(lens, lens->sensor_height_um, half_height);
    return wide_um < high_um ? wide_um : high_um;
}

/// rise * part / run, rounded to nearest, half upward. part < run.
static uint64_t interpolate(uint64_t rise, uint64_t part, uint64_t run) {
    uint64_t rest;
    const struct u128 product = u128_add(u128_mul(rise, part), (struct u128){run / 2U, 0});
    return u128_div_u64(product, run, &rest);
}

int64_t lens_position_q48(const struct lens_config *lens, uint32_t focal_um) {
    uint32_t i = 1;
    while (i + 1U < lens->point_count && lens->point[i].focal_um < focal_um) {
        i++;
    }
    const struct lens_point low = lens->point[i - 1U], high = lens->point[i];
    if (focal_um <= low.focal_um) {
        return low.position_q48;
    }
    if (focal_um >= high.focal_um) {
        return high.position_q48;
    }
    return low.position_q48 + (int64_t)interpolate((uint64_t)(high.position_q48 - low.position_q48),
                                                   focal_um - low.focal_um,
                                                   high.focal_um - low.focal_um);
}

uint32_t lens_focal_at_um(const struct lens_config *lens, int64_t position_q48) {
    uint32_t i = 1;
    while (i + 1U < lens->point_count && lens->point[i].position_q48 < position_q48) {
        i++;
    }
    const struct lens_point low = lens->point[i - 1U], high = lens->point[i];
    if (position_q48 <= low.position_q48) {
        return low.focal_um;
    }
    if (position_q48 >= high.position_q48) {
        return high.focal_um;
    }
    return low.focal_um + (uint32_t)interpolate(high.focal_um - low.focal_um,
                                                (uint64_t)(position_q48 - low.position_q48),
                                                (uint64_t)(high.position_q48 - low.position_q48));
}
