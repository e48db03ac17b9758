#include "linux/linux_camera_controls.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <string.h>
#include <sys/ioctl.h>

#define ASK_TRIES 2

static const uint32_t ids[HAL_CAMERA_CONTROLS] = {V4L2_CID_PAN_ABSOLUTE, V4L2_CID_TILT_ABSOLUTE,
                                                  V4L2_CID_ZOOM_ABSOLUTE};

// ---------------------------------------------------------------- what there is

/// Asks once more what got lost on its way; a device that has no such control says EINVAL, one
/// without any ENOTTY.
static bool ask(int fd, unsigned long request, void *about) {
    for (int tries = 0; tries < ASK_TRIES; tries++) {
        if (ioctl(fd, request, about) == 0) {
            return true;
        }
        if (errno == EINVAL || errno == ENOTTY) {
            return false;
        }
    }
    return false;
}

static bool read_range(int fd, uint32_t id, struct hal_camera_range *range) {
    struct v4l2_queryctrl query = {.id = id};
    const uint32_t unfit = V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY;
    if (!ask(fd, VIDIOC_QUERYCTRL, &query) || (query.flags & unfit) != 0U ||
        query.minimum > query.maximum) {
        return false;
    }
    *range = (struct hal_camera_range){.min = query.minimum,
                                       .max = query.maximum,
                                       .step = query.step < 1 ? 1 : query.step,
                                       .initial = query.default_value};
    if (range->initial < range->min || range->initial > range->max) {
        range->initial = range->min;
    }
    return true;
}

static int32_t read_value(int fd, uint32_t id, const struct hal_camera_range *range) {
    struct v4l2_control control = {.id = id};
    const bool good = ask(fd, VIDIOC_G_CTRL, &control) && control.value >= range->min &&
                      control.value <= range->max;
    return good ? control.value : range->initial;
}

// ---------------------------------------------------------------- the thread

static bool any_waits(const struct linux_camera_controls *controls) {
    bool any = false;
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS; i++) {
        any = any || controls->waiting[i];
    }
    return any;
}

/// Takes what waits into one request. Zoom has another unit of the camera to go to: alone, unless
/// nothing else waits. Returns how many.
static uint32_t gather(struct linux_camera_controls *controls, struct v4l2_ext_control *list,
                       enum hal_camera_control *which) {
    uint32_t count = 0;
    const bool aims = controls->waiting[HAL_CAMERA_PAN] || controls->waiting[HAL_CAMERA_TILT];
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS; i++) {
        if (!controls->waiting[i] || (i == (unsigned)HAL_CAMERA_ZOOM && aims)) {
            continue;
        }
        list[count] = (struct v4l2_ext_control){.id = ids[i], .value = controls->wanted[i]};
        which[count] = (enum hal_camera_control)i;
        controls->waiting[i] = false;
        count++;
    }
    return count;
}

static void note(struct linux_camera_controls *controls, const enum hal_camera_control *which,
                 const struct v4l2_ext_control *list, uint32_t count, int error_number) {
    for (uint32_t i = 0; i < count; i++) {
        const enum hal_camera_control control = which[i];
        if (error_number == 0) {
            controls->held[control] = list[i].value;
        } else if (!controls->waiting[control]) {
            controls->wanted[control] = controls->held[control]; // the old value holds
        }
    }
    controls->taken += error_number == 0 ? count : 0U;
    if (error_number != 0) {
        controls->failed += count;
        controls->error_number = error_number;
        controls->gone = controls->gone || error_number == ENODEV || error_number == ENXIO ||
                         error_number == ESHUTDOWN;
    }
}

static void *serve(void *context) {
    struct linux_camera_controls *const controls = context;
    pthread_mutex_lock(&controls->mutex);
    while (!controls->ending) {
        if (!any_waits(controls)) {
            pthread_cond_wait(&controls->changed, &controls->mutex);
            continue;
        }
        struct v4l2_ext_control list[HAL_CAMERA_CONTROLS];
        enum hal_camera_control which[HAL_CAMERA_CONTROLS];
        struct v4l2_ext_controls request = {.which = V4L2_CTRL_WHICH_CUR_VAL, .controls = list};
        request.count = gather(controls, list, which);
        pthread_mutex_unlock(&controls->mutex);
        const int error_number = ioctl(controls->fd, VIDIOC_S_EXT_CTRLS, &request) == 0 ? 0 : errno;
        pthread_mutex_lock(&controls->mutex);
        note(controls, which, list, request.count, error_number);
    }
    pthread_mutex_unlock(&controls->mutex);
    return NULL;
}

// ---------------------------------------------------------------- for the device

bool linux_camera_controls_open(struct linux_camera_controls *controls, int fd) {
    memset(controls, 0, sizeof *controls);
    controls->fd = fd;
    bool any = false;
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS; i++) {
        controls->present[i] = read_range(fd, ids[i], &controls->range[i]);
        if (controls->present[i]) {
            controls->wanted[i] = controls->held[i] = read_value(fd, ids[i], &controls->range[i]);
            any = true;
        }
    }
    if (!any) {
        return true;
    }
    pthread_mutex_init(&controls->mutex, NULL);
    pthread_cond_init(&controls->changed, NULL);
    controls->running = pthread_create(&controls->thread, NULL, serve, controls) == 0;
    if (!controls->running) {
        memset(controls->present, 0, sizeof controls->present);
    }
    return controls->running;
}

void linux_camera_controls_close(struct linux_camera_controls *controls) {
    if (!controls->running) {
        return;
    }
    pthread_mutex_lock(&controls->mutex);
    controls->ending = true;
    pthread_cond_signal(&controls->changed);
    pthread_mutex_unlock(&controls->mutex);
    pthread_join(controls->thread, NULL);
    pthread_cond_destroy(&controls->changed);
    pthread_mutex_destroy(&controls->mutex);
    controls->running = false;
}

int32_t linux_camera_controls_get(struct linux_camera_controls *controls,
                                  enum hal_camera_control control) {
    pthread_mutex_lock(&controls->mutex);
    const int32_t value = controls->wanted[control];
    pthread_mutex_unlock(&controls->mutex);
    return value;
}

void linux_camera_controls_set(struct linux_camera_controls *controls,
                               enum hal_camera_control control, int32_t value) {
    pthread_mutex_lock(&controls->mutex);
    if (controls->wanted[control] != value) {
        controls->wanted[control] = value;
        controls->waiting[control] = true;
        pthread_cond_signal(&controls->changed);
    }
    pthread_mutex_unlock(&controls->mutex);
}

bool linux_camera_controls_lost(struct linux_camera_controls *controls, uint32_t *taken,
                                uint32_t *failed) {
    if (!controls->running) {
        return false;
    }
    pthread_mutex_lock(&controls->mutex);
    const bool gone = controls->gone;
    *failed = controls->failed;
    *taken = controls->taken;
    pthread_mutex_unlock(&controls->mutex);
    return gone;
}
