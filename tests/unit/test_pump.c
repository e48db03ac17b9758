/// firmware/app/pump between devices that fail on demand and a controller.
#include "check.h"

#include "app/pump.h"

#define DEGREE (AXIS_TURN_Q48 / 360)

// ---------------------------------------------------------------- devices

enum { QUEUE_MAX = 64 };

static struct {
    uint32_t now_us;
    struct can_frame received[QUEUE_MAX]; ///< waiting for the pump
    uint32_t received_first, received_count;
    struct can_frame sent[QUEUE_MAX];
    uint32_t sent_count;
    enum hal_status send_status, receive_status, restart_status, pulse_status;
    uint32_t sends_that_work; ///< before send_status holds
    uint32_t restarts, pulses;
    uint32_t channel, pulse_ns; ///< last written
} world;

static uint32_t clock_now(void *ctx) {
    (void)ctx;
    return world.now_us;
}

static enum hal_status can_send(void *ctx, const struct can_frame *frame) {
    (void)ctx;
    if (world.sends_that_work == 0U && world.send_status != HAL_OK) {
        return world.send_status;
    }
    world.sends_that_work -= world.sends_that_work != 0U;
    world.sent[world.sent_count++ % QUEUE_MAX] = *frame;
    return HAL_OK;
}

static enum hal_status can_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    (void)ctx;
    if (world.receive_status != HAL_OK) {
        return world.receive_status;
    }
    if (world.received_count == 0U) {
        return HAL_EMPTY;
    }
    *frame = world.received[world.received_first++];
    *received_us = world.now_us - world.received_count;
    world.received_count--;
    return HAL_OK;
}

static enum hal_status can_state(void *ctx, struct hal_can_state *state) {
    (void)ctx;
    *state = (struct hal_can_state){HAL_CAN_ACTIVE, 0, 0, 0};
    return HAL_OK;
}

static enum hal_status can_filters(void *ctx, const struct hal_can_filter *filters,
                                   uint32_t count) {
    (void)ctx;
    (void)filters;
    (void)count;
    return HAL_OK;
}

static enum hal_status can_restart(void *ctx) {
    (void)ctx;
    world.restarts++;
    return world.restart_status;
}

static enum hal_status pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    (void)ctx;
    (void)channel;
    *limits = (struct hal_pwm_limits){20000000, 1000000, 40000000, 1};
    return HAL_OK;
}

static enum hal_status pwm_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    (void)ctx;
    (void)channel;
    (void)period_ns;
    return HAL_OK;
}

static enum hal_status pwm_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    (void)ctx;
    world.pulses++;
    if (world.pulse_status == HAL_OK) {
        world.channel = channel;
        world.pulse_ns = pulse_ns;
    }
    return world.pulse_status;
}

static const struct hal_clock_ops clock_ops = {clock_now};
static const struct hal_can_ops can_ops = {can_send, can_receive, can_state, can_filters,
                                           can_restart};
static const struct hal_pwm_ops pwm_ops = {pwm_limits, pwm_period, pwm_pulse};

// ---------------------------------------------------------------- a rig

static struct controller_config config;
static struct controller controller;
static struct pump pump;
static struct hal_clock hal_clock_device;
static struct hal_can hal_can_device;
static struct hal_pwm hal_pwm_device;
static struct pump_devices devices;

static void configure_axis(unsigned axis, enum drive_kind kind) {
    config.axis[axis].limits =
        (struct limiter_config){-90 * DEGREE, 90 * DEGREE, DEGREE, DEGREE, 1};
    config.axis[axis].drive = (struct drive_config){.kind = kind};
    if (kind == DRIVE_RMD) {
        config.axis[axis].drive.rmd =
            (struct drive_rmd_config){.id = (uint8_t)(axis + 1U), .reply_offset = 0x100};
    } else if (kind == DRIVE_PWM) {
        config.axis[axis].drive.pwm =
            (struct drive_pwm_config){axis + 10U, -90 * DEGREE, 90 * DEGREE, 1000000, 2000000};
    }
}

static void configure(enum drive_kind pan, enum drive_kind tilt) {
    config = (struct controller_config){.tick_us = 1000,
                                        .tracker = {DEGREE, 0, 0},
                                        .silence_us = 50000,
                                        .follow_error_q48 = DEGREE,
                                        .follow_error_us = 1000000};
    configure_axis(AXIS_PAN, pan);
    configure_axis(AXIS_TILT, tilt);
}

