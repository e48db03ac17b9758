/// The camera driver on the kernel's vivid: the contract suite, and the failures that vivid makes
/// of its own calls, which is also how it leaves.
#include "contract/support/camera_suite.h"
#include "contract/support/contract.h"
#include "vm/support/kernel_camera.h"
#include "vm/support/pauses.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define INTERVAL_US 100000U
#define VIVID_NAME  "vivid"

static void reset_vivid(void *context) {
    (void)context;
    linux_camera_close(&kernel_camera);
    kernel_camera_open(VIVID_NAME);
}

static void settle(void *context) {
    (void)context;
    usleep(2000);
}

/// Presses one of the buttons with which vivid makes its own calls fail. False: it has none.
static bool press(const char *name) {
    char path[LINUX_CAMERA_PATH_BYTES];
    struct linux_error error;
    struct v4l2_queryctrl about = {.id = V4L2_CTRL_FLAG_NEXT_CTRL};
    if (linux_camera_find(VIVID_NAME, path, sizeof path, &error) != HAL_OK) {
        return false;
    }
    const int fd = open(path, O_RDWR | O_NONBLOCK);
    bool pressed = false;
    while (fd >= 0 && !pressed && ioctl(fd, VIDIOC_QUERYCTRL, &about) == 0) {
        struct v4l2_control button = {.id = about.id, .value = 1};
        pressed = strcmp((const char *)about.name, name) == 0 &&
                  CHECK_EQ(ioctl(fd, VIDIOC_S_CTRL, &button), 0);
        about.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    close(fd);
    return pressed;
}

static void unplug_vivid(void *context) {
    (void)context;
    CHECK(press("Disconnect"));
}

static void stream_vivid(void) {
    struct hal_camera_format format = {
        .pixels = HAL_CAMERA_GREY, .width_px = 320, .height_px = 180, .interval_us = INTERVAL_US};
    reset_vivid(NULL);
    CHECK_EQ(hal_camera_negotiate(&kernel_camera.hal, &format), HAL_OK);
}

static void failures_of_the_kernel_itself(void) {
    static const char *const refusals[] = {
        "Inject VIDIOC_REQBUFS Error", "Inject VIDIOC_QBUF Error", "Inject VIDIOC_STREAMON Error"};
    struct hal_camera_frame frame = {0};
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        stream_vivid();
        CHECK(press(refusals[i]));
        CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_ERROR_IO);
        CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_OK);
        CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
    }
    stream_vivid();
    CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_OK);
    CHECK(press("Inject V4L2_BUF_FLAG_ERROR"));
    bool damaged = false;
    for (int i = 0; i < 10 && !damaged; i++) { // of those that wait already none is
        CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
        damaged = frame.damaged;
        kernel_camera_give_back(&frame);
    }
    CHECK(damaged);
    CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
    CHECK(!frame.damaged);
    kernel_camera_give_back(&frame);
    CHECK(press("Inject Fatal Streaming Error"));
    enum hal_status status = HAL_OK;
    for (int i = 0; i < 10 && status == HAL_OK; i++) {
        status = kernel_camera_take(&frame);
        if (status == HAL_OK) {
            kernel_camera_give_back(&frame);
        }
    }
    CHECK_EQ(status, HAL_ERROR_IO); // until it is started anew
    CHECK_EQ(hal_camera_dequeue(&kernel_camera.hal, &frame), HAL_ERROR_IO);
    CHECK_EQ(hal_camera_stop(&kernel_camera.hal), HAL_OK);
    CHECK_EQ(hal_camera_start(&kernel_camera.hal), HAL_OK);
    CHECK_EQ(kernel_camera_take(&frame), HAL_OK);
    CHECK(!frame.damaged);
}

static void suite(const char *name, enum hal_camera_pixels pixels) {
    const struct hal_camera_format format = {
        .pixels = pixels, .width_px = 320, .height_px = 180, .interval_us = INTERVAL_US};
    reset_vivid(NULL);
    camera_suite(&(struct camera_fixture){.name = name,
                                          .camera = &kernel_camera.hal,
                                          .clock = &kernel_camera_clock.hal,
                                          .format = format,
                                          .buffer_count = LINUX_CAMERA_BUFFERS,
                                          .reset = reset_vivid,
                                          .settle = settle,
                                          .unplug = unplug_vivid,
                                          .excuse = pauses_excuse});
}

int main(void) {
    char path[LINUX_CAMERA_PATH_BYTES];
    struct linux_error error;
    kernel_camera_begin(INTERVAL_US);
    if (linux_camera_find(VIVID_NAME, path, sizeof path, &error) != HAL_OK) {
        contract_skip("linux_camera", "vivid", "the kernel has no vivid");
        return 0;
    }
    suite("vivid_grey", HAL_CAMERA_GREY);
    suite("vivid_yuyv", HAL_CAMERA_YUYV);
    check_run_timed("vivid.failures_of_the_kernel_itself", failures_of_the_kernel_itself,
                    pauses_excuse);
    linux_camera_close(&kernel_camera);
    return check_finish();
}
