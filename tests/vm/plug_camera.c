/// Plays a USB camera that turns itself for the scripts: plugged in until SIGTERM, it shows what
/// the simulator's renderer draws of a world with one lamp or one tag in it, from where its own pan
/// and tilt have brought it.
///
/// Usage: plug_camera STATE WISH [PICTURE]. WISH is read again and again: `lamp|tag PAN_DEG
/// TILT_DEG`, where the thing is, and behind that `silent` if no frames shall come, `stubborn` if
/// it shall refuse to be turned. STATE always holds `pan tilt zoom settings frames`: where the
/// camera is (degrees, its unit), and what has reached it. With PICTURE, a file that somebody else
/// keeps new (`boresight sim
/// --frames`), it shows each as soon as it is there, and grey where it is of another size.
#include "detect/camera_model.h"
#include "detect/frame_file.h"
#include "detect/tags.h"
#include "view/render.h"
#include "vm/support/uvc_camera.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define DEGREE     (3.14159265358979323846 / 180.0)
#define FOCAL_PX   150.0 ///< at 160 pixels of width
#define SPEED_DPS  60.0
#define DISTANCE_M 10.0

/// What this program and the camera's process share.
struct stage {
    struct uvc_camera camera;
    volatile double pan_deg, tilt_deg; ///< where the camera is
    volatile double thing_pan_deg, thing_tilt_deg;
    volatile bool is_tag;
};

static volatile sig_atomic_t ended;

static void end(int number) {
    (void)number;
    ended = 1;
}

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

// ---------------------------------------------------------------- the world, in the camera's
// process

static bool ray(void *context, const double pixel[2], double direction[3]) {
    return camera_model_ray(context, pixel, direction);
}

static double toward(double at, double goal, double most) {
    return goal > at + most ? at + most : goal < at - most ? at - most : goal;
}

static void look_along(double pan_deg, double tilt_deg, double right[3], double ahead[3],
                       double up[3]) {
    const double p = pan_deg * DEGREE, t = tilt_deg * DEGREE;
    const double axes[3][3] = {{cos(p), -sin(p), 0.0},
                               {sin(p) * cos(t), cos(p) * cos(t), sin(t)},
                               {-sin(p) * sin(t), -cos(p) * sin(t), cos(t)}};
    memcpy(right, axes[0], sizeof axes[0]);
    memcpy(ahead, axes[1], sizeof axes[1]);
    memcpy(up, axes[2], sizeof axes[2]);
}

/// A lamp, 4 degrees wide, or a tag of 3.2 m, square to the line of sight.
static struct render_object thing_of(const struct stage *stage, const uint8_t *texture,
                                     uint32_t cells) {
    double right[3], ahead[3], up[3];
    look_along(stage->thing_pan_deg, stage->thing_tilt_deg, right, ahead, up);
    struct render_object thing = {.shape = RENDER_BALL, .radius_m = 0.35, .luma = 250};
    if (stage->is_tag) {
        thing = (struct render_object){
            .shape = RENDER_PLATE, .texture = texture, .columns = cells, .rows = cells};
    }
    for (unsigned i = 0; i < 3U; i++) {
        thing.centre_m[i] = DISTANCE_M * ahead[i];
        thing.right_m[i] = 1.6 * right[i];
        thing.up_m[i] = 1.6 * up[i];
    }
    return thing;
}

static const char *picture_file; ///< NULL: the world is here

static bool is_new(void *ctx) {
    static struct timespec shown;
    struct stat about;
    (void)ctx;
    if (stat(picture_file, &about) != 0 ||
        (about.st_mtim.tv_sec == shown.tv_sec && about.st_mtim.tv_nsec == shown.tv_nsec)) {
        return false;
    }
    shown = about.st_mtim;
    return true;
}

static void paint_file(const struct uvc_camera *camera, uint8_t *picture) {
    static struct frame_file file;
    struct hal_camera_luma frame;
    const bool read = frame_file_open(&file, picture_file) &&
                      frame_file_next(&file, &frame) == FRAME_FILE_OK &&
                      frame.width_px == camera->width_px && frame.height_px == camera->height_px;
    for (uint32_t y = 0; y < camera->height_px; y++) {
        uint8_t *line = picture + (size_t)y * camera->width_px;
        if (read) {
            memcpy(line, frame.luma + (size_t)y * frame.stride_bytes, camera->width_px);
        } else {
            memset(line, 90, camera->width_px);
        }
    }
    frame_file_close(&file);
}

