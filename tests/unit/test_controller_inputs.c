/// firmware/control: settings that are not valid, inputs that are refused, and the same outputs for
/// the same inputs, whatever the memory held and wherever the clock stood.
#include "rig.h"

// ---------------------------------------------------------------- settings

/// The settings as they are now must be refused: never armed, nothing sent, nothing worked on.
static void check_refused(int line) {
    const bool clean = check_clean();
    rig_start(0, 0xEE);
    for (int i = 0; i < 40 && check_clean(); i++) {
        rig.input.commands = COMMAND_ARM;
        rig_target(1, 100 * i, 0);
        rig_update(
            (struct target_update){.kind = TARGET_POSITION, .id = 2, .position_um = {1, 2, 3}});
        rig_receive((struct can_frame){.id = 0x241, .length = 8, .data = {0x92}});
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_FAULTED);
        CHECK_EQ(rig.output.status.faults, FAULT_CONFIG);
        CHECK_EQ(rig.output.frame_count, 0);
        for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
            CHECK(!rig.output.pulse_set[axis]);
            CHECK_EQ(rig.output.pulse_ns[axis], 0);
        }
    }
    CHECK(!rig.was_armed);
    CHECK(!controller_init(&rig.controller, &rig.config));
    if (clean && !check_clean()) {
        check_note("settings of line", line);
    }
    rig_configure();
}

#define REFUSED(change)                                                                            \
    do {                                                                                           \
        rig.config.change;                                                                         \
        check_refused(__LINE__);                                                                   \
    } while (0)

static void settings_that_are_not_valid(void) {
    rig_configure();
    CHECK(controller_init(&rig.controller, &rig.config));
    REFUSED(tick_us = 99);
    REFUSED(tick_us = 20001);
    REFUSED(position_um.x = TARGET_POSITION_UM_MAX + 1);
    REFUSED(position_um.y = INT64_MIN);
    REFUSED(position_um.z = -TARGET_POSITION_UM_MAX - 1);
    REFUSED(tracker.memory_q16 = 65536);
    REFUSED(tracker.jump_q48 = -1);
    REFUSED(tracker.jump_q48 = INT64_MIN);
    REFUSED(tracker.jump_q48 = TRACKER_JUMP_Q48_MAX + 1);
    REFUSED(follow_error_q48 = -1);
    REFUSED(lens.point_count = 0);
    REFUSED(lens.point_count = UINT32_MAX);
    REFUSED(lens.sensor_width_um = 0);
    REFUSED(axis[AXIS_PAN].drive.kind = DRIVE_NONE);
    REFUSED(axis[AXIS_TILT].drive.kind = DRIVE_NONE);
    REFUSED(axis[AXIS_TILT].drive.kind = (enum drive_kind)77);
    REFUSED(axis[AXIS_PAN].drive.rmd.id = 0);
    REFUSED(axis[AXIS_PAN].drive.rmd.id = 33);
    REFUSED(axis[AXIS_ZOOM].drive.pwm.low_pulse_ns = 0);
}

