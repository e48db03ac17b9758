/// firmware/drive/drive: units, settings and pulse-width drives. RMD drives: test_drive_rmd.c.
#include "check.h"

#include "drive/drive.h"
#include "drive/rmd.h"

#define TURN AXIS_TURN_Q48

static uint64_t seed = UINT64_C(0xD217E);
static struct drive drive;
static struct drive_config config;
static struct drive_output output;

static void init(uint64_t now_us) {
    for (size_t i = 0; i < sizeof drive; i++) {
        ((uint8_t *)&drive)[i] = 0x77;
    }
    drive_init(&drive, &config, now_us);
}

static void use_pwm(void) {
    config = (struct drive_config){.kind = DRIVE_PWM,
                                   .pwm = {.channel = 3,
                                           .low_q48 = -TURN / 4,
                                           .high_q48 = TURN / 4,
                                           .low_pulse_ns = 1000000,
                                           .high_pulse_ns = 2000000}};
    init(0);
}

static void tick(uint32_t count, bool powered, int64_t setpoint) {
    for (size_t i = 0; i < sizeof output; i++) {
        ((uint8_t *)&output)[i] = 0x99;
    }
    drive_tick(&drive, count, powered, setpoint, &output);
    CHECK(output.frame_count <= 2U);
    for (uint32_t i = 0; i < output.frame_count; i++) {
        CHECK(can_frame_is_valid(&output.frame[i]));
    }
}

// ---------------------------------------------------------------- units

static void hundredths_there_and_back(void) {
    for (int64_t cdeg = -72000; cdeg <= 72000 && check_clean(); cdeg++) {
        const int64_t q48 = drive_q48_from_cdeg(cdeg);
        CHECK_EQ(drive_cdeg_from_q48(q48), cdeg);
        // To nearest: twice the difference from cdeg * 2^48 / 36000 is at most one unit.
        const int64_t off = (q48 - cdeg * (TURN / 36000)) * 36000 - cdeg * (TURN % 36000);
        CHECK_NEAR(off, 0, 18000);
    }
    for (int i = 0; i < 20000 && check_clean(); i++) {
        const int64_t cdeg = (int64_t)(check_random(&seed) % 2160000001U) - 1080000000;
        CHECK_EQ(drive_cdeg_from_q48(drive_q48_from_cdeg(cdeg)), cdeg);
        const int64_t turns = cdeg / 36000;
        CHECK_EQ(drive_q48_from_cdeg(cdeg), turns * TURN + drive_q48_from_cdeg(cdeg % 36000));
    }
    CHECK_EQ(drive_q48_from_cdeg(36000), TURN);
    CHECK_EQ(drive_q48_from_cdeg(-9000), -TURN / 4);
}

static void positions_to_hundredths(void) {
    check_note("seed", (int64_t)seed);
    for (int i = 0; i < 20000 && check_clean(); i++) {
        const int64_t q48 = (int64_t)(check_random(&seed) >> 17) - TURN / 4; // below 2^47
        const int64_t cdeg = drive_cdeg_from_q48(q48);
        CHECK_NEAR(cdeg * (TURN / 1125) / 32, q48, TURN / 72000 + 36000);
        const int64_t nearest = drive_q48_from_cdeg(cdeg), up = drive_q48_from_cdeg(cdeg + 1),
                      down = drive_q48_from_cdeg(cdeg - 1);
        const int64_t apart = nearest > q48 ? nearest - q48 : q48 - nearest;
        CHECK(apart <= up - q48 + 1 && apart <= q48 - down + 1);
    }
    CHECK_EQ(drive_cdeg_from_q48(64 * TURN), 64 * 36000);
    CHECK_EQ(drive_cdeg_from_q48(-64 * TURN), -64 * 36000);
    CHECK_EQ(drive_cdeg_from_q48(32767 * TURN), INT64_C(32767) * 36000);
    CHECK_EQ(drive_cdeg_from_q48(INT64_MIN), INT64_C(-32768) * 36000);
    CHECK_EQ(drive_cdeg_from_q48(TURN / 64 - 1), 562); // half-way: 562.5
    CHECK_EQ(drive_cdeg_from_q48(TURN / 64), 563);
    CHECK_EQ(drive_cdeg_from_q48(TURN - 1), 36000);
    CHECK_EQ(drive_cdeg_from_q48(-1), 0);
}

