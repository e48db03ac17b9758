/// firmware/drive/rmd against the examples printed in the makers' documents and against bytes put
/// together by hand here; no table or shift of the codec is used. Needs no libc.
#include "check.h"

#include "drive/rmd.h"

static const uint64_t first_seed = UINT64_C(0x524D44C0DEC0DE01);

static struct can_frame frame_of(uint32_t id, const uint8_t *bytes) {
    struct can_frame f = {.id = id, .length = 8};
    for (unsigned i = 0; i < 8U; i++) {
        f.data[i] = bytes[i];
    }
    return f;
}
#define BYTES(...)          ((const uint8_t[8]){__VA_ARGS__})
#define FRAME(id, ...)      frame_of((id), BYTES(__VA_ARGS__))
#define CHECK_FRAME(got, w) check_frame(__LINE__, &(got), (w))

static void check_frame(int line, const struct can_frame *got, struct can_frame wanted) {
    check_equal(__FILE__, line, "id", got->id, wanted.id);
    check_equal(__FILE__, line, "flags", got->flags, wanted.flags);
    check_equal(__FILE__, line, "length", got->length, wanted.length);
    for (unsigned i = 0; i < 8U; i++) {
        check_equal(__FILE__, line, "byte", got->data[i], wanted.data[i]);
    }
}

static void requests_with_values(void) {
    struct can_frame f;
    CHECK_EQ(rmd_encode_position(1, 36000, 500, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xA4, 0, 0xF4, 0x01, 0xA0, 0x8C, 0, 0));
    CHECK_EQ(rmd_encode_position(1, -36000, 500, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xA4, 0, 0xF4, 0x01, 0x60, 0x73, 0xFF, 0xFF));
    CHECK_EQ(rmd_encode_position(1, 3000, 60, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xA4, 0, 0x3C, 0, 0xB8, 0x0B, 0, 0));
    CHECK_EQ(rmd_encode_position(1, -1234, 45, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xA4, 0, 0x2D, 0, 0x2E, 0xFB, 0xFF, 0xFF));
    CHECK_EQ(rmd_encode_position(32, INT32_MIN, 65535, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x160, 0xA4, 0, 0xFF, 0xFF, 0, 0, 0, 0x80));
    CHECK_EQ(rmd_encode_speed(1, 10000, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xA2, 0, 0, 0, 0x10, 0x27, 0, 0));
    CHECK_EQ(rmd_encode_speed(1, -10000, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xA2, 0, 0, 0, 0xF0, 0xD8, 0xFF, 0xFF));
    CHECK_EQ(rmd_encode_watchdog(1, 200, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xB3, 0, 0, 0, 0xC8, 0, 0, 0));
    CHECK_EQ(rmd_encode_watchdog(1, 1000, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xB3, 0, 0, 0, 0xE8, 0x03, 0, 0));
    CHECK_EQ(rmd_encode_report(1, RMD_READ_ANGLE, true, 10, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0xB6, 0x92, 1, 1, 0, 0, 0, 0));
    CHECK_EQ(rmd_encode_report(2, RMD_READ_STATUS, false, 655350, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x142, 0xB6, 0x9A, 0, 0xFF, 0xFF, 0, 0, 0));
    CHECK_EQ(rmd_encode_read_accel(1, RMD_DECEL_POSITION, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x141, 0x42, 1, 0, 0, 0, 0, 0, 0));
    rmd_encode_read_bus_id(&f);
    CHECK_FRAME(f, FRAME(0x300, 0x79, 0, 1, 0, 0, 0, 0, 0));
    // 10 rad (the document says 9.99), 1.02 rad/s, kp 10, kd 1, 10 Nm.
    const struct rmd_impedance s = {0xE666, 0x82E, 0x052, 0x333, 0xB55};
    CHECK_EQ(rmd_encode_impedance(1, &s, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x401, 0xE6, 0x66, 0x82, 0xE0, 0x52, 0x33, 0x3B, 0x55));
}

