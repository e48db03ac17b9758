#include "rig_camera.h"

#include "rig_schema.h"
#include "stage_camera.h"

#include "detect/tags.h"

#include <stddef.h>
#include <string.h>

/// In the order of enum hal_camera_pixels.
static const char *const pixel_names[] = {"any", "grey", "yuyv", "mjpeg", NULL};

#define CAMERA(member) .offset = offsetof(struct rig_camera, member)
static const char *const frames[] = {"cone", "rect", NULL}; // enum controller_frame

const struct ini_key rig_camera_keys[RIG_CAMERA_KEY_COUNT] = {
    {.name = "sensor_width_mm",
     .type = INI_DECIMAL,
     .fallback = "4.8",
     .min = "0.1",
     .max = "1000",
     .numerator = 1000,
     CAMERA(sensor_width_um),
     .help = "width of the image on the sensor"},
    {.name = "sensor_height_mm",
     .type = INI_DECIMAL,
     .fallback = "3.6",
     .min = "0.1",
     .max = "1000",
     .numerator = 1000,
     CAMERA(sensor_height_um),
     .help = "its height"},
    {.name = "focal_mm",
     .type = INI_DECIMAL,
     .fallback = "6",
     .min = "0.1",
     .max = "4000",
     .numerator = 1000,
     CAMERA(focal_um),
     .help = "focal length of a lens without zoom"},
    {.name = "margin_percent",
     .type = INI_DECIMAL,
     .fallback = "10",
     .min = "0",
     .max = "900",
     .numerator = 65536,
     .denominator = 100,
     CAMERA(margin_q16),
     .help = "how much wider than what it must hold the picture is"},
    {.name = "frame",
     .type = INI_CHOICE,
     .fallback = "cone",
     .choices = frames,
     CAMERA(frame),
     .help = "what holds the targets: cone: a circle; rect: the picture itself, as tight as can "
             "be"},
    {.name = "width_px",
     .type = INI_WHOLE,
     .fallback = "640",
     .min = "16",
     .max = "8192",
     CAMERA(width_px),
     .help = "width of the picture that the numbers below are of"},
    {.name = "height_px",
     .type = INI_WHOLE,
     .fallback = "480",
     .min = "16",
     .max = "8192",
     CAMERA(height_px),
     .help = "its height"},
    {.name = "fx_px",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "1000000",
     .numerator = 1000000,
     CAMERA(fx_upx),
     .help = "focal length in pixels across, at focal_mm; 0: from focal_mm and sensor_width_mm"},
    {.name = "fy_px",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "1000000",
     .numerator = 1000000,
     CAMERA(fy_upx),
     .help = "and down; 0: as fx_px"},
    {.name = "cx_px",
     .type = INI_DECIMAL,
     .fallback = "-1",
     .min = "-1",
     .max = "8192",
     .numerator = 1000000,
     CAMERA(cx_upx),
     .help = "where the axis of the lens meets the picture, from the left; -1: the middle"},
    {.name = "cy_px",
     .type = INI_DECIMAL,
     .fallback = "-1",
     .min = "-1",
     .max = "8192",
     .numerator = 1000000,
     CAMERA(cy_upx),
     .help = "and from the top; -1: the middle"},
    {.name = "k1",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-1000",
     .max = "1000",
     .numerator = 1000000000,
     CAMERA(k1_nano),
     .help = "distortion of the lens, as calibration programs print it: radial, r^2"},
    {.name = "k2",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-1000",
     .max = "1000",
     .numerator = 1000000000,
     CAMERA(k2_nano),
     .help = "radial, r^4"},
    {.name = "p1",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-1000",
     .max = "1000",
     .numerator = 1000000000,
     CAMERA(p1_nano),
     .help = "tangential"},
    {.name = "p2",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-1000",
     .max = "1000",
     .numerator = 1000000000,
     CAMERA(p2_nano),
     .help = "tangential"},
    {.name = "k3",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-1000",
     .max = "1000",
     .numerator = 1000000000,
     CAMERA(k3_nano),
     .help = "radial, r^6"},
    {.name = "right_deg",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-180",
     .max = "180",
     .numerator = 1000000,
     CAMERA(right_udeg),
     .help = "how far the camera sits turned to the right on the head"},
    {.name = "up_deg",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-180",
     .max = "180",
     .numerator = 1000000,
     CAMERA(up_udeg),
     .help = "how far it looks up"},
    {.name = "roll_deg",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-180",
     .max = "180",
     .numerator = 1000000,
     CAMERA(roll_udeg),
     .help = "how far it is rolled clockwise, seen from behind; 180: upside down"},
    {.name = "latency_ms",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-1000",
     .max = "1000",
     .numerator = 1000,
     CAMERA(latency_us),
     .help = "how long before its time stamp the middle of a frame was exposed"},
    {.name = "device",
     .type = INI_TEXT,
     .fallback = "",
     CAMERA(device),
     .help =
         "/dev/videoN or the camera's name: `run` looks for targets in its frames; empty: none"},
    {.name = "pixels",
     .type = INI_CHOICE,
     .fallback = "any",
     .choices = pixel_names,
     CAMERA(pixels),
     .help = "what the camera sends"},
    {.name = "rate_hz",
     .type = INI_DECIMAL,
     .fallback = "30",
     .min = "0.1",
     .max = "1000",
     .numerator = 1000,
     CAMERA(rate_mhz),
     .help = "frames a second"},
    {.name = "detect",
     .type = INI_TEXT,
     .fallback = "",
     CAMERA(detect),
     .help = "what to look for in its frames: tags, markers, motion, or several of them"},
    {.name = "tag_family",
     .type = INI_TEXT,
     .fallback = TAGS_FAMILY_DEFAULT,
     CAMERA(tag_family),
     .help = "of the tags: " TAGS_FAMILIES},
};

