/// How the gs_usb driver divides a bit, against a search through every division that there is.
#include "linux/linux_gs_usb.h"

#include "contract/support/contract.h"

#include <stdlib.h>

/// The rates of the protocol's table, and every rate that CANopen names, on the two kinds of cell.
static void timings(void) {
    const struct linux_gs_usb_limits bxcan = {48000000, 1, 16, 1, 8, 4, 1, 1024, 1};
    const struct linux_gs_usb_limits mcan = {80000000, 1, 256, 1, 128, 128, 1, 512, 1};
    const uint32_t table[][2] = {{1000000, 3}, {500000, 6}, {250000, 12}, {125000, 24}};
    struct linux_gs_usb_timing timing;
    for (unsigned i = 0; i < 4U; i++) {
        CHECK(linux_gs_usb_timing(&bxcan, table[i][0], &timing));
        CHECK_EQ(timing.divider, table[i][1]);
        CHECK_EQ(timing.segment1, 13);
        CHECK_EQ(timing.segment2, 2);
    }
    const uint32_t rates[] = {10000, 20000, 50000, 100000, 125000, 250000, 500000, 800000, 1000000};
    for (unsigned i = 0; i < sizeof rates / sizeof *rates; i++) {
        const struct linux_gs_usb_limits *const cells[] = {&bxcan, &mcan};
        for (unsigned k = 0; k < 2U; k++) {
            if (CHECK(linux_gs_usb_timing(cells[k], rates[i], &timing))) {
                const uint64_t quanta = 1U + timing.segment1 + timing.segment2;
                CHECK_EQ(quanta * timing.divider * rates[i], cells[k]->clock_hz);
                CHECK(timing.segment1 <= cells[k]->segment1_max);
                CHECK(timing.segment2 >= 1U && timing.segment2 <= cells[k]->segment2_max);
                CHECK_NEAR((1U + timing.segment1) * 1000U / quanta, 875, 45);
            }
        }
    }
    CHECK(!linux_gs_usb_timing(&bxcan, 0, &timing));
    CHECK(!linux_gs_usb_timing(&bxcan, 20000000, &timing));
    CHECK(!linux_gs_usb_timing(&bxcan, 999, &timing));
    CHECK(!linux_gs_usb_timing(&bxcan, 983000, &timing)); // 1.7 % beside 1000000
    CHECK(!linux_gs_usb_timing(&(struct linux_gs_usb_limits){0}, 1000000, &timing));
}

// ---------------------------------------------------------------- every division

/// A division, and how far off it is, in exact parts: |clock - d * rate * quanta| of d * rate *
/// quanta, and |8 * (1 + segment1) - 7 * quanta| of 8 * quanta from a sample at 7/8.
struct division {
    uint64_t rate_off, rate_of, sample_off, sample_of;
};

static struct division division_of(const struct linux_gs_usb_limits *limits, uint32_t bitrate,
                                   uint32_t divider, uint32_t segment1, uint32_t segment2) {
    const uint64_t quanta = 1U + segment1 + segment2, whole = (uint64_t)divider * bitrate * quanta;
    const int64_t sample = 8 * (1 + (int64_t)segment1) - 7 * (int64_t)quanta;
    return (struct division){.rate_off = limits->clock_hz > whole ? limits->clock_hz - whole
                                                                  : whole - limits->clock_hz,
                             .rate_of = whole,
                             .sample_off = (uint64_t)llabs(sample),
                             .sample_of = 8U * quanta};
}

/// In 1e-9 of the bit rate, and of the bit.
static uint64_t rate_ppb(const struct division *division) {
    return division->rate_off * 1000000000U / division->rate_of;
}
static uint64_t sample_ppb(const struct division *division) {
    return division->sample_off * 1000000000U / division->sample_of;
}

