/// Axes along which no two points have the same coordinate, with much room: a search, as no exact
/// method is known. For the files of regular/ only.
#ifndef REGULAR_TURN_H
#define REGULAR_TURN_H

#include "regular/regular.h"

/// Replaces result->rotation (by compute) by one with a larger tolerance, if it finds one, and sets
/// the tolerance. Random rotations, then ever smaller steps from the best: always the same ones.
/// Cost:      TURN_TRIALS times the pairs of points.
/// Accuracy:  the tolerance holds; nothing is claimed about a better one.
void turn_search(const struct regular_input *input, struct regular_result *result);
#define TURN_TRIALS 400U

#endif