static struct rig_eye read_eye(const struct rig_camera *from) {
    const double fx_px = from->fx_upx > 0 ? (double)from->fx_upx * 1e-6
                                          : (double)(from->focal_um * from->width_px) /
                                                (double)from->sensor_width_um;
    struct rig_eye eye = {
        .model = camera_model_pinhole((uint32_t)from->width_px, (uint32_t)from->height_px, fx_px)};
    struct camera_model *model = &eye.model;
    model->fy_px = from->fy_upx > 0 ? (double)from->fy_upx * 1e-6 : fx_px;
    model->cx_px = from->cx_upx >= 0 ? (double)from->cx_upx * 1e-6 : model->cx_px;
    model->cy_px = from->cy_upx >= 0 ? (double)from->cy_upx * 1e-6 : model->cy_px;
    model->k1 = (double)from->k1_nano * 1e-9;
    model->k2 = (double)from->k2_nano * 1e-9;
    model->p1 = (double)from->p1_nano * 1e-9;
    model->p2 = (double)from->p2_nano * 1e-9;
    model->k3 = (double)from->k3_nano * 1e-9;
    eye.seat = (struct camera_seat){(double)from->right_udeg * 1e-6, (double)from->up_udeg * 1e-6,
                                    (double)from->roll_udeg * 1e-6};
    eye.focal_mm = (double)from->focal_um * 1e-3;
    eye.latency_us = (int32_t)from->latency_us;
    return eye;
}

static bool read_detectors(const struct rig_camera *from, const struct ini *ini,
                           struct rig_eye *out) {
    out->detectors.tag_family = from->tag_family;
    if (!tags_family_known(from->tag_family)) {
        ini_complain(ini, "camera", "", "tag_family", "must be one of %s", TAGS_FAMILIES);
        return false;
    }
    const char *wrong =
        detector_settings_read(&out->detectors, from->detect, (uint32_t)strlen(from->detect));
    if (wrong != NULL) {
        ini_complain(ini, "camera", "", "detect", "%s", wrong);
        return false;
    }
    for (unsigned kind = 0; kind < DETECTION_KINDS; kind++) {
        out->detects = out->detects || out->detectors.wanted[kind];
    }
    return true;
}

bool rig_camera_build(const struct rig_camera *from, const struct ini *ini, struct rig_eye *out) {
    *out = read_eye(from);
    const char *wrong = camera_model_check(&out->model);
    if (wrong != NULL) {
        ini_complain(ini, "camera", "", "k1", "%s", wrong);
        return false;
    }
    return read_detectors(from, ini, out);
}

bool rig_frames_build(const struct rig_camera *from, const struct ini *ini,
                      struct rig_frames *out) {
    *out = (struct rig_frames){.device = from->device,
                               .wish = {.pixels = (enum hal_camera_pixels)from->pixels,
                                        .width_px = (uint32_t)from->width_px,
                                        .height_px = (uint32_t)from->height_px,
                                        .interval_us = (uint32_t)(1000000000 / from->rate_mhz)}};
    struct stage_camera_address address;
    if (strncmp(from->device, "fake", 4) == 0 &&
        (!stage_camera_parse(from->device, &address) || from->width_px % 2 != 0)) {
        ini_complain(ini, "camera", "", "device",
                     "is '%s'; a simulated camera is fake:FILE or fake:FILE@MS (0 to 1000), and "
                     "width_px is even",
                     from->device);
        return false;
    }
    if (from->device[0] != '\0' && from->detect[0] == '\0') {
        ini_complain(ini, "camera", "", "device", "needs to be told what to look for: detect = %s",
                     "tags, or markers, or motion");
        return false;
    }
    return true;
}