/// What the search finds: the best rate, and the best sample among those that are as good as that
/// of the driver's (errors are told apart by millionths).
static void search(const struct linux_gs_usb_limits *limits, uint32_t bitrate, uint64_t as_good_ppb,
                   uint64_t *best_rate_ppb, uint64_t *best_sample_ppb) {
    *best_rate_ppb = *best_sample_ppb = UINT64_MAX;
    for (uint32_t d = limits->divider_min; d <= limits->divider_max; d += limits->divider_step) {
        for (uint32_t s = limits->segment1_min; s <= limits->segment1_max; s++) {
            for (uint32_t t = limits->segment2_min; t <= limits->segment2_max; t++) {
                const struct division one = division_of(limits, bitrate, d, s, t);
                const uint64_t rate = rate_ppb(&one), sample = sample_ppb(&one);
                *best_rate_ppb = rate < *best_rate_ppb ? rate : *best_rate_ppb;
                if (rate <= as_good_ppb) {
                    *best_sample_ppb = sample < *best_sample_ppb ? sample : *best_sample_ppb;
                }
            }
        }
    }
}

static uint32_t from_to(uint64_t *seed, uint32_t least, uint32_t most) {
    return least + (uint32_t)(check_random(seed) % (most - least + 1U));
}

static void the_best_division(void) {
    static const uint32_t clocks[] = {8, 16, 24, 30, 36, 40, 48, 60, 64, 80, 120, 160};
    static const uint32_t rates[] = {20000,  50000,  83333,  100000, 125000,
                                     250000, 500000, 666666, 800000, 1000000};
    uint64_t seed = UINT64_C(0x71B17);
    uint32_t found = 0, none = 0;
    check_note("seed", (int64_t)seed);
    for (uint32_t i = 0; i < 3000U && check_clean(); i++) {
        struct linux_gs_usb_limits limits = {.clock_hz = 1000000U * clocks[i % 12U]};
        limits.segment1_min = from_to(&seed, 1, 4);
        limits.segment1_max = from_to(&seed, limits.segment1_min, 18);
        limits.segment2_min = from_to(&seed, 1, 3);
        limits.segment2_max = from_to(&seed, limits.segment2_min, 8);
        limits.divider_min = from_to(&seed, 1, 3);
        limits.divider_max = from_to(&seed, limits.divider_min, 60);
        limits.divider_step = from_to(&seed, 1, 3);
        const uint32_t bitrate = rates[from_to(&seed, 0, 9)] + (i % 4U == 3U ? i % 700U : 0U);
        struct linux_gs_usb_timing timing;
        uint64_t best_rate, best_sample;
        const bool has = linux_gs_usb_timing(&limits, bitrate, &timing);
        if (!has) {
            search(&limits, bitrate, 0, &best_rate, &best_sample);
            CHECK(best_rate > 999000U); // 0.1 %
            none++;
            continue;
        }
        CHECK(timing.segment1 >= limits.segment1_min && timing.segment1 <= limits.segment1_max);
        CHECK(timing.segment2 >= limits.segment2_min && timing.segment2 <= limits.segment2_max);
        CHECK(timing.divider >= limits.divider_min && timing.divider <= limits.divider_max &&
              (timing.divider - limits.divider_min) % limits.divider_step == 0U);
        const struct division chosen =
            division_of(&limits, bitrate, timing.divider, timing.segment1, timing.segment2);
        search(&limits, bitrate, rate_ppb(&chosen), &best_rate, &best_sample);
        CHECK(rate_ppb(&chosen) <= 1001000U);
        CHECK(rate_ppb(&chosen) <= best_rate + 2000U);
        CHECK(sample_ppb(&chosen) <= best_sample + 2000000U); // a thousandth of the bit, twice
        found++;
    }
    check_note("divisions found", found);
    check_note("and none that there were", none);
    CHECK(found > 1000U && none > 300U);
}

int main(void) {
    CONTRACT("linux_gs_usb", timings);
    CONTRACT("linux_gs_usb", the_best_division);
    return check_finish();
}
