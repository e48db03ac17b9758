/// firmware/drive/drive with RMD drives: what is asked and sent at which tick, what replies do, and
/// what happens without them. Frames are made and read here byte by byte.
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

static void use_rmd(uint8_t id) {
    config = (struct drive_config){
        .kind = DRIVE_RMD,
        .rmd = {
            .id = id, .reply_offset = RMD_REPLY_OFFSET_V3, .speed_max_dps = 90, .watchdog_ms = 50}};
    init(0);
}

static void use_lk(uint8_t id) {
    use_rmd(id);
    config.rmd.reply_offset = RMD_REPLY_OFFSET_LK;
    init(0);
}

static void tick(uint32_t count, bool powered, int64_t setpoint) {
    for (size_t i = 0; i < sizeof output; i++) {
        ((uint8_t *)&output)[i] = 0x99;
    }
    drive_tick(&drive, count, powered, setpoint, &output);
    CHECK(!output.pulse_set);
    CHECK(output.frame_count <= 2U);
    for (uint32_t i = 0; i < output.frame_count; i++) {
        CHECK(can_frame_is_valid(&output.frame[i]));
    }
}

/// The command of the one frame that a tick sends; -1 for none.
static int command_at(uint32_t count, bool powered, int64_t setpoint) {
    tick(count, powered, setpoint);
    if (output.frame_count == 0U) {
        return -1;
    }
    CHECK_EQ(output.frame_count, 1);
    CHECK_EQ(output.frame[0].id, 0x140U + config.rmd.id);
    CHECK_EQ(output.frame[0].flags, 0);
    CHECK_EQ(output.frame[0].length, 8);
    return output.frame[0].data[0];
}

static int32_t value_of(const struct can_frame *frame) {
    const uint32_t value = frame->data[4] | (uint32_t)frame->data[5] << 8 |
                           (uint32_t)frame->data[6] << 16 | (uint32_t)frame->data[7] << 24;
    return (int32_t)value;
}

/// A reply of the MyActuator dialect: command, byte 1, and a value in bytes 4 to 7.
static struct can_frame reply(uint8_t command, uint8_t index, int32_t value) {
    const uint32_t v = (uint32_t)value;
    return (struct can_frame){.id = 0x240U + config.rmd.id,
                              .length = 8,
                              .data = {command, index, 0, 0, (uint8_t)v, (uint8_t)(v >> 8),
                                       (uint8_t)(v >> 16), (uint8_t)(v >> 24)}};
}

/// 0x92 of the LKTech dialect: 56 bits.
static struct can_frame lk_angle(int64_t cdeg) {
    struct can_frame frame = {.id = 0x140U + config.rmd.id, .length = 8, .data = {0x92}};
    for (unsigned i = 0; i < 7U; i++) {
        frame.data[1U + i] = (uint8_t)((uint64_t)cdeg >> (8U * i));
    }
    return frame;
}

static bool receive(struct can_frame frame, uint64_t now_us) {
    return drive_receive(&drive, &frame, now_us, 0);
}

/// The four answers of the start-up, in any order.
static struct can_frame answer(unsigned question) {
    switch (question) {
    case 0:
        return reply(0x92, 0, 12345);
    case 1:
        return reply(0x9A, 40, 0x000001E0); // 48.0 V, no error
    case 2:
        return reply(0xB3, 0, 50);
    default:
        return reply(0x42, 0, 0);
    }
}

static void make_ready(void) {
    for (unsigned q = 0; q < 4U; q++) {
        CHECK(receive(answer(q), 0));
    }
    CHECK(drive.ready);
}

// ---------------------------------------------------------------- start-up of an RMD drive

static void questions_come_in_turn_and_move_nothing(void) {
    use_rmd(7);
    CHECK(!drive.ready && !drive.position_known);
    const int wanted[4] = {0x92, 0x9A, 0xB3, 0x42};
    for (uint32_t t = 0; t < 64U; t++) {
        CHECK_EQ(command_at(t, false, TURN), t % 4U == 2U ? wanted[t / 4U % 4U] : -1);
    }
    tick(10, false, TURN);
    CHECK_EQ(output.frame[0].data[0], 0xB3);
    CHECK_EQ(value_of(&output.frame[0]), 50);
    tick(14, false, TURN);
    CHECK_EQ(output.frame[0].data[1], 0); // the acceleration of positions
}

