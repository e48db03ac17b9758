#include "stage_camera.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SCHEME        "fake:"
#define LOOK_EVERY_US 100000U
#define BUFFERS       4U
#define LATE_MS_MAX   1000.0

bool stage_camera_parse(const char *device, struct stage_camera_address *address) {
    const size_t scheme = strlen(SCHEME);
    if (strncmp(device, SCHEME, scheme) != 0) {
        return false;
    }
    const char *path = device + scheme, *mark = strrchr(path, '@');
    double late_ms = 0.0;
    if (mark != NULL) {
        char *end;
        late_ms = strtod(mark + 1, &end);
        if (end == mark + 1 || *end != '\0' || !(late_ms >= 0.0 && late_ms <= LATE_MS_MAX)) {
            return false;
        }
    }
    const size_t size = mark != NULL ? (size_t)(mark - path) : strlen(path);
    if (size == 0U || size >= sizeof address->path) {
        return false;
    }
    memcpy(address->path, path, size);
    address->path[size] = '\0';
    address->late_us = (uint32_t)lround(late_ms * 1e3);
    return true;
}

// ---------------------------------------------------------------- pictures

/// Y0 U Y1 V from the brightness that stands at the front of the same memory.
static void spread(uint8_t *yuyv, const uint8_t *luma, size_t count) {
    for (size_t i = 0; i < count; i++) {
        yuyv[2U * i] = luma[i];
        yuyv[2U * i + 1U] = 128U;
    }
}

static void paint(void *ctx, uint8_t *picture, const struct hal_camera_format *format,
                  uint32_t exposed_us, uint32_t sequence) {
    struct stage_camera *stage = ctx;
    const struct rig_eye *eye = &stage->rig->eye;
    const size_t pixels = (size_t)eye->model.width_px * eye->model.height_px;
    struct camera_pose pose;
    (void)sequence;
    if (pose_history_at(&stage->truth, exposed_us - stage->address.late_us, &pose) != POSE_OK) {
        memset(picture, 0, format->frame_bytes_max); // before it knows of any gimbal
        return;
    }
    const struct camera_view view = camera_view_at(&stage->mount, &eye->seat, &pose);
    const bool yuyv = format->pixels == HAL_CAMERA_YUYV;
    uint8_t *luma = yuyv ? stage->picture : picture;
    if (!stage_draw(&stage->stage, &view, pose.zoom, &stage->world, luma, eye->model.width_px)) {
        memset(luma, 0, pixels);
    }
    if (yuyv) {
        spread(picture, luma, pixels);
    }
}

// ---------------------------------------------------------------- opening

static struct stage_looks looks_of(const struct rig_eye *eye) {
    const bool *wanted = eye->detectors.wanted;
    struct stage_looks looks = {.kind = STAGE_PEOPLE,
                                .size_deg = 5.0,
                                .sensor = {.blur_px = 0.8, .noise_luma = 2.0, .gain = 1.0},
                                .backdrop_luma = 80.0,
                                .backdrop_contrast = 50.0};
    if (wanted[DETECTION_TAG]) {
        looks.kind = STAGE_TAGS;
        looks.size_deg = 8.0;
    } else if (wanted[DETECTION_MARKER]) {
        looks.kind = STAGE_LAMPS;
        looks.size_deg = 2.0;
    }
    return looks;
}

bool stage_camera_create(struct stage_camera *stage, const struct rig *rig,
                         const struct hal_clock *clock) {
    memset(stage, 0, sizeof *stage);
    stage->rig = rig;
    stage->clock = clock;
    if (!stage_camera_parse(rig->camera.device, &stage->address)) {
        abort(); // rig_frames_build has looked
    }
    mount_init(&stage->mount, rig->controller.attitude);
    pose_history_init(&stage->truth);
    target_set_init(&stage->world, rig->controller.position_um, 0);
    const uint32_t width_px = rig->eye.model.width_px, height_px = rig->eye.model.height_px;
    const size_t bytes = (size_t)width_px * height_px * 2U;
    stage->pool = malloc(BUFFERS * bytes);
    stage->picture = malloc(bytes);
    stage->model = (struct fake_camera_model){.width_px_max = width_px,
                                              .height_px_max = height_px,
                                              .pool = stage->pool,
                                              .pool_bytes = BUFFERS * bytes,
                                              .buffer_count = BUFFERS,
                                              .latency_us = STAGE_CAMERA_TRANSFER_US,
                                              .paint = paint,
                                              .ctx = stage};
    const struct stage_looks looks = looks_of(&rig->eye);
    return stage_open(&stage->stage, &rig->eye, &looks, 1) && stage->pool != NULL &&
           stage->picture != NULL;
}

static void leave_file(struct stage_camera *stage) {
    if (stage->has_source) {
        target_source_close(&stage->source);
    }
    stage->has_source = false;
}

void stage_camera_free(struct stage_camera *stage) {
    leave_file(stage);
    stage_close(&stage->stage);
    free(stage->pool);
    free(stage->picture);
    stage->pool = stage->picture = NULL;
}

enum hal_status stage_camera_open(struct stage_camera *stage) {
    struct stat about;
    fake_camera_init(&stage->camera, stage->clock, &stage->model);
    if (stat(stage->address.path, &about) == 0 && S_ISREG(about.st_mode)) {
        return HAL_OK;
    }
    fake_camera_unplug(&stage->camera);
    linux_error_set(&stage->error, stage->address.path, "no such file for the simulated camera",
                    "write into it what the camera sees, as for `run --targets`");
    return HAL_ERROR_GONE;
}

// ---------------------------------------------------------------- what is there to see

void stage_camera_unplug(struct stage_camera *stage) {
    fake_camera_unplug(&stage->camera);
    linux_error_set(&stage->error, stage->address.path, "the simulated camera has left",
                    "put the file back");
}

void stage_camera_pose(struct stage_camera *stage, uint32_t at_us, const struct camera_pose *pose) {
    stage->time_us += stage->truth.count > 0U ? hal_clock_span_us(stage->last_us, at_us) : 0U;
    stage->last_us = at_us;
    pose_history_add(&stage->truth, at_us, pose);
}

static bool is_as_read(const struct stage_camera *stage, const struct stat *about) {
    const struct stat *then = &stage->read_from;
    return stage->has_source && about->st_ino == then->st_ino && about->st_size == then->st_size &&
           about->st_mtim.tv_sec == then->st_mtim.tv_sec &&
           about->st_mtim.tv_nsec == then->st_mtim.tv_nsec;
}

static void read_file(struct stage_camera *stage, const struct stat *about) {
    const struct target_update clear = {.kind = TARGET_CLEAR};
    leave_file(stage);
    (void)!target_set_apply(&stage->world, &clear, stage->time_us);
    stage->has_source = target_source_open(&stage->source, stage->address.path);
    stage->read_us = stage->time_us;
    stage->read_from = *about;
}

bool stage_camera_look(struct stage_camera *stage) {
    struct target_update update;
    struct stat about;
    if (stage->time_us >= stage->look_us) {
        stage->look_us = stage->time_us + LOOK_EVERY_US;
        stage->is_there = stat(stage->address.path, &about) == 0;
        if (stage->is_there && !is_as_read(stage, &about)) {
            read_file(stage, &about);
        }
    }
    while (stage->is_there && stage->has_source &&
           target_source_next(&stage->source, stage->time_us - stage->read_us, &update)) {
        (void)!target_set_apply(&stage->world, &update, stage->time_us); // else it is not seen
        target_source_taken(&stage->source);
    }
    return stage->is_there;
}
