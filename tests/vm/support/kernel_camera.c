#include "vm/support/kernel_camera.h"

#include "check.h"
#include "vm/support/pauses.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

struct linux_camera kernel_camera;
struct linux_clock kernel_camera_clock;

void kernel_camera_begin(uint32_t interval_us) {
    linux_clock_open(&kernel_camera_clock, 0xFFFF0000U); // wraps while it runs
    pauses_watch(interval_us / 4U);
    kernel_camera.fd = -1;
}

void kernel_camera_open(const char *name) {
    enum hal_status status = HAL_ERROR_GONE;
    for (int ms = 0; ms < KERNEL_CAMERA_PATIENCE_MS && status != HAL_OK; ms += 10) {
        status = linux_camera_open(&kernel_camera, name, &kernel_camera_clock.hal);
        if (status != HAL_OK) {
            usleep(10000);
        }
    }
    if (!CHECK_EQ(status, HAL_OK)) { // nothing else makes sense then
        printf("  %s\nFAIL linux_camera.opens\n", kernel_camera.error.line);
        exit(2);
    }
}

enum hal_status kernel_camera_take(struct hal_camera_frame *frame) {
    enum hal_status status = HAL_EMPTY;
    for (int ms = 0; ms < KERNEL_CAMERA_PATIENCE_MS && status == HAL_EMPTY; ms += 100) {
        struct pollfd ready = {kernel_camera.fd, POLLIN, 0};
        (void)poll(&ready, 1, 100);
        status = hal_camera_dequeue(&kernel_camera.hal, frame);
    }
    return status;
}

void kernel_camera_give_back(const struct hal_camera_frame *frame) {
    CHECK_EQ(hal_camera_requeue(&kernel_camera.hal, frame), HAL_OK);
}