static void ready_when_all_four_are_answered(void) {
    for (unsigned order = 0; order < 256U; order++) {
        use_rmd(3);
        unsigned answered = 0;
        for (unsigned i = 0; i < 4U; i++) {
            const unsigned question = order >> (2U * i) & 3U;
            CHECK(receive(answer(question), 5));
            answered |= 1U << question;
            CHECK_EQ(drive.ready, answered == 15U);
        }
    }
    use_rmd(3);
    make_ready();
    CHECK(drive.position_known);
    CHECK_EQ(drive.position_q48, drive_q48_from_cdeg(12345));
    CHECK_EQ(drive.temperature_c, 40);
    CHECK_EQ(drive.accel_plan_dps2, 0);
    CHECK_EQ(drive.bad_replies, 0);
}

/// It is written to flash: only until it is confirmed, and only its own value confirms it.
static void the_watchdog_is_written_until_confirmed(void) {
    use_rmd(3);
    CHECK_EQ(command_at(10, false, 0), 0xB3);
    CHECK(receive(reply(0xB3, 0, 51), 0));
    CHECK_EQ(command_at(26, false, 0), 0xB3);
    CHECK(receive(reply(0xB3, 0, 50), 0));
    CHECK_EQ(command_at(42, false, 0), -1);
    CHECK(receive(answer(0), 0) && receive(answer(1), 0));
    CHECK(!drive.ready);
    CHECK(receive(reply(0x42, 2, 500), 0)); // the answer to another's question
    CHECK(!drive.ready);
    CHECK(receive(reply(0x42, 0, 500), 0));
    CHECK(drive.ready);
    CHECK_EQ(drive.accel_plan_dps2, 500);
    for (uint32_t t = 0; t < 256U; t++) {
        CHECK(command_at(t, true, 0) != 0xB3);
    }
}

/// A drive that answers half of what it is asked is ready in the end.
static void lost_answers_are_asked_again(void) {
    for (int run = 0; run < 50; run++) {
        use_rmd(9);
        uint32_t t = 0, writes = 0;
        for (; t < 4000U && !drive.ready; t++) {
            const int command = command_at(t, false, 0);
            writes += command == 0xB3;
            if (command < 0 || check_random(&seed) % 2U == 0U) {
                continue;
            }
            for (unsigned q = 0; q < 4U; q++) {
                const struct can_frame frame = answer(q);
                (void)(frame.data[0] == command && receive(frame, t));
            }
        }
        CHECK(drive.ready);
        CHECK(writes <= t / 16U + 1U);
    }
}

/// Whatever the answer holds: zeros are also the watchdog's time here.
static void an_answer_confirms_its_own_question_only(void) {
    static const uint8_t commands[] = {0x92, 0x9A, 0xB3, 0x42};
    for (unsigned missing = 0; missing < 8U; missing++) {
        use_rmd(3);
        config.rmd.watchdog_ms = 0;
        if (missing >= 4U) {
            drive_forget(&drive);
        }
        for (unsigned q = 0; q < 8U; q++) {
            CHECK(q % 4U == missing % 4U || receive(reply(commands[q % 4U], 0, 0), 0));
        }
        CHECK(!drive.ready);
        CHECK(receive(reply(commands[missing % 4U], 0, 0), 0));
        CHECK(drive.ready);
    }
}

static void forgetting_starts_anew(void) {
    use_rmd(3);
    make_ready();
    CHECK(receive(reply(0x9A, 90, 0x000401E0), 1));
    CHECK_EQ(drive.error_bits, 4);
    drive_forget(&drive);
    CHECK(!drive.ready && !drive.position_known);
    CHECK_EQ(drive.error_bits, 0);
    CHECK_EQ(command_at(10, false, 0), 0xB3);
    CHECK(receive(answer(0), 1));
    CHECK(!drive.ready);
    make_ready();
}