static bool start(void) {
    world.now_us = 0;
    world.received_first = world.received_count = world.sent_count = 0;
    world.send_status = world.receive_status = world.restart_status = world.pulse_status = HAL_OK;
    world.sends_that_work = world.restarts = world.pulses = 0;
    world.channel = 0;
    world.pulse_ns = UINT32_MAX;
    CHECK_EQ(hal_clock_bind(&hal_clock_device, &clock_ops, NULL), HAL_OK);
    CHECK_EQ(hal_can_bind(&hal_can_device, &can_ops, NULL), HAL_OK);
    CHECK_EQ(hal_pwm_bind(&hal_pwm_device, &pwm_ops, NULL), HAL_OK);
    devices = (struct pump_devices){&hal_clock_device, &hal_can_device, &hal_pwm_device};
    for (size_t i = 0; i < sizeof pump; i++) {
        ((uint8_t *)&pump)[i] = 0xBB;
    }
    CHECK(controller_init(&controller, &config));
    return pump_init(&pump, &controller, &devices);
}

static void start_rig(void) {
    configure(DRIVE_RMD, DRIVE_PWM);
    CHECK(start());
}

static void step(void) {
    pump_step(&pump);
    world.now_us += 1000;
}

static void steps(int count) {
    for (int i = 0; i < count; i++) {
        step();
    }
}

static void arrive(struct can_frame frame) {
    world.received[world.received_first + world.received_count++] = frame;
}

/// A direction 1 degree apart for each id.
static struct target_update target(uint32_t id) {
    return (struct target_update){
        .kind = TARGET_DIRECTION, .id = id, .weight_q16 = 1, .direction = {(int32_t)id, 60, 0}};
}

// ---------------------------------------------------------------- tests

static void devices_that_are_missing(void) {
    configure(DRIVE_RMD, DRIVE_RMD);
    (void)start();
    devices.pwm = NULL;
    CHECK(pump_init(&pump, &controller, &devices)); // nothing needs it
    devices.can = NULL;
    CHECK(!pump_init(&pump, &controller, &devices));
    configure(DRIVE_PWM, DRIVE_PWM);
    (void)start();
    devices.can = NULL;
    CHECK(pump_init(&pump, &controller, &devices));
    devices.pwm = NULL;
    CHECK(!pump_init(&pump, &controller, &devices));
    devices.pwm = &hal_pwm_device;
    devices.clock = NULL;
    CHECK(!pump_init(&pump, &controller, &devices));
}

static void a_rig_without_can(void) {
    configure(DRIVE_PWM, DRIVE_PWM);
    (void)start();
    devices.can = NULL;
    CHECK(pump_init(&pump, &controller, &devices));
    pump_command(&pump, COMMAND_ARM);
    steps(20);
    CHECK_EQ(pump.output.status.mode, MODE_HOLDING);
    CHECK_EQ(pump.errors.can_receive_failed + pump.errors.can_send_failed, 0);
    CHECK_EQ(world.pulse_ns, 1500000);
}

static void the_clock_and_the_frames_go_in(void) {
    start_rig();
    world.now_us = 0xFFFFFFFF;
    for (uint32_t i = 0; i < 40U; i++) {
        arrive((struct can_frame){.id = 0x700U + i, .length = 1, .data = {(uint8_t)i}});
    }
    step();
    CHECK_EQ(pump.input.now_us, 0xFFFFFFFF);
    CHECK_EQ(pump.input.frame_count, CONTROLLER_FRAMES_IN_MAX);
    CHECK_EQ(pump.input.frame[15].id, 0x70F);
    CHECK_EQ(pump.input.frame_us[15], 0xFFFFFFFF - 25U); // when it arrived, with it
    step();
    CHECK_EQ(pump.input.frame_count, CONTROLLER_FRAMES_IN_MAX);
    CHECK_EQ(pump.input.frame[0].id, 0x710);
    step();
    CHECK_EQ(pump.input.frame_count, 8);
    CHECK_EQ(pump.input.frame[7].data[0], 39);
    step();
    CHECK_EQ(pump.input.frame_count, 0);
    CHECK_EQ(pump.output.status.frames_ignored, 40);
    CHECK_EQ(pump.output.status.time_us, 3000);
}

static void a_receiver_that_fails_is_counted(void) {
    start_rig();
    world.receive_status = HAL_ERROR_IO;
    step();
    step();
    CHECK_EQ(pump.errors.can_receive_failed, 2);
    CHECK_EQ(pump.output.status.time_us, 1000); // the ticks go on
    world.receive_status = HAL_OK;
    step();
    CHECK_EQ(pump.errors.can_receive_failed, 2);
}

static void frames_go_out(void) {
    start_rig();
    steps(64);
    CHECK_EQ(world.sent_count, 16); // a question in four ticks
    CHECK_EQ(world.sent[0].id, 0x141);
    CHECK_EQ(pump.errors.can_send_failed, 0);
}

