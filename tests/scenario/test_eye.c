/// Frames of a lamp in a known direction, seen from a gimbal that turns: the updates that come out
/// point at the lamp, not at where the pixel would be by now.
#include "check.h"

#include "detect/eye.h"
#include "property/support/frames.h"

#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180.0)

static struct frames frames;
static const struct render_backdrop even = {1, 60.0, 10.0, 10.0};
static const struct render_sensor webcam = {0.8, 2.0, 1.0};

static const struct hal_camera_format grey = {.pixels = HAL_CAMERA_GREY,
                                              .width_px = FRAMES_WIDTH,
                                              .height_px = FRAMES_HEIGHT,
                                              .stride_bytes = FRAMES_WIDTH,
                                              .frame_bytes_max = FRAMES_WIDTH * FRAMES_HEIGHT};

static struct eye *open_eye(int32_t latency_us) {
    struct eye_settings settings = {.model = frames_model(&frames), .latency_us = latency_us};
    CHECK(camera_model_check(&settings.model) == NULL);
    mount_init(&settings.mount, (struct mount_attitude){bam32(0), bam32(0), bam32(0)});
    CHECK(detector_settings_read(&settings.detectors, "markers", 7) == NULL);
    return eye_create(&settings);
}

/// The lamp is level, so many degrees to the right of north; the camera looks pan_deg to the right
/// and tilt_deg up.
static void draw_lamp(double lamp_deg, double pan_deg, double tilt_deg) {
    const double p = pan_deg * DEGREE, t = tilt_deg * DEGREE;
    const struct render_view view = {{cos(p), -sin(p), 0.0},
                                     {sin(p) * cos(t), cos(p) * cos(t), sin(t)},
                                     {-sin(p) * sin(t), -cos(p) * sin(t), cos(t)},
                                     {0.0, 0.0, 0.0}};
    const struct render_object lamp = {
        .shape = RENDER_BALL,
        .centre_m = {10.0 * sin(lamp_deg * DEGREE), 10.0 * cos(lamp_deg * DEGREE), 0.0},
        .radius_m = 0.1,
        .luma = 240};
    render_frame(&frames.render, &view, &even, &lamp, isnan(lamp_deg) ? 0U : 1U, &webcam,
                 &frames.picture[0][0], FRAMES_WIDTH);
}

static struct told {
    uint32_t count, gone;
    struct target_update last;
} told;

static void hear(void *context, const struct target_update *update) {
    (void)context;
    if (update->kind == TARGET_GONE) {
        told.gone++;
    } else {
        told.count++;
        told.last = *update;
    }
}

static struct hal_camera_frame frame_at(uint32_t at_us) {
    return (struct hal_camera_frame){.data = &frames.picture[0][0],
                                     .size_bytes = FRAMES_WIDTH * FRAMES_HEIGHT,
                                     .exposed_us = at_us};
}

/// Waits for the worker, however busy the machine is.
static bool collect(struct eye *eye, uint32_t now_us) {
    struct pollfd wait = {.fd = eye_fd(eye), .events = POLLIN};
    if (poll(&wait, 1, 30000) != 1) {
        return false;
    }
    (void)eye_collect(eye, now_us, hear, NULL);
    return true;
}

static double error_deg(const struct target_update *update, double lamp_deg) {
    const double x = update->direction.x, y = update->direction.y, z = update->direction.z;
    const double lamp = lamp_deg * DEGREE;
    const double along = x * sin(lamp) + y * cos(lamp), across = x * cos(lamp) - y * sin(lamp);
    return atan2(hypot(across, z), along) / DEGREE;
}

