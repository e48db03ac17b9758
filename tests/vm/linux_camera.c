/// The camera driver on the kernel's vivid, and on a USB camera that is emulated below the kernel's
/// uvcvideo. The contract suite in every format; then what only a broken camera does.
#include "linux/linux_camera.h"
#include "contract/support/camera_suite.h"
#include "contract/support/contract.h"
#include "contract/support/syscalls.h"
#include "linux/linux_clock.h"
#include "linux/linux_luma.h"
#include "vm/support/pauses.h"
#include "vm/support/uvc_camera.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define INTERVAL_US 100000U
#define PATIENCE_MS 30000
#define VIVID_NAME  "vivid"

static struct linux_clock board_clock;
static struct linux_camera camera;
static struct uvc_camera *model;
static struct usb_port port;

// ---------------------------------------------------------------- hands

/// Opens it as soon as it is there: the kernel takes its time to look at what was plugged in.
static void open_by_name(const char *name) {
    enum hal_status status = HAL_ERROR_GONE;
    for (int ms = 0; ms < PATIENCE_MS && status != HAL_OK; ms += 10) {
        status = linux_camera_open(&camera, name, &board_clock.hal);
        if (status != HAL_OK) {
            usleep(10000);
        }
    }
    if (!CHECK_EQ(status, HAL_OK)) { // nothing else makes sense then
        printf("  %s\nFAIL linux_camera.opens\n", camera.error.line);
        exit(2);
    }
}

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
    linux_camera_close(&camera);
    plug();
    open_by_name(UVC_CAMERA_NAME);
}

static void reset_vivid(void *context) {
    (void)context;
    linux_camera_close(&camera);
    open_by_name(VIVID_NAME);
}

static void settle(void *context) {
    (void)context;
    usleep(2000);
}

static void suite(const char *name, enum hal_camera_pixels pixels, bool usb) {
    const struct hal_camera_format format = {.pixels = pixels,
                                             .width_px = 320,
                                             .height_px = usb ? 240 : 180,
                                             .interval_us = INTERVAL_US};
    (usb ? reset_usb : reset_vivid)(NULL);
    camera_suite(&(struct camera_fixture){.name = name,
                                          .camera = &camera.hal,
                                          .clock = &board_clock.hal,
                                          .format = format,
                                          .buffer_count = LINUX_CAMERA_BUFFERS,
                                          .reset = usb ? reset_usb : reset_vivid,
                                          .settle = settle,
                                          .unplug = usb ? unplug : NULL,
                                          .excuse = pauses_excuse});
}

static void stream(uint32_t interval_us) {
    struct hal_camera_format format = {.pixels = HAL_CAMERA_GREY,
                                       .width_px = UVC_CAMERA_WIDTH / 2U,
                                       .height_px = UVC_CAMERA_HEIGHT / 2U,
                                       .interval_us = interval_us};
    CHECK_EQ(hal_camera_negotiate(&camera.hal, &format), HAL_OK);
    CHECK_EQ(hal_camera_start(&camera.hal), HAL_OK);
}

/// The next frame, or what else comes.
static enum hal_status take(struct hal_camera_frame *frame) {
    enum hal_status status = HAL_EMPTY;
    for (int ms = 0; ms < PATIENCE_MS && status == HAL_EMPTY; ms += 100) {
        struct pollfd ready = {camera.fd, POLLIN, 0};
        (void)poll(&ready, 1, 100);
        status = hal_camera_dequeue(&camera.hal, frame);
    }
    return status;
}

static void give_back(const struct hal_camera_frame *frame) {
    CHECK_EQ(hal_camera_requeue(&camera.hal, frame), HAL_OK);
}

