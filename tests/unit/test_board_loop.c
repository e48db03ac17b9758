/// app/board_loop and app/board_console between devices that the test holds in its hands.
#include "check.h"

#include "app/board_loop.h"

#define DEGREE (AXIS_TURN_Q48 / 360)

enum { STOP_BUTTON, KEY, ENABLE, LINES, SAID_MAX = 16384 };

static struct {
    uint32_t now_us;
    bool clock_stands;
    bool active[LINES];
    bool enable;
    enum hal_status read_status, start_status, filter_status;
    enum hal_reset_cause cause;
    uint32_t timeout_us, feeds;
    struct hal_can_filter filter[HAL_CAN_FILTERS_MAX];
    uint32_t filter_count;
    struct hal_can_state bus;
    uint32_t room; ///< of the serial line, bytes a tick
    char said[SAID_MAX];
    uint32_t said_count;
} world;

// ---------------------------------------------------------------- devices

static uint32_t clock_now(void *ctx) {
    (void)ctx;
    return world.now_us;
}

static enum hal_status gpio_read(void *ctx, uint32_t line, bool *active) {
    (void)ctx;
    *active = line < LINES && world.active[line];
    return world.read_status;
}

static enum hal_status gpio_write(void *ctx, uint32_t line, bool active) {
    (void)ctx;
    CHECK_EQ(line, ENABLE);
    world.enable = active;
    return HAL_OK;
}

static enum hal_status serial_write(void *ctx, const uint8_t *data, size_t size_bytes,
                                    size_t *written_bytes) {
    (void)ctx;
    while (*written_bytes < size_bytes && world.room != 0U && world.said_count < SAID_MAX) {
        world.said[world.said_count++] = (char)data[(*written_bytes)++];
        world.room--;
    }
    return *written_bytes != 0U ? HAL_OK : HAL_BUSY;
}

static enum hal_status serial_read(void *ctx, uint8_t *data, size_t capacity, size_t *read_bytes) {
    (void)ctx;
    (void)data;
    (void)capacity;
    (void)read_bytes;
    return HAL_EMPTY;
}

static enum hal_status serial_state(void *ctx, struct hal_serial_state *state) {
    (void)ctx;
    *state = (struct hal_serial_state){0, 0};
    return HAL_OK;
}

static enum hal_status watchdog_start(void *ctx, uint32_t timeout_us) {
    (void)ctx;
    world.timeout_us = timeout_us;
    return world.start_status;
}

static enum hal_status watchdog_feed(void *ctx) {
    (void)ctx;
    world.feeds++;
    return HAL_OK;
}

static enum hal_status watchdog_cause(void *ctx, enum hal_reset_cause *cause) {
    (void)ctx;
    *cause = world.cause;
    return HAL_OK;
}

static enum hal_status can_send(void *ctx, const struct can_frame *frame) {
    (void)ctx;
    (void)frame;
    return HAL_OK;
}

static enum hal_status can_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    (void)ctx;
    (void)frame;
    (void)received_us;
    return HAL_EMPTY;
}

static enum hal_status can_state(void *ctx, struct hal_can_state *state) {
    (void)ctx;
    *state = world.bus;
    return HAL_OK;
}

static enum hal_status can_filters(void *ctx, const struct hal_can_filter *filters,
                                   uint32_t count) {
    (void)ctx;
    world.filter_count = count;
    for (uint32_t i = 0; i < count; i++) {
        world.filter[i] = filters[i];
    }
    return world.filter_status;
}

static enum hal_status can_restart(void *ctx) {
    (void)ctx;
    return HAL_OK;
}

static enum hal_status pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    (void)ctx;
    (void)channel;
    (void)limits;
    return HAL_OK;
}

static enum hal_status pwm_set(void *ctx, uint32_t channel, uint32_t value) {
    (void)ctx;
    (void)channel;
    (void)value;
    return HAL_OK;
}

static const struct hal_clock_ops clock_ops = {clock_now};
static const struct hal_gpio_ops gpio_ops = {gpio_read, gpio_write};
static const struct hal_serial_ops serial_ops = {serial_write, serial_read, serial_state};
static const struct hal_watchdog_ops watchdog_ops = {watchdog_start, watchdog_feed, watchdog_cause};
static const struct hal_can_ops can_ops = {can_send, can_receive, can_state, can_filters,
                                           can_restart};
static const struct hal_pwm_ops pwm_ops = {pwm_limits, pwm_set, pwm_set};
static const struct hal_clock clock_ = {&clock_ops, NULL};
static const struct hal_gpio gpio = {&gpio_ops, NULL};
static const struct hal_serial serial = {&serial_ops, NULL};
static const struct hal_watchdog watchdog = {&watchdog_ops, NULL};
static const struct hal_can can = {&can_ops, NULL};
static const struct hal_pwm pwm = {&pwm_ops, NULL};

