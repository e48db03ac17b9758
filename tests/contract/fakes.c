/// Every contract suite on the fakes.
#include "contract/support/camera_suite.h"
#include "contract/support/can_suite.h"
#include "contract/support/clock_suite.h"
#include "contract/support/contract.h"
#include "contract/support/flash_suite.h"
#include "contract/support/gpio_suite.h"
#include "contract/support/pwm_suite.h"
#include "contract/support/serial_suite.h"
#include "contract/support/usb_suite.h"
#include "contract/support/watchdog_suite.h"
#include "devices/fake_camera.h"
#include "devices/fake_can.h"
#include "devices/fake_clock.h"
#include "devices/fake_flash.h"
#include "devices/fake_gpio.h"
#include "devices/fake_pwm.h"
#include "devices/fake_serial.h"
#include "devices/fake_usb.h"
#include "devices/fake_watchdog.h"

static struct fake_clock clock_;

/// The failures of whichever fake is being tested.
static struct fake_failures *failures;

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    fake_failures_at(failures, nth, 1, status);
    return true;
}

static void settle_1ms(void *context) {
    (void)context;
    fake_clock_advance(&clock_, 1000);
}

static void pass(void *context, uint32_t span_us) {
    (void)context;
    fake_clock_advance(&clock_, span_us);
}

static void start_at(void *context, uint32_t start_us) {
    (void)context;
    fake_clock_set(&clock_, start_us);
}

static void test_clock(void) {
    fake_clock_init(&clock_, 0);
    clock_suite(&(struct clock_fixture){
        .name = "fake_clock", .clock = &clock_.hal, .start_at = start_at, .pass = pass});
}

// ------------------------------------------------------------------------------------------ CAN
static struct fake_can can_a, can_b;

static void can_reset(void *context) {
    (void)context;
    fake_can_init(&can_a, &clock_.hal, 5, 64);
    fake_can_init(&can_b, &clock_.hal, 64, 17);
    failures = &can_a.failures;
}

static void can_settle(void *context) {
    (void)context;
    fake_clock_advance(&clock_, 100);
    fake_can_carry(&can_a, &can_b);
}

static void can_bus_off(void *context) {
    (void)context;
    fake_can_set_errors(&can_a, 256, 0);
}

static void test_can(void) {
    fake_clock_init(&clock_, UINT32_MAX - 1000U); // the times of arrival wrap on the way
    can_reset(NULL);
    can_suite(&(struct can_fixture){.name = "fake_can",
                                    .a = &can_a.hal,
                                    .b = &can_b.hal,
                                    .clock = &clock_.hal,
                                    .reset = can_reset,
                                    .settle = can_settle,
                                    .bus_off = can_bus_off,
                                    .fail_at = fail_at,
                                    .receive_capacity = 17,
                                    .send_capacity = 5});
}

// ----------------------------------------------------------------------------------------- GPIO
static struct fake_gpio gpio;

static void gpio_reset(void *context) {
    (void)context;
    fake_gpio_init(&gpio, gpio_suite_lines, GPIO_SUITE_LINES);
    failures = &gpio.failures;
}

static void gpio_drive(void *context, uint32_t line, bool high) {
    (void)context;
    fake_gpio_drive(&gpio, line, high);
}

static bool gpio_is_high(void *context, uint32_t line) {
    (void)context;
    return fake_gpio_is_high(&gpio, line);
}

static void test_gpio(void) {
    gpio_reset(NULL);
    gpio_suite(&(struct gpio_fixture){.name = "fake_gpio",
                                      .gpio = &gpio.hal,
                                      .lines = gpio_suite_lines,
                                      .line_count = GPIO_SUITE_LINES,
                                      .reset = gpio_reset,
                                      .drive = gpio_drive,
                                      .is_high = gpio_is_high,
                                      .fail_at = fail_at});
}

// ------------------------------------------------------------------------------------------ PWM
static struct fake_pwm pwm;
static uint32_t pwm_resolution_ns;

static void pwm_reset(void *context) {
    (void)context;
    fake_pwm_init(&pwm, 6, 4, pwm_resolution_ns);
    failures = &pwm.failures;
}