static bool wait_until(volatile int32_t *what, int32_t value) {
    for (int ms = 0; ms < PATIENCE_MS && *what != value; ms++) {
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
        CHECK_EQ(hal_camera_negotiate(&camera.hal, &format), HAL_OK);
        CHECK_EQ(format.pixels, pixels);
        const uint32_t before = model->frames;
        CHECK_EQ(hal_camera_start(&camera.hal), HAL_OK);
        for (uint32_t i = 0; i < 5U; i++) {
            struct hal_camera_frame frame = {0};
            struct hal_camera_luma got = {0};
            CHECK_EQ(take(&frame), HAL_OK);
            CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_OK);
            CHECK(!got.damaged);
            const uint8_t wanted = (uint8_t)(before + frame.sequence);
            for (uint32_t at = 0; at < format.width_px * format.height_px && check_clean(); at++) {
                CHECK_NEAR(got.luma[at], wanted, pixels == HAL_CAMERA_MJPEG ? 1 : 0);
            }
            give_back(&frame);
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
    CHECK_EQ(take(&frame), HAL_OK);
    give_back(&frame);
    for (int kind = 0; kind < 2; kind++) {
        uint32_t missing = 0, damaged = 0, before = frame.sequence;
        *(kind == 0 ? &model->tear_next : &model->spoil_next) = 3;
        for (int i = 0; i < 60 && missing + damaged < 3U; i++) {
            CHECK_EQ(take(&frame), HAL_OK);
            damaged += frame.damaged ? 1U : 0U;
            missing += frame.sequence - before - 1U;
            before = frame.sequence;
            give_back(&frame);
        }
        CHECK_EQ(missing + damaged, 3);
    }
}

/// The camera falls silent and speaks again: nothing comes, nothing breaks.
static void silence_is_empty(void) {
    reset_usb(NULL);
    stream(33333);
    struct hal_camera_frame frame = {0};
    CHECK_EQ(take(&frame), HAL_OK);
    give_back(&frame);
    model->silent = true;
    usleep(200000); // what is on its way
    enum hal_status status = HAL_OK;
    while (status == HAL_OK) {
        status = hal_camera_dequeue(&camera.hal, &frame);
        if (status == HAL_OK) {
            give_back(&frame);
        }
    }
    CHECK_EQ(status, HAL_EMPTY);
    usleep(300000);
    CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame), HAL_EMPTY);
    model->silent = false;
    CHECK_EQ(take(&frame), HAL_OK);
}

// ---------------------------------------------------------------- pan, tilt, zoom

static void settings_reach_the_camera(void) {
    reset_usb(NULL);
    CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 36000), HAL_OK);
    CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_TILT, -7200), HAL_OK);
    CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_ZOOM, 250), HAL_OK);
    CHECK(wait_until(&model->pan, 36000) && wait_until(&model->tilt, -7200) &&
          wait_until(&model->zoom, 250));
    // Where it was when another program opens it.
    linux_camera_close(&camera);
    open_by_name(UVC_CAMERA_NAME);
    int32_t value = 0;
    CHECK_EQ(hal_camera_control_get(&camera.hal, HAL_CAMERA_PAN, &value), HAL_OK);
    CHECK_EQ(value, 36000);
}

/// While a slow camera works on one setting, later ones replace each other; the last one arrives.
static void a_slow_camera_gets_the_last(void) {
    reset_usb(NULL);
    model->slow_us = 100000;
    const uint32_t before = model->settings;
    for (int32_t i = 1; i <= 200; i++) {
        CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 36 * i), HAL_OK);
        CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_TILT, -36 * i), HAL_OK);
        usleep(1000);
    }
    CHECK(wait_until(&model->pan, 7200) && wait_until(&model->tilt, -7200));
    CHECK(model->settings - before < 100U);
    model->slow_us = 0;
    CHECK_EQ(linux_camera_failed_settings(&camera), 0);
}

/// A setting that the camera refuses is counted, and the control tells that the old one holds.
static void refused_settings_are_counted(void) {
    reset_usb(NULL);
    CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 3600), HAL_OK);
    CHECK(wait_until(&model->pan, 3600));
    model->refuse_next = 1;
    CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 72000), HAL_OK);
    for (int ms = 0; ms < PATIENCE_MS && linux_camera_failed_settings(&camera) == 0U; ms++) {
        usleep(1000);
    }
    CHECK_EQ(linux_camera_failed_settings(&camera), 1);
    int32_t value = 0;
    CHECK_EQ(hal_camera_control_get(&camera.hal, HAL_CAMERA_PAN, &value), HAL_OK);
    CHECK_EQ(value, 3600);
    CHECK_EQ(model->pan, 3600);
    CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 72000), HAL_OK);
    CHECK(wait_until(&model->pan, 72000));
}

