/// The background: what is learned, what stands out, what fades in, and what a shift of brightness
/// or of the picture does.
#include "check.h"

#include "detect/background.h"

#include <math.h>
#include <stdlib.h>
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

/// One bright pixel in an even picture, learned; it moves by a pixel or two, at a border or not.
static void neighbours_explain_one_pixel(void) {
    static const int spots[][2] = {
        {0, 0},  {WIDTH - 1, 0}, {0, HEIGHT - 1}, {WIDTH - 1, HEIGHT - 1}, {20, 15},
        {0, 15}, {20, 0},        {WIDTH - 1, 15}, {20, HEIGHT - 1}};
    for (unsigned i = 0; i < sizeof spots / sizeof *spots; i++) {
        for (int by = 0; by < 25; by++) {
            const int right = by % 5 - 2, down = by / 5 - 2;
            const int u = spots[i][0] + right, v = spots[i][1] + down;
            if (u < 0 || u >= WIDTH || v < 0 || v >= HEIGHT) {
                continue;
            }
            background_forget(&background);
            for (int frame = 0; frame < 5; frame++) {
                memset(picture, 100, sizeof picture);
                square(spots[i][0], spots[i][1], 1, 200);
                CHECK(take(true) == 0.0);
            }
            memset(picture, 100, sizeof picture);
            square(u, v, 1, 200);
            const bool far = abs(right) == 2 || abs(down) == 2;
            CHECK(take(true) == (far ? 1.0 / PIXELS : 0.0));
            CHECK_EQ(mask[v * WIDTH + u] != 0U, far);
        }
    }
}

/// The other end of the line above or below is no neighbour.
static void ends_of_lines_are_no_neighbours(void) {
    static const int pairs[][4] = {{0, 15, WIDTH - 1, 14}, {WIDTH - 1, 14, 0, 15},
                                   {0, 15, WIDTH - 1, 15}, {20, 0, 20, HEIGHT - 1},
                                   {0, 15, WIDTH - 1, 13}, {WIDTH - 1, 14, 0, 16}};
    for (unsigned i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        background_forget(&background);
        for (int frame = 0; frame < 5; frame++) {
            memset(picture, 100, sizeof picture);
            square(pairs[i][0], pairs[i][1], 1, 200);
            (void)take(true);
        }
        memset(picture, 100, sizeof picture);
        square(pairs[i][2], pairs[i][3], 1, 200);
        CHECK(take(true) == 1.0 / PIXELS);
    }
}

/// Seen ten times, the background is the mean of what was seen: 100 once and 110 nine times.
static void a_young_background_is_the_mean(void) {
    static const struct {
        uint8_t luma;
        bool thing;
    } cases[] = {{125, false}, {129, true}, {93, false}, {89, true}};
    for (unsigned i = 0; i < 4U; i++) {
        background_forget(&background);
        for (int frame = 0; frame < 10; frame++) {
            memset(picture, 60, sizeof picture);
            square(5, 5, 6, frame == 0 ? 100 : 110);
            CHECK(take(false) == 0.0);
        }
        square(5, 5, 6, cases[i].luma);
        (void)take(false);
        CHECK_EQ(marked(5, 5, 6), cases[i].thing ? 36 : 0);
    }
}

/// Once off by nearly as much as is allowed, and a place is as sensitive as before.
static void one_jolt_is_no_wavering(void) {
    background_forget(&background);
    for (int frame = 0; frame < 100; frame++) {
        memset(picture, 100, sizeof picture);
        square(5, 5, 6, frame == 99 ? 117 : 100);
        CHECK(take(false) == 0.0);
    }
    square(5, 5, 6, 135);
    (void)take(false);
    CHECK_EQ(marked(5, 5, 6), 36);
}

/// What is black stays black when all else gets brighter, and what is white stays white.
static void black_and_white_do_not_shift(void) {
    for (int more = -60; more <= 60; more += 120) {
        background_forget(&background);
        memset(picture, 120, sizeof picture);
        square(3, 3, 5, more > 0 ? 4 : 251);
        for (int frame = 0; frame < 10; frame++) {
            (void)take(false);
        }
        memset(picture, 120 + more, sizeof picture);
        square(3, 3, 5, more > 0 ? 4 : 251);
        CHECK(take(false) == 0.0);
    }
}