/// The most that is valid, and one unit more.
static void settings_at_a_bound(void) {
    rig_configure();
    static const struct vec3_i64 corner = {TARGET_POSITION_UM_MAX, TARGET_POSITION_UM_MAX,
                                           TARGET_POSITION_UM_MAX};
    for (int sign = -1; sign <= 1; sign += 2) {
        const struct vec3_i64 at = {sign * corner.x, sign * corner.y, sign * corner.z};
        rig.config.position_um = at;
        CHECK(controller_init(&rig.controller, &rig.config));
        REFUSED(position_um = ((struct vec3_i64){at.x + sign, at.y, at.z}));
        REFUSED(position_um = ((struct vec3_i64){at.x, at.y + sign, at.z}));
        REFUSED(position_um = ((struct vec3_i64){at.x, at.y, at.z + sign}));
    }
    const uint32_t most_um = UINT32_C(1) << 20, aspect = RECTANGLE_ASPECT_MAX;
    const struct {
        uint32_t width_um, height_um;
        bool valid;
    } pictures[] = {
        {most_um, most_um, true},
        {most_um + 1U, most_um, false},
        {most_um, most_um + 1U, false},
        {1000U * aspect, 1000, true},
        {1000, 1000U * aspect, true},
        {1000U * aspect + 1U, 1000, false},
        {0, 1000, false},
        {1000, 1000U * aspect + 1U, false},
        {1000, 0, false},
    };
    for (unsigned i = 0; i < sizeof pictures / sizeof *pictures; i++) {
        rig.config.frame = CONTROLLER_FRAME_RECT;
        rig.config.axis[AXIS_ZOOM].drive.kind = DRIVE_NONE; // whose lens has bounds of its own
        rig.config.lens.sensor_width_um = pictures[i].width_um;
        rig.config.lens.sensor_height_um = pictures[i].height_um;
        CHECK_EQ(controller_init(&rig.controller, &rig.config), pictures[i].valid);
    }
    rig_configure();
}

static void limits_that_are_not_valid(void) {
    rig_configure();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        REFUSED(axis[axis].limits.min_q48 = rig.config.axis[axis].limits.max_q48 + 1);
        REFUSED(axis[axis].limits.min_q48 = INT64_MIN);
        REFUSED(axis[axis].limits.min_q48 = -16 * TURN - 1);
        REFUSED(axis[axis].limits.max_q48 = 16 * TURN + 1);
        REFUSED(axis[axis].limits.max_q48 = INT64_MAX);
        REFUSED(axis[axis].limits.speed_max_q48 = 0);
        REFUSED(axis[axis].limits.speed_max_q48 = INT64_MIN);
        REFUSED(axis[axis].limits.speed_max_q48 = TURN + 1);
        REFUSED(axis[axis].limits.accel_max_q48 = 0);
        REFUSED(axis[axis].limits.accel_max_q48 = TURN + 1);
        REFUSED(axis[axis].limits.smooth_ticks = 0);
        REFUSED(axis[axis].limits.smooth_ticks = LIMITER_SMOOTH_TICKS_MAX + 1U);
        REFUSED(axis[axis].limits.smooth_ticks = UINT32_MAX);
        REFUSED(axis[axis].home_q48 = rig.config.axis[axis].limits.max_q48 + 1);
        REFUSED(axis[axis].home_q48 = INT64_MIN);
        REFUSED(axis[axis].latency_us = CONTROLLER_LATENCY_US_MAX + 1U);
    }
}

/// Two axes that would turn the same actuator.
static void drives_that_collide(void) {
    rig_configure();
    REFUSED(axis[AXIS_TILT].drive.rmd.id = RIG_PAN_ID);
    rig.config.axis[AXIS_PAN].drive.rmd.reply_offset = 0;
    REFUSED(axis[AXIS_TILT].drive.rmd.id = RIG_PAN_ID);
    rig.config.axis[AXIS_TILT].drive = rig.config.axis[AXIS_ZOOM].drive;
    check_refused(__LINE__);
    rig.config.axis[AXIS_PAN].drive = rig.config.axis[AXIS_ZOOM].drive;
    check_refused(__LINE__);
    rig.config.axis[AXIS_ZOOM].drive = rig.config.axis[AXIS_PAN].drive;
    check_refused(__LINE__);
}

