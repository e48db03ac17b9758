/// The background: what is learned, what stands out, what fades in, and what a shift of brightness
/// or of the picture does.
#include "check.h"

#include "detect/background.h"

#include <string.h>

enum { WIDTH = 40, HEIGHT = 30, PIXELS = WIDTH * HEIGHT };

static const struct background_settings settings = {18, 15.0, 4.0};
static struct background background;
static uint8_t picture[PIXELS], mask[PIXELS], rough[PIXELS];
static uint64_t seed = UINT64_C(0xBAC4);

/// A rough scene, brighter by `more`, with noise of -3 to 3.
static void scene(int more) {
    for (int i = 0; i < PIXELS; i++) {
        picture[i] = (uint8_t)(rough[i] + more + (int)(check_random(&seed) % 7U) - 3);
    }
}

static void square(int u, int v, int side, uint8_t luma) {
    for (int y = v; y < v + side; y++) {
        memset(picture + y * WIDTH + u, luma, (size_t)side);
    }
}

static double take(bool near) {
    return background_take(&background, &settings, picture, NULL, 0.1, near, mask);
}

static unsigned marked(int u, int v, int side) {
    unsigned count = 0;
    for (int y = v; y < v + side; y++) {
        for (int x = u; x < u + side; x++) {
            count += mask[y * WIDTH + x] != 0U;
        }
    }
    return count;
}

static void learn(unsigned frames) {
    background_forget(&background);
    for (unsigned i = 0; i < frames; i++) {
        scene(0);
        (void)take(false);
    }
}

static void noise_is_background_and_a_thing_is_not(void) {
    learn(20);
    scene(0);
    CHECK(take(false) == 0.0);
    scene(0);
    square(10, 10, 6, 220);
    const double share = take(false);
    CHECK_EQ(marked(10, 10, 6), 36);
    CHECK(share == 36.0 / PIXELS);
    CHECK(mask[12 * WIDTH + 12] >= 18U);
}

static void a_shift_of_brightness_is_none(void) {
    learn(20);
    for (int more = 0; more <= 60; more += 12) {
        scene(more);
        square(20, 5, 5, 255);
        CHECK(take(false) <= 26.0 / PIXELS);
        CHECK(marked(20, 5, 5) == 25U);
    }
}

/// Seen for 2 s: what covers it is taken for the background after 2 s more; seen for long,
/// after 15.
static void what_stays_fades_in(void) {
    static const struct { unsigned learned, stays; } rounds[] = {{20, 20}, {300, 150}};
    for (unsigned k = 0; k < 2U; k++) {
        learn(rounds[k].learned);
        unsigned frames = 0;
        do {
            scene(0);
            square(10, 10, 6, 220);
            (void)take(false);
            frames++;
        } while (marked(10, 10, 6) > 0U && frames < 400U);
        CHECK_NEAR(frames, rounds[k].stays, 3);
        // Where it was is foreground when it leaves, until the place is known again.
        scene(0);
        (void)take(false);
        CHECK_EQ(marked(10, 10, 6), 36);
    }
}

/// A picture that is off by a pixel is explained by the neighbours, a thing is not.
static void neighbours_explain_a_shift(void) {
    learn(20);
    scene(0);
    memmove(picture + 1, picture, PIXELS - 1);
    const double without = take(false);
    learn(20);
    scene(0);
    memmove(picture + 1, picture, PIXELS - 1);
    square(30, 20, 4, 255);
    const double with = take(true);
    CHECK(without > 0.2);
    CHECK(with < 0.045); // the square, and the column that came in at the left edge
    CHECK(marked(30, 20, 4) == 16U);
}

static void the_background_moves_along(void) {
    static int32_t source[PIXELS];
    learn(20);
    for (int i = 0; i < PIXELS; i++) {
        source[i] = i % WIDTH + 5 < WIDTH ? i + 5 : -1; // the camera turned right by 5 pixels
    }
    CHECK(background_move(&background, source));
    scene(0);
    for (int v = 0; v < HEIGHT; v++) {
        memmove(picture + v * WIDTH, picture + v * WIDTH + 5, WIDTH - 5);
    }
    CHECK(take(false) == 0.0); // what came in at the right edge is learned at once
}

static void unknown_pixels_are_left_alone(void) {
    static uint8_t known[PIXELS];
    learn(20);
    memset(known, 1, sizeof known);
    scene(0);
    square(10, 10, 6, 220);
    for (int y = 10; y < 16; y++) {
        memset(known + y * WIDTH + 10, 0, 6);
    }
    CHECK(background_take(&background, &settings, picture, known, 0.1, false, mask) == 0.0);
}

int main(void) {
    if (!background_create(&background, WIDTH, HEIGHT)) {
        return 1;
    }
    for (int i = 0; i < PIXELS; i++) {
        rough[i] = (uint8_t)(80U + check_random(&seed) % 90U);
    }
    TEST(noise_is_background_and_a_thing_is_not);
    TEST(a_shift_of_brightness_is_none);
    TEST(what_stays_fades_in);
    TEST(neighbours_explain_a_shift);
    TEST(the_background_moves_along);
    TEST(unknown_pixels_are_left_alone);
    background_destroy(&background);
    return check_finish();
}