// ---------------------------------------------------------------- an RMD drive at work

static void a_cycle_of_four_ticks(void) {
    use_rmd(5);
    make_ready();
    uint32_t positions = 0, angles = 0, healths = 0;
    for (uint32_t i = 0; i < 128U; i++) {
        const uint32_t t = UINT32_MAX - 63U + i; // across the wrap of the counter
        const int command = command_at(t, true, TURN / 8);
        CHECK_EQ(command == 0xA4, t % 4U == 0U);
        CHECK_EQ(command == -1, t % 2U == 1U);
        positions += command == 0xA4;
        angles += command == 0x92;
        healths += command == 0x9A;
        if (command == 0xA4) {
            CHECK_EQ(value_of(&output.frame[0]), 4500);
            CHECK_EQ(output.frame[0].data[2] | output.frame[0].data[3] << 8, 90);
            CHECK_EQ(output.frame[0].data[1], 0);
        }
    }
    CHECK_EQ(positions, 32);
    CHECK_EQ(angles, 30);
    CHECK_EQ(healths, 2);
    for (uint32_t t = 0; t < 128U; t++) { // without power it is only asked
        const int command = command_at(t, false, TURN / 8);
        CHECK(command == -1 || command == 0x92 || command == 0x9A);
        CHECK_EQ(command == -1, t % 4U != 2U);
    }
}

/// What was read is what is commanded: holding a position moves nothing.
static void reversed_and_offset(void) {
    const int64_t zeros[] = {0, TURN / 3, -777 * TURN - 12345, 2000 * TURN};
    for (unsigned z = 0; z < 4U; z++) {
        for (int reversed = 0; reversed < 2; reversed++) {
            use_rmd(1);
            config.rmd.zero_q48 = zeros[z];
            config.rmd.reversed = reversed != 0;
            for (int i = 0; i < 200 && check_clean(); i++) {
                const int32_t zero = (int32_t)drive_cdeg_from_q48(zeros[z]);
                const int32_t cdeg = zero + (int32_t)(check_random(&seed) % 400001U) - 200000;
                CHECK(receive(reply(0x92, 0, cdeg), 0));
                const int64_t wanted = drive_q48_from_cdeg(cdeg) - zeros[z];
                CHECK_EQ(drive.position_q48, reversed != 0 ? -wanted : wanted);
                CHECK_EQ(command_at(4, true, drive.position_q48), 0xA4);
                CHECK_EQ(value_of(&output.frame[0]), cdeg);
            }
        }
    }
    config.rmd.zero_q48 = TURN / 4; // by hand: reversed, 90 degrees off
    tick(0, true, TURN / 36);
    CHECK_EQ(value_of(&output.frame[0]), 8000);
}

static void angles_out_of_range_change_nothing(void) {
    use_rmd(1);
    make_ready();
    const int64_t before = drive.position_q48;
    const int32_t wild[] = {64 * 36000 + 1, -64 * 36000 - 1, INT32_MAX, INT32_MIN, 1080000001};
    for (unsigned i = 0; i < 5U; i++) {
        CHECK(receive(reply(0x92, 0, wild[i]), 1000));
        CHECK_EQ(drive.position_q48, before);
        CHECK_EQ(drive.bad_replies, i + 1U);
        CHECK_EQ(drive.heard_us, 0);
    }
    CHECK(receive(reply(0x92, 0, 64 * 36000), 1000));
    CHECK_EQ(drive.position_q48, 64 * TURN);
    CHECK_EQ(drive.heard_us, 1000);
    CHECK(receive(reply(0x92, 0, -64 * 36000), 1000));
    CHECK_EQ(drive.position_q48, -64 * TURN);
}

static void frames_of_others_are_not_taken(void) {
    use_rmd(4);
    struct can_frame frame = answer(0);
    for (uint32_t id = 0; id <= CAN_FRAME_STANDARD_ID_MAX; id++) {
        frame.id = id;
        CHECK_EQ(receive(frame, 9), id == 0x244U);
    }
    frame = answer(0);
    for (unsigned flags = 1; flags < 8U; flags++) {
        frame.flags = (uint8_t)flags;
        drive.heard_us = 5;
        CHECK(!receive(frame, 9));
        CHECK_EQ(drive.heard_us, 5);
    }
    CHECK_EQ(drive.bad_replies, 0);
}