/// Both drives on the same tick, so that a frame is left when the first fails.
static void use_two_frames_a_tick(void) {
    configure(DRIVE_RMD, DRIVE_RMD);
    configure_axis(AXIS_ZOOM, DRIVE_RMD);
    config.lens = (struct lens_config){.point = {{4000, 0}, {8000, AXIS_TURN_Q48}},
                                       .point_count = 2,
                                       .sensor_width_um = 5000,
                                       .sensor_height_um = 5000};
    CHECK(start());
    uint32_t ticks = 0;
    while (pump.output.frame_count != 2U && ticks < 500U) { // when pan is driven and zoom is asked
        for (uint8_t id = 1; id <= 3U; id++) {
            const uint32_t reply = 0x240U + id;
            arrive((struct can_frame){.id = reply, .length = 8, .data = {0x92}});
            arrive((struct can_frame){.id = reply, .length = 8, .data = {0x9A}});
            arrive((struct can_frame){.id = reply, .length = 8, .data = {0xB3}});
            arrive((struct can_frame){.id = reply, .length = 8, .data = {0x42}});
        }
        pump_command(&pump, COMMAND_ARM);
        step();
        world.received_first = 0;
        ticks++;
    }
    CHECK_EQ(pump.output.frame_count, 2);
    CHECK_EQ(world.received_count, 0);
    steps(3);
}

static void a_full_queue_drops_the_rest_of_the_tick(void) {
    use_two_frames_a_tick();
    const uint32_t sent = world.sent_count;
    world.send_status = HAL_BUSY;
    step();
    CHECK_EQ(pump.output.frame_count, 2);
    CHECK_EQ(world.sent_count, sent);
    CHECK_EQ(pump.errors.can_send_failed, 1);
    CHECK_EQ(world.restarts, 0);
    steps(3);
    world.sends_that_work = 1;
    const uint32_t failed = pump.errors.can_send_failed;
    step();
    CHECK_EQ(world.sent_count, sent + 1U); // the first of the two
    CHECK_EQ(pump.errors.can_send_failed, failed + 1U);
    world.send_status = HAL_OK;
    steps(3);
    const uint32_t before = world.sent_count;
    step();
    CHECK_EQ(world.sent_count, before + 2U);
}

static void a_bus_that_is_off_is_restarted(void) {
    start_rig();
    world.send_status = HAL_ERROR_DOWN;
    steps(16);
    CHECK_EQ(world.restarts, 4);
    CHECK_EQ(pump.errors.can_restarts, 1); // it is the same one
    CHECK_EQ(pump.errors.can_send_failed, 4);
    world.restart_status = HAL_ERROR_DENIED;
    steps(16);
    CHECK_EQ(world.restarts, 8);
    CHECK_EQ(pump.errors.can_restarts, 1);
    CHECK_EQ(pump.errors.can_send_failed, 8);
    world.send_status = world.restart_status = HAL_OK;
    steps(4);
    world.send_status = HAL_ERROR_DOWN;
    steps(8);
    CHECK_EQ(pump.errors.can_restarts, 2);
}

static void pulses_are_written_when_they_change(void) {
    configure(DRIVE_PWM, DRIVE_PWM);
    CHECK(start());
    step();
    CHECK_EQ(world.pulses, 2); // none, on both channels: who knows what they gave before
    CHECK_EQ(world.pulse_ns, 0);
    steps(20);
    CHECK_EQ(world.pulses, 2);
    pump_command(&pump, COMMAND_ARM);
    step();
    CHECK_EQ(world.pulses, 4);
    CHECK_EQ(world.channel, 11);
    CHECK_EQ(world.pulse_ns, 1500000);
    steps(20);
    CHECK_EQ(world.pulses, 4);
}

static void pulses_that_fail_are_written_again(void) {
    configure(DRIVE_PWM, DRIVE_PWM);
    CHECK(start());
    step();
    pump_command(&pump, COMMAND_ARM);
    world.pulse_status = HAL_ERROR_IO;
    steps(5);
    CHECK_EQ(pump.errors.pwm_failed, 10);
    CHECK_EQ(world.pulse_ns, 0);
    world.pulse_status = HAL_OK;
    step();
    CHECK_EQ(pump.errors.pwm_failed, 10);
    CHECK_EQ(world.pulse_ns, 1500000);
    const uint32_t pulses = world.pulses;
    step();
    CHECK_EQ(world.pulses, pulses);
}