static void paint(void *ctx, const struct uvc_camera *camera, uint8_t *picture) {
    static struct render render;
    static struct camera_model model;
    static uint8_t texture[TAGS_CELLS_MAX * TAGS_CELLS_MAX];
    static uint32_t cells;
    static double moved_s;
    struct stage *const stage = ctx;
    const double at_s = now_s(), most = SPEED_DPS * (moved_s > 0.0 ? at_s - moved_s : 0.0);
    moved_s = at_s;
    stage->pan_deg = toward(stage->pan_deg, camera->pan / 3600.0, most);
    stage->tilt_deg = toward(stage->tilt_deg, camera->tilt / 3600.0, most);
    if (picture_file != NULL) {
        paint_file(camera, picture);
        return;
    }
    if (render.width_px != camera->width_px) {
        model = camera_model_pinhole(camera->width_px, camera->height_px,
                                     FOCAL_PX * camera->width_px / 160.0);
        if (camera_model_check(&model) != NULL ||
            !render_create(&render, camera->width_px, camera->height_px, ray, &model, 1) ||
            !tags_draw(TAGS_FAMILY_DEFAULT, 7, texture, &cells)) {
            stage->is_tag = false;
            cells = 1;
        }
    }
    struct render_view view = {.at_m = {0.0, 0.0, 0.0}};
    look_along(stage->pan_deg, stage->tilt_deg, view.right, view.ahead, view.up);
    const struct render_object thing = thing_of(stage, texture, cells);
    const struct render_backdrop backdrop = {.seed = 1, .luma = 90.0, .grain_deg = 20.0};
    const struct render_sensor sensor = {.blur_px = 0.5, .noise_luma = 2.0, .gain = 1.0};
    render_frame(&render, &view, &backdrop, &thing, 1, &sensor, picture, camera->width_px);
}

// ---------------------------------------------------------------- the script's side

static void read_wish(struct stage *stage, const char *path) {
    char kind[16], more[16] = "";
    double pan_deg, tilt_deg;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return;
    }
    if (fscanf(file, "%15s %lf %lf %15s", kind, &pan_deg, &tilt_deg, more) >= 3) {
        stage->is_tag = strcmp(kind, "tag") == 0;
        stage->thing_pan_deg = pan_deg;
        stage->thing_tilt_deg = tilt_deg;
        stage->camera.silent = strcmp(more, "silent") == 0;
        stage->camera.refuse_next = strcmp(more, "stubborn") == 0 ? UINT32_MAX : 0U;
    }
    fclose(file);
}

/// Whole, whenever it is read.
static void write_state(const struct stage *stage, const char *path) {
    char other[256];
    snprintf(other, sizeof other, "%s.new", path);
    FILE *file = fopen(other, "w");
    if (file != NULL) {
        const struct uvc_camera *camera = &stage->camera;
        fprintf(file, "%.4f %.4f %d %u %u\n", stage->pan_deg, stage->tilt_deg, camera->zoom,
                camera->settings, camera->frames);
        if (fclose(file) == 0) {
            (void)rename(other, path);
        }
    }
}

int main(int argc, char **argv) {
    if (argc != 3 && argc != 4) {
        fprintf(stderr, "usage: plug_camera STATE WISH [PICTURE]\n");
        return 2;
    }
    picture_file = argv[3]; // NULL if there is none
    struct stage *const stage = usb_port_share(sizeof *stage);
    struct usb_port port;
    signal(SIGTERM, end);
    uvc_camera_init(&stage->camera);
    stage->camera.paint = paint;
    stage->camera.ready = picture_file != NULL ? is_new : NULL;
    stage->camera.ctx = stage;
    read_wish(stage, argv[2]);
    uvc_camera_plug(&port, 3, &stage->camera);
    while (ended == 0) {
        read_wish(stage, argv[2]);
        write_state(stage, argv[1]);
        usleep(50000);
    }
    usb_port_unplug(&port);
    return 0;
}