static void frames_that_cannot_be_decoded_are_counted_only(void) {
    use_rmd(4);
    struct can_frame frame = answer(0);
    for (uint8_t length = 0; length < 8U; length++) {
        frame.length = length;
        CHECK(receive(frame, 9));
    }
    CHECK_EQ(drive.bad_replies, 8);
    frame.length = 255;
    CHECK(receive(frame, 9));
    CHECK(receive(reply(0x00, 0, 0), 9));
    CHECK(receive(reply(0x88, 0, 0), 9)); // LKTech only
    CHECK(receive(reply(0x42, 4, 0), 9));
    CHECK_EQ(drive.bad_replies, 12);
    CHECK_EQ(drive.heard_us, 0);
    CHECK(!drive.position_known && !drive.ready);
    CHECK_EQ(drive.asked, 0);
}

/// Random frames with the drive's id: each is heard and decoded, or counted and without effect.
static void random_frames(void) {
    check_note("seed", (int64_t)seed);
    for (int dialect = 0; dialect < 2; dialect++) {
        if (dialect == 0) {
            use_rmd(4);
        } else {
            use_lk(4);
        }
        for (uint64_t i = 1; i < 20000U && check_clean(); i++) {
            struct can_frame frame = {.id = dialect == 0 ? 0x244 : 0x144, .length = 8};
            const uint64_t bytes = check_random(&seed);
            for (unsigned k = 0; k < 8U; k++) {
                frame.data[k] = (uint8_t)(bytes >> (8U * k));
            }
            const struct drive before = drive;
            CHECK(receive(frame, i));
            if (drive.bad_replies != before.bad_replies) {
                CHECK_EQ(drive.bad_replies, before.bad_replies + 1U);
                CHECK_EQ(drive.heard_us, before.heard_us);
                CHECK_EQ(drive.position_q48, before.position_q48);
                CHECK_EQ(drive.error_bits, before.error_bits);
                CHECK_EQ(drive.asked, before.asked);
                CHECK_EQ(drive.ready, before.ready);
            } else {
                CHECK_EQ(drive.heard_us, i);
            }
            CHECK_NEAR(drive.position_q48, 0, 64 * TURN);
        }
    }
}

// ---------------------------------------------------------------- health

static void silence_is_counted_from_the_last_reply(void) {
    const uint64_t late = UINT64_C(1) << 33;
    use_rmd(4);
    init(late);
    CHECK_EQ(drive_check(&drive, late + 50000U, 50000), DRIVE_HEALTHY);
    CHECK_EQ(drive_check(&drive, late + 50001U, 50000), DRIVE_FAULT_SILENT);
    CHECK(receive(reply(0xA4, 0, 0), late + 60000U)); // any reply
    CHECK_EQ(drive_check(&drive, late + 110000U, 50000), DRIVE_HEALTHY);
    CHECK_EQ(drive_check(&drive, late + 110001U, 50000), DRIVE_FAULT_SILENT);
    CHECK(drive_has_feedback(&drive));
}

/// Replies of other kinds keep a drive alive, but say nothing of where it is.
static void positions_grow_old(void) {
    use_rmd(4);
    CHECK(!drive_position_is_fresh(&drive, 0, 50000));
    make_ready();
    CHECK(receive(answer(0), 1000));
    CHECK(receive(answer(1), 80000));
    CHECK_EQ(drive_check(&drive, 80000, 50000), DRIVE_HEALTHY);
    CHECK(drive_position_is_fresh(&drive, 51000, 50000));
    CHECK(!drive_position_is_fresh(&drive, 51001, 50000));
    CHECK(receive(reply(0x92, 0, INT32_MAX), 51000)); // no position
    CHECK(!drive_position_is_fresh(&drive, 51001, 50000));
    drive_forget(&drive);
    CHECK(!drive_position_is_fresh(&drive, 1000, 50000));
}