/// Pixels that show nothing have no say in how bright the picture is.
static void unknown_pixels_are_not_asked(void) {
    static uint8_t known[PIXELS];
    learn(20);
    scene(0);
    for (int i = 0; i < PIXELS; i++) {
        known[i] = i % 3 == 0;
        picture[i] = (uint8_t)(picture[i] + (known[i] != 0U ? 0 : 70));
    }
    CHECK(background_take(&background, &settings, picture, known, 0.1, false, mask) == 0.0);
}

/// A place that wavers, at last by 16 up and down, has to differ by more than one that is still.
static void what_wavers_is_less_sensitive(void) {
    background_forget(&background);
    for (int frame = 0; frame < 400; frame++) {
        const int waver = frame < 260 ? 3 + frame / 20 : 16;
        memset(picture, 100, sizeof picture);
        square(5, 5, 6, (uint8_t)(frame % 2 == 0 ? 100 - waver : 100 + waver));
        CHECK(take(false) == 0.0);
    }
    memset(picture, 100, sizeof picture);
    square(5, 5, 6, 135);
    square(20, 5, 6, 135);
    (void)take(false);
    CHECK_EQ(marked(5, 5, 6), 0);
    CHECK_EQ(marked(20, 5, 6), 36);
    square(5, 5, 6, 150); // but there is an end to it
    square(20, 5, 6, 150);
    (void)take(false);
    CHECK_EQ(marked(5, 5, 6), 36);
    // At rest again, it becomes as sensitive as the rest.
    for (int frame = 0; frame < 400; frame++) {
        memset(picture, 100, sizeof picture);
        (void)take(false);
    }
    square(5, 5, 6, 135);
    (void)take(false);
    CHECK_EQ(marked(5, 5, 6), 36);
}

/// A shadow that moves slowly, up or down by 100 in 100 s, is never more than background.
static void slow_changes_are_followed(void) {
    for (int way = -1; way <= 1; way += 2) {
        background_forget(&background);
        for (int frame = 0; frame <= 1000; frame++) {
            memset(picture, 128, sizeof picture);
            square(5, 5, 9, (uint8_t)(128 + way * frame / 10));
            CHECK(take(false) == 0.0);
        }
        // And that is what it is then.
        memset(picture, 128, sizeof picture);
        (void)take(false);
        CHECK_EQ(marked(5, 5, 9), 81);
    }
}

/// What comes and goes is foreground whenever it is there, for as long as that goes on.
static void what_flickers_never_fades_in(void) {
    learn(20);
    for (int frame = 0; frame < 600; frame++) {
        scene(0);
        if (frame % 12 < 4) {
            square(10, 10, 6, 220);
        }
        (void)take(false);
        CHECK_EQ(marked(10, 10, 6), frame % 12 < 4 ? 36 : 0);
    }
}

/// Known afterwards is what was known before, from the first pixel to the last.
static void what_moved_is_still_known(void) {
    static int32_t source[PIXELS];
    for (int by = -5; by <= 5; by += 10) {
        background_forget(&background);
        memset(picture, 100, sizeof picture);
        for (int frame = 0; frame < 10; frame++) {
            (void)take(false);
        }
        for (int i = 0; i < PIXELS; i++) {
            source[i] = i + by >= 0 && i + by < PIXELS ? i + by : -1;
        }
        CHECK(background_move(&background, source));
        for (int u = 0; u < 10; u++) { // things at both ends
            picture[u] = picture[PIXELS - 1 - u] = 200;
        }
        (void)take(false);
        for (int i = 0; i < PIXELS; i++) {
            const bool thing = i < 10 || i >= PIXELS - 10;
            CHECK_EQ(mask[i], thing && source[i] >= 0 ? 100 : 0);
        }
    }
}

static void the_time_it_has_learned_for(void) {
    learn(20);
    CHECK(fabs(background.learned_s - 2.0) < 1e-9);
    background_forget(&background);
    CHECK(background.learned_s == 0.0);
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
    TEST(neighbours_explain_one_pixel);
    TEST(ends_of_lines_are_no_neighbours);
    TEST(a_young_background_is_the_mean);
    TEST(one_jolt_is_no_wavering);
    TEST(black_and_white_do_not_shift);
    TEST(unknown_pixels_are_not_asked);
    TEST(what_wavers_is_less_sensitive);
    TEST(slow_changes_are_followed);
    TEST(what_flickers_never_fades_in);
    TEST(what_moved_is_still_known);
    TEST(the_time_it_has_learned_for);
    background_destroy(&background);
    return check_finish();
}