// ---------------------------------------------------------------- settings

static void settings_of_rmd_drives(void) {
    config = (struct drive_config){.kind = DRIVE_RMD,
                                   .rmd = {.id = 1, .reply_offset = RMD_REPLY_OFFSET_V3}};
    CHECK(drive_config_valid(&config));
    config.rmd.id = 32;
    CHECK(drive_config_valid(&config));
    config.rmd.id = 0;
    CHECK(!drive_config_valid(&config));
    config.rmd.id = 33;
    CHECK(!drive_config_valid(&config));
    config.rmd.id = 1;
    config.rmd.reply_offset = 0x80;
    CHECK(!drive_config_valid(&config));
    config.rmd.reply_offset = RMD_REPLY_OFFSET_LK;
    CHECK(drive_config_valid(&config));
    config.rmd.zero_q48 = 2000 * TURN;
    CHECK(drive_config_valid(&config));
    config.rmd.zero_q48 = -2000 * TURN - 1;
    CHECK(!drive_config_valid(&config));
    config.rmd.zero_q48 = INT64_MIN;
    CHECK(!drive_config_valid(&config));
    config.kind = DRIVE_NONE;
    CHECK(!drive_config_valid(&config));
    config.kind = (enum drive_kind)9;
    CHECK(!drive_config_valid(&config));
}

static bool pwm_valid(int64_t low, int64_t high, uint32_t low_ns, uint32_t high_ns) {
    const struct drive_config c = {
        .kind = DRIVE_PWM,
        .pwm = {
            .low_q48 = low, .high_q48 = high, .low_pulse_ns = low_ns, .high_pulse_ns = high_ns}};
    return drive_config_valid(&c);
}

static void settings_of_pulses(void) {
    CHECK(pwm_valid(0, 1 << 24, 1000, 2000));
    CHECK(!pwm_valid(0, (1 << 24) - 1, 1000, 2000));
    CHECK(!pwm_valid(TURN, 0, 1000, 2000));
    CHECK(pwm_valid(0, TURN, 2000000, 1000000));
    CHECK(!pwm_valid(0, TURN, 1000000, 1000000));
    CHECK(!pwm_valid(0, TURN, 0, 1000000));
    CHECK(!pwm_valid(0, TURN, 1000000, 0));
    CHECK(pwm_valid(0, TURN, 1, 20000000));
    CHECK(!pwm_valid(0, TURN, 1, 20000001));
    CHECK(!pwm_valid(0, TURN, UINT32_MAX, 1));
    CHECK(pwm_valid(-64 * TURN, 64 * TURN, 1000, 2000));
    CHECK(!pwm_valid(-64 * TURN - 1, 64 * TURN, 1000, 2000));
    CHECK(!pwm_valid(INT64_MIN, INT64_MAX, 1000, 2000)); // the difference overflows
    CHECK(!pwm_valid(INT64_MAX, INT64_MIN, 1000, 2000));
    CHECK(!pwm_valid(-64 * TURN, INT64_MAX, 1000, 2000));
}

// ---------------------------------------------------------------- pulses

static uint32_t pulse(int64_t setpoint) {
    tick((uint32_t)check_random(&seed), true, setpoint);
    CHECK(output.pulse_set);
    CHECK_EQ(output.frame_count, 0);
    CHECK_EQ(drive.position_q48, setpoint);
    return output.pulse_ns;
}