/// One bit after the other: the frame is one big-endian number.
static void bits_of_an_impedance_set_point(void) {
    for (unsigned bit = 0; bit < 64U; bit++) {
        const uint64_t number = UINT64_C(1) << bit;
        const struct rmd_impedance s = {(uint16_t)(number >> 48), (uint16_t)(number >> 36 & 0xFFFU),
                                        (uint16_t)(number >> 24 & 0xFFFU),
                                        (uint16_t)(number >> 12 & 0xFFFU),
                                        (uint16_t)(number & 0xFFFU)};
        struct can_frame f, wanted = FRAME(0x401, 0, 0, 0, 0, 0, 0, 0, 0);
        wanted.data[7U - bit / 8U] = (uint8_t)(1U << bit % 8U);
        CHECK_EQ(rmd_encode_impedance(1, &s, &f), RMD_OK);
        CHECK_FRAME(f, wanted);
    }
    const struct rmd_impedance all = {0xFFFF, 0xFFF, 0xFFF, 0xFFF, 0xFFF};
    struct can_frame f;
    CHECK_EQ(rmd_encode_impedance(32, &all, &f), RMD_OK);
    CHECK_FRAME(f, FRAME(0x420, 255, 255, 255, 255, 255, 255, 255, 255));
}

static void requests_without_values(void) {
    static const uint8_t commands[] = {0x70, 0x76, 0x77, 0x78, 0x80, 0x81, 0x88,
                                       0x92, 0x9A, 0x9C, 0xB1, 0xB2, 0xB5};
    for (unsigned c = 0; c < 256U; c++) {
        bool plain = false;
        for (unsigned i = 0; i < sizeof commands; i++) {
            plain = plain || commands[i] == c;
        }
        struct can_frame f = FRAME(7, 1, 2, 3, 4, 5, 6, 7, 8);
        CHECK_EQ(rmd_encode(3, (enum rmd_command)c, &f), plain ? RMD_OK : RMD_BAD_COMMAND);
        CHECK_FRAME(f, plain ? FRAME(0x143, (uint8_t)c, 0, 0, 0, 0, 0, 0, 0)
                             : FRAME(7, 1, 2, 3, 4, 5, 6, 7, 8));
    }
}

static void bad_requests_leave_the_frame_alone(void) {
    const struct can_frame before = FRAME(7, 1, 2, 3, 4, 5, 6, 7, 8);
    struct can_frame f = before;
    const struct rmd_impedance s = {0xFFFF, 0xFFF, 0xFFF, 0xFFF, 0xFFF};
    static const uint8_t ids[] = {0, 33, 255};
    for (unsigned i = 0; i < sizeof ids; i++) {
        CHECK_EQ(rmd_encode(ids[i], RMD_STOP, &f), RMD_BAD_ID);
        CHECK_EQ(rmd_encode_position(ids[i], 0, 0, &f), RMD_BAD_ID);
        CHECK_EQ(rmd_encode_speed(ids[i], 0, &f), RMD_BAD_ID);
        CHECK_EQ(rmd_encode_watchdog(ids[i], 0, &f), RMD_BAD_ID);
        CHECK_EQ(rmd_encode_report(ids[i], RMD_READ_ANGLE, true, 10, &f), RMD_BAD_ID);
        CHECK_EQ(rmd_encode_read_accel(ids[i], RMD_ACCEL_POSITION, &f), RMD_BAD_ID);
        CHECK_EQ(rmd_encode_impedance(ids[i], &s, &f), RMD_BAD_ID);
    }
    CHECK_EQ(rmd_encode_report(1, RMD_READ_ANGLE, true, 15, &f), RMD_BAD_VALUE);
    CHECK_EQ(rmd_encode_report(1, RMD_READ_ANGLE, true, 655360, &f), RMD_BAD_VALUE);
    CHECK_EQ(rmd_encode_read_accel(1, (enum rmd_accel)4, &f), RMD_BAD_VALUE);
    const struct rmd_impedance too_large[] = {
        {0, 0x1000, 0, 0, 0}, {0, 0, 0x1000, 0, 0}, {0, 0, 0, 0x1000, 0}, {0, 0, 0, 0, 0x1000}};
    for (unsigned i = 0; i < 4U; i++) {
        CHECK_EQ(rmd_encode_impedance(1, &too_large[i], &f), RMD_BAD_VALUE);
    }
    CHECK_FRAME(f, before);
}