static void settings_at_the_ends_of_their_ranges(void) {
    rig_configure();
    struct controller_config *config = &rig.config;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        config->axis[axis].limits =
            (struct limiter_config){-16 * TURN, 16 * TURN, TURN, TURN, LIMITER_SMOOTH_TICKS_MAX};
        config->axis[axis].home_q48 = -16 * TURN;
        config->axis[axis].latency_us = CONTROLLER_LATENCY_US_MAX;
    }
    config->position_um = (struct vec3_i64){TARGET_POSITION_UM_MAX, -TARGET_POSITION_UM_MAX, 0};
    config->tracker = (struct tracker_config){TRACKER_JUMP_Q48_MAX, 65535, UINT32_MAX};
    config->tick_us = 20000;
    config->follow_error_q48 = INT64_MAX;
    config->follow_error_us = config->settle_us = UINT32_MAX;
    CHECK(controller_init(&rig.controller, config));
    config->settle_us = 0;
    rig_start(0, 0);
    rig_arm();
    for (int i = 0; i < 1000 && check_clean(); i++) {
        rig_target(1, i * 1234, i * 77);
        rig_tick();
        CHECK_EQ(rig_mode(), MODE_TRACKING);
    }
    rig_configure(); // a range of one point, no speed to speak of
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        config->axis[axis].limits = (struct limiter_config){0, 0, 1, 1, 1};
    }
    rig_start(0, 0);
    rig_arm();
    rig_target(1, 9000, 4500);
    rig_ticks(100);
    CHECK_EQ(rig.output.status.axis[AXIS_PAN].setpoint_q48, 0);
}

// ---------------------------------------------------------------- the same again

/// Start-up, slews, a moving target, silence, a stop, a fault and what follows; with `nonsense`,
/// between all kinds of input that must be refused. Returns the hash of all outputs.
static uint64_t run_story(uint32_t now_us, uint8_t garbage, bool nonsense) {
    uint64_t seed = UINT64_C(0x5709);
    rig_configure();
    rig.config.target_expiry_us = 900000;
    rig_start(now_us, garbage);
    rig.input.commands = COMMAND_ARM;
    for (int i = 0; i < 6000 && check_clean(); i++) {
        if (nonsense) {
            const uint64_t dice = check_random(&seed);
            struct can_frame frame = {.id = (uint32_t)(dice % 0x240U), .length = 8}; // foreign
            if (dice >> 60 == 0U) {
                frame = (struct can_frame){.id = 0x241, .length = (uint8_t)(dice >> 50 & 7U)};
            }
            rig_receive(frame);
            rig_receive((struct can_frame){.id = 0x242, .length = 8, .data = {0x92, [7] = 0x70}});
            rig_update((struct target_update){.kind = TARGET_DIRECTION, .id = 1});
            rig_update((struct target_update){.kind = (enum target_kind)99, .id = 2});
            rig_update((struct target_update){
                .kind = TARGET_POSITION, .id = 1, .position_um = {INT64_MIN, 0, 0}});
        }
        if (i % 40 == 0 && (i < 3000 || i > 4200)) {
            rig_target(1, i < 1500 ? 6000 : i * 2, i / 4);
            rig_target(2, i < 1500 ? 7500 : i * 2 + 900, i / 3);
        }
        rig.drive[1].silent = i > 2000 && i < 2100;
        if (i == 2500 || i == 5500) {
            rig.input.commands = COMMAND_ARM;
        }
        if (i == 5000) {
            rig.input.commands = COMMAND_STOP;
        }
        rig_tick();
    }
    CHECK_EQ(rig_mode(), MODE_TRACKING);
    return rig.hash;
}

static void the_memory_before_does_not_matter(void) {
    const uint64_t hash = run_story(0, 0x00, false);
    const uint8_t garbage[] = {0xFF, 0xA5, 0x7F, 0x01};
    for (unsigned i = 0; i < sizeof garbage; i++) {
        CHECK_EQ(run_story(0, garbage[i], false), hash);
    }
}

static void the_clock_may_start_anywhere(void) {
    const uint64_t hash = run_story(0, 0, false);
    CHECK_EQ(run_story(UINT32_C(0xFFFF0000), 0, false), hash); // wraps at once
    CHECK_EQ(run_story(0U - 3000000U, 0, false), hash);        // in the middle
    CHECK_EQ(run_story(UINT32_C(0x7FFFF000), 0, false), hash);
}