static void pulses_are_linear_and_bounded(void) {
    use_pwm();
    CHECK(drive.ready && !drive.position_known);
    CHECK_EQ(pulse(-TURN / 4), 1000000);
    CHECK_EQ(pulse(0), 1500000);
    CHECK_EQ(pulse(TURN / 4), 2000000);
    CHECK_EQ(pulse(TURN / 8), 1750000);
    CHECK_EQ(pulse(-TURN / 4 - 1), 1000000);
    CHECK_EQ(pulse(TURN / 4 + 1), 2000000);
    CHECK_EQ(pulse(64 * TURN), 2000000);
    CHECK_EQ(pulse(-64 * TURN), 1000000);
    uint32_t last = 0;
    for (int64_t i = -600; i <= 600 && check_clean(); i++) {
        const uint32_t ns = pulse(i * (TURN / 2400));
        CHECK(ns >= last);
        CHECK_NEAR(ns * INT64_C(1200), 1500000 * INT64_C(1200) + i * 1000000, 601);
        last = ns;
    }
    tick(0, false, 0);
    CHECK(output.pulse_set);
    CHECK_EQ(output.pulse_ns, 0);
    drive_forget(&drive);
    CHECK(drive.ready);
}

static void pulses_of_a_reversed_servo(void) {
    use_pwm();
    config.pwm.low_pulse_ns = 2500000;
    config.pwm.high_pulse_ns = 500000;
    CHECK_EQ(pulse(-TURN / 4), 2500000);
    CHECK_EQ(pulse(TURN / 4), 500000);
    CHECK_EQ(pulse(TURN), 500000);
    CHECK_NEAR(pulse(TURN / 12), 1500000 - 333333, 1);
}

/// The widest and the narrowest range that are allowed.
static void pulses_at_the_ends_of_the_range(void) {
    use_pwm();
    config.pwm = (struct drive_pwm_config){0, -64 * TURN, 64 * TURN, 1, 20000000};
    CHECK_EQ(pulse(-64 * TURN), 1);
    CHECK_EQ(pulse(64 * TURN), 20000000);
    CHECK_NEAR(pulse(0), 10000000, 1);
    config.pwm = (struct drive_pwm_config){0, 5, 5 + (1 << 24), 20000000, 1};
    CHECK_EQ(pulse(4), 20000000);
    CHECK_EQ(pulse(5), 20000000);
    CHECK_EQ(pulse(5 + (1 << 24)), 1);
    CHECK_NEAR(pulse(5 + (1 << 23)), 10000000, 1);
}

/// Nobody knows what such a drive does.
static void servos_say_nothing(void) {
    use_pwm();
    for (uint32_t id = 0; id <= CAN_FRAME_STANDARD_ID_MAX; id++) {
        const struct can_frame frame = {.id = id, .length = 8, .data = {0x92}};
        CHECK(!drive_receive(&drive, &frame, 9, 0));
    }
    CHECK_EQ(drive_check(&drive, UINT64_MAX, 0), DRIVE_HEALTHY);
    CHECK(!drive_has_feedback(&drive));
    CHECK(drive_position_is_fresh(&drive, UINT64_MAX, 0));
}

static void no_drive(void) {
    config = (struct drive_config){.kind = DRIVE_NONE};
    init(0);
    CHECK(!drive.ready);
    tick(0, true, TURN);
    CHECK_EQ(output.frame_count, 0);
    CHECK(!output.pulse_set);
    CHECK_EQ(drive_check(&drive, UINT64_MAX, 0), DRIVE_HEALTHY);
    CHECK(!drive_has_feedback(&drive));
}

int main(void) {
    TEST(hundredths_there_and_back);
    TEST(positions_to_hundredths);
    TEST(settings_of_rmd_drives);
    TEST(settings_of_pulses);
    TEST(pulses_are_linear_and_bounded);
    TEST(pulses_of_a_reversed_servo);
    TEST(pulses_at_the_ends_of_the_range);
    TEST(servos_say_nothing);
    TEST(no_drive);
    return check_finish();
}
