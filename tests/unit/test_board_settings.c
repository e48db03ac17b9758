/// app/board_settings and app/settings_digest: what may be changed, when, and by how much.
#include "desk.h"

#include "app/settings_digest.h"

static char buffer[128];

static struct word word_of(const char *text) {
    struct word word = {text, 0};
    while (text[word.size_bytes] != '\0') {
        word.size_bytes++;
    }
    return word;
}

static const char *set(const char *name, int64_t micro) {
    return board_settings_set(&desk_loop.settings, word_of(name), micro, &desk_loop.controller);
}

static bool get_is(const char *name, const char *wanted) {
    struct text text;
    text_begin(&text, buffer, sizeof buffer);
    if (board_settings_get(&desk_loop.settings, word_of(name), &text) != NULL) {
        return false;
    }
    const struct word value = word_of(wanted);
    const uint32_t at = text.size_bytes - value.size_bytes;
    return text.size_bytes > value.size_bytes && buffer[at - 1U] == ' ' &&
           word_is((struct word){&buffer[at], value.size_bytes}, wanted);
}

static void switch_on(void) {
    desk_configure();
    desk_start(0);
    desk_ticks(5);
}

static void what_is_set_comes_back(void) {
    static const struct {
        const char *name;
        int64_t micro;
        const char *shown;
    } cases[] = {
        {"camera.margin_percent", 12500000, "12.5"},
        {"camera.margin_percent", 900000000, "900"},
        {"controller.target_expiry_ms", 1500, "0.001"}, // whole microseconds
        {"controller.target_expiry_ms", 0, "0"},
        {"controller.smoothing_percent", 90000000, "90"},
        {"controller.coast_ms", 250000000, "250"},
        {"controller.jump_deg", 1500000, "1.5"},
        {"pan.limit_min_deg", -90000000, "-90"},
        {"pan.limit_min_deg", -45500000, "-45.5"},
        {"pan.limit_max_deg", 33333330, "33.33333"},
        {"tilt.speed_max_dps", 12340000, "12.34"},
        {"tilt.speed_max_dps", 10000, "0.01"},
        {"tilt.accel_max_dps2", 100000, "0.1"},
        {"pan.accel_max_dps2", 999900000, "999.9"},
    };
    switch_on();
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK(set(cases[i].name, cases[i].micro) == NULL);
        if (!CHECK(get_is(cases[i].name, cases[i].shown))) {
            check_note("case", i);
        }
    }
    desk_ticks(5);
    CHECK_EQ(desk_mode(), MODE_READY);
}

static void the_numbers_inside(void) {
    switch_on();
    CHECK(set("tilt.speed_max_dps", 36000000) == NULL);
    CHECK(set("tilt.accel_max_dps2", 36000000) == NULL);
    const struct limiter_config *limits = &desk_loop.settings.now.axis[AXIS_TILT].limits;
    // A tenth of a turn a second, each millisecond: 2^48 / 10,000.
    CHECK_NEAR(limits->speed_max_q48, AXIS_TURN_Q48 / 10000, AXIS_TURN_Q48 / 10000000000);
    CHECK_NEAR(limits->accel_max_q48, AXIS_TURN_Q48 / 10000000, 1000);
    CHECK(set("controller.target_expiry_ms", 500000000) == NULL);
    CHECK_EQ(desk_loop.controller.targets.expiry_us, 500000);
}

/// As narrow as one likes, never wider; what the image was built for is in reach again.
static void only_stricter(void) {
    switch_on();
    CHECK(set("pan.limit_max_deg", 90000010) != NULL);
    CHECK(set("pan.limit_min_deg", -90000010) != NULL);
    CHECK(set("pan.speed_max_dps", 100010000) != NULL);
    CHECK(set("pan.accel_max_dps2", 1000200000) != NULL);
    CHECK(set("pan.limit_max_deg", -1000000) != NULL); // home is at 0
    CHECK(set("pan.limit_max_deg", 5000000) == NULL);
    CHECK(set("pan.limit_max_deg", 90000000) == NULL);
    CHECK_EQ(desk_loop.settings.now.axis[AXIS_PAN].limits.max_q48, 90 * DESK_DEGREE);
    CHECK(set("camera.margin_percent", 900000001) != NULL);
    CHECK(set("camera.margin_percent", -1) != NULL);
    CHECK(set("safety.silence_ms", 100000000) != NULL);
}

static void not_while_driven(void) {
    switch_on();
    pump_command(&desk_loop.pump, COMMAND_ARM);
    desk_ticks(5);
    CHECK(desk_driven());
    CHECK(set("pan.speed_max_dps", 1000000) != NULL);
    CHECK(get_is("pan.speed_max_dps", "100"));
    CHECK(set("camera.margin_percent", 5000000) == NULL);
    CHECK(desk_driven());
    pump_command(&desk_loop.pump, COMMAND_STOP);
    desk_ticks(500);
    CHECK(set("pan.speed_max_dps", 1000000) != NULL); // it holds: that is driven, too
}

static void a_change_does_not_arm(void) {
    desk_configure();
    desk_settings.arm_on_start = true;
    desk_config.refusal = "not today";
    desk_start(0);
    desk_ticks(5);
    CHECK(!desk_driven());
    desk_loop.status.refusal = NULL;
    CHECK(set("pan.speed_max_dps", 1000000) == NULL);
    desk_ticks(20);
    CHECK(!desk_driven());
}