static void pwm_measure(void *context, uint32_t channel, uint32_t *pulse_ns, uint32_t *period_ns) {
    (void)context;
    *pulse_ns = fake_pwm_pulse_ns(&pwm, channel);
    *period_ns = fake_pwm_period_ns(&pwm, channel);
}

static void test_pwm(const char *name, uint32_t resolution_ns) {
    pwm_resolution_ns = resolution_ns;
    pwm_reset(NULL);
    pwm_suite(&(struct pwm_fixture){.name = name,
                                    .pwm = &pwm.hal,
                                    .channel_count = 6,
                                    .reset = pwm_reset,
                                    .measure = pwm_measure,
                                    .fail_at = fail_at});
}

// --------------------------------------------------------------------------------------- serial
static struct fake_serial serial;

static void serial_reset(void *context) {
    (void)context;
    fake_serial_init(&serial, 300, 200);
    failures = &serial.failures;
}

static size_t serial_peer_write(void *context, const uint8_t *data, size_t size_bytes) {
    (void)context;
    fake_serial_give(&serial, data, size_bytes);
    return size_bytes;
}

static size_t serial_peer_read(void *context, uint8_t *data, size_t capacity_bytes) {
    (void)context;
    return fake_serial_take(&serial, data, capacity_bytes);
}

static void serial_hang_up(void *context) {
    (void)context;
    fake_serial_hang_up(&serial);
}

static void test_serial(void) {
    serial_reset(NULL);
    serial_suite(&(struct serial_fixture){.name = "fake_serial",
                                          .serial = &serial.hal,
                                          .reset = serial_reset,
                                          .peer_write = serial_peer_write,
                                          .peer_read = serial_peer_read,
                                          .settle = settle_1ms,
                                          .hang_up = serial_hang_up,
                                          .fail_at = fail_at,
                                          .receive_capacity = 200});
}

// ------------------------------------------------------------------------------------------ USB
static struct fake_usb usb;

/// A device that echoes one bulk transfer at a time and refuses all else.
static struct {
    uint8_t data[HAL_USB_TRANSFER_BYTES_MAX];
    uint16_t size_bytes;
} echo;

static enum hal_status echo_answer(void *ctx, struct hal_usb_transfer *transfer) {
    (void)ctx;
    if (transfer->kind == HAL_USB_BULK && transfer->endpoint == 2U && echo.size_bytes == 0U) {
        memcpy(echo.data, transfer->data, transfer->size_bytes);
        echo.size_bytes = transfer->actual_bytes = transfer->size_bytes;
        return HAL_OK;
    }
    if (transfer->kind == HAL_USB_BULK && transfer->endpoint == 0x81U && echo.size_bytes != 0U) {
        transfer->actual_bytes = echo.size_bytes;
        memcpy(transfer->data, echo.data, echo.size_bytes);
        echo.size_bytes = 0;
        return HAL_OK;
    }
    return transfer->kind == HAL_USB_BULK ? HAL_BUSY : HAL_ERROR_UNSUPPORTED;
}

static const struct fake_usb_model usb_model = {.identity = {0x1234, 0xABCD, 0x0107, "0001-fake"},
                                                .answer = echo_answer};

static void usb_reset(void *context) {
    (void)context;
    echo.size_bytes = 0;
    fake_usb_init(&usb, &clock_.hal, &usb_model);
    failures = &usb.failures;
}

static void usb_unplug(void *context) {
    (void)context;
    fake_usb_unplug(&usb);
}

static void test_usb(void) {
    fake_clock_init(&clock_, UINT32_MAX - 30000U); // time-outs across the wrap
    usb_reset(NULL);
    usb_suite(&(struct usb_fixture){.name = "fake_usb",
                                    .usb = &usb.hal,
                                    .identity = usb_model.identity,
                                    .reset = usb_reset,
                                    .settle = settle_1ms,
                                    .unplug = usb_unplug,
                                    .fail_at = fail_at,
                                    .echo_out = 2,
                                    .echo_in = 0x81});
}

// --------------------------------------------------------------------------------------- camera
static struct fake_camera camera;
static uint8_t camera_pool[4U * 160U * 120U * 2U];
static const struct fake_camera_model camera_model = {
    .width_px_max = 160,
    .height_px_max = 120,
    .pool = camera_pool,
    .pool_bytes = sizeof camera_pool,
    .buffer_count = 4,
    .latency_us = 1500,
    .ranges = {[HAL_CAMERA_PAN] = {-522000, 522000, 3600, 0},
               [HAL_CAMERA_ZOOM] = {100, 507, 10, 100}}}; // no tilt

