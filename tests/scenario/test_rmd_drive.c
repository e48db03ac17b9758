/// devices/rmd_drive: bytes on the bus, modes, watchdog and failures. The loops are in
/// test_rmd_drive_loops.c.
#include "rmd_rig.h"

#include "drive/rmd.h"

static struct rig rig;

static void new_rig(void) {
    rig_init(&rig, axis_plant_pan(), rmd_drive_defaults(1), 0.0);
}

static void check_bytes(int line, struct can_frame got, uint32_t id, const uint8_t *bytes) {
    check_equal(__FILE__, line, "id", got.id, id);
    check_equal(__FILE__, line, "length", got.length, 8);
    for (unsigned i = 0; i < 8U; i++) {
        check_equal(__FILE__, line, "byte", got.data[i], bytes[i]);
    }
}
#define CHECK_BYTES(got, id, ...) check_bytes(__LINE__, (got), (id), BYTES(__VA_ARGS__))

static void answers_at_rest(void) {
    new_rig();
    CHECK_BYTES(rig_ask(&rig, BYTES(0x92)), 0x241, 0x92);
    // 24 C, brake locked, 24.0 V, no error.
    CHECK_BYTES(rig_ask(&rig, BYTES(0x9A)), 0x241, 0x9A, 24, 0, 0, 240);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x9C)), 0x241, 0x9C, 24);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x70)), 0x241, 0x70);
    CHECK_BYTES(rig_ask(&rig, BYTES(0xB1)), 0x241, 0xB1, 0, 0, 0, 4); // ms since power-on
    CHECK_BYTES(rig_ask(&rig, BYTES(0xB2)), 0x241, 0xB2, 0, 0, 0, 0x60, 0xFE, 0x34, 0x01);
    CHECK_BYTES(rig_ask(&rig, BYTES(0xB5)), 0x241, 0xB5, 'X', '4', '-', '1', '0', ' ', ' ');
    CHECK_BYTES(rig_ask(&rig, BYTES(0x42, 2)), 0x241, 0x42, 2);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x43, 2, 0, 0, 0x10, 0x27, 0, 0)), 0x241, 0x43, 2, 0, 0, 0x10,
                0x27, 0, 0);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x42, 2)), 0x241, 0x42, 2, 0, 0, 0x10, 0x27, 0, 0);
    (void)rig_ask(&rig, BYTES(0x43, 2, 0, 0, 99, 0, 0, 0)); // below 100: kept as it was
    CHECK_BYTES(rig_ask(&rig, BYTES(0x42, 2)), 0x241, 0x42, 2, 0, 0, 0x10, 0x27, 0, 0);
    CHECK_BYTES(rig_ask(&rig, BYTES(0xB3, 0, 0, 0, 0xC8, 0, 0, 0)), 0x241, 0xB3, 0, 0, 0, 0xC8, 0,
                0, 0);
    CHECK_EQ(rig.drive.config.watchdog_ms, 200);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x77)), 0x241, 0x77);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x9A)), 0x241, 0x9A, 24, 0, 1, 240);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x78)), 0x241, 0x78);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x9A)), 0x241, 0x9A, 24, 0, 0, 240);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x80)), 0x241, 0x80);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x81)), 0x241, 0x81);
}

static void angles_in_the_answers(void) {
    struct rmd_drive_config c = rmd_drive_defaults(32);
    rig_init(&rig, axis_plant_pan(), c, -123.456);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x92)), 0x260, 0x92, 0, 0, 0, 0xC6, 0xCF, 0xFF, 0xFF); // -12346
    // 0x60: -123.456 / 360 * 131072 * 12.5 = -561861.97, rounded down.
    struct can_frame f = rig_ask(&rig, BYTES(0x60));
    CHECK_EQ(rig_i32(&f), -561862);
    f = rig_ask(&rig, BYTES(0x9C));
    CHECK_BYTES(f, 0x260, 0x9C, 24, 0, 0, 0, 0, 0x85, 0xFF); // -123 degrees
    c.zero_cdeg = 500;
    rig_init(&rig, axis_plant_pan(), c, 10.0);
    f = rig_ask(&rig, BYTES(0x92));
    CHECK_EQ(rig_i32(&f), 1500);
    rig_position(&rig, 20.0, 0);
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) - 15.0) < 0.005);
}

