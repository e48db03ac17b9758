/// The camera driver on a USB camera that is emulated below the kernel's uvcvideo. The contract
/// suite in every format; then what only a broken camera does.
#include "linux/linux_camera.h"
#include "contract/support/camera_suite.h"
#include "contract/support/contract.h"
#include "contract/support/lives.h"
#include "contract/support/syscalls.h"
#include "linux/linux_luma.h"
#include "vm/support/kernel_camera.h"
#include "vm/support/nobody.h"
#include "vm/support/pauses.h"
#include "vm/support/uvc_camera.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define INTERVAL_US 100000U

static struct uvc_camera *model;
static struct usb_port port;

// ---------------------------------------------------------------- hands

static void plug(void) {
    if (port.child == 0) {
        uvc_camera_init(model);
        uvc_camera_plug(&port, 1, model);
    }
}

static void unplug(void *context) {
    (void)context;
    usb_port_unplug(&port);
}

static void reset_usb(void *context) {
    (void)context;
    linux_camera_close(&kernel_camera);
    plug();
    kernel_camera_open(UVC_CAMERA_NAME);
}

static void settle(void *context) {
    (void)context;
    usleep(2000);
}

static void suite(const char *name, enum hal_camera_pixels pixels) {
    const struct hal_camera_format format = {
        .pixels = pixels, .width_px = 320, .height_px = 240, .interval_us = INTERVAL_US};
    reset_usb(NULL);
    camera_suite(&(struct camera_fixture){.name = name,
                                          .camera = &kernel_camera.hal,
                                          .clock = &kernel_camera_clock.hal,
                                          .format = format,
                                          .buffer_count = LINUX_CAMERA_BUFFERS,
                                          .reset = reset_usb,
                                          .settle = settle,
                                          .unplug = unplug,
                                          .excuse = pauses_excuse});
}

static void stream(uint32_t interval_us) {
    struct hal_camera_format format = {.pixels = HAL_CAMERA_GREY,
                                       .width_px = UVC_CAMERA_WIDTH / 2U,
                                       .height_px = UVC_CAMERA_HEIGHT / 2U,
                                       .interval_us = interval_us};
    CHECK_EQ(hal_camera_negotiate(&kernel_camera.hal, &format), HAL_OK);
    CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_OK);
}

static bool wait_until(volatile int32_t *what, int32_t value) {
    for (int ms = 0; ms < KERNEL_CAMERA_PATIENCE_MS && *what != value; ms++) {
        usleep(1000);
    }
    return *what == value;
}

// ---------------------------------------------------------------- pictures

/// In every format the pixels are those that the camera painted.
static void pictures_arrive(void) {
    for (unsigned pixels = HAL_CAMERA_GREY; pixels <= HAL_CAMERA_MJPEG; pixels++) {
        if (pixels == HAL_CAMERA_MJPEG && linux_luma_jpeg_library() == NULL) {
            continue;
        }
        reset_usb(NULL);
        struct linux_luma luma = {0};
        struct hal_camera_format format = {.pixels = (enum hal_camera_pixels)pixels};
        CHECK_EQ(hal_camera_negotiate(&kernel_camera.hal, &format), HAL_OK);
        CHECK_EQ(format.pixels, pixels);
        const uint32_t before = model->frames;
        CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_OK);
        for (uint32_t i = 0; i < 5U; i++) {
            struct hal_camera_frame frame = {0};
            struct hal_camera_luma got = {0};
            CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
            CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_OK);
            CHECK(!got.damaged);
            const uint8_t wanted = (uint8_t)(before + frame.sequence);
            for (uint32_t at = 0; at < format.width_px * format.height_px && check_clean(); at++) {
                CHECK_NEAR(got.luma[at], wanted, pixels == HAL_CAMERA_MJPEG ? 1 : 0);
            }
            kernel_camera_give_back(&frame);
        }
        linux_luma_free(&luma);
    }
}

/// A frame that is torn, or that the camera itself marks as spoilt, is dropped by the kernel: the
/// numbers tell.
static void lost_frames_leave_gaps(void) {
    reset_usb(NULL);
    stream(33333);
    struct hal_camera_frame frame = {0};
    CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
    kernel_camera_give_back(&frame);
    for (int kind = 0; kind < 2; kind++) {
        uint32_t missing = 0, damaged = 0, before = frame.sequence;
        *(kind == 0 ? &model->tear_next : &model->spoil_next) = 3;
        for (int i = 0; i < 60 && missing + damaged < 3U; i++) {
            CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
            damaged += frame.damaged ? 1U : 0U;
            missing += frame.sequence - before - 1U;
            before = frame.sequence;
            kernel_camera_give_back(&frame);
        }
        CHECK_EQ(missing + damaged, 3);
    }
}