static void refused_inputs_change_no_output(void) {
    const uint64_t hash = run_story(0, 0, false);
    const uint32_t ignored = rig.output.status.frames_ignored,
                   rejected = rig.output.status.updates_rejected;
    CHECK_EQ(ignored, 0);
    CHECK_EQ(rejected, 0);
    CHECK_EQ(run_story(0, 0, true), hash);
    CHECK_EQ(rig.output.status.updates_rejected, 3 * 6000);
    CHECK(rig.output.status.frames_ignored > 5000U);
    CHECK(rig.controller.drive[1].bad_replies >= 6000U);
    CHECK(rig.controller.drive[0].bad_replies > 200U);
}

static void a_controller_can_be_copied(void) {
    const uint64_t whole = run_story(0, 0, false);
    CHECK(whole != 0U);
    static struct rig copy; // the drives and the input, too; pointers lead to rig.config only
    copy = rig;
    for (int run = 0; run < 2; run++) {
        rig_command(COMMAND_STOP);
        rig_ticks(400);
        rig_command(COMMAND_ARM);
        rig_target(1, 100, 100);
        rig_ticks(400);
        if (run == 0) {
            const uint64_t hash = rig.hash;
            rig = copy;
            copy.hash = hash;
        }
    }
    CHECK_EQ(rig.hash, copy.hash);
}

// ---------------------------------------------------------------- too much

static void inputs_beyond_the_maxima_are_cut_off(void) {
    rig_init();
    rig_arm();
    for (uint32_t i = 0; i < CONTROLLER_UPDATES_MAX; i++) {
        rig_target(i, 100, 0);
    }
    for (uint32_t i = 0; i < CONTROLLER_FRAMES_IN_MAX; i++) {
        rig_receive((struct can_frame){.id = 0x700});
    }
    rig.input.update_count = UINT32_MAX;
    rig.input.frame_count = UINT32_MAX;
    rig_tick();
    CHECK_EQ(rig.output.status.target_count, CONTROLLER_UPDATES_MAX);
    CHECK(rig.output.status.frames_ignored <= CONTROLLER_FRAMES_IN_MAX);
    rig.input.commands = UINT32_MAX & ~(uint32_t)COMMAND_STOP; // bits without a meaning
    rig_ticks(10);
    CHECK_EQ(rig_mode(), MODE_TRACKING);
}

static void the_set_is_full(void) {
    rig_init();
    for (uint32_t i = 0; i < 300U; i++) {
        rig_target(i, (int)i, 0);
        if (i % 15U == 14U) {
            rig_tick();
        }
    }
    CHECK_EQ(rig.output.status.target_count, TARGET_CAPACITY);
    CHECK_EQ(rig.output.status.updates_rejected, 300U - TARGET_CAPACITY);
    rig_update((struct target_update){.kind = TARGET_CLEAR});
    rig_target(1000, 0, 0);
    rig_tick();
    CHECK_EQ(rig.output.status.target_count, 1);
}

/// A tick full of updates may hold half of a frame: the aim waits for the rest, but not for ever.
static void the_aim_waits_for_a_frame(void) {
    rig_init();
    rig_arm();
    rig_target(0, 0, 0);
    rig_tick();
    const uint32_t solved = rig.output.status.aims_solved;
    for (uint32_t i = 0; i < 2U * CONTROLLER_UPDATES_MAX; i++) {
        rig_target(i, (int)i, 0);
        if (i % CONTROLLER_UPDATES_MAX == CONTROLLER_UPDATES_MAX - 1U) {
            rig_tick();
            CHECK_EQ(rig.output.status.aims_solved, solved);
            CHECK_EQ(rig.output.status.framing.framed_count, 1);
        }
    }
    rig_tick();
    CHECK_EQ(rig.output.status.aims_solved, solved + 1U);
    CHECK_EQ(rig.output.status.framing.framed_count, 2U * CONTROLLER_UPDATES_MAX);
    for (uint32_t tick = 0; tick < 2U * (CONTROLLER_WAIT_TICKS_MAX + 1U); tick++) {
        for (uint32_t i = 0; i < CONTROLLER_UPDATES_MAX; i++) {
            rig_target(i, (int)(i + tick), 0);
        }
        rig_tick();
    }
    CHECK_EQ(rig.output.status.aims_solved, solved + 3U);
}