static void speaks_the_lktech_dialect(void) {
    struct rmd_drive_config c = rmd_drive_defaults(3);
    c.lktech = true;
    rig_init(&rig, axis_plant_pan(), c, -10.0);
    CHECK_BYTES(rig_ask(&rig, BYTES(0x92)), 0x143, 0x92, 0x18, 0xFC, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF);
    rig_position(&rig, 5.0, 0);
    rig_run(&rig, 500);
    CHECK(rig_deg(&rig) == -10.0); // not switched on
    CHECK_BYTES(rig_ask(&rig, BYTES(0x88)), 0x143, 0x88);
    rig_position(&rig, 5.0, 0);
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) - 5.0) < 0.005);
    // The encoder: 5 / 360 * 131072 * 12.5 counts, the lower 16 bits.
    const struct can_frame f = rig_ask(&rig, BYTES(0x9C));
    CHECK_NEAR(f.data[6] | f.data[7] << 8, 22756, 25);
}

static void strangers_are_ignored(void) {
    new_rig();
    struct can_frame f = {.id = 0x141, .length = 7, .data = {0x92}};
    CHECK(can_bus_send(&rig.bus, &rig.host, &f, 0));
    f.length = 8;
    f.flags = CAN_FRAME_EXTENDED;
    CHECK(can_bus_send(&rig.bus, &rig.host, &f, 0));
    f.flags = 0;
    f.id = 0x142;
    CHECK(can_bus_send(&rig.bus, &rig.host, &f, 0));
    f.id = 0x241;
    CHECK(can_bus_send(&rig.bus, &rig.host, &f, 0));
    f.id = 0x141;
    f.data[0] = 0x55;
    CHECK(can_bus_send(&rig.bus, &rig.host, &f, 0));
    rig_run(&rig, 5);
    CHECK_EQ(rig.replies.count, 0);
    CHECK_EQ(rig.drive.ignored, 3);
    f.id = 0x280; // to all
    f.data[0] = 0x92;
    CHECK(can_bus_send(&rig.bus, &rig.host, &f, 0));
    rig_run(&rig, 5);
    CHECK_EQ(rig.replies.count, 1);
    CHECK_EQ(rig.replies.frames[0].frame.id, 0x241);
}

static void answers_take_60_to_120_us(void) {
    new_rig();
    uint64_t least = UINT64_MAX, most = 0;
    for (unsigned i = 0; i < 500U; i++) {
        struct can_frame f = {.id = 0x141, .length = 8, .data = {0x92}};
        const uint64_t asked = rig.bus.now_ns + 1000U * can_frame_bits(&rig.bus.timing, &f);
        f = rig_ask(&rig, BYTES(0x92));
        const uint64_t answered =
            rig.replies.frames[(rig.replies.first + CAN_RX_QUEUE - 1U) % CAN_RX_QUEUE].t_ns;
        const uint64_t latency = answered - 1000U * can_frame_bits(&rig.bus.timing, &f) - asked;
        least = latency < least ? latency : least;
        most = latency > most ? latency : most;
    }
    check_note("shortest latency, ns", (int64_t)least);
    check_note("longest latency, ns", (int64_t)most);
    CHECK(least >= 60000U && least < 62000U && most > 118000U && most <= 120000U);
}

/// The firmware's codec and this drive understand each other.
static void talks_with_the_firmware_codec(void) {
    new_rig();
    struct can_frame f;
    struct rmd_reply reply;
    CHECK_EQ(rmd_encode_position(1, -1234, 45, &f), RMD_OK);
    f = rig_ask(&rig, f.data);
    CHECK_EQ(rmd_decode(&f, RMD_REPLY_OFFSET_V3, &reply), RMD_OK);
    CHECK_EQ(reply.kind, RMD_REPLY_MOTION);
    rig_run(&rig, 1500);
    CHECK_EQ(rmd_encode(1, RMD_READ_ANGLE, &f), RMD_OK);
    f = rig_ask(&rig, f.data);
    CHECK_EQ(rmd_decode(&f, RMD_REPLY_OFFSET_V3, &reply), RMD_OK);
    CHECK_EQ(reply.kind, RMD_REPLY_ANGLE);
    CHECK_NEAR(reply.value.angle_cdeg, -1234, 1);
    CHECK_EQ(rmd_encode(1, RMD_READ_STATUS, &f), RMD_OK);
    f = rig_ask(&rig, f.data);
    CHECK_EQ(rmd_decode(&f, RMD_REPLY_OFFSET_V3, &reply), RMD_OK);
    CHECK(reply.value.health.brake_released);
    CHECK_EQ(reply.value.health.supply_dv, 240);
}