/// Pulled out while a setting is on its way and nothing streams: the next call knows.
static void settings_notice_that_it_has_left(void) {
    reset_usb(NULL);
    model->slow_us = 200000;
    CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 3600), HAL_OK);
    unplug(NULL);
    enum hal_status status = HAL_OK;
    for (int ms = 0; ms < PATIENCE_MS && status == HAL_OK; ms++) {
        status = hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 36 * (ms % 100));
        usleep(1000);
    }
    CHECK_EQ(status, HAL_ERROR_GONE);
    CHECK(strstr(camera.error.line, ": the camera has left; plug it in again") != NULL);
    linux_camera_close(&camera);
}

// ---------------------------------------------------------------- failures at every step

/// From opening to closing. Returns how far it came; each step may fail, none may break.
static int whole_life(void) {
    int steps = 0;
    struct hal_camera_frame frame;
    if (linux_camera_open(&camera, UVC_CAMERA_NAME, &board_clock.hal) != HAL_OK) {
        CHECK(camera.error.line[0] != '\0');
        CHECK_EQ(hal_camera_start(&camera.hal), HAL_ERROR_GONE);
        return steps;
    }
    struct hal_camera_format format = {.pixels = HAL_CAMERA_GREY, .width_px = 160};
    steps += hal_camera_negotiate(&camera.hal, &format) == HAL_OK;
    steps += hal_camera_start(&camera.hal) == HAL_OK;
    for (int i = 0; i < 3; i++) {
        if (take(&frame) == HAL_OK) {
            CHECK(frame.size_bytes > 0U && frame.size_bytes <= format.frame_bytes_max);
            steps += hal_camera_requeue(&camera.hal, &frame) == HAL_OK;
        }
    }
    steps += hal_camera_control_set(&camera.hal, HAL_CAMERA_PAN, 3600) == HAL_OK;
    steps += hal_camera_stop(&camera.hal) == HAL_OK;
    return steps;
}

/// Each system call in turn fails; then all is well again, and nothing is left open.
static void every_system_call_fails_once(void) {
    linux_camera_close(&camera);
    plug();
    open_by_name(UVC_CAMERA_NAME);
    linux_camera_close(&camera);
    const uint32_t files = syscalls_open_files();
    const int errors[] = {EIO, ENODEV};
    uint32_t calls = 0;
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
        for (uint32_t nth = 1; check_clean(); nth++) {
            syscalls_at(nth, SYSCALLS_FAIL, errors[i]);
            (void)whole_life();
            const bool met = syscalls_met();
            syscalls_at(0, SYSCALLS_FAIL, 0);
            linux_camera_close(&camera);
            CHECK_EQ(syscalls_open_files(), files);
            if (nth % 10U == 1U || !met) { // it still works
                CHECK_EQ(whole_life(), 7);
                linux_camera_close(&camera);
            }
            if (!met) {
                calls = nth;
                break;
            }
        }
    }
    check_note("system calls from open to close", calls);
    CHECK(calls > 40U);
}