/// The camera falls silent and speaks again: nothing comes, nothing breaks.
static void silence_is_empty(void) {
    reset_usb(NULL);
    stream(33333);
    struct hal_camera_frame frame = {0};
    CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
    kernel_camera_give_back(&frame);
    model->silent = true;
    usleep(200000); // what is on its way
    enum hal_status status = HAL_OK;
    while (status == HAL_OK) {
        status = hal_camera_dequeue(&kernel_camera.hal, &frame);
        if (status == HAL_OK) {
            kernel_camera_give_back(&frame);
        }
    }
    CHECK_EQ(status, HAL_EMPTY);
    usleep(300000);
    CHECK_EQ(hal_camera_dequeue(&kernel_camera.hal, &frame), HAL_EMPTY);
    model->silent = false;
    CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
}

// ---------------------------------------------------------------- pan, tilt, zoom

static void settings_reach_the_camera(void) {
    reset_usb(NULL);
    CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_PAN, 36000), HAL_OK);
    CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_TILT, -7200), HAL_OK);
    CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_ZOOM, 250), HAL_OK);
    CHECK(wait_until(&model->pan, 36000) && wait_until(&model->tilt, -7200) &&
          wait_until(&model->zoom, 250));
    // Where it was when another program opens it.
    linux_camera_close(&kernel_camera);
    kernel_camera_open(UVC_CAMERA_NAME);
    int32_t value = 0;
    CHECK_EQ(hal_camera_control_get(&kernel_camera.hal, HAL_CAMERA_PAN, &value), HAL_OK);
    CHECK_EQ(value, 36000);
}

/// While a slow camera works on one setting, later ones replace each other; the last one arrives.
static void a_slow_camera_gets_the_last(void) {
    reset_usb(NULL);
    model->slow_us = 100000;
    const uint32_t before = model->settings;
    for (int32_t i = 1; i <= 200; i++) {
        CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_PAN, 36 * i), HAL_OK);
        CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_TILT, -36 * i), HAL_OK);
        usleep(1000);
    }
    CHECK(wait_until(&model->pan, 7200) && wait_until(&model->tilt, -7200));
    CHECK(model->settings - before < 100U);
    model->slow_us = 0;
    CHECK_EQ(linux_camera_failed_settings(&kernel_camera), 0);
}

/// A setting that the camera refuses is counted, and the control tells that the old one holds.
static void refused_settings_are_counted(void) {
    reset_usb(NULL);
    CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_PAN, 3600), HAL_OK);
    CHECK(wait_until(&model->pan, 3600));
    model->refuse_next = 1;
    CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_PAN, 72000), HAL_OK);
    for (int ms = 0;
         ms < KERNEL_CAMERA_PATIENCE_MS && linux_camera_failed_settings(&kernel_camera) == 0U;
         ms++) {
        usleep(1000);
    }
    CHECK_EQ(linux_camera_failed_settings(&kernel_camera), 1);
    int32_t value = 0;
    CHECK_EQ(hal_camera_control_get(&kernel_camera.hal, HAL_CAMERA_PAN, &value), HAL_OK);
    CHECK_EQ(value, 3600);
    CHECK_EQ(model->pan, 3600);
    CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_PAN, 72000), HAL_OK);
    CHECK(wait_until(&model->pan, 72000));
}

/// Pulled out while a setting is on its way and nothing streams: the next call knows.
static void settings_notice_that_it_has_left(void) {
    reset_usb(NULL);
    model->slow_us = 200000;
    CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_PAN, 3600), HAL_OK);
    unplug(NULL);
    enum hal_status status = HAL_OK;
    for (int ms = 0; ms < KERNEL_CAMERA_PATIENCE_MS && status == HAL_OK; ms++) {
        status = hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_PAN, 36 * (ms % 100));
        usleep(1000);
    }
    CHECK_EQ(status, HAL_ERROR_GONE);
    CHECK(strstr(kernel_camera.error.line, ": the camera has left; plug it in again") != NULL);
    linux_camera_close(&kernel_camera);
}

// ---------------------------------------------------------------- failures at every step