/// 60 degrees a second to the right and 10 up; each frame is handed in 48 ms after its exposure,
/// when the gimbal has turned by 3 degrees: 29 pixels.
static void a_gimbal_that_turns(void) {
    struct eye *eye = open_eye(5000);
    CHECK(eye != NULL);
    uint32_t now_us = 0xFFFF0000U; // the clock wraps on the way
    double pan_deg = -12.0, tilt_deg = -2.0, shown_deg[2] = {0.0, 0.0};
    uint32_t exposed_us = 0;
    double worst = 0.0;
    memset(&told, 0, sizeof told);
    for (uint32_t ms = 0; ms < 400U && check_clean(); ms++) {
        const struct camera_pose pose = {pan_deg, tilt_deg, 1.0};
        eye_pose(eye, now_us, &pose);
        if (ms % 50U == 0U) {
            exposed_us = now_us;
            shown_deg[0] = pan_deg;
            shown_deg[1] = tilt_deg;
        } else if (ms % 50U == 48U) {
            draw_lamp(5.0, shown_deg[0], shown_deg[1]);
            const struct hal_camera_frame frame = frame_at(exposed_us + 5000U);
            CHECK(eye_submit(eye, &grey, &frame) == EYE_OK);
            CHECK(collect(eye, now_us));
            if (told.count > 0U) {
                worst = fmax(worst, error_deg(&told.last, 5.0));
            }
        }
        now_us += 1000U;
        pan_deg += 0.060;
        tilt_deg += 0.010;
    }
    CHECK_EQ(told.count, 7); // of 8 frames the first is not told
    CHECK(worst < 0.02);
    check_note("error of direction, worst, in 1/1000000 degree", (int64_t)(worst * 1e6));
    // 0.1 m at 10 m: 0.573 degrees.
    const double radius_deg = told.last.radius_bam32 * 360.0 / 4294967296.0;
    CHECK(radius_deg > 0.5 && radius_deg < 0.7);
    CHECK(told.last.kind == TARGET_DIRECTION && told.last.id == DETECTION_MARKER_ID);
    CHECK_EQ(eye_counts_of(eye).frames, 8);
    eye_destroy(eye);
}

static void what_leaves_is_gone(void) {
    struct eye *eye = open_eye(0);
    CHECK(eye != NULL);
    memset(&told, 0, sizeof told);
    for (uint32_t i = 0; i < 20U; i++) {
        const struct camera_pose pose = {0.0, 0.0, 1.0};
        const uint32_t now_us = i * 50000U;
        eye_pose(eye, now_us, &pose);
        draw_lamp(i < 5U ? 3.0 : NAN, 0.0, 0.0);
        const struct hal_camera_luma luma = {.luma = &frames.picture[0][0],
                                             .width_px = FRAMES_WIDTH,
                                             .height_px = FRAMES_HEIGHT,
                                             .stride_bytes = FRAMES_WIDTH,
                                             .exposed_us = now_us};
        CHECK(eye_look(eye, &luma, now_us, hear, NULL) == EYE_OK);
    }
    CHECK_EQ(told.count, 4);
    CHECK_EQ(told.gone, 1);
    eye_destroy(eye);
}

static void frames_that_can_not_be_used(void) {
    struct eye *eye = open_eye(0);
    CHECK(eye != NULL);
    draw_lamp(3.0, 0.0, 0.0);
    struct hal_camera_frame frame = frame_at(1000000);
    CHECK(eye_submit(eye, &grey, &frame) == EYE_UNPLACED); // nobody told a pose
    const struct camera_pose pose = {0.0, 0.0, 1.0};
    eye_pose(eye, 1000000, &pose);
    CHECK(eye_submit(eye, &grey, &frame) == EYE_OK);
    // Until it is collected, another one is passed over, whether the worker is done or not.
    CHECK(eye_submit(eye, &grey, &frame) == EYE_BUSY);
    CHECK(collect(eye, 1000000));
    CHECK(eye_submit(eye, &grey, &frame) == EYE_OK);
    CHECK(collect(eye, 1000000));
    CHECK(eye_collect(eye, 1000000, hear, NULL) == 0U);
    frame.exposed_us = 500000; // before the first pose
    CHECK(eye_submit(eye, &grey, &frame) == EYE_UNPLACED);
    frame.exposed_us = 1000000;
    frame.size_bytes = 0;
    CHECK(eye_submit(eye, &grey, &frame) == EYE_ERROR_FRAME);
    struct hal_camera_format mjpeg = grey;
    mjpeg.pixels = HAL_CAMERA_MJPEG; // these bytes are no JPEG picture
    frame.size_bytes = 1000;
    CHECK(eye_submit(eye, &mjpeg, &frame) == EYE_OK);
    CHECK(collect(eye, 1000000));
    const struct eye_counts counts = eye_counts_of(eye);
    CHECK_EQ(counts.frames, 2);
    CHECK_EQ(counts.busy, 1);
    CHECK_EQ(counts.unplaced, 2);
    CHECK_EQ(counts.undecodable, 2);
    frame.size_bytes = FRAMES_WIDTH * FRAMES_HEIGHT;
    CHECK(eye_submit(eye, &grey, &frame) == EYE_OK);
    eye_destroy(eye); // while the worker may be at it
}

int main(void) {
    if (!frames_open(&frames, 560.0, true, 14)) {
        return 1;
    }
    TEST(a_gimbal_that_turns);
    TEST(what_leaves_is_gone);
    TEST(frames_that_can_not_be_used);
    frames_close(&frames);
    return check_finish();
}
