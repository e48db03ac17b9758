/// A board on the desk: app/board_loop with two hobby servos, and a serial line whose other end the
/// test holds.
///
/// The line has a speed: in each tick it carries so many bytes each way, and what the board has no
/// room for is lost. A header, so that the tests of a folder that has only programs can share it.
#ifndef TESTS_UNIT_DESK_H
#define TESTS_UNIT_DESK_H

#include "check.h"

#include "app/board_loop.h"

#define DESK_DEGREE (AXIS_TURN_Q48 / 360)

enum {
    DESK_STOP_BUTTON,
    DESK_LINES,
    DESK_SAID_MAX = 1 << 16,
    DESK_RING_BYTES = 512, ///< as the boards' drivers have for what they receive
    DESK_SEND_BYTES = 1024,
    DESK_QUEUE_MAX = 1 << 15
};

static struct {
    uint32_t now_us;
    bool pressed, enable;
    uint32_t pulses;              ///< how often a pulse was set
    uint32_t byte_ns;             ///< how long a byte takes on the line; 0: no time
    uint64_t send_ns, receive_ns; ///< when the line is free again
    char queue[DESK_QUEUE_MAX];   ///< on its way to the board
    uint32_t queue_count, queue_at;
    uint8_t ring[DESK_RING_BYTES];
    uint32_t ring_put, ring_taken, lost;
    uint8_t send[DESK_SEND_BYTES];
    uint32_t send_put, send_taken;
    bool deaf; ///< nobody takes what the board says
    char said[DESK_SAID_MAX];
    uint32_t said_count, said_seen;
    uint32_t bytes_in, bytes_out;
    uint64_t time_ns;
} desk;

static struct controller_config desk_settings;
static struct board_config desk_config;
static struct board_loop desk_loop;

// ---------------------------------------------------------------- devices

static uint32_t desk_clock_now(void *ctx) {
    (void)ctx;
    return desk.now_us;
}

static enum hal_status desk_gpio_read(void *ctx, uint32_t line, bool *active) {
    (void)ctx;
    *active = line == DESK_STOP_BUTTON && desk.pressed;
    return HAL_OK;
}

static enum hal_status desk_gpio_write(void *ctx, uint32_t line, bool active) {
    (void)ctx;
    (void)line;
    desk.enable = active;
    return HAL_OK;
}

static enum hal_status desk_serial_write(void *ctx, const uint8_t *data, size_t size_bytes,
                                         size_t *written_bytes) {
    (void)ctx;
    while (*written_bytes < size_bytes && desk.send_put - desk.send_taken < DESK_SEND_BYTES) {
        desk.send[desk.send_put++ % DESK_SEND_BYTES] = data[(*written_bytes)++];
    }
    return *written_bytes != 0U ? HAL_OK : HAL_BUSY;
}

static enum hal_status desk_serial_read(void *ctx, uint8_t *data, size_t capacity,
                                        size_t *read_bytes) {
    (void)ctx;
    while (*read_bytes < capacity && desk.ring_taken != desk.ring_put) {
        data[(*read_bytes)++] = desk.ring[desk.ring_taken++ % DESK_RING_BYTES];
    }
    return *read_bytes != 0U ? HAL_OK : HAL_EMPTY;
}

static enum hal_status desk_serial_state(void *ctx, struct hal_serial_state *state) {
    (void)ctx;
    *state = (struct hal_serial_state){desk.lost, 0};
    return HAL_OK;
}

static enum hal_status desk_watchdog_start(void *ctx, uint32_t timeout_us) {
    (void)ctx;
    (void)timeout_us;
    return HAL_OK;
}

static enum hal_status desk_watchdog_feed(void *ctx) {
    (void)ctx;
    return HAL_OK;
}

static enum hal_status desk_watchdog_cause(void *ctx, enum hal_reset_cause *cause) {
    (void)ctx;
    *cause = HAL_RESET_POWER_ON;
    return HAL_OK;
}

static enum hal_status desk_pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    (void)ctx;
    (void)channel;
    (void)limits;
    return HAL_OK;
}

static enum hal_status desk_pwm_set(void *ctx, uint32_t channel, uint32_t value) {
    (void)ctx;
    (void)channel;
    desk.pulses += value != 0U;
    return HAL_OK;
}

static const struct hal_clock_ops desk_clock_ops = {desk_clock_now};
static const struct hal_gpio_ops desk_gpio_ops = {desk_gpio_read, desk_gpio_write};
static const struct hal_serial_ops desk_serial_ops = {desk_serial_write, desk_serial_read,
                                                      desk_serial_state};
static const struct hal_watchdog_ops desk_watchdog_ops = {desk_watchdog_start, desk_watchdog_feed,
                                                          desk_watchdog_cause};
static const struct hal_pwm_ops desk_pwm_ops = {desk_pwm_limits, desk_pwm_set, desk_pwm_set};
static const struct hal_clock desk_clock = {&desk_clock_ops, NULL};
static const struct hal_gpio desk_gpio = {&desk_gpio_ops, NULL};
static const struct hal_serial desk_serial = {&desk_serial_ops, NULL};
static const struct hal_watchdog desk_watchdog = {&desk_watchdog_ops, NULL};
static const struct hal_pwm desk_pwm = {&desk_pwm_ops, NULL};
static const struct board_stop_line desk_stop_lines[] = {{DESK_STOP_BUTTON, "emergency stop"}};
static const char *const desk_notes[] = {"board: desk", NULL};

// ---------------------------------------------------------------- the board