/// 20 targets go round at 30 degrees a second, and each is reported 50 times a second, one in a
/// tick: the picture goes with them. Where they are in it is off by what a report is old. Its
/// search never ends: pan and tilt wait for that and then follow it as it is, again and again.
/// (Every goal is a jump, so none coasts.)
static void the_picture_goes_with_targets_in_turn(void) {
    rig_configure();
    rig.config.frame = CONTROLLER_FRAME_RECT;
    rig.config.tracker.jump_q48 = 0;
    rig_start(0, 0x55);
    rig_target(0, 0, 0);
    rig_arm();
    int64_t goal = 0;
    uint32_t since = 0;
    for (int tick = 0; tick < 3000 && check_clean(); tick++) {
        const int id = tick % 20;
        rig_target((uint32_t)id, 3 * tick + id % 5 * 250, id / 5 * 100);
        rig_tick();
        const struct framing *framing = &rig.output.status.framing;
        if (tick > 300) {
            CHECK_NEAR(framing->pan_bam32.bam, BAM_OF(3 * tick + 500).bam, BAM_OF(100).bam);
            CHECK_NEAR(framing->half_width_bam32.bam, BAM_OF(550).bam, BAM_OF(100).bam);
            CHECK(framing->refining);
        }
        const int64_t pan = rig.output.status.axis[AXIS_PAN].goal_q48;
        if (tick > 300) {
            CHECK_EQ(pan != goal, since == CONTROLLER_REFINING_TICKS_MAX);
        }
        since = pan == goal ? since + 1U : 0U;
        goal = pan;
    }
}

/// It moves, goes away and is back at once: the goal is where it is, and how it moved is forgotten.
static void a_target_that_was_away_is_a_new_one(void) {
    rig_init();
    rig_arm();
    for (int i = 0; i <= 10; i++) { // 30 degrees a second
        rig_target(1, i * 60, 0);
        rig_ticks(20);
    }
    rig_gone(1);
    rig_tick();
    rig_target(1, 650, 50);
    rig_tick();
    for (int i = 0; i < 60 && check_clean(); i++) {
        CHECK_NEAR(rig.output.status.axis[AXIS_PAN].goal_q48, 650 * CENTIDEGREE, DEGREE / 100000);
        CHECK_NEAR(rig.output.status.axis[AXIS_TILT].goal_q48, 50 * CENTIDEGREE, DEGREE / 100000);
        rig_tick();
    }
}

/// Random bytes in every field of the input, also from the drives' own ids.
static void random_inputs(void) {
    uint64_t seed = UINT64_C(0xF022);
    check_note("seed", (int64_t)seed);
    rig_init();
    for (int i = 0; i < 20000 && check_clean(); i++) {
        for (unsigned k = 0; k < 3U; k++) {
            const uint64_t dice = check_random(&seed), bytes = check_random(&seed);
            struct can_frame frame = {.id = 0x240U + (uint32_t)(dice % 4U),
                                      .length = dice >> 8 & 1U ? 8 : (uint8_t)(dice >> 16),
                                      .flags = dice >> 24 & 15U ? 0 : (uint8_t)(dice >> 32)};
            const uint8_t commands[] = {0x92, 0x9A, 0xA4, 0x42, 0xB3, 0x9C, 0x81, (uint8_t)bytes};
            frame.data[0] = commands[dice >> 40 & 7U];
            for (unsigned b = 1; b < 8U; b++) {
                frame.data[b] = (uint8_t)(bytes >> (8U * b));
            }
            rig_receive(frame);
        }
        for (unsigned k = 0; k < 3U; k++) {
            const uint64_t a = check_random(&seed);
            const uint64_t b = check_random(&seed);
            const uint64_t c = check_random(&seed);
            const unsigned shift = (unsigned)(a >> 58);
            struct target_update update = {.kind = (enum target_kind)(a % 6U),
                                           .id = (uint32_t)(a >> 8 & 7U),
                                           .weight_q16 = (uint32_t)b & 3U};
            if (update.kind == TARGET_POSITION) {
                update.position_um = (struct vec3_i64){(int64_t)(b >> shift), (int64_t)(c >> shift),
                                                       -(int64_t)((b ^ c) >> (shift | 1U))};
                update.radius_um = (uint32_t)(a >> 20);
            } else {
                update.direction = vec3((int32_t)b, (int32_t)c, (int32_t)(b >> 32));
                update.radius_bam32 = (uint32_t)(c >> 33);
            }
            rig_update(update);
        }
        rig.input.commands = (uint32_t)(check_random(&seed) % 64U == 0U);
        rig_tick();
    }
    check_note("updates rejected", rig.output.status.updates_rejected);
    check_note("aims solved", rig.output.status.aims_solved);
}

