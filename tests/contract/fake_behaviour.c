/// What the fakes do beyond the contracts: failures to order, errors of the bus, lost pictures. The
/// flash has a program of its own.
#include "check.h"
#include "devices/fake_camera.h"
#include "devices/fake_can.h"
#include "devices/fake_clock.h"
#include "devices/fake_failures.h"
#include "devices/fake_gpio.h"
#include "devices/fake_pwm.h"
#include "devices/fake_serial.h"
#include "devices/fake_usb.h"
#include "devices/fake_watchdog.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static struct fake_clock clock_;

static void failures_to_order(void) {
    for (uint32_t nth = 0; nth <= 6U; nth++) {
        for (uint32_t count = 0; count <= 3U; count++) {
            struct fake_failures failures = {0};
            fake_failures_at(&failures, 1, 9, HAL_ERROR_TIMEOUT); // replaced by the next order
            fake_failures_at(&failures, nth, count, HAL_ERROR_IO);
            for (uint32_t call = 1; call <= 12U; call++) {
                const bool fails = nth != 0U && call >= nth && call < nth + count;
                CHECK_EQ(fake_failures_call(&failures), fails ? HAL_ERROR_IO : HAL_OK);
                CHECK_EQ(failures.call_count, call);
            }
        }
    }
    struct fake_failures failures = {0};
    fake_failures_at(&failures, 2, 1, HAL_ERROR_IO);
    fake_failures_set_gone(&failures, true);
    CHECK_EQ(fake_failures_presence(&failures), HAL_ERROR_GONE);
    for (int i = 0; i < 5; i++) {
        CHECK_EQ(fake_failures_call(&failures), HAL_ERROR_GONE);
    }
    fake_failures_set_gone(&failures, false);
    CHECK_EQ(fake_failures_presence(&failures), HAL_OK);
    CHECK_EQ(fake_failures_call(&failures), HAL_OK);
    CHECK_EQ(fake_failures_call(&failures), HAL_ERROR_IO); // the order still stands
    CHECK_EQ(fake_failures_call(&failures), HAL_OK);
}

static void clock_that_runs_when_read(void) {
    fake_clock_init(&clock_, 10);
    CHECK_EQ(hal_clock_now_us(&clock_.hal), 10);
    CHECK_EQ(hal_clock_now_us(&clock_.hal), 10);
    clock_.step_us = 3;
    CHECK_EQ(hal_clock_now_us(&clock_.hal), 10);
    CHECK_EQ(hal_clock_now_us(&clock_.hal), 13);
}

static enum hal_can_health health_at(struct fake_can *can, uint16_t transmit, uint16_t receive) {
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    fake_can_set_errors(can, transmit, receive);
    CHECK_EQ(hal_can_state(&can->hal, &state), HAL_OK);
    CHECK_EQ(state.transmit_error_count, transmit);
    CHECK_EQ(state.receive_error_count, receive);
    return state.health;
}

/// The thresholds of ISO 11898-1: passive above 127, off above 255.
static void can_error_counters(void) {
    struct fake_can can;
    fake_can_init(&can, &clock_.hal, 4, 4);
    CHECK_EQ(health_at(&can, 0, 0), HAL_CAN_ACTIVE);
    CHECK_EQ(health_at(&can, 127, 127), HAL_CAN_ACTIVE);
    CHECK_EQ(health_at(&can, 128, 0), HAL_CAN_PASSIVE);
    CHECK_EQ(health_at(&can, 0, 128), HAL_CAN_PASSIVE);
    CHECK_EQ(health_at(&can, 127, 0), HAL_CAN_ACTIVE);
    CHECK_EQ(health_at(&can, 255, 255), HAL_CAN_PASSIVE);
    const struct can_frame frame = {.id = 1};
    CHECK_EQ(hal_can_send(&can.hal, &frame), HAL_OK); // passive: still on the bus
    fake_can_give(&can, &frame);
    CHECK_EQ(health_at(&can, 256, 0), HAL_CAN_OFF);
    CHECK(fake_can_next(&can) == NULL);
    fake_can_give(&can, &frame); // not heard
    CHECK_EQ(can.received.count, 1);
    CHECK_EQ(health_at(&can, 0, 0), HAL_CAN_OFF); // once off, only a restart helps
    fake_can_recover(&can);
    CHECK_EQ(health_at(&can, 0, 0), HAL_CAN_OFF);
    CHECK_EQ(hal_can_restart(&can.hal), HAL_OK);
    CHECK_EQ(health_at(&can, 256, 0), HAL_CAN_OFF);
    fake_can_recover(&can);
    CHECK_EQ(can.state.health, HAL_CAN_ACTIVE);
    CHECK_EQ(can.state.transmit_error_count, 0);
}

