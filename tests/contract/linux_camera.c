/// The camera driver, and a camera's pan and zoom as channels of pulses, on a video device that
/// stands below the C library: in the test's time, with every error at every step.
/// tests/vm/linux_camera.c has the same on the kernel's own devices.
#include "linux/linux_camera.h"
#include "contract/support/camera_suite.h"
#include "contract/support/contract.h"
#include "contract/support/failing_camera.h"
#include "contract/support/lives.h"
#include "contract/support/syscalls.h"
#include "contract/support/v4l2_model.h"
#include "devices/fake_clock.h"
#include "linux/linux_camera_servo.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define INTERVAL_US 33333U

static struct fake_clock clock_;
static struct linux_camera camera;
static struct failing_camera failing;
static struct linux_camera_servo servo;
static const char *path;

// ---------------------------------------------------------------- hands

static void fail_kernel(bool on) {
    syscalls_at(on ? 1 : 0, SYSCALLS_FAIL_ON, EIO);
}

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    return failing_camera_at(&failing, nth, status);
}

static void reset(void *context) {
    (void)context;
    linux_camera_close(&camera);
    v4l2_model_reset();
    CHECK_EQ(linux_camera_open(&camera, path, &clock_.hal), HAL_OK);
    failing_camera_init(&failing, &camera.hal, fail_kernel);
}

static void settle(void *context) {
    (void)context;
    fake_clock_advance(&clock_, INTERVAL_US / 8U);
}

static void unplug(void *context) {
    (void)context;
    v4l2_model_unplug();
}

static void stream(void) {
    struct hal_camera_format format = {
        .pixels = HAL_CAMERA_GREY, .width_px = 160, .height_px = 120, .interval_us = INTERVAL_US};
    CHECK_EQ(hal_camera_negotiate(&camera.hal, &format), HAL_OK);
    CHECK_EQ(hal_camera_start(&camera.hal), HAL_OK);
}

/// The next frame, or what else comes.
static enum hal_status take(struct hal_camera_frame *frame) {
    enum hal_status status = HAL_EMPTY;
    for (int i = 0; i < 80 && status == HAL_EMPTY; i++) {
        settle(NULL);
        status = hal_camera_dequeue(&camera.hal, frame);
    }
    return status;
}

static void give_back(const struct hal_camera_frame *frame) {
    CHECK_EQ(hal_camera_requeue(&camera.hal, frame), HAL_OK);
}

/// Until so many settings have got to the camera, or not.
static void await_settings(uint32_t count) {
    for (int i = 0;
         i < 300000 &&
         linux_camera_taken_settings(&camera) + linux_camera_failed_settings(&camera) < count;
         i++) {
        usleep(100);
    }
    CHECK(linux_camera_taken_settings(&camera) + linux_camera_failed_settings(&camera) >= count);
}

// ---------------------------------------------------------------- frames that are not whole

static void damaged_frames_say_so(void) {
    reset(NULL);
    stream();
    struct hal_camera_frame frame = {0};
    v4l2_model_faults.flag = 1;
    CHECK_EQ(take(&frame), HAL_OK);
    CHECK(frame.damaged && frame.sequence == 0U && frame.size_bytes == 160U * 120U);
    give_back(&frame);
    v4l2_model_faults.cut = 1;
    CHECK_EQ(take(&frame), HAL_OK);
    CHECK(frame.damaged && frame.sequence == 1U && frame.size_bytes == 80U * 120U);
    give_back(&frame);
    CHECK_EQ(take(&frame), HAL_OK);
    CHECK(!frame.damaged && frame.sequence == 2U && frame.data[0] == 7U);
    give_back(&frame);
    v4l2_model_faults.lose = 3;
    CHECK_EQ(take(&frame), HAL_OK);
    CHECK(!frame.damaged && frame.sequence == 6U);
}

