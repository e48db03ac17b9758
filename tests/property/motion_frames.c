/// Moving objects in rendered sequences: how many are found, how many are none, whether ids stay,
/// and how fast; with a camera that stands and with one that turns.
///
/// People-like outlines walk before a rough background, each with a brightness of its own, some of
/// them hardly different from what is behind them; noise, blur, and light that changes slowly. An
/// object counts in every frame in which it is wholly in the picture, not hidden by another one,
/// and has moved for a second. It is found when a detection's box overlaps its own by 30 % of both
/// together (the usual measure of detectors is 50 % for boxes drawn by hand).
#include "check.h"

#include "detect/detector.h"
#include "property/support/frames.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PEOPLE = 5, FRAME_US = 66667, CELLS = 8 };

#define DEGREE (3.14159265358979323846 / 180.0)

static struct frames frames;
static uint8_t clothes[PEOPLE][CELLS];

/// Walks to and fro at a distance, on an arc around the camera.
static struct person {
    double distance_m, height_m, start_deg, speed_dps, swing_deg;
} people[PEOPLE];

static double bearing_deg(const struct person *person, double time_s) {
    // A triangle wave: steady speed, turning at the ends.
    const double way = person->start_deg + person->speed_dps * time_s;
    const double lap = 4.0 * person->swing_deg;
    const double at = way - lap * floor(way / lap);
    return fabs(at - 2.0 * person->swing_deg) - person->swing_deg;
}

static void make_people(void) {
    for (unsigned i = 0; i < PEOPLE; i++) {
        people[i] = (struct person){.distance_m = 9.0 + 2.5 * i,
                                    .height_m = frames_any(&frames, 1.6, 1.9),
                                    .start_deg = frames_any(&frames, 0.0, 100.0),
                                    .speed_dps = frames_any(&frames, 3.0, 7.0),
                                    .swing_deg = 24.0};
        for (unsigned k = 0; k < CELLS; k++) {
            const bool bright = frames_any(&frames, 0.0, 1.0) > 0.5;
            clothes[i][k] =
                (uint8_t)(bright ? frames_any(&frames, 170, 230) : frames_any(&frames, 20, 70));
        }
    }
}

static struct render_object object_of(unsigned i, double time_s) {
    const struct person *person = &people[i];
    const double b = bearing_deg(person, time_s) * DEGREE;
    return (struct render_object){
        .shape = RENDER_PLATE,
        .centre_m = {person->distance_m * sin(b), person->distance_m * cos(b), 0.3 * i - 0.8},
        .right_m = {0.25 * cos(b), -0.25 * sin(b), 0.0},
        .up_m = {0.0, 0.0, 0.5 * person->height_m},
        .texture = clothes[i],
        .columns = 2,
        .rows = CELLS / 2};
}

// ---------------------------------------------------------------- truth

struct box {
    double edge[4]; ///< left, top, right, bottom
    double distance_m;
    bool whole;
};

static struct box box_of(const struct render_object *object, const struct camera_view *view) {
    struct box box = {
        {1e9, 1e9, -1e9, -1e9}, hypot(object->centre_m[0], object->centre_m[1]), true};
    for (unsigned i = 0; i < 4U; i++) {
        double at[3], camera[3], pixel[2];
        for (unsigned k = 0; k < 3U; k++) {
            at[k] = object->centre_m[k] + (i & 1U ? 1.0 : -1.0) * object->right_m[k] +
                    (i & 2U ? 1.0 : -1.0) * object->up_m[k];
        }
        for (unsigned k = 0; k < 3U; k++) {
            const double *axis = k == 0U ? view->right : k == 1U ? view->ahead : view->up;
            camera[k] = axis[0] * at[0] + axis[1] * at[1] + axis[2] * at[2];
        }
        if (camera[1] < 0.1) {
            box.whole = false;
            return box;
        }
        frames_project(&frames, camera, pixel);
        for (unsigned k = 0; k < 2U; k++) {
            box.edge[k] = fmin(box.edge[k], pixel[k]);
            box.edge[k + 2U] = fmax(box.edge[k + 2U], pixel[k]);
        }
    }
    box.whole = box.edge[0] > 4 && box.edge[1] > 4 && box.edge[2] < FRAMES_WIDTH - 5 &&
                box.edge[3] < FRAMES_HEIGHT - 5;
    return box;
}

static double area_of(const double edge[4]) {
    return fmax(0.0, edge[2] - edge[0]) * fmax(0.0, edge[3] - edge[1]);
}

static double common(const double a[4], const double b[4]) {
    const double both[4] = {fmax(a[0], b[0]), fmax(a[1], b[1]), fmin(a[2], b[2]), fmin(a[3], b[3])};
    return area_of(both);
}

static double overlap(const double a[4], const double b[4]) {
    const double both = common(a, b);
    return both / (area_of(a) + area_of(b) - both);
}