static struct rmd_reply decoded(struct can_frame frame, uint32_t offset) {
    struct rmd_reply r = {.id = 99, .kind = (enum rmd_reply_kind)99};
    CHECK_EQ(rmd_decode(&frame, offset, &r), RMD_OK);
    return r;
}

static void replies_of_motion(void) {
    static const uint8_t commands[] = {0x9C, 0xA1, 0xA2, 0xA4, 0xA8};
    for (unsigned i = 0; i < sizeof commands; i++) {
        struct rmd_reply r = decoded(FRAME(0x241, commands[i], 0x32, 0x64, 0, 0xF4, 1, 0x2D, 0),
                                     RMD_REPLY_OFFSET_V3);
        CHECK_EQ(r.id, 1);
        CHECK_EQ(r.command, commands[i]);
        CHECK_EQ(r.kind, RMD_REPLY_MOTION);
        CHECK_EQ(r.value.motion.temperature_c, 50);
        CHECK_EQ(r.value.motion.current_ca, 100);
        CHECK_EQ(r.value.motion.speed_dps, 500);
        CHECK_EQ(r.value.motion.angle_deg, 45);
        r = decoded(FRAME(0x260, commands[i], 0xF6, 0x9C, 0xFF, 0x0C, 0xFE, 0xD3, 0xFF),
                    RMD_REPLY_OFFSET_V3);
        CHECK_EQ(r.id, 32);
        CHECK_EQ(r.value.motion.temperature_c, -10);
        CHECK_EQ(r.value.motion.current_ca, -100);
        CHECK_EQ(r.value.motion.speed_dps, -500);
        CHECK_EQ(r.value.motion.angle_deg, -45);
        r = decoded(FRAME(0x141, commands[i], 0x32, 0, 0xF8, 0xF4, 1, 0xE8, 0xFF),
                    RMD_REPLY_OFFSET_LK);
        CHECK_EQ(r.kind, RMD_REPLY_MOTION_LK);
        CHECK_EQ(r.value.motion_lk.temperature_c, 50);
        CHECK_EQ(r.value.motion_lk.current_raw, -2048);
        CHECK_EQ(r.value.motion_lk.speed_dps, 500);
        CHECK_EQ(r.value.motion_lk.encoder_count, 65512);
    }
}

static void replies_of_angle(void) {
    struct rmd_reply r =
        decoded(FRAME(0x241, 0x92, 0, 0, 0, 0xA0, 0x8C, 0, 0), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_ANGLE);
    CHECK_EQ(r.value.angle_cdeg, 36000);
    r = decoded(FRAME(0x241, 0x92, 0, 0, 0, 0, 0, 0, 0x80), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.value.angle_cdeg, INT32_MIN);
    // LKTech: 56 bits from byte 1 on; what an int32 can't hold is refused.
    r = decoded(FRAME(0x141, 0x92, 0xA0, 0x8C, 0, 0, 0, 0, 0), RMD_REPLY_OFFSET_LK);
    CHECK_EQ(r.value.angle_cdeg, 36000);
    r = decoded(FRAME(0x141, 0x92, 0x60, 0x73, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF), RMD_REPLY_OFFSET_LK);
    CHECK_EQ(r.value.angle_cdeg, -36000);
    static const uint8_t beyond[][8] = {{0x92, 0, 0, 0, 0x80, 0, 0, 0},
                                        {0x92, 0xFF, 0xFF, 0xFF, 0x7F, 0xFF, 0xFF, 0xFF},
                                        {0x92, 0, 0, 0, 0, 1, 0, 0},
                                        {0x92, 0, 0, 0, 0, 0, 0, 0x80}};
    for (unsigned i = 0; i < 4U; i++) {
        const struct can_frame f = frame_of(0x141, beyond[i]);
        CHECK_EQ(rmd_decode(&f, RMD_REPLY_OFFSET_LK, &r), RMD_BAD_VALUE);
    }
}

