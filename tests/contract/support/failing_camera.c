#include "contract/support/failing_camera.h"

#include "check.h"

static bool begin(struct failing_camera *camera) {
    const bool due = camera->nth == 1U;
    camera->nth -= camera->nth > 0U;
    if (due) {
        camera->fail(true);
    }
    return due;
}

static enum hal_status end(const struct failing_camera *camera, bool due, enum hal_status status) {
    if (due) {
        camera->fail(false);
    }
    return status;
}

static enum hal_status failing_negotiate(void *ctx, struct hal_camera_format *format) {
    struct failing_camera *camera = ctx;
    const bool due = begin(camera);
    return end(camera, due, hal_camera_negotiate(camera->inside, format));
}

static enum hal_status failing_start(void *ctx) {
    struct failing_camera *camera = ctx;
    const bool due = begin(camera);
    return end(camera, due, hal_camera_start(camera->inside));
}

static enum hal_status failing_stop(void *ctx) {
    struct failing_camera *camera = ctx;
    const bool due = begin(camera);
    return end(camera, due, hal_camera_stop(camera->inside));
}

static enum hal_status failing_dequeue(void *ctx, struct hal_camera_frame *frame) {
    struct failing_camera *camera = ctx;
    const bool due = begin(camera);
    return end(camera, due, hal_camera_dequeue(camera->inside, frame));
}

static enum hal_status failing_requeue(void *ctx, const struct hal_camera_frame *frame) {
    struct failing_camera *camera = ctx;
    const bool due = begin(camera);
    return end(camera, due, hal_camera_requeue(camera->inside, frame));
}

static enum hal_status failing_range(void *ctx, enum hal_camera_control control,
                                     struct hal_camera_range *range) {
    struct failing_camera *camera = ctx;
    camera->nth -= camera->nth > 0U;
    return hal_camera_control_range(camera->inside, control, range);
}

static enum hal_status failing_get(void *ctx, enum hal_camera_control control, int32_t *value) {
    struct failing_camera *camera = ctx;
    camera->nth -= camera->nth > 0U;
    return hal_camera_control_get(camera->inside, control, value);
}

static enum hal_status failing_set(void *ctx, enum hal_camera_control control, int32_t value) {
    struct failing_camera *camera = ctx;
    camera->nth -= camera->nth > 0U;
    return hal_camera_control_set(camera->inside, control, value);
}

void failing_camera_init(struct failing_camera *camera, const struct hal_camera *inside,
                         void (*fail)(bool on)) {
    static const struct hal_camera_ops ops = {failing_negotiate, failing_start,   failing_stop,
                                              failing_dequeue,   failing_requeue, failing_range,
                                              failing_get,       failing_set};
    *camera = (struct failing_camera){.inside = inside, .fail = fail};
    CHECK_EQ(hal_camera_bind(&camera->hal, &ops, camera), HAL_OK);
}

bool failing_camera_at(struct failing_camera *camera, uint32_t nth, enum hal_status status) {
    camera->nth = nth;
    return status == HAL_ERROR_IO;
}