static void updates_wait_in_order(void) {
    start_rig();
    uint32_t pushed = 0, seen = 0;
    for (int round = 0; round < 10; round++) { // across the end of the ring
        while (pump_push(&pump, &(struct target_update){.kind = TARGET_GONE, .id = pushed})) {
            pushed++;
        }
        CHECK_EQ(pump.update_count, PUMP_UPDATES_MAX);
        step();
        CHECK_EQ(pump.input.update_count, CONTROLLER_UPDATES_MAX);
        for (uint32_t i = 0; i < pump.input.update_count; i++) {
            CHECK_EQ(pump.input.update[i].id, seen++);
        }
    }
    CHECK_EQ(pump.errors.updates_dropped, 10);
    CHECK_EQ(pushed, 128 + 9 * 16);
    for (int round = 0; round < 7; round++) {
        step();
        CHECK_EQ(pump.input.update_count, 16);
    }
    step();
    CHECK_EQ(pump.input.update_count, 0);
    CHECK_EQ(pump.update_count, 0);
    CHECK(pump_push(&pump, &(struct target_update){.kind = TARGET_GONE, .id = 7}));
    step();
    CHECK_EQ(pump.input.update_count, 1);
    CHECK_EQ(pump.input.update[0].id, 7);
}

static void push(uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        CHECK(pump_push(&pump, &(struct target_update){.kind = TARGET_GONE, .id = i}));
    }
}

/// The next ticks take so many, each as many as it can.
static void take(uint32_t count) {
    for (uint32_t left = count; left != 0U && check_clean();) {
        const uint32_t now = left < CONTROLLER_UPDATES_MAX ? left : CONTROLLER_UPDATES_MAX;
        step();
        CHECK_EQ(pump.input.update_count, now);
        left -= now;
    }
}

/// A frame of more than a tick takes goes in ticks that follow each other; the controller aims
/// after the last (tests/unit/test_controller_inputs.c).
static void held_updates_go_together(void) {
    start_rig();
    push(3);
    pump_hold(&pump);
    push(40);
    step();
    CHECK_EQ(pump.input.update_count, 3);
    push(10);
    step();
    CHECK_EQ(pump.input.update_count, 0);
    pump_release(&pump);
    push(1);
    take(51);
    pump_hold(&pump);
    push(5);
    pump_forget(&pump);
    push(2);
    step();
    CHECK_EQ(pump.input.update_count, 2);
    // A queue that is full of what is held back holds nothing back any more.
    pump_hold(&pump);
    push(PUMP_UPDATES_MAX);
    step();
    CHECK_EQ(pump.input.update_count, 0);
    CHECK(!pump_push(&pump, &(struct target_update){.kind = TARGET_GONE}));
    take(CONTROLLER_UPDATES_MAX);
    push(1);
    take(PUMP_UPDATES_MAX + 1U - CONTROLLER_UPDATES_MAX);
}

static void commands_are_given_once(void) {
    start_rig();
    pump_command(&pump, COMMAND_ARM);
    pump_command(&pump, COMMAND_STOP);
    step();
    CHECK_EQ(pump.input.commands, COMMAND_ARM | COMMAND_STOP);
    step();
    CHECK_EQ(pump.input.commands, 0);
}

/// What the pump recorded as input gives the same outputs to a controller without a pump.
static void the_recorded_input_replays(void) {
    static struct controller replayed;
    static struct controller_output output;
    configure(DRIVE_PWM, DRIVE_PWM);
    CHECK(start());
    CHECK(controller_init(&replayed, &config));
    for (uint32_t i = 0; i < 300U && check_clean(); i++) {
        if (i == 3U) {
            pump_command(&pump, COMMAND_ARM);
        }
        if (i % 7U == 0U) {
            const struct target_update update = target(i / 7U);
            CHECK(pump_push(&pump, &update));
        }
        step();
        controller_step(&replayed, &pump.input, &output);
        for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
            CHECK_EQ(output.pulse_ns[axis], pump.output.pulse_ns[axis]);
            CHECK_EQ(output.status.axis[axis].goal_q48, pump.output.status.axis[axis].goal_q48);
        }
        CHECK_EQ(output.status.mode, pump.output.status.mode);
    }
    CHECK_EQ(pump.output.status.mode, MODE_TRACKING);
}

static void the_build_has_a_name(void) {
    CHECK(build_id[0] != '\0');
}

int main(void) {
    TEST(devices_that_are_missing);
    TEST(a_rig_without_can);
    TEST(the_clock_and_the_frames_go_in);
    TEST(a_receiver_that_fails_is_counted);
    TEST(frames_go_out);
    TEST(a_full_queue_drops_the_rest_of_the_tick);
    TEST(a_bus_that_is_off_is_restarted);
    TEST(pulses_are_written_when_they_change);
    TEST(pulses_that_fail_are_written_again);
    TEST(updates_wait_in_order);
    TEST(held_updates_go_together);
    TEST(commands_are_given_once);
    TEST(the_recorded_input_replays);
    TEST(the_build_has_a_name);
    return check_finish();
}
