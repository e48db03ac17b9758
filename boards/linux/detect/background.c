#include "detect/background.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { Q6 = 64, AGE_CS_MAX = 60000 };

bool background_create(struct background *background, uint32_t width_px, uint32_t height_px) {
    const size_t pixels = (size_t)width_px * height_px;
    *background = (struct background){.width_px = width_px,
                                      .height_px = height_px,
                                      .pixel = calloc(pixels, sizeof *background->pixel),
                                      .low = malloc(pixels),
                                      .high = malloc(pixels),
                                      .scratch = malloc(pixels)};
    return background->pixel != NULL && background->low != NULL && background->high != NULL &&
           background->scratch != NULL;
}

void background_destroy(struct background *background) {
    free(background->pixel);
    free(background->low);
    free(background->high);
    free(background->scratch);
    memset(background, 0, sizeof *background);
}

void background_forget(struct background *background) {
    const size_t pixels = (size_t)background->width_px * background->height_px;
    memset(background->pixel, 0, pixels * sizeof *background->pixel);
    background->learned_s = 0.0;
}

// ---------------------------------------------------------------- the whole picture

/// By how much the picture as a whole is brighter than the background: the median difference of
/// every fifth pixel.
static int brighter(const struct background *background, const uint8_t *picture,
                    const uint8_t *known) {
    uint32_t histogram[511] = {0}, count = 0;
    const size_t pixels = (size_t)background->width_px * background->height_px;
    for (size_t i = 0; i < pixels; i += 5U) {
        const struct background_pixel *pixel = &background->pixel[i];
        if (pixel->age_cs > 0U && (known == NULL || known[i] != 0U)) {
            histogram[255 + picture[i] - pixel->mean_q6 / Q6]++;
            count++;
        }
    }
    uint32_t below = 0;
    for (int i = 0; i < 511 && count > 0U; i++) {
        below += histogram[i];
        if (2U * below >= count) {
            return i - 255;
        }
    }
    return 0;
}

/// The least and the most of each pixel's background and its neighbours'.
static void find_ranges(struct background *background) {
    const uint32_t width = background->width_px, height = background->height_px;
    const size_t pixels = (size_t)width * height;
    uint8_t *mean = background->scratch;
    for (size_t i = 0; i < pixels; i++) {
        mean[i] = (uint8_t)(background->pixel[i].mean_q6 / Q6);
    }
    for (uint32_t v = 0; v < height; v++) {
        const uint32_t above = v > 0U ? v - 1U : v, below = v + 1U < height ? v + 1U : v;
        for (uint32_t u = 0; u < width; u++) {
            const uint32_t left = u > 0U ? u - 1U : u, right = u + 1U < width ? u + 1U : u;
            uint8_t low = 255, high = 0;
            for (uint32_t y = above; y <= below; y++) {
                for (uint32_t x = left; x <= right; x++) {
                    const uint8_t at = mean[(size_t)y * width + x];
                    low = at < low ? at : low;
                    high = at > high ? at : high;
                }
            }
            background->low[(size_t)v * width + u] = low;
            background->high[(size_t)v * width + u] = high;
        }
    }
}

// ---------------------------------------------------------------- a pixel

static uint16_t toward(uint16_t from, int to, int rate_q16) {
    const int step = (to - from) * rate_q16;
    return (uint16_t)(from + (step + (step < 0 ? -32767 : 32767)) / 65536);
}

struct pace {
    int rate_q16;       ///< of slow changes, this frame
    uint16_t step_cs;   ///< time since the last frame
    uint16_t absorb_cs; ///< the oldest a background counts
};

static void settle(struct background_pixel *pixel, int luma_q6, int off_q6,
                   const struct pace *pace) {
    // A young background is the mean of what was seen so far.
    const int young_q16 = (int)(65536U * pace->step_cs / ((uint32_t)pixel->age_cs + pace->step_cs));
    const int rate_q16 = young_q16 > pace->rate_q16 ? young_q16 : pace->rate_q16;
    pixel->mean_q6 = toward(pixel->mean_q6, luma_q6, rate_q16);
    pixel->wavers_q6 = toward(pixel->wavers_q6, off_q6, rate_q16);
    const uint32_t age_cs = (uint32_t)pixel->age_cs + pace->step_cs;
    pixel->age_cs = (uint16_t)(age_cs > pace->absorb_cs ? pace->absorb_cs : age_cs);
    pixel->other_cs =
        (uint16_t)(pixel->other_cs > 2U * pace->step_cs ? pixel->other_cs - 2U * pace->step_cs : 0);
}