static void torque_needs_the_brake_open(void) {
    new_rig();
    rig_send(&rig, BYTES(0xA1, 0, 0, 0, 0x96, 0)); // 1.5 A: 1.2 Nm
    rig_run(&rig, 100);
    CHECK(rig_dps(&rig) == 0.0);
    (void)rig_ask(&rig, BYTES(0x77));
    rig_run(&rig, 99);
    // Half a newton metre and more over Coulomb friction for 0.1 s.
    CHECK(rig_dps(&rig) > 100.0 && rig_dps(&rig) < 300.0);
    const struct can_frame f = rig_ask(&rig, BYTES(0x9C));
    CHECK_EQ(f.data[2] | f.data[3] << 8, 150);
    CHECK_NEAR(f.data[4] | f.data[5] << 8, lround(rig_dps(&rig)), 8);
    CHECK_EQ(rig_ask(&rig, BYTES(0x70)).data[7], 1);
    (void)rig_ask(&rig, BYTES(0x80));
    rig_run(&rig, 1000);
    CHECK(rig_dps(&rig) == 0.0);
    CHECK_EQ(rig_ask(&rig, BYTES(0x70)).data[7], 0);
}

static void speed_increment_and_stop(void) {
    new_rig();
    rig_send_i32(&rig, 0xA2, 0, -2000); // -20 dps
    rig_run(&rig, 500);
    CHECK(fabs(rig_dps(&rig) + 20.0) < 0.2);
    CHECK_EQ(rig_ask(&rig, BYTES(0x70)).data[7], 2);
    (void)rig_ask(&rig, BYTES(0x81));
    rig_run(&rig, 500);
    CHECK(fabs(rig_dps(&rig)) < 0.01);
    const double before = rig_deg(&rig);
    rig_send_i32(&rig, 0xA8, 30, 1500);
    rig_run(&rig, 300);
    CHECK(rig_dps(&rig) < 31.0 && rig_dps(&rig) > 29.0);
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) - before - 15.0) < 0.005);
    CHECK_EQ(rig_ask(&rig, BYTES(0x70)).data[7], 3);
}

static void watchdog_cuts_and_brakes(void) {
    new_rig();
    (void)rig_ask(&rig, BYTES(0xB3, 0, 0, 0, 50));
    rig_send_i32(&rig, 0xA2, 0, 6000);
    for (unsigned i = 0; i < 100U; i++) { // any frame keeps it quiet
        rig_send(&rig, BYTES(0x92));
        rig_run(&rig, 10);
    }
    CHECK(fabs(rig_dps(&rig) - 60.0) < 0.5);
    const uint64_t last = rig.drive.last_frame_ns;
    while (!rig.drive.brake_locked && rig.bus.now_ns < last + 100U * MS) {
        rig_run_us(&rig, 250);
    }
    CHECK(rig.bus.now_ns - last > 50U * MS && rig.bus.now_ns - last <= 50U * MS + 500000U);
    const double from = rig_deg(&rig);
    rig_run(&rig, 5); // 5.6 Nm on 0.0167 kg m^2: 60 dps are gone after 3 ms
    CHECK(rig_dps(&rig) == 0.0);
    CHECK(rig_deg(&rig) - from < 0.15);
    // The first frame is too late to count, so its command is not obeyed; the next one runs.
    rig_run(&rig, 500);
    const double rest = rig_deg(&rig);
    rig_position(&rig, 0.0, 60);
    rig_run(&rig, 20);
    CHECK(rig_deg(&rig) == rest);
    CHECK_EQ(rig_errors(&rig), 0);
    rig_run(&rig, 20);
    CHECK(rig_deg(&rig) == rest); // a question moves nothing
    for (unsigned i = 0; i < 1000U; i++) {
        rig_position(&rig, 0.0, 60);
        rig_run(&rig, 4);
    }
    CHECK(fabs(rig_deg(&rig)) < 0.005);
}

static void falls_silent(void) {
    new_rig();
    rig_send_i32(&rig, 0xA2, 0, 1000);
    rig_run(&rig, 300);
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_SILENT, true);
    CHECK_EQ(rig_ask(&rig, BYTES(0x80)).id, 0);
    rig_run(&rig, 300);
    CHECK(fabs(rig_dps(&rig) - 10.0) < 0.2); // goes on
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_SILENT, false);
    CHECK_EQ(rig_ask(&rig, BYTES(0x80)).id, 0x241);
}

static void falls_idle_without_an_error(void) {
    rig_init(&rig, axis_plant_tilt(), rmd_drive_defaults(1), 0.0);
    rig.plant.config.gravity_nm = 2.0; // more than friction holds
    rig_position(&rig, 30.0, 60);
    rig_run(&rig, 2000);
    CHECK(fabs(rig_deg(&rig) - 30.0) < 0.01);
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_IDLE, true);
    rig_run(&rig, 200);
    CHECK(rig_deg(&rig) < 20.0); // the brake stays open: it drops
    CHECK_EQ(rig_errors(&rig), 0);
    CHECK_EQ(rig_ask(&rig, BYTES(0x70)).data[7], 0);
}