// ---------------------------------------------------------------- a board

static const struct board_stop_line stop_lines[] = {{STOP_BUTTON, "emergency stop"},
                                                    {KEY, "key switch off"}};
static const char *const notes[] = {"board: test", NULL};
static struct controller_config settings;
static struct board_config config;
static struct board_devices devices;
static struct board_loop loop;

static void configure_axis(unsigned axis) {
    settings.axis[axis].limits =
        (struct limiter_config){-90 * DEGREE, 90 * DEGREE, DEGREE / 10, DEGREE / 1000, 1};
    settings.axis[axis].drive.kind = DRIVE_PWM;
    settings.axis[axis].drive.pwm =
        (struct drive_pwm_config){axis, -90 * DEGREE, 90 * DEGREE, 1000000, 2000000};
}

/// Hobby servos: no drive has to answer, so only the board stands between the rig and motion.
static void configure(void) {
    uint8_t *bytes = (uint8_t *)&world;
    for (size_t i = 0; i < sizeof world; i++) {
        bytes[i] = 0;
    }
    world.cause = HAL_RESET_POWER_ON;
    world.room = UINT32_MAX;
    settings = (struct controller_config){
        .tick_us = 1000, .tracker = {DEGREE, 0, 0}, .silence_us = 50000, .arm_on_start = true};
    configure_axis(AXIS_PAN);
    configure_axis(AXIS_TILT);
    config = (struct board_config){&settings, stop_lines, 2, ENABLE, notes, NULL};
    devices = (struct board_devices){{&clock_, NULL, &pwm}, &gpio, &serial, &watchdog};
}

static void start(void) {
    uint8_t *bytes = (uint8_t *)&loop;
    for (size_t i = 0; i < sizeof loop; i++) {
        bytes[i] = 0x5A;
    }
    board_loop_init(&loop, &config, &devices);
}

static enum controller_mode mode(void) {
    return loop.pump.output.status.mode;
}

static bool armed(void) {
    return mode() == MODE_SETTLING || mode() == MODE_TRACKING || mode() == MODE_HOLDING;
}

static void ticks(uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        world.now_us += world.clock_stands ? 0U : 1000U;
        board_loop_tick(&loop, 0);
    }
}

static void arm(void) {
    pump_command(&loop.pump, COMMAND_ARM);
    ticks(5);
}

static bool says(const char *wanted) {
    for (uint32_t at = 0; at < world.said_count; at++) {
        uint32_t i = 0;
        while (wanted[i] != '\0' && at + i < world.said_count && world.said[at + i] == wanted[i]) {
            i++;
        }
        if (wanted[i] == '\0') {
            return true;
        }
    }
    return false;
}

// ---------------------------------------------------------------- tests

static void arms_when_nothing_is_wrong(void) {
    configure();
    start();
    CHECK(!world.enable);
    ticks(3);
    CHECK(armed() && world.enable);
}

static void never_arms_while_a_stop_line_is_active(void) {
    for (unsigned line = STOP_BUTTON; line <= KEY; line++) {
        configure();
        start();
        world.active[line] = true;
        ticks(10);
        arm();
        CHECK(!armed() && !world.enable);
        world.active[line] = false;
        ticks(10);
        CHECK(!armed()); // not by itself
        arm();
        CHECK(armed() && world.enable);
    }
}

static void stops_when_a_stop_line_becomes_active(void) {
    configure();
    start();
    ticks(5);
    CHECK(armed());
    world.active[STOP_BUTTON] = true;
    ticks(1);
    CHECK_EQ(mode(), MODE_STOPPED);
    CHECK(world.enable); // it holds, and that takes power
    world.active[STOP_BUTTON] = false;
    ticks(100);
    CHECK_EQ(mode(), MODE_STOPPED);
    arm();
    CHECK(armed());
}

static void a_line_that_cannot_be_read_stops(void) {
    configure();
    start();
    ticks(5);
    world.read_status = HAL_ERROR_IO;
    ticks(1);
    CHECK_EQ(mode(), MODE_STOPPED);
}

static void does_not_arm_by_itself_after_a_crash(void) {
    const enum hal_reset_cause causes[] = {HAL_RESET_WATCHDOG, HAL_RESET_SOFTWARE};
    for (unsigned i = 0; i < 2U; i++) {
        configure();
        world.cause = causes[i];
        start();
        ticks(50);
        CHECK(!armed());
        arm();
        CHECK(armed());
    }
}

static void expect_refusal(const char *why) {
    start();
    ticks(10);
    arm();
    ticks(1500);
    CHECK(!armed() && !world.enable);
    CHECK(says(why));
    CHECK(says("held: "));
    CHECK(world.feeds > 1000U); // alive all the same
}

