#include "linux/linux_gs_usb.h"

/// How far the bit rate may be off, in millionths: CAN takes 1 % with both ends off.
#define ERROR_MAX_PPM  1000U
#define SAMPLE_BEST_PM 875U ///< per mille of the bit

static uint32_t apart(uint64_t a, uint64_t b) {
    const uint64_t difference = a > b ? a - b : b - a;
    return difference > UINT32_MAX ? UINT32_MAX : (uint32_t)difference;
}

static uint32_t between(uint32_t value, uint32_t least, uint32_t most) {
    return value < least ? least : value > most ? most : value;
}

bool linux_gs_usb_timing(const struct linux_gs_usb_limits *limits, uint32_t bitrate,
                         struct linux_gs_usb_timing *timing) {
    uint64_t best = UINT64_MAX;
    const uint32_t step = limits->divider_step == 0U ? 1U : limits->divider_step;
    const uint32_t most = limits->divider_max > 65536U ? 65536U : limits->divider_max;
    for (uint32_t divider = limits->divider_min; bitrate > 0U && divider <= most; divider += step) {
        const uint64_t quantum = (uint64_t)divider * bitrate;
        const uint64_t quanta = quantum == 0U ? 0U : (limits->clock_hz + quantum / 2U) / quantum;
        if (quanta < 1U + limits->segment1_min + limits->segment2_min ||
            quanta > 1U + (uint64_t)limits->segment1_max + limits->segment2_max) {
            continue;
        }
        const uint32_t count = (uint32_t)quanta;
        // The nearest to an eighth; the smaller one of two.
        uint32_t segment2 = between((count + 3U) / 8U, limits->segment2_min, limits->segment2_max);
        const uint32_t segment1 =
            between(count - 1U - segment2, limits->segment1_min, limits->segment1_max);
        segment2 = count - 1U - segment1;
        if (segment2 < limits->segment2_min || segment2 > limits->segment2_max) {
            continue;
        }
        const uint32_t error_ppm =
            apart((uint64_t)limits->clock_hz * 1000000U / (quanta * quantum), 1000000U);
        const uint32_t sample_pm = (1U + segment1) * 1000U / count;
        const uint64_t score = (uint64_t)error_ppm << 32 | apart(sample_pm, SAMPLE_BEST_PM);
        if (error_ppm <= ERROR_MAX_PPM && score < best) {
            best = score;
            *timing = (struct linux_gs_usb_timing){segment1, segment2, divider};
        }
    }
    return best != UINT64_MAX;
}