// ---------------------------------------------------------------- score

static struct score {
    uint32_t shown, found, told, wrong, frames, ids;
    double squares, cpu_s;
    uint32_t id_of[PEOPLE];
} score;

static bool hidden(const struct box *boxes, unsigned which) {
    for (unsigned i = 0; i < PEOPLE; i++) {
        // Also objects that touch: they are one piece of foreground.
        double wide[4] = {boxes[i].edge[0] - 8, boxes[i].edge[1] - 8, boxes[i].edge[2] + 8,
                          boxes[i].edge[3] + 8};
        if (i != which && common(wide, boxes[which].edge) > 0.0) {
            return true;
        }
    }
    return false;
}

static void count_frame(const struct detections *found, const struct box *boxes) {
    for (unsigned k = 0; k < PEOPLE; k++) {
        if (!boxes[k].whole || hidden(boxes, k)) {
            continue;
        }
        score.shown++;
        for (uint32_t i = 0; i < found->count; i++) {
            const struct detection *item = &found->item[i];
            if (overlap(item->box_px, boxes[k].edge) >= 0.3) {
                score.found++;
                score.ids += score.id_of[k] != item->id;
                score.id_of[k] = item->id;
                const double du = item->pixel[0] - 0.5 * (boxes[k].edge[0] + boxes[k].edge[2]);
                const double dv = item->pixel[1] - 0.5 * (boxes[k].edge[1] + boxes[k].edge[3]);
                score.squares += du * du + dv * dv;
                break;
            }
        }
    }
    for (uint32_t i = 0; i < found->count; i++) {
        bool some = false;
        for (unsigned k = 0; k < PEOPLE; k++) {
            some = some || common(found->item[i].box_px, boxes[k].edge) > 0.0;
        }
        score.told++;
        score.wrong += !some;
    }
}

/// turn_dps: the camera pans to and fro at this speed.
static void measure(const char *name, uint32_t frame_count, double turn_dps) {
    static const struct render_backdrop rough = {9, 110.0, 60.0, 6.0};
    struct detector_settings settings = {0};
    CHECK(detector_settings_read(&settings, "motion", 6) == NULL);
    struct detector *detector = detector_create(&settings, FRAMES_WIDTH, FRAMES_HEIGHT);
    struct detector_sight sight;
    struct camera_model model = frames_model(&frames);
    CHECK(detector != NULL && camera_model_check(&model) == NULL);
    memset(&score, 0, sizeof score);
    make_people();
    for (uint32_t n = 0; n < frames_many(frame_count) && detector != NULL; n++) {
        const double time_s = n * FRAME_US * 1e-6;
        const double pan = turn_dps * (fabs(fmod(time_s, 4.0) - 2.0) - 1.0) * DEGREE;
        sight.model = turn_dps != 0.0 ? &model : NULL;
        sight.view = (struct camera_view){
            {cos(pan), -sin(pan), 0.0}, {sin(pan), cos(pan), 0.0}, {0.0, 0.0, 1.0}};
        const struct render_sensor webcam = {0.8, 4.0, 1.0 + 0.05 * sin(time_s)};
        struct render_object objects[PEOPLE];
        struct box boxes[PEOPLE];
        for (unsigned i = 0; i < PEOPLE; i++) {
            objects[i] = object_of(i, time_s);
            boxes[i] = box_of(&objects[i], &sight.view);
        }
        const struct hal_camera_luma frame =
            frames_draw_from(&frames, &sight.view, &rough, objects, PEOPLE, &webcam);
        static struct detections found;
        const double start_s = frames_cpu_s();
        detector_frame(detector, &frame, n * FRAME_US, &sight, &found);
        score.cpu_s += frames_cpu_s() - start_s;
        score.frames++;
        if (n >= 20U) {
            count_frame(&found, boxes);
        }
    }
    detector_destroy(detector);
    printf("MEASURED motion, %s: %u of %u found (%.1f %%), %u of %u told are none, middles %.1f px "
           "rms, %.1f ids a person, %.0f frames a second\n",
           name, score.found, score.shown, 100.0 * score.found / score.shown, score.wrong,
           score.told, sqrt(score.squares / score.found), (double)score.ids / PEOPLE,
           score.frames / score.cpu_s);
    CHECK(score.shown > 100U);
    CHECK(score.found >= 0.85 * score.shown);
    CHECK(score.wrong <= 0.05 * score.told);
}

static void a_camera_that_stands(void) {
    measure("fixed camera", 220, 0.0);
}

static void a_camera_that_turns(void) {
    measure("camera panning at 8 degrees a second", 90, 8.0);
}

int main(void) {
    if (!frames_open(&frames, 560.0, true, 15)) {
        return 1;
    }
    TEST(a_camera_that_stands);
    if (frames_many(10) == 10U) {
        TEST(a_camera_that_turns);
    }
    frames_close(&frames);
    return check_finish();
}