static void a_lower_speed_holds(void) {
    switch_on();
    CHECK(set("pan.speed_max_dps", 10000000) == NULL);
    desk_ticks(5);
    desk_type("\rarm\raim 45 0\r");
    desk_ticks(100);
    int64_t before = desk_cdeg(AXIS_PAN), most = 0;
    for (int i = 0; i < 20; i++) {
        desk_ticks(100);
        most = desk_cdeg(AXIS_PAN) - before > most ? desk_cdeg(AXIS_PAN) - before : most;
        before = desk_cdeg(AXIS_PAN);
    }
    CHECK_NEAR(most, 100, 1); // hundredths of a degree in 100 ms
}

static void the_list(void) {
    struct text text;
    uint32_t lines = 0;
    switch_on();
    text_begin(&text, buffer, sizeof buffer);
    while (board_settings_list(&desk_loop.settings, lines, &text)) {
        CHECK(!text.cut && text.size_bytes <= 79U);
        text_begin(&text, buffer, sizeof buffer);
        lines++;
    }
    CHECK_EQ(lines, 13);
    desk_type("\rget\r");
    desk_ticks(60);
    CHECK(desk_says("\ncamera.margin_percent 0  (from 0 to 900)\r\n"));
    CHECK(desk_says("\npan.limit_min_deg -90  (from -90; not while driven)\r\n"));
    CHECK(desk_says("\ntilt.limit_max_deg 90  (to 90; not while driven)\r\n"));
    CHECK(desk_says("\ntilt.accel_max_dps2 1000  (from 0.1 to 1000; not while driven)\r\n\r> "));
}

// ---------------------------------------------------------------- digest

static struct controller_config other;

static bool counts(void) {
    const bool differs = settings_digest(&other) != settings_digest(&desk_settings);
    other = desk_settings;
    return differs;
}

static void every_value_counts(void) {
    desk_configure();
    desk_settings.lens.point_count = 2;
    desk_settings.axis[AXIS_TILT].drive =
        (struct drive_config){.kind = DRIVE_RMD, .rmd = {1, 0x100, false, 0, 100, 50}};
    other = desk_settings;
    CHECK(!counts());
    other.arm_on_start = true;
    CHECK(!counts());
    other.axis[AXIS_ZOOM].limits.max_q48 = 7; // of an axis that does not exist
    CHECK(!counts());
    other.frame = CONTROLLER_FRAME_RECT;
    CHECK(counts());
#define COUNTS(member)                                                                             \
    do {                                                                                           \
        other.member++;                                                                            \
        CHECK(counts());                                                                           \
    } while (0)
    COUNTS(tick_us);
    COUNTS(position_um.x);
    COUNTS(position_um.y);
    COUNTS(position_um.z);
    COUNTS(attitude.heading.bam);
    COUNTS(attitude.pitch.bam);
    COUNTS(attitude.roll.bam);
    COUNTS(axis[AXIS_PAN].limits.min_q48);
    COUNTS(axis[AXIS_PAN].limits.max_q48);
    COUNTS(axis[AXIS_PAN].limits.speed_max_q48);
    COUNTS(axis[AXIS_PAN].limits.accel_max_q48);
    COUNTS(axis[AXIS_PAN].limits.smooth_ticks);
    COUNTS(axis[AXIS_PAN].home_q48);
    COUNTS(axis[AXIS_PAN].latency_us);
    COUNTS(axis[AXIS_PAN].drive.pwm.channel);
    COUNTS(axis[AXIS_PAN].drive.pwm.low_q48);
    COUNTS(axis[AXIS_PAN].drive.pwm.high_q48);
    COUNTS(axis[AXIS_PAN].drive.pwm.low_pulse_ns);
    COUNTS(axis[AXIS_PAN].drive.pwm.high_pulse_ns);
    COUNTS(axis[AXIS_TILT].drive.rmd.id);
    COUNTS(axis[AXIS_TILT].drive.rmd.reply_offset);
    COUNTS(axis[AXIS_TILT].drive.rmd.zero_q48);
    COUNTS(axis[AXIS_TILT].drive.rmd.speed_max_dps);
    COUNTS(axis[AXIS_TILT].drive.rmd.watchdog_ms);
    other.axis[AXIS_TILT].drive.rmd.reversed = true;
    CHECK(counts());
    COUNTS(lens.point[1].focal_um);
    COUNTS(lens.point[1].position_q48);
    COUNTS(lens.point_count);
    COUNTS(lens.sensor_width_um);
    COUNTS(lens.sensor_height_um);
    COUNTS(lens.margin_q16);
    COUNTS(target_expiry_us);
    COUNTS(tracker.jump_q48);
    COUNTS(tracker.memory_q16);
    COUNTS(tracker.coast_ticks);
    COUNTS(silence_us);
    COUNTS(settle_us);
    COUNTS(follow_error_q48);
    COUNTS(follow_error_us);
}

int main(void) {
    TEST(what_is_set_comes_back);
    TEST(the_numbers_inside);
    TEST(only_stricter);
    TEST(not_while_driven);
    TEST(a_change_does_not_arm);
    TEST(a_lower_speed_holds);
    TEST(the_list);
    TEST(every_value_counts);
    return check_finish();
}
