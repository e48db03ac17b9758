#include "fixed/trig.h"

#include "fixed/trig_series.h"
#include "fixed/wide.h"

const uint64_t trig_sin_terms[TRIG_TERMS] = {
    UINT64_C(0x6487ED5110B4611A), UINT64_C(0x0A55DE7312DF295F), UINT64_C(0x00519AF19DD6AB87),
    UINT64_C(0x000132D2CCE62BD8), UINT64_C(0x000002A0F0690FDD), UINT64_C(0x00000003C60E9FBD),
    UINT64_C(0x0000000003D1E86A), UINT64_C(0x000000000002DF5B), UINT64_C(0x00000000000001AB),
    UINT64_C(0x0000000000000001)};
const uint64_t trig_cos_terms[TRIG_TERMS] = {
    UINT64_C(0x8000000000000000), UINT64_C(0x277A79937C8BBCB5), UINT64_C(0x020783E1036B5876),
    UINT64_C(0x000AAE9E3F1E5FFD), UINT64_C(0x00001E1F506891BB), UINT64_C(0x00000034DA3E5441),
    UINT64_C(0x000000003F3A7147), UINT64_C(0x000000000036DC4A), UINT64_C(0x0000000000002419),
    UINT64_C(0x0000000000000013)};

uint64_t trig_series(const uint64_t *terms, unsigned count, uint64_t t2) {
    uint64_t sum = terms[count - 1U];
    for (unsigned i = count - 1U; i != 0U; i--) {
        sum = terms[i - 1U] - trig_mul_q63(t2, sum);
    }
    return sum;
}

static q30_t q30_from_q63(uint64_t value) {
    return (q30_t)((value + (UINT64_C(1) << 32)) >> 33);
}

struct trig_octant trig_octant(uint32_t x_bam) {
    const uint64_t t = (uint64_t)x_bam << 34, t2 = trig_mul_q63(t, t);
    return (struct trig_octant){.sin_by_t_q63 = trig_series(trig_sin_terms, 7, t2),
                                .cos_q63 = trig_series(trig_cos_terms, 8, t2)};
}

struct sincos trig_sincos(bam32_t angle) {
    // Octant symmetry: fold to [0, 1/8 turn], then swap and negate.
    const uint32_t quadrant = angle.bam >> 30;
    uint32_t x = angle.bam & (BAM32_QUARTER - 1U);
    const bool upper_octant = x > BAM32_QUARTER / 2U;
    if (upper_octant) {
        x = BAM32_QUARTER - x;
    }
    const struct trig_octant octant = trig_octant(x);
    const q30_t small = q30_from_q63(trig_mul_q63((uint64_t)x << 34, octant.sin_by_t_q63));
    const q30_t large = q30_from_q63(octant.cos_q63);
    const q30_t s = upper_octant ? large : small, c = upper_octant ? small : large;
    switch (quadrant) {
    case 0:
        return (struct sincos){s, c};
    case 1:
        return (struct sincos){c, -s};
    case 2:
        return (struct sincos){-s, -c};
    default:
        return (struct sincos){-c, s};
    }
}

/// atan(k / 64) with 2^64 units a turn.
static const uint64_t atan_table[65] = {
    UINT64_C(0x0000000000000000), UINT64_C(0x00A2F61E5C28262A), UINT64_C(0x0145D7E159046278),
    UINT64_C(0x01E890FCD5255C1A), UINT64_C(0x028B0D430E589AED), UINT64_C(0x032D38B38A738106),
    UINT64_C(0x03CEFF89AC340906), UINT64_C(0x04704E4ADA035582), UINT64_C(0x051111D41DDD9A1B),
    UINT64_C(0x05B137672768F3A0), UINT64_C(0x0650ACB69B4FE3AE), UINT64_C(0x06EF5FF19D399BF0),
    UINT64_C(0x078D3FCE842E72EC), UINT64_C(0x082A3B94ABCD89A5), UINT64_C(0x08C64325576561A1),
    UINT64_C(0x096147039EB78911), UINT64_C(0x09FB385B5EE39E8E), UINT64_C(0x0A9409072C9C755D),
    UINT64_C(0x0B2BAB954758B68A), UINT64_C(0x0BC2134B8F9DB904), UINT64_C(0x0C57342A84C77619),
    UINT64_C(0x0CEB02EF50C4D90E), UINT64_C(0x0D7D7514EA1EFDBA), UINT64_C(0x0E0E80D456487EC6),
    UINT64_C(0x0E9E1D24179D5A77), UINT64_C(0x0F2C41B6D3AB2AFA), UINT64_C(0x0FB8E6F93F4CA68F),
    UINT64_C(0x1044060F5EDBE182), UINT64_C(0x10CD98D1293EE442), UINT64_C(0x115599C69CDCE966),
    UINT64_C(0x11DC042355A3C0DD), UINT64_C(0x1260D3C1B330A904), UINT64_C(0x12E4051D9DF30866),
    UINT64_C(0x1365954EF9BEA97F), UINT64_C(0x13E58203D3C358A8), UINT64_C(0x1463C97A5945F355),
    UINT64_C(0x14E06A7AA3C7DDEE), UINT64_C(0x155B6450668A0849), UINT64_C(0x15D4B6C4888C7725),
    UINT64_C(0x164C6216B556B249), UINT64_C(0x16C266F6EDFC1E3E), UINT64_C(0x1736C67F22F472C7),
    UINT64_C(0x17A9822CDE870C11), UINT64_C(0x181A9BDB06B242E0), UINT64_C(0x188A15BBBCA863E4),
    UINT64_C(0x18F7F2525F34085C), UINT64_C(0x1964346DB496E206), UINT64_C(0x19CEDF223FC198EA),
    UINT64_C(0x1A37F5C4C419EF33), UINT64_C(0x1A9F7BE4FA66874B), UINT64_C(0x1B05754878E5B08C),
    UINT64_C(0x1B69E5E5D00EA1A5), UINT64_C(0x1BCCD1DFDD02723F), UINT64_C(0x1C2E3D815243C04A),
    UINT64_C(0x1C8E2D3876E8E159), UINT64_C(0x1CECA5931C245E37), UINT64_C(0x1D49AB3AC8B1BB50),
    UINT64_C(0x1DA542F11970AA94), UINT64_C(0x1DFF718C563E1741), UINT64_C(0x1E583BF439E868C5),
    UINT64_C(0x1EAFA71EEBF23A7B), UINT64_C(0x1F05B80E2AB3F69E), UINT64_C(0x1F5A73CCA450A08D),
    UINT64_C(0x1FADDF6B7CDC07B6), UINT64_C(0x2000000000000000)};

