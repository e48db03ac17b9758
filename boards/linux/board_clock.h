/// What time is it on the board? Offsets between its clock and ours, with an error that holds.
///
/// Each question that is answered gives two bounds: the board read its clock after the question was
/// sent and before the answer came. All questions together give the best of the lower and the best
/// of the upper bounds, which widen by as much as two clocks may drift apart. The truth lies
/// between, however unequal and irregular the delays of the two ways are; the middle is the
/// estimate, half the width its error. At 115,200 baud that is 1.8 ms: 12 bytes there and 28 back
/// take 3.5 ms. Shown: tests/scenario/test_board_clock.c.
#ifndef LINUX_BOARD_CLOCK_H
#define LINUX_BOARD_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/// How fast two crystals may drift apart; a good one is within 50 parts in a million.
#define BOARD_CLOCK_DRIFT_PPM 200

struct board_clock {
    uint32_t answers, restarts;
    uint64_t at_us;          ///< our time of the last answer, for which the bounds hold
    int64_t low_us, high_us; ///< of board time less ours
};

void board_clock_init(struct board_clock *clock);

/// An answer: sent and received at our times, read by the board at its time. Bounds that exclude
/// each other mean another clock (the board restarted): it begins anew with this answer.
void board_clock_take(struct board_clock *clock, uint64_t sent_us, uint64_t received_us,
                      uint64_t board_us);

/// False: not known yet. Board time at our time, and by how much it may be off.
bool board_clock_read(const struct board_clock *clock, uint64_t now_us, uint64_t *board_us,
                      uint64_t *error_us);

#endif