static void doubt(struct background_pixel *pixel, int luma_q6, int least_q6,
                  const struct pace *pace) {
    if (pixel->other_cs > 0U && abs(luma_q6 - pixel->other_q6) < least_q6) {
        pixel->other_q6 = toward(pixel->other_q6, luma_q6, 65536 / 8);
        pixel->other_cs = (uint16_t)(pixel->other_cs + pace->step_cs);
    } else {
        pixel->other_q6 = (uint16_t)luma_q6;
        pixel->other_cs = pace->step_cs;
    }
    if (pixel->other_cs > pixel->age_cs) {
        pixel->mean_q6 = pixel->other_q6;
        pixel->wavers_q6 = 2 * Q6;
        pixel->age_cs = pixel->other_cs;
        pixel->other_cs = 0;
    }
}

/// How far the pixel is from what its neighbours' background explains.
static int off_range(const struct background *background, size_t i, int luma) {
    const int low = background->low[i], high = background->high[i];
    return luma < low ? low - luma : luma > high ? luma - high : 0;
}

double background_take(struct background *background, const struct background_settings *settings,
                       const uint8_t *picture, const uint8_t *known, double elapsed_s, bool near,
                       uint8_t *mask) {
    const size_t pixels = (size_t)background->width_px * background->height_px;
    const int shift = brighter(background, picture, known);
    if (near) {
        find_ranges(background);
    }
    const double step_cs = fmin(fmax(round(elapsed_s * 100.0), 1.0), 1000.0);
    const double absorb_cs = fmin(settings->absorb_s * 100.0, AGE_CS_MAX - 1000.0);
    const struct pace pace = {(int)(65536.0 * fmin(1.0, elapsed_s / settings->learn_s)),
                              (uint16_t)step_cs, (uint16_t)absorb_cs};
    size_t shown = 0, foreground = 0;
    for (size_t i = 0; i < pixels; i++) {
        struct background_pixel *pixel = &background->pixel[i];
        mask[i] = 0;
        if (known != NULL && known[i] == 0U) {
            continue;
        }
        int luma = picture[i] - shift;
        luma = luma < 0 ? 0 : luma > 255 ? 255 : luma;
        const int luma_q6 = luma * Q6;
        shown++;
        if (pixel->age_cs == 0U) {
            *pixel = (struct background_pixel){
                .mean_q6 = (uint16_t)luma_q6, .wavers_q6 = 2 * Q6, .age_cs = pace.step_cs};
            continue;
        }
        const int off_q6 = abs(luma_q6 - pixel->mean_q6);
        const int wavers = 4 * pixel->wavers_q6 > 40 * Q6 ? 40 * Q6 : 4 * pixel->wavers_q6;
        const int least_q6 =
            settings->contrast_min * Q6 > wavers ? settings->contrast_min * Q6 : wavers;
        if (off_q6 < least_q6) {
            settle(pixel, luma_q6, off_q6, &pace);
        } else if (near && off_range(background, i, luma) * Q6 < least_q6) {
            // Its neighbour's: says nothing about its own.
            pixel->other_cs = 0;
        } else {
            mask[i] = (uint8_t)(off_q6 / Q6);
            foreground++;
            doubt(pixel, luma_q6, least_q6, &pace);
        }
    }
    background->learned_s += elapsed_s;
    return shown == 0U ? 0.0 : (double)foreground / (double)shown;
}

bool background_move(struct background *background, const int32_t *source) {
    const size_t pixels = (size_t)background->width_px * background->height_px;
    struct background_pixel *moved = calloc(pixels, sizeof *moved);
    if (moved == NULL) {
        return false;
    }
    for (size_t i = 0; i < pixels; i++) {
        if (source[i] >= 0) {
            moved[i] = background->pixel[source[i]];
        }
    }
    free(background->pixel);
    background->pixel = moved;
    return true;
}