#define ONE_TURN_PER_RADIAN_Q64 UINT64_C(0x28BE60DB9391054A) // 1 / (2 pi)
#define ONE_THIRD_Q64           UINT64_C(0x5555555555555555)
#define ONE_FIFTH_Q64           UINT64_C(0x3333333333333333)
#define ONE_SEVENTH_Q64         UINT64_C(0x2492492492492492)

/// rise / run, Q64, within 16 units, for rise <= run / 128 and run >= 2^62. Two digits, for which
/// the leading 32 bits of run are divisor enough.
static uint64_t small_quotient_q64(uint64_t rise, uint64_t run) {
    const uint64_t leading = run >> 32, rest = run & UINT32_MAX;
    // rise / run, Q32, a little too small: at most 2^25.
    const uint64_t high = rise / (leading + 1U);
    // Half of what that leaves of rise 2^32: below 2^64.
    const uint64_t left = ((rise - high * leading) << 31) - (high * rest >> 1);
    return (high << 32) + left / (leading >> 1);
}

/// atan(y / x) for 0 <= y <= x, 2^56 <= x < 2^57.
static uint64_t atan_octant(uint64_t y, uint64_t x) {
    // tan(a - b) = (y - m x) / (x + m y) with m = k/64 the tabulated tangent nearest to y/x.
    const uint64_t k = (64U * y + x / 2U) / x;
    const uint64_t scaled_y = 64U * y, near = k * x;
    const uint64_t rise = scaled_y >= near ? scaled_y - near : near - scaled_y;
    const uint64_t run = 64U * x + k * y;             // below 2^64: 128 x
    const uint64_t t = small_quotient_q64(rise, run); // tan of the remainder, at most 1/128
    const uint64_t t2 = u64_mul_high_near(t, t);
    uint64_t series = ONE_FIFTH_Q64 - u64_mul_high_near(t2, ONE_SEVENTH_Q64);
    series = ONE_THIRD_Q64 - u64_mul_high_near(t2, series);
    const uint64_t radians = t - u64_mul_high_near(t, u64_mul_high_near(t2, series));
    const uint64_t turns = u64_mul_high_near(radians, ONE_TURN_PER_RADIAN_Q64);
    return scaled_y >= near ? atan_table[k] + turns : atan_table[k] - turns;
}

uint64_t trig_atan2_turn64(uint64_t y, uint64_t x) {
    const uint64_t larger = x > y ? x : y;
    if (larger == 0U) {
        return 0;
    }
    // Bring the larger one to 57 bits; dropping bits of both moves the angle by less than 2^-55
    // rad.
    const unsigned zeros = u64_leading_zeros(larger);
    if (zeros > 7U) {
        x <<= zeros - 7U;
        y <<= zeros - 7U;
    } else {
        x >>= 7U - zeros;
        y >>= 7U - zeros;
    }
    return y <= x ? atan_octant(y, x) : (UINT64_C(1) << 62) - atan_octant(x, y);
}

bam32_t trig_atan2(int64_t y, int64_t x) {
    uint64_t turn = trig_atan2_turn64(u64_abs(y), u64_abs(x));
    if (x < 0) {
        turn = (UINT64_C(1) << 63) - turn;
    }
    const uint32_t bam = (uint32_t)((turn + (UINT64_C(1) << 31)) >> 32);
    return bam32(y < 0 ? 0U - bam : bam);
}