/// A bus model looks at the next frame as often as arbitration is lost, then takes it.
static void can_waits_for_its_bus(void) {
    struct fake_can can;
    fake_can_init(&can, &clock_.hal, 2, 1);
    const struct can_frame first = {.id = 1}, second = {.id = 2};
    CHECK(fake_can_next(&can) == NULL);
    fake_can_take(&can); // nothing to take: no effect
    CHECK_EQ(hal_can_send(&can.hal, &first), HAL_OK);
    CHECK_EQ(hal_can_send(&can.hal, &second), HAL_OK);
    CHECK_EQ(hal_can_send(&can.hal, &second), HAL_BUSY);
    CHECK_EQ(fake_can_next(&can)->id, 1);
    CHECK_EQ(fake_can_next(&can)->id, 1);
    fake_can_take(&can);
    CHECK_EQ(fake_can_next(&can)->id, 2);
    fake_can_take(&can);
    CHECK(fake_can_next(&can) == NULL);
}

static void gpio_released_and_driven(void) {
    const struct hal_gpio_line lines[] = {{HAL_GPIO_INPUT, HAL_GPIO_PULL_UP, false, false},
                                          {HAL_GPIO_INPUT, HAL_GPIO_PULL_NONE, false, false},
                                          {HAL_GPIO_OUTPUT, HAL_GPIO_PULL_NONE, false, false}};
    struct fake_gpio gpio;
    fake_gpio_init(&gpio, lines, 3);
    fake_gpio_drive(&gpio, 0, false);
    fake_gpio_drive(&gpio, 1, true);
    fake_gpio_drive(&gpio, 2, true); // an output can't be driven from outside
    CHECK(!fake_gpio_is_high(&gpio, 0) && fake_gpio_is_high(&gpio, 1));
    CHECK(!fake_gpio_is_high(&gpio, 2));
    fake_gpio_release(&gpio, 0);
    fake_gpio_release(&gpio, 1);
    CHECK(fake_gpio_is_high(&gpio, 0) && !fake_gpio_is_high(&gpio, 1));
}

static void pwm_timers_are_apart(void) {
    struct fake_pwm pwm;
    fake_pwm_init(&pwm, 6, 4, 1000);
    CHECK_EQ(hal_pwm_set_period(&pwm.hal, 2, 3000000), HAL_OK);
    for (uint32_t channel = 0; channel < 6U; channel++) {
        CHECK_EQ(fake_pwm_period_ns(&pwm, channel), channel < 4U ? 3000000 : FAKE_PWM_PERIOD_NS);
    }
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 5, 2600000), HAL_OK);
    CHECK_EQ(hal_pwm_set_period(&pwm.hal, 0, 2500000), HAL_OK); // not its timer's pulse
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 3, 2400000), HAL_OK);
    CHECK_EQ(hal_pwm_set_period(&pwm.hal, 0, 2400000), HAL_ERROR_ARGUMENT);
}

static void serial_counts_damage(void) {
    struct fake_serial serial;
    struct hal_serial_state state;
    fake_serial_init(&serial, 8, 8);
    fake_serial_damage(&serial, 3);
    CHECK_EQ(hal_serial_state(&serial.hal, &state), HAL_OK);
    CHECK_EQ(state.damaged_count, 3);
    CHECK_EQ(state.lost_count, 0);
}

static struct hal_usb_setup seen;
static int naks;

static enum hal_status slow_answer(void *ctx, struct hal_usb_transfer *transfer) {
    (void)ctx;
    seen = transfer->setup;
    return naks-- > 0 ? HAL_BUSY : HAL_OK;
}

/// A transfer that waits is not overtaken by the next one of its endpoint, but by others.
static void usb_keeps_the_order_of_an_endpoint(void) {
    const struct fake_usb_model model = {.answer = slow_answer};
    struct fake_usb usb;
    fake_usb_init(&usb, &clock_.hal, &model);
    struct hal_usb_transfer first = {.kind = HAL_USB_BULK, .endpoint = 0x81}, second = first;
    struct hal_usb_transfer other = {.kind = HAL_USB_BULK, .endpoint = 0x82}, *done = NULL;
    CHECK_EQ(hal_usb_submit(&usb.hal, &first), HAL_OK);
    CHECK_EQ(hal_usb_submit(&usb.hal, &second), HAL_OK);
    naks = 1;
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_EMPTY);
    CHECK_EQ(hal_usb_submit(&usb.hal, &other), HAL_OK);
    naks = 1;
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_OK);
    CHECK(done == &other);
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_OK);
    CHECK(done == &first);
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_OK);
    CHECK(done == &second);
}

static void usb_model_sees_the_request(void) {
    const struct fake_usb_model model = {.answer = slow_answer};
    struct fake_usb usb;
    fake_usb_init(&usb, &clock_.hal, &model);
    naks = 2;
    struct hal_usb_transfer transfer = {.kind = HAL_USB_CONTROL, .setup = {0x40, 0x85, 6000, 3}};
    struct hal_usb_transfer *done = NULL;
    CHECK_EQ(hal_usb_submit(&usb.hal, &transfer), HAL_OK);
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_EMPTY);
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_EMPTY);
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_OK);
    CHECK(done == &transfer);
    CHECK(seen.request_type == 0x40U && seen.request == 0x85U && seen.value == 6000U &&
          seen.index == 3U);
}