static void other_replies(void) {
    struct rmd_reply r =
        decoded(FRAME(0x241, 0x9A, 0x32, 0, 1, 0xE5, 1, 4, 0), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_HEALTH);
    CHECK_EQ(r.value.health.temperature_c, 50);
    CHECK(r.value.health.brake_released);
    CHECK_EQ(r.value.health.supply_dv, 485);
    CHECK_EQ(r.value.health.error_bits, RMD_ERROR_LOW_VOLTAGE);
    r = decoded(FRAME(0x241, 0x42, 1, 0, 0, 0x10, 0x27, 0, 0), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_ACCEL);
    CHECK_EQ(r.value.accel.index, RMD_DECEL_POSITION);
    CHECK_EQ(r.value.accel.accel_dps2, 10000);
    r = decoded(FRAME(0x241, 0x70, 0, 0, 0, 0, 0, 0, 3), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_MODE);
    CHECK_EQ(r.value.mode, 3);
    r = decoded(FRAME(0x241, 0xB1, 0, 0, 0, 0, 0, 0, 0x10), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_UPTIME);
    CHECK_EQ(r.value.uptime_ms, 268435456);
    r = decoded(FRAME(0x241, 0xB2, 0, 0, 0, 0x2E, 0x89, 0x34, 0x01), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_VERSION);
    CHECK_EQ(r.value.version_date, 20220206);
    r = decoded(FRAME(0x241, 0xB3, 0, 0, 0, 0xC8, 0, 0, 0), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_WATCHDOG);
    CHECK_EQ(r.value.watchdog_ms, 200);
    r = decoded(FRAME(0x241, 0xB5, 'X', '4', '-', '1', '0', 'E', '!'), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_MODEL);
    static const char model[8] = "X4-10E!";
    for (unsigned i = 0; i < 8U; i++) {
        CHECK_EQ(r.value.model[i], model[i]);
    }
    r = decoded(FRAME(0x300, 0x79, 0, 1, 0, 0, 0, 0x42, 0x02), RMD_REPLY_OFFSET_V3);
    CHECK_EQ(r.kind, RMD_REPLY_BUS_ID);
    CHECK_EQ(r.id, 2);
    static const uint8_t acks[] = {0x77, 0x78, 0x80, 0x81};
    for (unsigned i = 0; i < sizeof acks; i++) {
        r = decoded(FRAME(0x24A, acks[i], 0, 0, 0, 0, 0, 0, 0), RMD_REPLY_OFFSET_V3);
        CHECK_EQ(r.kind, RMD_REPLY_ACK);
        CHECK_EQ(r.id, 10);
        CHECK_EQ(r.command, acks[i]);
    }
    r = decoded(FRAME(0x141, 0x88, 0, 0, 0, 0, 0, 0, 0), RMD_REPLY_OFFSET_LK);
    CHECK_EQ(r.kind, RMD_REPLY_ACK);
}

static enum rmd_status refused(struct can_frame frame, uint32_t offset) {
    struct rmd_reply r;
    return rmd_decode(&frame, offset, &r);
}