static void refuses_for_good(void) {
    configure();
    config.refusal = "the crystal does not oscillate";
    expect_refusal("will not arm: the crystal does not oscillate\r\n");
    configure();
    world.start_status = HAL_ERROR_IO;
    expect_refusal("will not arm: the watchdog does not start\r\n");
    configure();
    devices.pump.pwm = NULL;
    expect_refusal("will not arm: a device that the drives need is missing\r\n");
    configure();
    settings.tick_us = 1;
    expect_refusal("will not arm: the settings are not valid\r\n");
    configure();
    devices.pump.can = &can;
    world.filter_status = HAL_ERROR_IO;
    expect_refusal("will not arm: the CAN filters can't be set\r\n");
}

static void feeds_only_when_all_have_checked_in(void) {
    configure();
    start();
    CHECK_EQ(world.timeout_us, 33000);
    ticks(100);
    CHECK_EQ(world.feeds, 100);
    world.clock_stands = true; // the control step sees no time pass
    ticks(100);
    CHECK_EQ(world.feeds, 100);
    world.clock_stands = false;
    ticks(1);
    CHECK_EQ(world.feeds, 101);
}

static void listens_to_its_drives_only(void) {
    configure();
    devices.pump.can = &can;
    settings.axis[AXIS_TILT].drive.kind = DRIVE_RMD;
    settings.axis[AXIS_TILT].drive.rmd = (struct drive_rmd_config){.id = 7, .reply_offset = 0x100};
    start();
    CHECK_EQ(world.filter_count, 1);
    for (uint32_t id = 0; id <= CAN_FRAME_STANDARD_ID_MAX; id++) {
        for (uint8_t flags = 0; flags < 4U; flags++) {
            const struct can_frame frame = {.id = id, .flags = flags, .length = 8};
            CHECK_EQ(hal_can_filter_passes(&world.filter[0], &frame), id == 0x247 && flags == 0);
        }
    }
}

static void tells_who_it_is(void) {
    configure();
    devices.pump.can = &can;
    world.cause = HAL_RESET_BROWN_OUT;
    world.bus = (struct hal_can_state){HAL_CAN_PASSIVE, 128, 7, 0};
    start();
    ticks(10);
    CHECK(says("boresight ") && says(build_id) && says("\r\nboard: test\r\nreset: brown-out\r\n"));
    ticks(3500);
    CHECK(says("     3 s  holding  pan    0.00  tilt    0.00  targets 0  can passive 128/7"));
    world.active[KEY] = true;
    ticks(1000);
    CHECK(says("held: key switch off\r\n"));
}

/// A bus that was off for a moment is told; the line after that is about the present again.
static void tells_the_worst_of_the_bus(void) {
    configure();
    devices.pump.can = &can;
    start();
    ticks(1500);
    CHECK(says(" 1 s  holding  pan    0.00  tilt    0.00  targets 0  can active 0/0"));
    world.bus = (struct hal_can_state){HAL_CAN_OFF, 256, 0, 0};
    ticks(1);
    world.bus = (struct hal_can_state){HAL_CAN_ACTIVE, 3, 0, 0};
    ticks(1800);
    CHECK(says(" 2 s  holding  pan    0.00  tilt    0.00  targets 0  can off 256/0"));
    CHECK(says(" 3 s  holding  pan    0.00  tilt    0.00  targets 0  can active 3/0"));
}

/// A line that takes a byte a tick gets every line whole, and the loop goes on.
static void slow_line(void) {
    configure();
    start();
    for (int i = 0; i < 3000; i++) {
        world.room = 1;
        ticks(1);
    }
    CHECK(says("\r\nreset: power-on\r\n"));
    CHECK(says("     1 s  holding  pan"));
    CHECK(says("     2 s  holding  pan"));
    CHECK_EQ(world.feeds, 3000);
}

static void dead_line(void) {
    configure();
    world.room = 0;
    start();
    ticks(3000);
    CHECK_EQ(world.feeds, 3000);
    CHECK(armed());
}

int main(void) {
    TEST(arms_when_nothing_is_wrong);
    TEST(never_arms_while_a_stop_line_is_active);
    TEST(stops_when_a_stop_line_becomes_active);
    TEST(a_line_that_cannot_be_read_stops);
    TEST(does_not_arm_by_itself_after_a_crash);
    TEST(refuses_for_good);
    TEST(feeds_only_when_all_have_checked_in);
    TEST(listens_to_its_drives_only);
    TEST(tells_who_it_is);
    TEST(tells_the_worst_of_the_bus);
    TEST(slow_line);
    TEST(dead_line);
    return check_finish();
}