static inline void desk_axis(unsigned axis) {
    struct controller_axis_config *config = &desk_settings.axis[axis];
    config->limits = (struct limiter_config){-90 * DESK_DEGREE, 90 * DESK_DEGREE, DESK_DEGREE / 10,
                                             DESK_DEGREE / 1000, 1};
    config->drive.kind = DRIVE_PWM;
    config->drive.pwm =
        (struct drive_pwm_config){axis, -90 * DESK_DEGREE, 90 * DESK_DEGREE, 1000000, 2000000};
}

/// The rig as built: 90 degrees to each side, 100 degrees/s, 1000 degrees/s^2.
static inline void desk_configure(void) {
    desk_settings = (struct controller_config){
        .tick_us = 1000, .tracker = {3 * DESK_DEGREE, 0, 250}, .silence_us = 50000};
    desk_axis(AXIS_PAN);
    desk_axis(AXIS_TILT);
    desk_config =
        (struct board_config){&desk_settings, desk_stop_lines, 1, DESK_LINES, desk_notes, NULL};
}

/// The program starts, at power-on or after a reset, with whatever is in its memory.
static inline void desk_boot(void) {
    uint8_t *bytes = (uint8_t *)&desk_loop;
    for (size_t i = 0; i < sizeof desk_loop; i++) {
        bytes[i] = 0x5A;
    }
    const struct board_devices devices = {
        {&desk_clock, NULL, &desk_pwm}, &desk_gpio, &desk_serial, &desk_watchdog};
    board_loop_init(&desk_loop, &desk_config, &devices);
}

/// Switches it on. baud 0: the line takes no time.
static inline void desk_start(uint32_t baud) {
    desk.now_us = 0xFFFF0000U;
    desk.time_ns = desk.send_ns = desk.receive_ns = 0;
    desk.pressed = desk.enable = desk.deaf = false;
    desk.pulses = desk.lost = desk.bytes_in = desk.bytes_out = 0;
    desk.queue_count = desk.queue_at = desk.ring_put = desk.ring_taken = 0;
    desk.send_put = desk.send_taken = desk.said_count = desk.said_seen = 0;
    desk.byte_ns = baud != 0U ? 1000000000U / baud * 10U : 0U;
    desk_boot();
}

static inline void desk_carry(void) {
    while (desk.queue_at != desk.queue_count && desk.receive_ns <= desk.time_ns) {
        desk.receive_ns =
            desk.byte_ns == 0U
                ? 0U
                : (desk.receive_ns + 1000000U < desk.time_ns ? desk.time_ns : desk.receive_ns) +
                      desk.byte_ns;
        const char byte = desk.queue[desk.queue_at++];
        if (desk.ring_put - desk.ring_taken == DESK_RING_BYTES) {
            desk.lost++;
        } else {
            desk.ring[desk.ring_put++ % DESK_RING_BYTES] = (uint8_t)byte;
        }
        desk.bytes_in++;
    }
    if (desk.queue_at == desk.queue_count) {
        desk.queue_at = desk.queue_count = 0;
    }
    while (!desk.deaf && desk.send_taken != desk.send_put && desk.send_ns <= desk.time_ns) {
        desk.send_ns =
            desk.byte_ns == 0U
                ? 0U
                : (desk.send_ns + 1000000U < desk.time_ns ? desk.time_ns : desk.send_ns) +
                      desk.byte_ns;
        const uint8_t byte = desk.send[desk.send_taken++ % DESK_SEND_BYTES];
        if (desk.said_count < DESK_SAID_MAX) {
            desk.said[desk.said_count++] = (char)byte;
        }
        desk.bytes_out++;
    }
}

static inline void desk_ticks(uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        desk.now_us += 1000U;
        desk.time_ns += 1000000U;
        desk_carry();
        board_loop_tick(&desk_loop, 0);
    }
}

static inline void desk_send(const char *bytes, uint32_t count) {
    for (uint32_t i = 0; i < count && desk.queue_count < DESK_QUEUE_MAX; i++) {
        desk.queue[desk.queue_count++] = bytes[i];
    }
}

static inline void desk_type(const char *text) {
    uint32_t count = 0;
    while (text[count] != '\0') {
        count++;
    }
    desk_send(text, count);
}

static inline enum controller_mode desk_mode(void) {
    return desk_loop.pump.output.status.mode;
}

static inline bool desk_driven(void) {
    return desk_mode() == MODE_SETTLING || desk_mode() == MODE_TRACKING ||
           desk_mode() == MODE_HOLDING;
}

/// Where an axis is told to be, in hundredths of a degree.
static inline int64_t desk_cdeg(unsigned axis) {
    return drive_cdeg_from_q48(desk_loop.pump.output.status.axis[axis].setpoint_q48);
}

// ---------------------------------------------------------------- what it said

/// Forgets what was said so far.
static inline void desk_forget(void) {
    desk.said_count = desk.said_seen = 0;
}

static inline bool desk_says(const char *wanted) {
    for (uint32_t at = 0; at < desk.said_count; at++) {
        uint32_t i = 0;
        while (wanted[i] != '\0' && at + i < desk.said_count && desk.said[at + i] == wanted[i]) {
            i++;
        }
        if (wanted[i] == '\0') {
            return true;
        }
    }
    return false;
}

/// Exactly that, since the last desk_forget; then forgets it. Shows what it was, if it was not.
static inline bool desk_said(const char *wanted) {
    uint32_t i = 0;
    while (wanted[i] != '\0' && i < desk.said_count && desk.said[i] == wanted[i]) {
        i++;
    }
    const bool same = wanted[i] == '\0' && i == desk.said_count;
    if (!same) {
        check_write("  it said:\n", 11);
        check_write(desk.said, desk.said_count);
        check_write("\n", 1);
    }
    desk_forget();
    return same;
}

#endif