/// Their buffers go back to the camera, even if that fails the first time.
static void frames_without_a_picture(void) {
    for (unsigned kind = 0; kind < 4U; kind++) {
        reset(NULL);
        stream();
        struct hal_camera_frame frame = {.sequence = 77};
        for (uint32_t i = 0; i < 3U * LINUX_CAMERA_BUFFERS && check_clean(); i++) {
            *(kind % 2U == 0U ? &v4l2_model_faults.empty : &v4l2_model_faults.swell) = 1;
            fake_clock_advance(&clock_, INTERVAL_US);
            syscalls_at(kind < 2U ? 0 : 2, SYSCALLS_FAIL, EIO); // giving it back
            CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame), HAL_ERROR_IO);
            CHECK_EQ(frame.sequence, 77);
            syscalls_at(0, SYSCALLS_FAIL, 0);
            CHECK(strstr(camera.error.line, path) != NULL);
            CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame), HAL_EMPTY);
        }
        CHECK_EQ(v4l2_model_queued(), LINUX_CAMERA_BUFFERS);
        CHECK_EQ(take(&frame), HAL_OK);
        CHECK_EQ(frame.sequence, 0);
    }
}

/// What taking a frame answers when the kernel says error_number, once; the frame is not lost.
static void expect_dequeue(int error_number, enum hal_status wanted) {
    reset(NULL);
    stream();
    struct hal_camera_frame frame = {.sequence = 77};
    fake_clock_advance(&clock_, INTERVAL_US);
    syscalls_at(1, SYSCALLS_FAIL, error_number);
    CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame), wanted);
    syscalls_at(0, SYSCALLS_FAIL, 0);
    CHECK_EQ(frame.sequence, 77);
    CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame),
             wanted == HAL_ERROR_GONE ? HAL_ERROR_GONE : HAL_OK);
    CHECK_EQ(frame.sequence, wanted == HAL_ERROR_GONE ? 77 : 0);
}

static void frames_that_can_not_be_taken(void) {
    expect_dequeue(EAGAIN, HAL_EMPTY);
    expect_dequeue(EIO, HAL_ERROR_IO);
    expect_dequeue(EBUSY, HAL_ERROR_IO);
    expect_dequeue(ENOMEM, HAL_ERROR_IO);
    expect_dequeue(ENODEV, HAL_ERROR_GONE);
    expect_dequeue(ENXIO, HAL_ERROR_GONE);
    expect_dequeue(ESHUTDOWN, HAL_ERROR_GONE);
}

// ---------------------------------------------------------------- controls

/// A question that gets lost is asked again; a camera that can't answer it has no such control.
static void controls_that_break(void) {
    struct hal_camera_range range;
    for (uint32_t errors = 0; errors <= 2U; errors++) {
        linux_camera_close(&camera);
        v4l2_model_reset();
        v4l2_model_faults.control_error = EIO;
        v4l2_model_faults.control_errors = errors;
        CHECK_EQ(linux_camera_open(&camera, path, &clock_.hal), HAL_OK);
        CHECK_EQ(hal_camera_control_range(&camera.hal, HAL_CAMERA_PAN, &range),
                 errors < 2U ? HAL_OK : HAL_ERROR_UNSUPPORTED);
        CHECK_EQ(hal_camera_control_range(&camera.hal, HAL_CAMERA_TILT, &range), HAL_OK);
        stream();
        struct hal_camera_frame frame;
        CHECK_EQ(take(&frame), HAL_OK);
    }
}

