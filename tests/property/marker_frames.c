/// Bright markers in rendered frames: how many are found, how exactly, and how fast.
///
/// Lamps from 6.2 px of diameter (30 pixels of area) and from 30 px up, through a lens with
/// distortion, blurred and noisy, before a rough background with bright patches that are none.
#include "check.h"

#include "detect/markers.h"
#include "property/support/frames.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PER_FRAME = 12 };

static struct frames frames;

static struct score {
    uint32_t shown, found, wrong, frames;
    double squares, worst, bias[2], cpu_s, confidence_least;
} score;

/// A lamp in one of twelve cells of the picture.
static struct render_object place_lamp(uint32_t which, double diameter_px, uint8_t luma) {
    const double depth = frames_any(&frames, 2.0, 6.0);
    const double pixel[2] = {80.0 + 160.0 * (which % 4U) + frames_any(&frames, -40, 40),
                             80.0 + 160.0 * (which / 4U) + frames_any(&frames, -40, 40)};
    double ray[3];
    frames_ray(&frames, pixel, ray);
    const double distance = depth * sqrt(ray[0] * ray[0] + 1.0 + ray[2] * ray[2]);
    return (struct render_object){.shape = RENDER_BALL,
                                  .centre_m = {ray[0] * depth, depth, ray[2] * depth},
                                  .radius_m = 0.5 * diameter_px / frames.focal_px * distance,
                                  .luma = luma};
}

static void count_frame(const struct markers_work *work, const struct render_object *objects) {
    bool taken[MARKERS_MAX] = {false};
    for (uint32_t k = 0; k < PER_FRAME; k++) {
        double truth[2];
        frames_project(&frames, objects[k].centre_m, truth);
        score.shown++;
        for (uint32_t i = 0; i < work->count; i++) {
            const double du = work->item[i].pixel[0] - truth[0];
            const double dv = work->item[i].pixel[1] - truth[1];
            if (taken[i] || hypot(du, dv) > 3.0) {
                continue;
            }
            taken[i] = true;
            score.found++;
            score.squares += du * du + dv * dv;
            score.bias[0] += du;
            score.bias[1] += dv;
            score.worst = fmax(score.worst, hypot(du, dv));
            score.confidence_least = fmin(score.confidence_least, work->item[i].confidence);
            break;
        }
    }
    for (uint32_t i = 0; i < work->count; i++) {
        score.wrong += !taken[i];
    }
}

static void measure(uint32_t frame_count, double low, double high, uint8_t luma_least,
                    const struct render_backdrop *backdrop, const struct render_sensor *sensor) {
    static struct markers_work work;
    const struct markers_settings settings = markers_defaults(FRAMES_HEIGHT);
    if (!CHECK(markers_create(&work))) {
        return;
    }
    score = (struct score){.confidence_least = 1.0};
    for (uint32_t n = 0; n < frames_many(frame_count); n++) {
        struct render_object objects[PER_FRAME];
        for (uint32_t k = 0; k < PER_FRAME; k++) {
            objects[k] = place_lamp(k, frames_any(&frames, low, high),
                                    (uint8_t)frames_any(&frames, luma_least, 256.0));
        }
        const struct hal_camera_luma frame =
            frames_draw(&frames, backdrop, objects, PER_FRAME, sensor);
        const double start_s = frames_cpu_s();
        markers_find(&work, &settings, &frame);
        score.cpu_s += frames_cpu_s() - start_s;
        score.frames++;
        count_frame(&work, objects);
    }
    markers_destroy(&work);
    printf("MEASURED lamps of %.1f to %.1f px: %u of %u found, %u wrong, %.3f px rms, worst %.2f, "
           "bias %+.3f %+.3f, confidence from %.2f, %.0f frames a second\n",
           low, high, score.found, score.shown, score.wrong, sqrt(score.squares / score.found),
           score.worst, score.bias[0] / score.found, score.bias[1] / score.found,
           score.confidence_least, score.frames / score.cpu_s);
    CHECK(score.found >= 0.99 * score.shown);
    CHECK(score.found > 0U && sqrt(score.squares / score.found) <= 0.3);
    CHECK(score.wrong <= 0.01 * score.shown);
}

static const struct render_backdrop rough = {5, 90.0, 60.0, 5.0};
static const struct render_backdrop dark = {6, 20.0, 10.0, 5.0};
static const struct render_sensor webcam = {1.0, 4.0, 1.0};
static const struct render_sensor sharp = {0.4, 2.0, 1.0};

static void lamps_of_30_pixels_of_area(void) {
    measure(30, 6.2, 8.0, 225, &rough, &webcam);
}

static void lamps_of_30_pixels_of_width(void) {
    measure(20, 30.0, 70.0, 225, &rough, &webcam);
}

static void lamps_of_all_brightnesses_in_the_dark(void) {
    measure(30, 6.2, 40.0, 110, &dark, &sharp);
}

/// A page of light, a bar, a ring and a corner are bright, but no markers.
static void other_bright_things(void) {
    static struct markers_work work;
    const struct markers_settings settings = markers_defaults(FRAMES_HEIGHT);
    const uint8_t ring[25] = {240, 240, 240, 240, 240, 240, 0,   0,   0,   240, 240, 0,  0,
                              0,   240, 240, 0,   0,   0,   240, 240, 240, 240, 240, 240};
    const uint8_t corner[4] = {240, 0, 240, 240};
    const struct render_object objects[] = {
        {RENDER_PLATE, {-0.7, 2, 0.2}, {0.3, 0, 0}, {0, 0, 0.45}, 0.0, 240, NULL, 0, 0},
        {RENDER_PLATE, {0.2, 2, 0.5}, {0.2, 0, 0}, {0, 0, 0.02}, 0.0, 240, NULL, 0, 0},
        {RENDER_PLATE, {0.2, 2, 0.0}, {0.1, 0, 0}, {0, 0, 0.1}, 0.0, 0, ring, 5, 5},
        {RENDER_PLATE, {0.2, 2, -0.4}, {0.1, 0, 0}, {0, 0, 0.1}, 0.0, 0, corner, 2, 2},
        {RENDER_BALL, {0.7, 2, 0.0}, {0}, {0}, 0.05, 240, NULL, 0, 0}};
    CHECK(markers_create(&work));
    const struct hal_camera_luma frame = frames_draw(&frames, &rough, objects, 5, &webcam);
    markers_find(&work, &settings, &frame);
    double truth[2];
    frames_project(&frames, objects[4].centre_m, truth);
    CHECK_EQ(work.count, 1);
    CHECK(hypot(work.item[0].pixel[0] - truth[0], work.item[0].pixel[1] - truth[1]) < 0.3);
    markers_destroy(&work);
}

int main(void) {
    if (!frames_open(&frames, 560.0, true, 12)) {
        return 1;
    }
    TEST(lamps_of_30_pixels_of_area);
    TEST(lamps_of_30_pixels_of_width);
    TEST(lamps_of_all_brightnesses_in_the_dark);
    TEST(other_bright_things);
    frames_close(&frames);
    return check_finish();
}
