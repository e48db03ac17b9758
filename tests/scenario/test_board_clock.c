/// boards/linux/board_clock: two clocks that drift, over a line with delays of every kind. The
/// stated error must hold at any time, and be no larger than the shortest delays and the drift
/// explain.
#include "check.h"

#include "board_clock.h"

#include <stdlib.h>

/// A board whose clock runs at its own speed, on a line with delays.
struct line {
    int64_t drift_ppm;
    uint64_t start_us;           ///< board time at our time 0
    uint32_t there_us, back_us;  ///< shortest delays
    uint32_t jitter_us;          ///< added to each, evenly distributed
    uint32_t spike_us, spike_in; ///< one in so many is late by this
    bool ticks;                  ///< the board looks at its line once a millisecond
    uint64_t seed;
};

static uint64_t board_time(const struct line *line, uint64_t us) {
    return line->start_us + us + (uint64_t)((int64_t)us / 1000000 * line->drift_ppm) +
           (uint64_t)((int64_t)(us % 1000000U) * line->drift_ppm / 1000000);
}

static uint64_t delay(struct line *line, uint32_t shortest_us) {
    uint64_t us = shortest_us;
    us += line->jitter_us != 0U ? check_random(&line->seed) % line->jitter_us : 0U;
    if (line->spike_in != 0U && check_random(&line->seed) % line->spike_in == 0U) {
        us += line->spike_us;
    }
    return us;
}

/// Answers ten times a second for a minute. Returns the largest error that was stated after the
/// first two seconds.
static uint64_t run(struct line line, uint64_t *worst_us) {
    struct board_clock clock;
    uint64_t stated_us = 0;
    *worst_us = 0;
    board_clock_init(&clock);
    for (uint64_t now_us = 1000; now_us < 60000000U; now_us += 100000U) {
        uint64_t read_us = now_us + delay(&line, line.there_us);
        read_us = line.ticks ? (read_us + 999U) / 1000U * 1000U : read_us;
        const uint64_t received_us = read_us + delay(&line, line.back_us);
        board_clock_take(&clock, now_us, received_us, board_time(&line, read_us));
        for (uint64_t later_us = 0; later_us < 100000U; later_us += 9973U) {
            uint64_t guess_us, error_us;
            const uint64_t at_us = received_us + later_us;
            CHECK(board_clock_read(&clock, at_us, &guess_us, &error_us));
            const int64_t off_us = (int64_t)(guess_us - board_time(&line, at_us));
            const uint64_t size_us = (uint64_t)llabs(off_us);
            if (!CHECK(size_us <= error_us)) {
                check_note("seed", (int64_t)line.seed);
                return 0;
            }
            *worst_us = size_us > *worst_us ? size_us : *worst_us;
            if (now_us > 2000000U && error_us > stated_us) {
                stated_us = error_us;
            }
        }
    }
    CHECK_EQ(clock.restarts, 0);
    return stated_us;
}

static void a_quiet_line(void) {
    uint64_t worst_us;
    const struct line line = {.there_us = 1040, .back_us = 2430, .seed = 1};
    const uint64_t stated_us = run(line, &worst_us);
    check_note("115200 baud without jitter: stated error, us", (int64_t)stated_us);
    check_note("true error, us", (int64_t)worst_us);
    CHECK(stated_us <= (1040U + 2430U) / 2U + 25U);
    CHECK_NEAR(worst_us, (2430 - 1040) / 2, 25); // half of what one way is longer than the other
}

static void jitter_and_ticks(void) {
    uint64_t worst_us;
    const struct line line = {.there_us = 1040,
                              .back_us = 2430,
                              .jitter_us = 1000,
                              .ticks = true,
                              .spike_us = 50000,
                              .spike_in = 10,
                              .seed = 2};
    const uint64_t stated_us = run(line, &worst_us);
    check_note("with ticks, jitter of 1 ms, and every tenth late by 50 ms: stated, us",
               (int64_t)stated_us);
    check_note("true, us", (int64_t)worst_us);
    CHECK(stated_us <= 2600U);
}

static void drift_both_ways(void) {
    for (int64_t ppm = -200; ppm <= 200; ppm += 100) {
        uint64_t worst_us;
        const struct line line = {.drift_ppm = ppm,
                                  .start_us = 123456789,
                                  .there_us = 100,
                                  .back_us = 100,
                                  .jitter_us = 3000,
                                  .seed = 3};
        CHECK(run(line, &worst_us) <= 1600U);
    }
}

static void any_line(void) {
    uint64_t state = 2026;
    check_note("seed", (int64_t)state);
    for (unsigned i = 0; i < 200U; i++) {
        uint64_t worst_us;
        const uint64_t random = check_random(&state);
        const struct line line = {.drift_ppm = (int64_t)(random % 381U) - 190,
                                  .start_us = check_random(&state) >> 20,
                                  .there_us = (uint32_t)(random >> 10) % 20000U,
                                  .back_us = (uint32_t)(random >> 25) % 20000U,
                                  .jitter_us = (uint32_t)(random >> 40) % 30000U,
                                  .spike_us = 300000,
                                  .spike_in = (uint32_t)(random >> 60),
                                  .ticks = (random >> 59 & 1U) != 0U,
                                  .seed = random | 1U};
        (void)run(line, &worst_us);
        if (!check_clean()) {
            return;
        }
    }
}

/// A board that starts again has another clock: after one answer the error holds for that one.
static void another_clock(void) {
    struct board_clock clock;
    uint64_t board_us, error_us;
    board_clock_init(&clock);
    CHECK(!board_clock_read(&clock, 5, &board_us, &error_us));
    board_clock_take(&clock, 1000, 3000, 90002000);
    board_clock_take(&clock, 101000, 103000, 90102000);
    CHECK(clock.restarts == 0U && board_clock_read(&clock, 200000, &board_us, &error_us));
    CHECK(board_us + error_us >= 90200000U && board_us <= 90200000U + error_us);
    board_clock_take(&clock, 201000, 203000, 500);
    CHECK(clock.restarts == 1U && board_clock_read(&clock, 202000, &board_us, &error_us));
    CHECK(board_us + error_us >= 500U && board_us <= 500U + error_us && error_us <= 1002U);
}

int main(void) {
    TEST(a_quiet_line);
    TEST(jitter_and_ticks);
    TEST(drift_both_ways);
    TEST(any_line);
    TEST(another_clock);
    return check_finish();
}
