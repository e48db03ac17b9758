#include "contract/support/camera_suite.h"

#include "contract/support/contract.h"

#define PATIENCE    3000
#define BUFFERS_MAX 32U

static const struct camera_fixture *fixture;

static void reset(void) {
    fixture->reset(fixture->context);
}

static void begin(void) {
    reset();
    struct hal_camera_format format = fixture->format;
    CHECK_EQ(hal_camera_negotiate(fixture->camera, &format), HAL_OK);
    CHECK_EQ(hal_camera_start(fixture->camera), HAL_OK);
}

/// Waits for a frame.
static struct hal_camera_frame take(void) {
    struct hal_camera_frame frame = {0};
    enum hal_status status = HAL_EMPTY;
    for (int i = 0; i < PATIENCE && status == HAL_EMPTY; i++) {
        fixture->settle(fixture->context);
        status = hal_camera_dequeue(fixture->camera, &frame);
    }
    CHECK_EQ(status, HAL_OK);
    CHECK(frame.data != NULL && frame.size_bytes > 0U);
    return frame;
}

static void give_back(const struct hal_camera_frame *frame) {
    CHECK_EQ(hal_camera_requeue(fixture->camera, frame), HAL_OK);
}

static void every_op(void) {
    CONTRACT_EVERY_OP(camera, fixture->camera);
}