/// Every request of its class stalls, at every stage; then it works again.
static void requests_are_stalled_at_every_stage(void) {
    for (int stage = 0; stage < 4; stage++) {
        reset_usb(NULL);
        struct hal_camera_frame frame;
        struct hal_camera_format format = {.pixels = HAL_CAMERA_YUYV};
        model->refuses = stage == 0;
        const enum hal_status agreed = hal_camera_negotiate(&camera.hal, &format);
        CHECK_EQ(agreed, stage == 0 ? HAL_ERROR_IO : HAL_OK);
        model->refuses = stage == 1;
        const enum hal_status started = hal_camera_start(&camera.hal);
        CHECK_EQ(started, stage == 0 ? HAL_ERROR_ARGUMENT : stage == 1 ? HAL_ERROR_IO : HAL_OK);
        if (started == HAL_OK) {
            CHECK_EQ(take(&frame), HAL_OK);
            give_back(&frame);
        }
        model->refuses = stage >= 2;
        CHECK_EQ(hal_camera_control_set(&camera.hal, HAL_CAMERA_ZOOM, 300), HAL_OK);
        CHECK_EQ(hal_camera_stop(&camera.hal), HAL_OK);
        linux_camera_close(&camera);
        model->refuses = false;
        open_by_name(UVC_CAMERA_NAME);
        stream(33333);
        CHECK_EQ(take(&frame), HAL_OK);
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
                last = hal_camera_negotiate(&camera.hal, &format);
                break;
            case 1:
                last = hal_camera_start(&camera.hal);
                break;
            case 2:
                last = take(&frame);
                break;
            case 3:
                last = hal_camera_requeue(&camera.hal, &frame);
                break;
            case 4:
                last = hal_camera_control_set(&camera.hal, HAL_CAMERA_TILT, 7200);
                break;
            case 5:
                last = take(&frame);
                break;
            default:
                last = hal_camera_stop(&camera.hal);
                break;
            }
            if (at < step) {
                CHECK_EQ(last, HAL_OK);
            }
        }
        CHECK(step == 6 || last == HAL_ERROR_GONE);
        linux_camera_close(&camera);
        CHECK_EQ(hal_camera_start(&camera.hal), HAL_ERROR_GONE);
    }
    reset_usb(NULL);
    stream(33333);
    struct hal_camera_frame frame;
    CHECK_EQ(take(&frame), HAL_OK);
}

// ---------------------------------------------------------------- lines for people

static void expect_line(const char *device, enum hal_status wanted, const char *end) {
    struct linux_camera other;
    CHECK_EQ(linux_camera_open(&other, device, &board_clock.hal), wanted);
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
    CHECK_EQ(linux_camera_open(&other, UVC_CAMERA_NAME, &board_clock.hal), HAL_OK);
    struct hal_camera_format format = {.pixels = HAL_CAMERA_GREY};
    CHECK_EQ(hal_camera_negotiate(&other.hal, &format), HAL_ERROR_DENIED);
    CHECK(strstr(other.error.line, ": in use by another program; end that one first") != NULL);
    linux_camera_close(&other);
}

static void the_list_tells_what_it_can(void) {
    reset_usb(NULL);
    linux_camera_close(&camera);
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
    linux_clock_open(&board_clock, 0xFFFF0000U); // wraps while it runs
    pauses_watch(INTERVAL_US / 4U);
    camera.fd = -1;
    char path[LINUX_CAMERA_PATH_BYTES];
    struct linux_error error;
    if (linux_camera_find(VIVID_NAME, path, sizeof path, &error) == HAL_OK) {
        suite("vivid_grey", HAL_CAMERA_GREY, false);
        suite("vivid_yuyv", HAL_CAMERA_YUYV, false);
        linux_camera_close(&camera);
    } else {
        contract_skip("linux_camera", "vivid", "the kernel has no vivid");
    }
    model = usb_port_share(sizeof *model);
    suite("uvc_grey", HAL_CAMERA_GREY, true);
    suite("uvc_mjpeg", HAL_CAMERA_MJPEG, true);
    TIMED(pictures_arrive);
    TIMED(lost_frames_leave_gaps);
    TIMED(silence_is_empty);
    TIMED(settings_reach_the_camera);
    TIMED(a_slow_camera_gets_the_last);
    TIMED(refused_settings_are_counted);
    TIMED(settings_notice_that_it_has_left);
    TIMED(every_system_call_fails_once);
    TIMED(requests_are_stalled_at_every_stage);
    TIMED(pulled_out_at_every_step);
    TIMED(refusals_say_what_to_do);
    TIMED(the_list_tells_what_it_can);
    linux_camera_close(&camera);
    usb_port_unplug(&port);
    return check_finish();
}