/// The board is already being reset when a feed comes late.
static void watchdog_is_not_fed_too_late(void) {
    struct fake_watchdog watchdog;
    fake_watchdog_init(&watchdog, &clock_.hal, HAL_RESET_POWER_ON);
    CHECK_EQ(hal_watchdog_start(&watchdog.hal, 1000), HAL_OK);
    fake_clock_advance(&clock_, 1001);
    CHECK_EQ(hal_watchdog_feed(&watchdog.hal), HAL_OK);
    CHECK(fake_watchdog_has_fired(&watchdog));
}

static void paint_number(void *ctx, uint8_t *picture, const struct hal_camera_format *format,
                         uint32_t exposed_us, uint32_t sequence) {
    *(uint32_t *)ctx = exposed_us;
    memset(picture, (int)(0x80U + sequence), format->frame_bytes_max);
}

static void camera_loses_and_damages(void) {
    static uint8_t pool[2U * 16U * 16U * 2U];
    uint32_t painted_us = 0;
    const struct fake_camera_model model = {.width_px_max = 16,
                                            .height_px_max = 16,
                                            .pool = pool,
                                            .pool_bytes = sizeof pool,
                                            .buffer_count = 2,
                                            .latency_us = 4000,
                                            .paint = paint_number,
                                            .ctx = &painted_us};
    struct fake_camera camera;
    fake_clock_init(&clock_, 500);
    fake_camera_init(&camera, &clock_.hal, &model);
    struct hal_camera_format format = {.interval_us = 10000};
    struct hal_camera_frame frame;
    CHECK_EQ(hal_camera_negotiate(&camera.hal, &format), HAL_OK);
    CHECK_EQ(hal_camera_start(&camera.hal), HAL_OK);
    fake_clock_advance(&clock_, 3999);
    CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame), HAL_EMPTY);
    fake_camera_lose(&camera, 3);
    fake_clock_advance(&clock_, 30000);
    CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame), HAL_EMPTY); // 0, 1, 2 are lost
    fake_camera_damage(&camera, 1);
    for (uint32_t sequence = 3; sequence <= 4U; sequence++) {
        fake_clock_advance(&clock_, 10000);
        CHECK_EQ(hal_camera_dequeue(&camera.hal, &frame), HAL_OK);
        CHECK_EQ(frame.sequence, sequence);
        CHECK_EQ(frame.exposed_us, 500U + sequence * 10000U);
        CHECK_EQ(painted_us, frame.exposed_us);
        CHECK_EQ(frame.damaged, sequence == 3U);
        CHECK_EQ(frame.data[0], 0x80U + sequence);
        CHECK_EQ(frame.data[frame.size_bytes - 1U], sequence == 3U ? 0U : 0x80U + sequence);
        CHECK_EQ(hal_camera_requeue(&camera.hal, &frame), HAL_OK);
    }
}

// ------------------------------------------------------------------------- wrong use of a fake
static void empty_queue(void) {
    struct fake_can can;
    fake_can_init(&can, &clock_.hal, 0, 1);
}
static void huge_queue(void) {
    struct fake_serial serial;
    fake_serial_init(&serial, 1, FAKE_SERIAL_BYTES_MAX + 1U);
}
static void no_channels(void) {
    struct fake_pwm pwm;
    fake_pwm_init(&pwm, 0, 1, 1);
}
static void small_pool(void) {
    static uint8_t byte[511];
    struct fake_camera camera;
    const struct fake_camera_model model = {.width_px_max = 16,
                                            .height_px_max = 16,
                                            .pool = byte,
                                            .pool_bytes = sizeof byte,
                                            .buffer_count = 1};
    fake_camera_init(&camera, &clock_.hal, &model);
}

/// A fake set up wrongly must not run on and make tests pass.
static void wrong_set_up_ends_the_program(void) {
    void (*const wrong[])(void) = {empty_queue, huge_queue, no_channels, small_pool};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        int status = 0;
        const pid_t child = fork();
        if (child == 0) {
            wrong[i]();
            _exit(0);
        }
        CHECK(child > 0 && waitpid(child, &status, 0) == child);
        CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
    }
}

int main(void) {
    fake_clock_init(&clock_, 0);
    TEST(failures_to_order);
    TEST(clock_that_runs_when_read);
    TEST(can_error_counters);
    TEST(can_waits_for_its_bus);
    TEST(gpio_released_and_driven);
    TEST(pwm_timers_are_apart);
    TEST(serial_counts_damage);
    TEST(usb_keeps_the_order_of_an_endpoint);
    TEST(usb_model_sees_the_request);
    TEST(watchdog_is_not_fed_too_late);
    TEST(camera_loses_and_damages);
    TEST(wrong_set_up_ends_the_program);
    return check_finish();
}
