#include "board_clock.h"

void board_clock_init(struct board_clock *clock) {
    *clock = (struct board_clock){.answers = 0};
}

/// Rounded up: the bounds hold.
static int64_t drift_us(const struct board_clock *clock, uint64_t now_us) {
    const uint64_t age_us = now_us >= clock->at_us ? now_us - clock->at_us : clock->at_us - now_us;
    return (int64_t)((age_us * BOARD_CLOCK_DRIFT_PPM + 999999U) / 1000000U);
}

void board_clock_take(struct board_clock *clock, uint64_t sent_us, uint64_t received_us,
                      uint64_t board_us) {
    const int64_t low_us = (int64_t)(board_us - received_us);
    const int64_t high_us = (int64_t)(board_us - sent_us) + 1; // its clock shows whole microseconds
    const int64_t drift = drift_us(clock, received_us);
    const bool fits = clock->answers != 0U && clock->low_us - drift <= high_us &&
                      clock->high_us + drift >= low_us;
    clock->restarts += clock->answers != 0U && !fits;
    if (fits) {
        clock->low_us = clock->low_us - drift > low_us ? clock->low_us - drift : low_us;
        clock->high_us = clock->high_us + drift < high_us ? clock->high_us + drift : high_us;
    } else {
        clock->low_us = low_us;
        clock->high_us = high_us;
    }
    clock->at_us = received_us;
    clock->answers++;
}

bool board_clock_read(const struct board_clock *clock, uint64_t now_us, uint64_t *board_us,
                      uint64_t *error_us) {
    if (clock->answers == 0U) {
        return false;
    }
    const int64_t drift = drift_us(clock, now_us);
    const int64_t width = clock->high_us - clock->low_us;
    *board_us = now_us + (uint64_t)(clock->low_us + width / 2);
    *error_us = (uint64_t)((width + 1) / 2 + drift);
    return true;
}