static bool same_text(const char *a, const char *b) {
    size_t i = 0;
    while (a[i] == b[i] && a[i] != '\0') {
        i++;
    }
    return a[i] == b[i];
}

static void modes_and_faults_have_names(void) {
    CHECK(same_text(controller_mode_name(MODE_STARTING), "starting"));
    CHECK(same_text(controller_mode_name(MODE_TRACKING), "tracking"));
    CHECK(same_text(controller_mode_name(MODE_FAULTED), "faulted"));
    CHECK(same_text(controller_fault_name(0), "none"));
    CHECK(same_text(controller_fault_name(FAULT_CONFIG), "the settings are not valid"));
    CHECK(same_text(controller_fault_name(FAULT_DRIVE_SILENT | FAULT_OVERRUN),
                    "a drive does not answer"));
    CHECK(same_text(controller_fault_name(FAULT_OVERRUN), "ticks came late"));
    CHECK(same_text(controller_fault_name(UINT32_C(1) << 31), "none"));
}

/// What a drive says is of the moment when it said it, not of the tick that finds it in a queue.
static void a_measurement_has_the_time_of_its_arrival(void) {
    const struct {
        uint32_t age_us, counts_us;
    } cases[] = {{0, 0}, {400, 400}, {7000, 7000}, {UINT32_C(0x80000001), 0}};
    for (unsigned i = 0; i < sizeof cases / sizeof *cases; i++) {
        rig_configure();
        rig_start(0xFFFFFE00, 0); // the clock wraps on the way
        CHECK(rig_until(MODE_READY, 60));
        rig_ticks(10);
        rig.input.frame_count = 0;
        rig_receive((struct can_frame){.id = 0x240 + RIG_PAN_ID, .length = 8, .data = {0x92}});
        rig.input.frame_us[0] = rig.input.now_us - cases[i].age_us;
        rig_tick();
        const struct controller_status *const status = &rig.output.status;
        CHECK_EQ(status->time_us - status->axis[AXIS_PAN].measured_us, cases[i].counts_us);
    }
}

int main(void) {
    TEST(settings_that_are_not_valid);
    TEST(settings_at_a_bound);
    TEST(limits_that_are_not_valid);
    TEST(drives_that_collide);
    TEST(settings_at_the_ends_of_their_ranges);
    TEST(the_memory_before_does_not_matter);
    TEST(the_clock_may_start_anywhere);
    TEST(refused_inputs_change_no_output);
    TEST(a_controller_can_be_copied);
    TEST(inputs_beyond_the_maxima_are_cut_off);
    TEST(the_set_is_full);
    TEST(the_aim_waits_for_a_frame);
    TEST(the_picture_goes_with_targets_in_turn);
    TEST(a_target_that_was_away_is_a_new_one);
    TEST(random_inputs);
    TEST(modes_and_faults_have_names);
    TEST(a_measurement_has_the_time_of_its_arrival);
    return check_finish();
}
