#include "property/support/frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "check.h"

#define CX 322.6
#define CY 236.1

struct lens {
    double focal_px, k1, k2, p1, p2;
};
static struct lens lens; // of the frames that are open: render's callback has no room for more

static void distort(double x, double y, double out[2]) {
    const double r2 = x * x + y * y, radial = 1.0 + lens.k1 * r2 + lens.k2 * r2 * r2;
    out[0] = x * radial + 2.0 * lens.p1 * x * y + lens.p2 * (r2 + 2.0 * x * x);
    out[1] = y * radial + lens.p1 * (r2 + 2.0 * y * y) + 2.0 * lens.p2 * x * y;
}

static bool ray(void *context, const double pixel[2], double direction[3]) {
    (void)context;
    const double u = (pixel[0] - CX) / lens.focal_px, v = (pixel[1] - CY) / lens.focal_px;
    double x = u, y = v;
    for (int i = 0; i < 300; i++) {
        double out[2];
        distort(x, y, out);
        x += 0.7 * (u - out[0]);
        y += 0.7 * (v - out[1]);
    }
    direction[0] = x;
    direction[1] = 1.0;
    direction[2] = -y;
    return true;
}

bool frames_open(struct frames *frames, double focal_px, bool distorted, uint64_t seed) {
    memset(frames, 0, sizeof *frames);
    frames->random = seed * 2U + 1U;
    frames->focal_px = focal_px;
    lens = distorted ? (struct lens){focal_px, -0.21, 0.05, 0.0007, -0.0011}
                     : (struct lens){focal_px, 0.0, 0.0, 0.0, 0.0};
    return render_create(&frames->render, FRAMES_WIDTH, FRAMES_HEIGHT, ray, NULL, seed);
}

void frames_close(struct frames *frames) {
    render_destroy(&frames->render);
}

double frames_any(struct frames *frames, double low, double high) {
    return low + (high - low) * (double)(check_random(&frames->random) >> 11) * 0x1p-53;
}

void frames_project(const struct frames *frames, const double at[3], double pixel[2]) {
    (void)frames;
    double out[2];
    distort(at[0] / at[1], -at[2] / at[1], out);
    pixel[0] = out[0] * lens.focal_px + CX;
    pixel[1] = out[1] * lens.focal_px + CY;
}

void frames_ray(const struct frames *frames, const double pixel[2], double direction[3]) {
    (void)frames;
    (void)ray(NULL, pixel, direction);
}

struct camera_model frames_model(const struct frames *frames) {
    return (struct camera_model){
        FRAMES_WIDTH, FRAMES_HEIGHT, frames->focal_px, frames->focal_px, CX,  CY,
        lens.k1,      lens.k2,       lens.p1,          lens.p2,          0.0, 0.0};
}

struct hal_camera_luma frames_draw_from(struct frames *frames, const struct camera_view *turned,
                                        const struct render_backdrop *backdrop,
                                        const struct render_object *objects, uint32_t count,
                                        const struct render_sensor *sensor) {
    struct render_view view = {.at_m = {0.0, 0.0, 0.0}};
    memcpy(view.right, turned->right, sizeof view.right);
    memcpy(view.ahead, turned->ahead, sizeof view.ahead);
    memcpy(view.up, turned->up, sizeof view.up);
    render_frame(&frames->render, &view, backdrop, objects, count, sensor, &frames->picture[0][0],
                 FRAMES_WIDTH);
    return (struct hal_camera_luma){.luma = &frames->picture[0][0],
                                    .width_px = FRAMES_WIDTH,
                                    .height_px = FRAMES_HEIGHT,
                                    .stride_bytes = FRAMES_WIDTH};
}

struct hal_camera_luma frames_draw(struct frames *frames, const struct render_backdrop *backdrop,
                                   const struct render_object *objects, uint32_t count,
                                   const struct render_sensor *sensor) {
    static const struct camera_view north = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return frames_draw_from(frames, &north, backdrop, objects, count, sensor);
}

uint32_t frames_many(uint32_t full) {
    return getenv("BENCH") != NULL ? full / 10U : full;
}

double frames_cpu_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}