static void arguments(void) {
    reset();
    struct hal_camera_format wrong = fixture->format;
    wrong.pixels = (enum hal_camera_pixels)(HAL_CAMERA_MJPEG + 1);
    CHECK_EQ(hal_camera_negotiate(fixture->camera, &wrong), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_camera_negotiate(fixture->camera, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_camera_start(fixture->camera), HAL_ERROR_ARGUMENT); // nothing agreed on
    CHECK_EQ(hal_camera_dequeue(fixture->camera, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_camera_requeue(fixture->camera, NULL), HAL_ERROR_ARGUMENT);
    const enum hal_camera_control none[] = {HAL_CAMERA_CONTROLS, (enum hal_camera_control)1000};
    for (size_t i = 0; i < 2U; i++) {
        struct hal_camera_range range;
        int32_t value = 77;
        CHECK_EQ(hal_camera_control_range(fixture->camera, none[i], &range), HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_camera_control_get(fixture->camera, none[i], &value), HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_camera_control_set(fixture->camera, none[i], 0), HAL_ERROR_ARGUMENT);
        CHECK_EQ(value, 77);
    }
    CHECK_EQ(hal_camera_control_range(fixture->camera, HAL_CAMERA_PAN, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_camera_control_get(fixture->camera, HAL_CAMERA_PAN, NULL), HAL_ERROR_ARGUMENT);
}

static void expect_sound(const struct hal_camera_format *format) {
    CHECK(format->pixels >= HAL_CAMERA_GREY && format->pixels <= HAL_CAMERA_MJPEG);
    CHECK(format->width_px >= 1U && format->height_px >= 1U && format->interval_us >= 1U);
    const uint32_t bytes_a_pixel = format->pixels == HAL_CAMERA_YUYV ? 2 : 1;
    if (format->pixels == HAL_CAMERA_MJPEG) {
        CHECK_EQ(format->stride_bytes, 0);
        CHECK(format->frame_bytes_max > 0U);
    } else {
        CHECK(format->stride_bytes >= format->width_px * bytes_a_pixel);
        CHECK(format->frame_bytes_max >= format->stride_bytes * format->height_px);
    }
    CHECK(format->pixels != HAL_CAMERA_YUYV || format->width_px % 2U == 0U);
}

/// A wish that can be granted is; any other is answered with something that can.
static void formats_are_negotiated(void) {
    reset();
    struct hal_camera_format format = fixture->format;
    format.stride_bytes = format.frame_bytes_max = 1; // the device's to say
    CHECK_EQ(hal_camera_negotiate(fixture->camera, &format), HAL_OK);
    CHECK_EQ(format.pixels, fixture->format.pixels);
    CHECK_EQ(format.width_px, fixture->format.width_px);
    CHECK_EQ(format.height_px, fixture->format.height_px);
    CHECK_EQ(format.interval_us, fixture->format.interval_us);
    expect_sound(&format);
    const struct hal_camera_format wishes[] = {
        {0},
        {.pixels = HAL_CAMERA_GREY, .width_px = 1, .height_px = 1, .interval_us = 1},
        {.pixels = HAL_CAMERA_YUYV, .width_px = 33, .height_px = 33},
        {.pixels = HAL_CAMERA_YUYV, .width_px = 161, .height_px = 121},
        {.pixels = HAL_CAMERA_MJPEG,
         .width_px = UINT32_MAX,
         .height_px = UINT32_MAX,
         .interval_us = UINT32_MAX}};
    for (size_t i = 0; i < sizeof wishes / sizeof wishes[0]; i++) {
        format = wishes[i];
        CHECK_EQ(hal_camera_negotiate(fixture->camera, &format), HAL_OK);
        expect_sound(&format);
        struct hal_camera_format again = format;
        CHECK_EQ(hal_camera_negotiate(fixture->camera, &again), HAL_OK);
        CHECK(memcmp(&again, &format, sizeof format) == 0);
    }
}

static void start_and_stop(void) {
    reset();
    struct hal_camera_frame frame = {.sequence = 77};
    CHECK_EQ(hal_camera_dequeue(fixture->camera, &frame), HAL_ERROR_DOWN);
    CHECK_EQ(hal_camera_stop(fixture->camera), HAL_OK);
    for (int round = 0; round < 3; round++) {
        struct hal_camera_format format = fixture->format;
        CHECK_EQ(hal_camera_negotiate(fixture->camera, &format), HAL_OK);
        CHECK_EQ(hal_camera_start(fixture->camera), HAL_OK);
        struct hal_camera_format other = format;
        CHECK_EQ(hal_camera_negotiate(fixture->camera, &other), HAL_BUSY);
        frame = take();
        CHECK_EQ(frame.sequence, 0);
        CHECK_EQ(hal_camera_start(fixture->camera), HAL_OK); // no effect
        give_back(&frame);
        const struct hal_camera_frame kept = take();
        CHECK_EQ(kept.sequence, 1);
        CHECK_EQ(hal_camera_stop(fixture->camera), HAL_OK);
        CHECK_EQ(hal_camera_dequeue(fixture->camera, &frame), HAL_ERROR_DOWN);
        CHECK_EQ(hal_camera_requeue(fixture->camera, &kept), HAL_ERROR_DOWN);
        CHECK_EQ(hal_camera_stop(fixture->camera), HAL_OK);
        CHECK_EQ(hal_camera_start(fixture->camera), HAL_OK); // the format still holds
        CHECK_EQ(hal_camera_requeue(fixture->camera, &kept), HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_camera_stop(fixture->camera), HAL_OK);
    }
}

/// One after another, each exposed an interval after the one before and before it was handed out.
static void frames_in_sequence(void) {
    begin();
    struct hal_camera_format format = fixture->format;
    CHECK_EQ(hal_camera_stop(fixture->camera), HAL_OK);
    CHECK_EQ(hal_camera_negotiate(fixture->camera, &format), HAL_OK);
    CHECK_EQ(hal_camera_start(fixture->camera), HAL_OK);
    uint32_t before_us = hal_clock_now_us(fixture->clock);
    for (uint32_t i = 0; i < 3U * fixture->buffer_count && check_clean(); i++) {
        const struct hal_camera_frame frame = take();
        CHECK_EQ(frame.sequence, i);
        CHECK(!frame.damaged);
        CHECK(frame.size_bytes <= format.frame_bytes_max);
        CHECK(format.pixels == HAL_CAMERA_MJPEG ||
              frame.size_bytes >= format.stride_bytes * format.height_px);
        CHECK(hal_clock_has_reached(hal_clock_now_us(fixture->clock), frame.exposed_us));
        const uint32_t span_us = hal_clock_span_us(before_us, frame.exposed_us);
        CHECK(i == 0U || (span_us >= format.interval_us / 2U && span_us < 2U * format.interval_us));
        before_us = frame.exposed_us;
        give_back(&frame);
    }
}

static void let_pass_us(uint32_t span_us) {
    const uint32_t from_us = hal_clock_now_us(fixture->clock);
    while (hal_clock_span_us(from_us, hal_clock_now_us(fixture->clock)) < span_us) {
        fixture->settle(fixture->context);
    }
}

/// Frames that waited come oldest first, and a stop takes back whatever is out.
static void waiting_frames_in_order(void) {
    begin();
    for (uint32_t round = 0; round < 3U; round++) {
        const struct hal_camera_frame first = take();
        let_pass_us((fixture->buffer_count + round) * fixture->format.interval_us);
        uint32_t before = first.sequence;
        for (uint32_t i = 1; i < fixture->buffer_count; i++) {
            const struct hal_camera_frame frame = take();
            CHECK_EQ(frame.sequence, before + 1U);
            before = frame.sequence;
            if (round % 2U == 0U) {
                give_back(&frame);
            }
        }
        CHECK_EQ(hal_camera_stop(fixture->camera), HAL_OK);
        CHECK_EQ(hal_camera_start(fixture->camera), HAL_OK);
    }
}

/// Frames that nobody has a buffer for are lost, and the numbers say how many.
static void all_buffers_out(void) {
    begin();
    struct hal_camera_frame frames[BUFFERS_MAX];
    for (uint32_t i = 0; i < fixture->buffer_count; i++) {
        frames[i] = take();
        CHECK_EQ(frames[i].sequence, i);
        for (uint32_t k = 0; k < i; k++) {
            CHECK(frames[k].data != frames[i].data);
            CHECK(frames[k].buffer_index != frames[i].buffer_index);
        }
    }
    struct hal_camera_frame none = {.sequence = 77};
    const uint32_t from_us = hal_clock_now_us(fixture->clock);
    while (hal_clock_span_us(from_us, hal_clock_now_us(fixture->clock)) <
           3U * fixture->format.interval_us) {
        fixture->settle(fixture->context);
        CHECK_EQ(hal_camera_dequeue(fixture->camera, &none), HAL_EMPTY);
    }
    CHECK_EQ(none.sequence, 77);
    for (uint32_t i = fixture->buffer_count; i > 0U; i--) { // in any order
        give_back(&frames[i - 1U]);
        CHECK_EQ(hal_camera_requeue(fixture->camera, &frames[i - 1U]), HAL_ERROR_ARGUMENT);
    }
    const struct hal_camera_frame next = take();
    CHECK(next.sequence >= fixture->buffer_count + 2U);
    CHECK(next.sequence <= fixture->buffer_count + 4U);
    give_back(&next);
    CHECK_EQ(take().sequence, next.sequence + 1U);
}

static void requeue_knows_its_frames(void) {
    begin();
    const struct hal_camera_frame frame = take();
    struct hal_camera_frame alien = frame;
    alien.buffer_index = UINT32_MAX;
    CHECK_EQ(hal_camera_requeue(fixture->camera, &alien), HAL_ERROR_ARGUMENT);
    alien.buffer_index = (frame.buffer_index + 1U) % fixture->buffer_count; // not out
    CHECK_EQ(hal_camera_requeue(fixture->camera, &alien), HAL_ERROR_ARGUMENT);
    give_back(&frame);
    CHECK_EQ(take().sequence, frame.sequence + 1U);
}

static int32_t value_of(enum hal_camera_control control) {
    int32_t value = INT32_MIN;
    CHECK_EQ(hal_camera_control_get(fixture->camera, control, &value), HAL_OK);
    return value;
}

/// Waits out a control that is still being handed over.
static void set_control(enum hal_camera_control control, int32_t value) {
    enum hal_status status = HAL_BUSY;
    for (int i = 0; i < PATIENCE && status == HAL_BUSY; i++) {
        status = hal_camera_control_set(fixture->camera, control, value);
        fixture->settle(fixture->context);
    }
    CHECK_EQ(status, HAL_OK);
}

static void one_control(enum hal_camera_control control, const struct hal_camera_range *range) {
    CHECK(range->min <= range->initial && range->initial <= range->max && range->step >= 1);
    const int32_t good[] = {range->min, range->max, range->initial};
    for (size_t i = 0; i < 3U; i++) {
        set_control(control, good[i]);
        // The last step need not end at the maximum.
        CHECK(value_of(control) <= good[i] && value_of(control) > good[i] - range->step);
    }
    set_control(control, range->min);
    if (range->max - range->min >= 2 * (int64_t)range->step) {
        const int32_t halfway = range->step / 2;
        set_control(control, range->min + range->step + halfway);
        CHECK_EQ(value_of(control), range->min + range->step);
        set_control(control, range->min + 2 * range->step - (range->step - 1) / 2);
        CHECK_EQ(value_of(control), range->min + 2 * range->step);
    }
    const int32_t before = value_of(control);
    if (range->min > INT32_MIN) {
        CHECK_EQ(hal_camera_control_set(fixture->camera, control, range->min - 1),
                 HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_camera_control_set(fixture->camera, control, INT32_MIN), HAL_ERROR_ARGUMENT);
    }
    if (range->max < INT32_MAX) {
        CHECK_EQ(hal_camera_control_set(fixture->camera, control, range->max + 1),
                 HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_camera_control_set(fixture->camera, control, INT32_MAX), HAL_ERROR_ARGUMENT);
    }
    CHECK_EQ(value_of(control), before);
}

/// Each that the camera has obeys; each that it lacks says so, whatever is asked of it.
static void controls(void) {
    reset();
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS; i++) {
        const enum hal_camera_control control = (enum hal_camera_control)i;
        struct hal_camera_range range = {0};
        int32_t value = 77;
        const enum hal_status status = hal_camera_control_range(fixture->camera, control, &range);
        if (status == HAL_OK) {
            one_control(control, &range);
            continue;
        }
        CHECK_EQ(status, HAL_ERROR_UNSUPPORTED);
        CHECK_EQ(hal_camera_control_get(fixture->camera, control, &value), HAL_ERROR_UNSUPPORTED);
        CHECK_EQ(hal_camera_control_set(fixture->camera, control, 0), HAL_ERROR_UNSUPPORTED);
        CHECK_EQ(value, 77);
    }
}

static void unplugged(void) {
    for (uint32_t out = 0; out <= fixture->buffer_count; out++) {
        begin();
        struct hal_camera_frame frame = {0};
        for (uint32_t i = 0; i < out; i++) {
            frame = take();
        }
        fixture->unplug(fixture->context);
        struct hal_camera_frame last = {0};
        enum hal_status status = HAL_OK;
        for (int i = 0; i < PATIENCE && (status == HAL_OK || status == HAL_EMPTY); i++) {
            status = hal_camera_dequeue(fixture->camera, &last); // ready ones may still come
        }
        CHECK_EQ(status, HAL_ERROR_GONE);
        CHECK_EQ(hal_camera_requeue(fixture->camera, &frame), HAL_ERROR_GONE);
        CHECK_EQ(hal_camera_start(fixture->camera), HAL_ERROR_GONE);
        struct hal_camera_format format = fixture->format;
        CHECK_EQ(hal_camera_stop(fixture->camera), HAL_ERROR_GONE);
        CHECK_EQ(hal_camera_negotiate(fixture->camera, &format), HAL_ERROR_GONE);
        int32_t value;
        CHECK_EQ(hal_camera_control_get(fixture->camera, HAL_CAMERA_PAN, &value), HAL_ERROR_GONE);
        CHECK_EQ(hal_camera_control_set(fixture->camera, HAL_CAMERA_PAN, 0), HAL_ERROR_GONE);
    }
    begin(); // plugged in again it works
    CHECK_EQ(take().sequence, 0);
}

static void exercise(struct contract_plan *plan) {
    struct hal_camera_format format = fixture->format;
    CONTRACT_DO(plan, hal_camera_negotiate(fixture->camera, &format));
    CONTRACT_DO(plan, hal_camera_start(fixture->camera));
    for (uint32_t i = 0; i < fixture->buffer_count + 1U; i++) {
        struct hal_camera_frame frame = {.sequence = 77};
        enum hal_status status = HAL_EMPTY;
        for (int k = 0; k < PATIENCE && frame.data == NULL; k++) {
            fixture->settle(fixture->context);
            status = hal_camera_dequeue(fixture->camera, &frame);
            if (status == HAL_EMPTY) {
                plan->calls++;
            } else if (contract_failed(plan, status)) {
                CHECK_EQ(frame.sequence, 77);
            }
        }
        CHECK_EQ(frame.sequence, i); // a call that fails costs no frame
        CONTRACT_DO(plan, hal_camera_requeue(fixture->camera, &frame));
    }
    struct hal_camera_range range;
    CONTRACT_DO(plan, hal_camera_control_range(fixture->camera, HAL_CAMERA_PAN, &range));
    int32_t value = 77;
    CONTRACT_DO(plan, hal_camera_control_set(fixture->camera, HAL_CAMERA_PAN, range.max));
    CONTRACT_DO(plan, hal_camera_control_get(fixture->camera, HAL_CAMERA_PAN, &value));
    CHECK(value > range.max - range.step);
    if (contract_failed(plan, hal_camera_control_set(fixture->camera, HAL_CAMERA_PAN, range.min))) {
        CHECK(!contract_failed(plan,
                               hal_camera_control_get(fixture->camera, HAL_CAMERA_PAN, &value)));
        CHECK(value > range.max - range.step);
    }
    // Stops whatever it says.
    (void)contract_failed(plan, hal_camera_stop(fixture->camera));
    struct hal_camera_frame frame;
    enum hal_status status = hal_camera_dequeue(fixture->camera, &frame);
    if (status != HAL_ERROR_DOWN) {
        CHECK(contract_failed(plan, status));
    }
}

static void fails_at_every_call(void) {
    contract_each_failure(&(struct contract_failures){fixture->context, fixture->reset,
                                                      fixture->fail_at, fixture->some_cannot_fail},
                          exercise);
}

static void run(const char *test, void (*function)(void)) {
    contract_run_timed(fixture->name, test, function, fixture->excuse);
}

void camera_suite(const struct camera_fixture *with) {
    fixture = with;
    CONTRACT(with->name, every_op);
    run("arguments", arguments);
    run("formats_are_negotiated", formats_are_negotiated);
    run("start_and_stop", start_and_stop);
    run("frames_in_sequence", frames_in_sequence);
    run("waiting_frames_in_order", waiting_frames_in_order);
    run("all_buffers_out", all_buffers_out);
    run("requeue_knows_its_frames", requeue_knows_its_frames);
    run("controls", controls);
    if (with->unplug != NULL) {
        run("unplugged", unplugged);
    } else {
        contract_skip(with->name, "unplugged", "the rig can't unplug it");
    }
    CONTRACT_IF(with->fail_at, "the rig can't make calls fail", with->name, fails_at_every_call);
}