/// From opening to closing. Which frames come is the camera's business.
static void live(void) {
    struct hal_camera_frame frame = {0};
    int32_t value = 0;
    if (life_note("open",
                  linux_camera_open(&kernel_camera, UVC_CAMERA_NAME, &kernel_camera_clock.hal),
                  &kernel_camera.error) != HAL_OK) {
        CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_ERROR_GONE);
        return;
    }
    struct hal_camera_format format = {.pixels = HAL_CAMERA_GREY, .width_px = 160};
    life_note("negotiate", hal_camera_negotiate(&kernel_camera.hal, &format), &kernel_camera.error);
    life_value("pixels", format.pixels);
    life_note("get", hal_camera_control_get(&kernel_camera.hal, HAL_CAMERA_PAN, &value),
              &kernel_camera.error);
    life_value("pan", value);
    life_note("start", hal_camera_start(&kernel_camera.hal), &kernel_camera.error);
    for (int i = 0; i < 2; i++) {
        if (life_note("dequeue", kernel_camera_take(&frame), &kernel_camera.error) == HAL_OK) {
            CHECK(frame.size_bytes > 0U && frame.size_bytes <= format.frame_bytes_max);
            life_note("requeue", hal_camera_requeue(&kernel_camera.hal, &frame),
                      &kernel_camera.error);
        }
    }
    life_note("stop", hal_camera_stop(&kernel_camera.hal), &kernel_camera.error);
    linux_camera_close(&kernel_camera);
}

/// Each system call in turn fails. How often it is asked for a frame is chance; settings, which a
/// thread hands over, are in tests/contract/linux_camera.c.
static void fails_at_every_step(void) {
    const struct life_error errors[] = {
        LIFE_EIO,
        LIFE_ENODEV,
        LIFE_ENOMEM,
        {EACCES, LIFE_STATUS(HAL_ERROR_DENIED) | LIFE_STATUS(HAL_ERROR_IO)}};
    reset_usb(NULL);
    linux_camera_close(&kernel_camera);
    lives_each_failure(&(struct lives){.device = "",
                                       .live = live,
                                       .errors = errors,
                                       .error_count = 4,
                                       .share_out = true,
                                       .stride = LIVES_VM_STRIDE,
                                       .spared = "poll ",
                                       .recover_every = 10});
}

/// Every request of its class stalls, at every stage; then it works again.
static void requests_are_stalled_at_every_stage(void) {
    for (int stage = 0; stage < 4; stage++) {
        reset_usb(NULL);
        struct hal_camera_frame frame;
        struct hal_camera_format format = {.pixels = HAL_CAMERA_YUYV};
        model->refuses = stage == 0;
        const enum hal_status agreed = hal_camera_negotiate(&kernel_camera.hal, &format);
        CHECK_EQ(agreed, stage == 0 ? HAL_ERROR_IO : HAL_OK);
        model->refuses = stage == 1;
        const enum hal_status started = hal_camera_start(&kernel_camera.hal);
        CHECK_EQ(started, stage == 0 ? HAL_ERROR_ARGUMENT : stage == 1 ? HAL_ERROR_IO : HAL_OK);
        if (started == HAL_OK) {
            CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
            kernel_camera_give_back(&frame);
        }
        model->refuses = stage >= 2;
        CHECK_EQ(hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_ZOOM, 300), HAL_OK);
        CHECK_EQ(hal_camera_stop(&kernel_camera.hal), HAL_OK);
        linux_camera_close(&kernel_camera);
        model->refuses = false;
        kernel_camera_open(UVC_CAMERA_NAME);
        stream(33333);
        CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
    }
}

/// Pulled out between any two calls of its life; every call that follows ends, and says that it is
/// gone; plugged in again, it works.
static void pulled_out_at_every_step(void) {
    for (int step = 0; step < 7 && check_clean(); step++) {
        reset_usb(NULL);
        struct hal_camera_frame frame = {0};
        struct hal_camera_format format = {.pixels = HAL_CAMERA_MJPEG};
        enum hal_status last = HAL_OK;
        for (int at = 0; at < 7; at++) {
            if (at == step) {
                unplug(NULL);
            }
            switch (at) {
            case 0:
                last = hal_camera_negotiate(&kernel_camera.hal, &format);
                break;
            case 1:
                last = hal_camera_start(&kernel_camera.hal);
                break;
            case 2:
                last = kernel_camera_take(&frame);
                break;
            case 3:
                last = hal_camera_requeue(&kernel_camera.hal, &frame);
                break;
            case 4:
                last = hal_camera_control_set(&kernel_camera.hal, HAL_CAMERA_TILT, 7200);
                break;
            case 5:
                last = kernel_camera_take(&frame);
                break;
            default:
                last = hal_camera_stop(&kernel_camera.hal);
                break;
            }
            if (at < step) {
                CHECK_EQ(last, HAL_OK);
            }
        }
        CHECK(step == 6 || last == HAL_ERROR_GONE);
        linux_camera_close(&kernel_camera);
        CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_ERROR_GONE);
    }
    reset_usb(NULL);
    stream(33333);
    struct hal_camera_frame frame;
    CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
}

