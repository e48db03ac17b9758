/// A camera's pan and zoom as channels of pulses, on a fake camera.
#include "linux/linux_camera_servo.h"
#include "contract/support/contract.h"
#include "devices/fake_camera.h"
#include "devices/fake_clock.h"

static struct fake_clock clock_;
static struct fake_camera camera;
static struct linux_camera_servo servo;
static uint8_t pool[2U * 16U * 16U * 2U];
static const struct fake_camera_model model = {
    .width_px_max = 16,
    .height_px_max = 16,
    .pool = pool,
    .pool_bytes = sizeof pool,
    .buffer_count = 2,
    .ranges = {[HAL_CAMERA_PAN] = {-648000, 648000, 1, 0},
               [HAL_CAMERA_ZOOM] = {100, 500, 10, 100}}}; // no tilt

static void begin(void) {
    fake_clock_init(&clock_, 0);
    fake_camera_init(&camera, &clock_.hal, &model);
    CHECK_EQ(linux_camera_servo_bind(&servo, &camera.hal), HAL_OK);
}

static int32_t value_of(enum hal_camera_control control) {
    int32_t value = INT32_MIN;
    CHECK_EQ(hal_camera_control_get(&camera.hal, control, &value), HAL_OK);
    return value;
}

static enum hal_status pulse(uint32_t channel, int64_t value) {
    return hal_pwm_set_pulse(&servo.hal, channel, (uint32_t)(10000000 + value));
}

static void every_op(void) {
    begin();
    CONTRACT_EVERY_OP(pwm, &servo.hal);
}

static void a_nanosecond_is_an_arc_second(void) {
    begin();
    const int32_t values[] = {0, 1, -1, 3600, -648000, 648000, 123457};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        CHECK_EQ(pulse(HAL_CAMERA_PAN, values[i]), HAL_OK);
        CHECK_EQ(value_of(HAL_CAMERA_PAN), values[i]);
    }
    CHECK_EQ(pulse(HAL_CAMERA_ZOOM, 250), HAL_OK);
    CHECK_EQ(value_of(HAL_CAMERA_ZOOM), 250);
    CHECK_EQ(value_of(HAL_CAMERA_PAN), 123457);
}

static void beyond_its_range_it_goes_to_the_end(void) {
    begin();
    CHECK_EQ(pulse(HAL_CAMERA_PAN, 648001), HAL_OK);
    CHECK_EQ(value_of(HAL_CAMERA_PAN), 648000);
    CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, 1), HAL_OK);
    CHECK_EQ(value_of(HAL_CAMERA_PAN), -648000);
    CHECK_EQ(pulse(HAL_CAMERA_ZOOM, 99), HAL_OK);
    CHECK_EQ(value_of(HAL_CAMERA_ZOOM), 100);
    CHECK_EQ(pulse(HAL_CAMERA_ZOOM, 9999999), HAL_OK);
    CHECK_EQ(value_of(HAL_CAMERA_ZOOM), 500);
    CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, 20000000), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, UINT32_MAX), HAL_ERROR_ARGUMENT);
}

static void without_pulses_it_stays(void) {
    begin();
    CHECK_EQ(pulse(HAL_CAMERA_PAN, 7200), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&servo.hal, HAL_CAMERA_PAN, 0), HAL_OK);
    CHECK_EQ(value_of(HAL_CAMERA_PAN), 7200);
}

static void channels_are_the_controls_that_it_has(void) {
    begin();
    struct hal_pwm_limits limits = {.period_ns = 77};
    const uint32_t none[] = {HAL_CAMERA_TILT, HAL_CAMERA_CONTROLS, UINT32_MAX};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        CHECK_EQ(hal_pwm_limits(&servo.hal, none[i], &limits), HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_pwm_set_period(&servo.hal, none[i], 20000000), HAL_ERROR_ARGUMENT);
        CHECK_EQ(pulse(none[i], 0), HAL_ERROR_ARGUMENT);
        CHECK_EQ(limits.period_ns, 77);
    }
    CHECK_EQ(hal_pwm_limits(&servo.hal, HAL_CAMERA_PAN, &limits), HAL_OK);
    CHECK_EQ(limits.period_ns, 20000000);
    CHECK_EQ(limits.resolution_ns, 1);
    CHECK_EQ(hal_pwm_set_period(&servo.hal, HAL_CAMERA_PAN, 20000000), HAL_OK);
    CHECK_EQ(hal_pwm_set_period(&servo.hal, HAL_CAMERA_PAN, 19999999), HAL_ERROR_ARGUMENT);
}

static void failures_are_passed_on(void) {
    begin();
    CHECK_EQ(pulse(HAL_CAMERA_PAN, 3600), HAL_OK);
    for (uint32_t nth = 1; nth <= 2U; nth++) {
        fake_failures_at(&camera.failures, nth, 1, HAL_ERROR_IO);
        CHECK_EQ(pulse(HAL_CAMERA_PAN, 7200), HAL_ERROR_IO);
        CHECK_EQ(value_of(HAL_CAMERA_PAN), 3600);
    }
    fake_camera_unplug(&camera);
    struct hal_pwm_limits limits;
    CHECK_EQ(pulse(HAL_CAMERA_PAN, 0), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_limits(&servo.hal, HAL_CAMERA_PAN, &limits), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_set_period(&servo.hal, HAL_CAMERA_PAN, 20000000), HAL_ERROR_GONE);
}

int main(void) {
    TEST(every_op);
    TEST(a_nanosecond_is_an_arc_second);
    TEST(beyond_its_range_it_goes_to_the_end);
    TEST(without_pulses_it_stays);
    TEST(channels_are_the_controls_that_it_has);
    TEST(failures_are_passed_on);
    return check_finish();
}