/// By the camera's pulses, too: the old value holds, and it is counted.
static void settings_that_fail(void) {
    const int errors[] = {EIO, ERANGE, EBUSY};
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
        int32_t value = 77;
        reset(NULL);
        CHECK_EQ(linux_camera_servo_bind(&servo, &camera.hal), HAL_OK);
        CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, 10003600), HAL_OK);
        await_settings(1);
        v4l2_model_faults.refuse = errors[i];
        CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, 10007200), HAL_OK);
        await_settings(2);
        CHECK_EQ(linux_camera_failed_settings(&camera), 1);
        CHECK_EQ(hal_camera_control_get(&camera.hal, HAL_CAMERA_PAN, &value), HAL_OK);
        CHECK_EQ(value, 3600);
        v4l2_model_faults.refuse = 0;
        CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, 10007200), HAL_OK);
        await_settings(3);
        CHECK_EQ(v4l2_model_value(V4L2_CID_PAN_ABSOLUTE), 7200);
    }
    const int gone[] = {ENODEV, ENXIO, ESHUTDOWN};
    for (size_t i = 0; i < sizeof gone / sizeof *gone; i++) {
        struct hal_pwm_limits limits;
        reset(NULL);
        CHECK_EQ(linux_camera_servo_bind(&servo, &camera.hal), HAL_OK);
        v4l2_model_faults.refuse = gone[i];
        CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_TILT, 10003600), HAL_OK);
        await_settings(1);
        CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_TILT, 10003600), HAL_ERROR_GONE);
        CHECK_EQ(hal_pwm_limits(&servo.hal, HAL_CAMERA_TILT, &limits), HAL_ERROR_GONE);
        CHECK(strstr(camera.error.line, ": the camera has left; plug it in again") != NULL);
    }
}

// ---------------------------------------------------------------- opening

static void expect_refusal(enum hal_status wanted, const char *end) {
    struct linux_camera refused;
    CHECK_EQ(linux_camera_open(&refused, path, &clock_.hal), wanted);
    if (!CHECK(strncmp(refused.error.line, path, strlen(path)) == 0 &&
               strcmp(refused.error.line + strlen(path), end) == 0)) {
        printf("  %s\n", refused.error.line);
    }
    CHECK_EQ(hal_camera_start(&refused.hal), HAL_ERROR_GONE);
    linux_camera_close(&refused);
}

static void cameras_that_can_not_be_had(void) {
    reset(NULL);
    v4l2_model_faults.no_frames = true;
    expect_refusal(HAL_ERROR_UNSUPPORTED, ": it gives no frames; `boresight probe` lists the "
                                          "cameras");
    v4l2_model_faults.no_frames = false;
    syscalls_at(1, SYSCALLS_FAIL, EBUSY);
    expect_refusal(HAL_ERROR_DENIED, ": in use by another program; end that one first (`fuser -v` "
                                     "on the file shows it)");
    syscalls_at(0, SYSCALLS_FAIL, 0);
    v4l2_model_faults.busy = true;
    struct hal_camera_format format = {.pixels = HAL_CAMERA_GREY};
    CHECK_EQ(hal_camera_negotiate(&camera.hal, &format), HAL_ERROR_DENIED);
    v4l2_model_faults.busy = false;
    CHECK_EQ(hal_camera_negotiate(&camera.hal, &format), HAL_OK);
    v4l2_model_faults.busy = true;
    CHECK_EQ(hal_camera_start(&camera.hal), HAL_ERROR_DENIED);
    v4l2_model_faults.busy = false;
    CHECK_EQ(hal_camera_start(&camera.hal), HAL_OK);
    reset(NULL);
    v4l2_model_faults.missing = 7;
    CHECK_EQ(hal_camera_negotiate(&camera.hal, &format), HAL_ERROR_UNSUPPORTED);
}

// ---------------------------------------------------------------- errors at every step

static void note_format(struct hal_camera_format format) {
    life_note("negotiate", hal_camera_negotiate(&camera.hal, &format), &camera.error);
    life_value("pixels", format.pixels);
    life_value("width", format.width_px);
    life_value("interval", format.interval_us);
}

static void note_frame(void) {
    struct hal_camera_frame frame = {.sequence = 77};
    fake_clock_advance(&clock_, 100000);
    if (life_note("dequeue", take(&frame), &camera.error) == HAL_OK) {
        life_value("sequence", frame.sequence);
        life_value("bytes", frame.size_bytes);
        life_value("pixel", frame.damaged ? -1 : frame.data[0]);
        life_note("requeue", hal_camera_requeue(&camera.hal, &frame), &camera.error);
    }
}

