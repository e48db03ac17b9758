/// What a scene looks like without the things that move in it.
///
/// Every pixel has a background (brightness, how much it wavers, for how long it was seen) and a
/// candidate: what is there instead, and for how long. A candidate that stays as long as the
/// background was seen, at most `absorb_s`, becomes the background: what stands still fades in, and
/// a place that something left is soon known again. Shifts of the whole picture's brightness are
/// taken out first.
#ifndef DETECT_BACKGROUND_H
#define DETECT_BACKGROUND_H

#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdint.h>

struct background_settings {
    uint8_t contrast_min; ///< grey levels by which a foreground pixel differs at least
    double absorb_s;      ///< what stands still for so long is background
    double learn_s;       ///< time constant of slow changes
};

struct background_pixel {
    uint16_t mean_q6, wavers_q6; ///< grey levels; mean of the absolute difference
    uint16_t other_q6;           ///< the candidate's mean
    uint16_t age_cs, other_cs;   ///< seen for, hundredths of a second; age 0: not known yet
};

struct background {
    uint32_t width_px, height_px;
    struct background_pixel *pixel;
    uint8_t *low, *high; ///< least and most of the background around each pixel
    uint8_t *scratch;
    double learned_s;
};

bool background_create(struct background *background, uint32_t width_px,
                       uint32_t height_px) MUST_CHECK;
void background_destroy(struct background *background);

/// Everything is unknown again.
void background_forget(struct background *background);

/// A picture of that size, elapsed_s after the one before. known[i] 0: that pixel shows nothing
/// (NULL: all do). Sets mask[i] to 0 for background, else to by how many grey levels the pixel
/// differs. near: a pixel that one of its eight neighbours' background explains is background, too,
/// for cameras that move or shake.
/// Returns: the share of foreground pixels among those known.
/// Shown: tests/scenario/test_background.c.
double background_take(struct background *background, const struct background_settings *settings,
                       const uint8_t *picture, const uint8_t *known, double elapsed_s, bool near,
                       uint8_t *mask);

/// Moves the background: pixel i is what was at source[i] (negative: nothing known).
bool background_move(struct background *background, const int32_t *source) MUST_CHECK;

#endif