static void errors_are_reported_until_they_are_gone(void) {
    use_rmd(4);
    make_ready();
    for (unsigned bit = 0; bit < 16U; bit++) {
        CHECK(receive(reply(0x9A, 0x9C, (int32_t)((UINT32_C(0x10000) << bit) | 480U)), 7));
        CHECK_EQ(drive.error_bits, 1U << bit);
        CHECK_EQ(drive.temperature_c, -100);
        CHECK_EQ(drive_check(&drive, 7, 50000), DRIVE_FAULT_REPORTED);
        CHECK_EQ(drive_check(&drive, 60000, 50000), DRIVE_FAULT_SILENT); // silence counts first
    }
    CHECK(receive(answer(1), 8));
    CHECK_EQ(drive_check(&drive, 8, 50000), DRIVE_HEALTHY);
}

// ---------------------------------------------------------------- LKTech

static void lk_is_asked_for_its_angle_only(void) {
    use_lk(6);
    for (uint32_t t = 0; t < 128U; t++) {
        CHECK_EQ(command_at(t, false, 0), t % 4U == 2U ? 0x92 : -1);
    }
    CHECK(!drive.ready);
    CHECK(receive(lk_angle(-4500), 3));
    CHECK(drive.ready && drive.position_known);
    CHECK_EQ(drive.position_q48, -TURN / 8);
    for (uint32_t t = 0; t < 128U; t++) {
        CHECK_EQ(command_at(t, false, 0), t % 4U == 2U ? 0x92 : -1);
    }
}

static void lk_runs_before_it_moves(void) {
    use_lk(6);
    CHECK(receive(lk_angle(0), 0));
    for (uint32_t t = 0; t < 64U; t += 4U) { // the confirmation is lost again and again
        CHECK_EQ(command_at(t, true, TURN / 4), 0x88);
    }
    const struct can_frame run = {.id = 0x146, .length = 8, .data = {0x88}};
    CHECK(receive(run, 1));
    CHECK_EQ(command_at(64, true, TURN / 4), 0xA4);
    CHECK_EQ(value_of(&output.frame[0]), 9000);
    drive_forget(&drive); // it may have restarted
    CHECK(receive(lk_angle(0), 2));
    CHECK_EQ(command_at(68, true, TURN / 4), 0x88);
}

static void lk_frames(void) {
    use_lk(6);
    CHECK(receive(lk_angle(64 * 36000), 1));
    CHECK_EQ(drive.position_q48, 64 * TURN);
    const int64_t wild[] = {64 * 36000 + 1, INT64_C(1) << 31, -(INT64_C(1) << 31) - 1,
                            (INT64_C(1) << 55) - 1};
    for (unsigned i = 0; i < 4U; i++) {
        CHECK(receive(lk_angle(wild[i]), 2));
        CHECK_EQ(drive.position_q48, 64 * TURN);
        CHECK_EQ(drive.heard_us, 1);
    }
    struct can_frame v3 = reply(0x92, 0, 0);
    CHECK(!receive(v3, 3)); // 0x246
    const struct can_frame motion = {.id = 0x146, .length = 8, .data = {0xA4, 30}};
    CHECK(receive(motion, 4));
    CHECK_EQ(drive.heard_us, 4);
}

int main(void) {
    TEST(questions_come_in_turn_and_move_nothing);
    TEST(ready_when_all_four_are_answered);
    TEST(the_watchdog_is_written_until_confirmed);
    TEST(lost_answers_are_asked_again);
    TEST(an_answer_confirms_its_own_question_only);
    TEST(forgetting_starts_anew);
    TEST(a_cycle_of_four_ticks);
    TEST(reversed_and_offset);
    TEST(angles_out_of_range_change_nothing);
    TEST(frames_of_others_are_not_taken);
    TEST(frames_that_cannot_be_decoded_are_counted_only);
    TEST(random_frames);
    TEST(silence_is_counted_from_the_last_reply);
    TEST(positions_grow_old);
    TEST(errors_are_reported_until_they_are_gone);
    TEST(lk_is_asked_for_its_angle_only);
    TEST(lk_runs_before_it_moves);
    TEST(lk_frames);
    return check_finish();
}