static void reboots_and_forgets_turns(void) {
    struct axis_plant_config axis = axis_plant_pan();
    axis.stop_max_rad = 1e3;
    rig_init(&rig, axis, rmd_drive_defaults(1), 0.0);
    rig_position(&rig, 400.0, 0);
    rig_run(&rig, 3000);
    struct can_frame f = rig_ask(&rig, BYTES(0x92));
    CHECK_NEAR(rig_i32(&f), 40000, 1);
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_REBOOT, true);
    CHECK_EQ(rig_ask(&rig, BYTES(0x92)).id, 0);
    rig_run(&rig, 295);
    CHECK_EQ(rig_ask(&rig, BYTES(0x92)).id, 0);
    rig_run(&rig, 5);
    f = rig_ask(&rig, BYTES(0x92));
    CHECK_NEAR(rig_i32(&f), 4000, 1);
    CHECK(rig.drive.brake_locked && rig.drive.mode == RMD_DRIVE_OFF);
    f = rig_ask(&rig, BYTES(0xB1));
    CHECK(rig_i32(&f) < 400);
    rig_position(&rig, 50.0, 60);
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) - 410.0) < 0.01);
    CHECK_EQ(rig_ask(&rig, BYTES(0x76)).id, 0); // reset: no answer
    rig_run(&rig, 100);
    CHECK_EQ(rig_ask(&rig, BYTES(0x92)).id, 0);
    rig_run(&rig, 250);
    CHECK_EQ(rig_ask(&rig, BYTES(0x92)).id, 0x241);
}

static void a_jam_becomes_a_stall(void) {
    new_rig();
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_JAM, true);
    rig_position(&rig, 30.0, 60);
    rig_run(&rig, 400);
    CHECK_EQ(rig_errors(&rig), 0);
    CHECK(rig.plant.motor_nm > 7.5);
    rig_run(&rig, 300);
    CHECK_EQ(rig_errors(&rig), 0x0002);
    CHECK(rig.plant.motor_nm == 0.0 && rig.drive.brake_locked);
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_JAM, false);
    rig_position(&rig, 30.0, 60);
    rig_run(&rig, 500);
    CHECK(rig_deg(&rig) == 0.0); // answered, not obeyed
    rig_send(&rig, BYTES(0x76));
    rig_run(&rig, 350);
    CHECK_EQ(rig_errors(&rig), 0);
    rig_position(&rig, 30.0, 60);
    rig_run(&rig, 1500);
    CHECK(fabs(rig_deg(&rig) - 30.0) < 0.01);
}

static void overheats(void) {
    new_rig();
    rig_position(&rig, 100.0, 60);
    rig_run(&rig, 500);
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_HEAT, true);
    rig_run(&rig, 100);
    CHECK(rig_dps(&rig) == 0.0);
    CHECK_EQ(rig_errors(&rig), 0x1000);
    // By itself: the sheet's stall test, 5.2 Nm for 10 s from 24 C, warms by 41 K.
    struct rmd_drive_config c = rmd_drive_defaults(1);
    c.torque_limit_nm = 10.0;
    rig_init(&rig, axis_plant_pan(), c, 0.0);
    rmd_drive_fail(&rig.drive, RMD_DRIVE_FAIL_JAM, true);
    (void)rig_ask(&rig, BYTES(0x77));
    rig_send(&rig, BYTES(0xA1, 0, 0, 0, 0x8A, 0x02)); // 6.50 A: 5.2 Nm
    rig_run(&rig, 10000);
    const int warm = (int8_t)rig_ask(&rig, BYTES(0x9A)).data[1];
    check_note("after 10 s at 5.2 Nm, C", warm);
    CHECK(warm > 40 && warm < 70);
    rig_run(&rig, 60000);
    const int warmer = (int8_t)rig_ask(&rig, BYTES(0x9A)).data[1];
    CHECK(warmer > warm && warmer < 90);
}

int main(void) {
    TEST(answers_at_rest);
    TEST(angles_in_the_answers);
    TEST(speaks_the_lktech_dialect);
    TEST(strangers_are_ignored);
    TEST(answers_take_60_to_120_us);
    TEST(talks_with_the_firmware_codec);
    TEST(torque_needs_the_brake_open);
    TEST(speed_increment_and_stop);
    TEST(watchdog_cuts_and_brakes);
    TEST(falls_silent);
    TEST(falls_idle_without_an_error);
    TEST(reboots_and_forgets_turns);
    TEST(a_jam_becomes_a_stall);
    TEST(overheats);
    return check_finish();
}