static void note_controls(void) {
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS; i++) {
        struct hal_camera_range range = {0};
        int32_t value = 77;
        const enum hal_camera_control control = (enum hal_camera_control)i;
        life_note("range", hal_camera_control_range(&camera.hal, control, &range), &camera.error);
        life_value("max", range.max);
        life_note("get", hal_camera_control_get(&camera.hal, control, &value), &camera.error);
        life_value("value", value);
    }
    const enum hal_status set =
        life_note("set", hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, 10007200), &camera.error);
    if (set == HAL_OK) {
        await_settings(1);
    }
    struct hal_pwm_limits limits; // a camera that has left says so now
    const enum hal_status after = hal_pwm_limits(&servo.hal, HAL_CAMERA_PAN, &limits);
    const uint32_t failed = linux_camera_failed_settings(&camera);
    life_note("setting", after == HAL_OK && failed > 0U ? HAL_ERROR_IO : after,
              after != HAL_OK ? &camera.error : NULL);
    life_value("pan", v4l2_model_value(V4L2_CID_PAN_ABSOLUTE));
}

static void live(void) {
    v4l2_model_reset();
    if (life_note("open", linux_camera_open(&camera, path, &clock_.hal), &camera.error) != HAL_OK) {
        CHECK_EQ(hal_camera_start(&camera.hal), HAL_ERROR_GONE);
        return;
    }
    CHECK_EQ(linux_camera_servo_bind(&servo, &camera.hal), HAL_OK);
    note_format((struct hal_camera_format){.pixels = HAL_CAMERA_MJPEG});
    note_format(
        (struct hal_camera_format){.width_px = 160, .height_px = 120, .interval_us = 33333});
    life_note("start", hal_camera_start(&camera.hal), &camera.error);
    note_frame();
    note_frame();
    note_controls();
    life_note("stop", hal_camera_stop(&camera.hal), &camera.error);
    life_note("start", hal_camera_start(&camera.hal), &camera.error);
    note_frame();
    linux_camera_close(&camera);
    CHECK_EQ(hal_camera_start(&camera.hal), HAL_ERROR_GONE);
}

static void fails_at_every_step(void) {
    const uint32_t io = LIFE_STATUS(HAL_ERROR_IO);
    const struct life_error errors[] = {
        LIFE_EIO,
        LIFE_ENODEV,
        LIFE_ENOMEM,
        {EACCES, io | LIFE_STATUS(HAL_ERROR_DENIED)},
        {EBUSY, io | LIFE_STATUS(HAL_ERROR_DENIED)},
        {EAGAIN, io | LIFE_STATUS(HAL_ERROR_DENIED) | LIFE_STATUS(HAL_EMPTY)}};
    linux_camera_close(&camera);
    lives_each_failure(&(struct lives){.device = path,
                                       .live = live,
                                       .errors = errors,
                                       .error_count = 6,
                                       .recover_every = 8,
                                       .dies = true});
}

int main(void) {
    fake_clock_init(&clock_, 0xFFFF0000U); // wraps while it runs
    path = v4l2_model_plug(&clock_.hal);
    camera.fd = -1;
    reset(NULL);
    camera_suite(&(struct camera_fixture){.name = "linux_camera",
                                          .camera = &failing.hal,
                                          .clock = &clock_.hal,
                                          .format = {.pixels = HAL_CAMERA_GREY,
                                                     .width_px = 320,
                                                     .height_px = 240,
                                                     .interval_us = INTERVAL_US},
                                          .buffer_count = LINUX_CAMERA_BUFFERS,
                                          .reset = reset,
                                          .settle = settle,
                                          .unplug = unplug,
                                          .fail_at = fail_at,
                                          .some_cannot_fail = true}); // controls ask a thread
    CONTRACT("linux_camera", damaged_frames_say_so);
    CONTRACT("linux_camera", frames_without_a_picture);
    CONTRACT("linux_camera", frames_that_can_not_be_taken);
    CONTRACT("linux_camera", controls_that_break);
    CONTRACT("linux_camera", settings_that_fail);
    CONTRACT("linux_camera", cameras_that_can_not_be_had);
    CONTRACT("linux_camera", fails_at_every_step);
    linux_camera_close(&camera);
    unlink(path);
    return check_finish();
}