static void bad_replies(void) {
    struct can_frame f = FRAME(0x241, 0x92, 0, 0, 0, 0, 0, 0, 0);
    for (unsigned length = 0; length <= 255U; length++) {
        f.length = (uint8_t)length;
        CHECK_EQ(refused(f, RMD_REPLY_OFFSET_V3), length == 8U ? RMD_OK : RMD_BAD_LENGTH);
    }
    f.length = 8;
    for (unsigned flags = 0; flags <= 255U; flags++) {
        f.flags = (uint8_t)flags;
        CHECK_EQ(refused(f, RMD_REPLY_OFFSET_V3), flags == 0U ? RMD_OK : RMD_BAD_FRAME);
    }
    f.flags = 0;
    for (uint32_t id = 0; id <= 0x7FFU; id++) {
        f.id = id;
        CHECK_EQ(refused(f, RMD_REPLY_OFFSET_V3), id == 0x300U                   ? RMD_BAD_COMMAND
                                                  : id >= 0x241U && id <= 0x260U ? RMD_OK
                                                                                 : RMD_BAD_ID);
        CHECK_EQ(refused(f, RMD_REPLY_OFFSET_LK),
                 id >= 0x141U && id <= 0x160U ? RMD_OK : RMD_BAD_ID);
    }
    // A request heard as a reply, an id outside 1 to 32, a brake that is neither.
    CHECK_EQ(refused(FRAME(0x300, 0x79, 0, 1, 0, 0, 0, 0, 0), RMD_REPLY_OFFSET_V3), RMD_BAD_VALUE);
    CHECK_EQ(refused(FRAME(0x300, 0x79, 0, 0, 0, 0, 0, 0x42, 2), RMD_REPLY_OFFSET_V3),
             RMD_BAD_VALUE);
    CHECK_EQ(refused(FRAME(0x300, 0x79, 0, 1, 0, 0, 0, 0x61, 2), RMD_REPLY_OFFSET_V3),
             RMD_BAD_VALUE);
    CHECK_EQ(refused(FRAME(0x241, 0x9A, 0, 0, 2, 0, 0, 0, 0), RMD_REPLY_OFFSET_V3), RMD_BAD_VALUE);
    CHECK_EQ(refused(FRAME(0x241, 0x42, 4, 0, 0, 0, 0, 0, 0), RMD_REPLY_OFFSET_V3), RMD_BAD_VALUE);
}

/// Every frame of 8 bytes decodes or is refused with the output untouched; all 256 commands are
/// tried with random values, on ids around both reply ranges.
static void any_frame_is_decoded_or_refused(void) {
    uint64_t seed = first_seed;
    check_note("seed", (int64_t)seed);
    int64_t accepted = 0, turned_down = 0;
    for (unsigned i = 0; i < 200000U && check_clean(); i++) {
        const uint64_t bits = check_random(&seed), more = check_random(&seed);
        struct can_frame f = {.id = (uint32_t)(more >> 8), .length = 8};
        if ((more & 3U) != 0U) {
            static const uint32_t base[] = {0x140, 0x240, 0x2FF, 0x140};
            f.id = base[more & 3U] + (uint32_t)(more >> 8) % 35U;
        }
        for (unsigned k = 0; k < 8U; k++) {
            f.data[k] = (uint8_t)(bits >> (8U * k));
        }
        f.data[0] = (uint8_t)i;
        const uint32_t offset = (i & 256U) != 0U ? RMD_REPLY_OFFSET_LK : RMD_REPLY_OFFSET_V3;
        struct rmd_reply reply;
        unsigned char *raw = (unsigned char *)&reply;
        for (unsigned k = 0; k < sizeof reply; k++) {
            raw[k] = 0xA5;
        }
        const enum rmd_status status = rmd_decode(&f, offset, &reply);
        if (status == RMD_OK) {
            accepted++;
            CHECK(reply.id >= 1U && reply.id <= 32U);
            CHECK_EQ(reply.command, f.data[0]);
            CHECK(reply.kind <= RMD_REPLY_BUS_ID);
            continue;
        }
        turned_down++;
        CHECK(status == RMD_BAD_ID || status == RMD_BAD_COMMAND || status == RMD_BAD_VALUE);
        for (unsigned k = 0; k < sizeof reply && check_clean(); k++) {
            CHECK_EQ(raw[k], 0xA5);
        }
    }
    check_note("accepted", accepted);
    check_note("refused", turned_down);
    CHECK(accepted > 1500 && turned_down > 1500);
}

int main(void) {
    TEST(requests_with_values);
    TEST(bits_of_an_impedance_set_point);
    TEST(requests_without_values);
    TEST(bad_requests_leave_the_frame_alone);
    TEST(replies_of_motion);
    TEST(replies_of_angle);
    TEST(other_replies);
    TEST(bad_replies);
    TEST(any_frame_is_decoded_or_refused);
    return check_finish();
}