static void camera_reset(void *context) {
    (void)context;
    fake_camera_init(&camera, &clock_.hal, &camera_model);
    failures = &camera.failures;
}

static void camera_unplug(void *context) {
    (void)context;
    fake_camera_unplug(&camera);
}

static void test_camera(enum hal_camera_pixels pixels, const char *name) {
    fake_clock_init(&clock_, UINT32_MAX - 50000U); // exposures across the wrap
    camera_reset(NULL);
    camera_suite(&(struct camera_fixture){
        .name = name,
        .camera = &camera.hal,
        .clock = &clock_.hal,
        .format = {.pixels = pixels, .width_px = 64, .height_px = 48, .interval_us = 10000},
        .buffer_count = 4,
        .reset = camera_reset,
        .settle = settle_1ms,
        .unplug = camera_unplug,
        .fail_at = fail_at});
}

// ---------------------------------------------------------------------------------------- flash
static struct fake_flash flash;
static uint8_t flash_memory[4U * 4096U];
static struct hal_flash_geometry flash_geometry;
static uint32_t flash_busy_polls;

static void flash_reset(void *context) {
    (void)context;
    fake_flash_init(&flash, &flash_geometry, flash_memory, 1);
    flash.busy_polls = flash_busy_polls;
    failures = &flash.failures;
}

static void flash_reopen(void *context) {
    (void)context;
    fake_flash_power_on(&flash);
}

static void test_flash(const char *name, struct hal_flash_geometry geometry, uint32_t busy_polls) {
    flash_geometry = geometry;
    flash_busy_polls = busy_polls;
    flash_reset(NULL);
    flash_suite(&(struct flash_fixture){.name = name,
                                        .flash = &flash.hal,
                                        .geometry = geometry,
                                        .reset = flash_reset,
                                        .settle = settle_1ms,
                                        .reopen = flash_reopen,
                                        .fail_at = fail_at});
}

// ------------------------------------------------------------------------------------- watchdog
static struct fake_watchdog watchdog;

static void watchdog_reset(void *context) {
    (void)context;
    fake_watchdog_init(&watchdog, &clock_.hal, HAL_RESET_POWER_ON);
    failures = &watchdog.failures;
}

static bool watchdog_has_fired(void *context) {
    (void)context;
    return fake_watchdog_has_fired(&watchdog);
}

static void watchdog_come_up(void *context) {
    (void)context;
    fake_watchdog_init(&watchdog, &clock_.hal, HAL_RESET_WATCHDOG);
}

static void test_watchdog(void) {
    fake_clock_init(&clock_, UINT32_MAX - 100000U); // feeds across the wrap
    watchdog_reset(NULL);
    watchdog_suite(&(struct watchdog_fixture){.name = "fake_watchdog",
                                              .watchdog = &watchdog.hal,
                                              .timeout_us_min = 33000,
                                              .timeout_us_max = 8000000,
                                              .too_short_us = FAKE_WATCHDOG_TIMEOUT_US_MIN - 1U,
                                              .too_long_us = FAKE_WATCHDOG_TIMEOUT_US_MAX + 1U,
                                              .reset = watchdog_reset,
                                              .pass = pass,
                                              .has_fired = watchdog_has_fired,
                                              .come_up = watchdog_come_up,
                                              .fail_at = fail_at});
}

int main(void) {
    test_clock();
    test_can();
    test_gpio();
    test_pwm("fake_pwm_1us", 1000);
    test_pwm("fake_pwm_exact", 1);
    test_serial();
    test_usb();
    test_camera(HAL_CAMERA_GREY, "fake_camera_grey");
    test_camera(HAL_CAMERA_YUYV, "fake_camera_yuyv");
    test_flash("fake_flash_words", (struct hal_flash_geometry){4, 1024, 4}, 0);
    test_flash("fake_flash_pages", (struct hal_flash_geometry){2, 4096, 256}, 3);
    test_flash("fake_flash_bytes", (struct hal_flash_geometry){3, 64, 1}, 1);
    test_watchdog();
    return check_finish();
}