// ---------------------------------------------------------------- lines for people

static void expect_line(const char *device, enum hal_status wanted, const char *end) {
    struct linux_camera other;
    CHECK_EQ(linux_camera_open(&other, device, &kernel_camera_clock.hal), wanted);
    if (!CHECK(strncmp(other.error.line, device, strlen(device)) == 0 &&
               strcmp(other.error.line + strlen(device), end) == 0)) {
        printf("  %s\n", other.error.line);
    }
    linux_camera_close(&other);
}

static void refusals_say_what_to_do(void) {
    expect_line("/dev/video99", HAL_ERROR_GONE,
                ": no such file or device; is it plugged in? `boresight probe` lists the cameras");
    expect_line("No such camera", HAL_ERROR_GONE,
                ": no camera of that name; is it plugged in? `boresight probe` lists the cameras");
    expect_line("/dev/null", HAL_ERROR_UNSUPPORTED,
                ": it gives no frames; `boresight probe` lists the cameras");
    reset_usb(NULL);
    stream(33333);
    struct linux_camera other;
    CHECK_EQ(linux_camera_open(&other, UVC_CAMERA_NAME, &kernel_camera_clock.hal), HAL_OK);
    struct hal_camera_format format = {.pixels = HAL_CAMERA_GREY};
    CHECK_EQ(hal_camera_negotiate(&other.hal, &format), HAL_ERROR_DENIED);
    CHECK(strstr(other.error.line, ": in use by another program; end that one first") != NULL);
    linux_camera_close(&other);
}

/// By its path and by its name, which it doesn't tell nobody.
static void forbidden(void) {
    char path[LINUX_CAMERA_PATH_BYTES];
    reset_usb(NULL);
    snprintf(path, sizeof path, "%s", kernel_camera.path);
    linux_camera_close(&kernel_camera);
    nobody_begin();
    expect_line(path, HAL_ERROR_DENIED,
                ": no permission; its mode is 600 and no group is let in: a udev rule or chmod has "
                "to change that");
    CHECK_EQ(linux_camera_open(&kernel_camera, UVC_CAMERA_NAME, &kernel_camera_clock.hal),
             HAL_ERROR_DENIED);
    CHECK(strstr(kernel_camera.error.line, ": no permission; ") != NULL);
    nobody_end();
}

static void the_list_tells_what_it_can(void) {
    reset_usb(NULL);
    linux_camera_close(&kernel_camera);
    struct linux_camera_info list[8];
    const uint32_t count = linux_camera_list(list, 8);
    bool seen = false;
    for (uint32_t i = 0; i < count && i < 8U; i++) {
        if (strcmp(list[i].name, UVC_CAMERA_NAME) == 0) {
            seen = true;
            CHECK_EQ(list[i].pixels, 0xE);
            CHECK_EQ(list[i].controls, 7);
            CHECK_EQ(list[i].width_px, UVC_CAMERA_WIDTH);
            CHECK_EQ(list[i].height_px, UVC_CAMERA_HEIGHT);
            CHECK_EQ(list[i].zoom.max, UVC_CAMERA_ZOOM_MAX);
        }
    }
    CHECK(seen);
}

#define TIMED(function) check_run_timed("linux_camera." #function, function, pauses_excuse)

int main(void) {
    kernel_camera_begin(INTERVAL_US);
    model = usb_port_share(sizeof *model);
    suite("uvc_grey", HAL_CAMERA_GREY);
    suite("uvc_mjpeg", HAL_CAMERA_MJPEG);
    TIMED(pictures_arrive);
    TIMED(lost_frames_leave_gaps);
    TIMED(silence_is_empty);
    TIMED(settings_reach_the_camera);
    TIMED(a_slow_camera_gets_the_last);
    TIMED(refused_settings_are_counted);
    TIMED(settings_notice_that_it_has_left);
    TIMED(fails_at_every_step);
    TIMED(requests_are_stalled_at_every_stage);
    TIMED(pulled_out_at_every_step);
    TIMED(refusals_say_what_to_do);
    TIMED(forbidden);
    TIMED(the_list_tells_what_it_can);
    linux_camera_close(&kernel_camera);
    usb_port_unplug(&port);
    return check_finish();
}
