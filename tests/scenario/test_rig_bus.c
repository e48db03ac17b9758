/// Reading buses from a rig file; one bus and two of them, of slcan adapters on pseudo-terminals.
#include "rig_bus.h"

#include "check.h"
#include "linux/linux_clock.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

static void texts_that_are_buses(void) {
    static const struct {
        const char *text;
        struct rig_bus_address wanted;
    } cases[] = {
        {"can:can0", {RIG_BUS_SOCKETCAN, "can0", 0, 1000000}},
        {"slcan:/dev/ttyACM0", {RIG_BUS_SLCAN, "/dev/ttyACM0", 0, 1000000}},
        {"slcan:/dev/serial/by-id/usb-x:0@500000",
         {RIG_BUS_SLCAN, "/dev/serial/by-id/usb-x:0", 0, 500000}},
        {"gs_usb", {RIG_BUS_GS_USB, "", 0, 1000000}},
        {"gs_usb@250000", {RIG_BUS_GS_USB, "", 0, 250000}},
        {"gs_usb/1", {RIG_BUS_GS_USB, "", 1, 1000000}},
        {"gs_usb:003A00205250", {RIG_BUS_GS_USB, "003A00205250", 0, 1000000}},
        {"gs_usb:A/255@125000", {RIG_BUS_GS_USB, "A", 255, 125000}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct rig_bus_address got;
        CHECK(rig_bus_parse(cases[i].text, &got));
        CHECK_EQ(got.kind, cases[i].wanted.kind);
        CHECK(strcmp(got.path, cases[i].wanted.path) == 0);
        CHECK_EQ(got.channel, cases[i].wanted.channel);
        CHECK_EQ(got.bitrate, cases[i].wanted.bitrate);
    }
}

static void texts_that_are_none(void) {
    static const char *const bad[] = {"",
                                      "can",
                                      "can:",
                                      "CAN:can0",
                                      "slcan",
                                      "slcan:",
                                      "slcan:x@",
                                      "slcan:x@0",
                                      "slcan:x@5k",
                                      "slcan:x@-1",
                                      "gs_usb:",
                                      "gs_usb/",
                                      "gs_usb/x",
                                      "gs_usb/256",
                                      "gs_usb@",
                                      "gs_usb@1/1",
                                      "gs_usb:a/1@",
                                      "gs_usb:a/1x",
                                      "gs_usbs:a",
                                      "gs_us",
                                      "fake",
                                      "slcan:x@99999999999",
                                      "gs_usb:/1",
                                      "gs_usb:@500000",
                                      "gs_usb@ 500000"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct rig_bus_address got;
        if (!CHECK(!rig_bus_parse(bad[i], &got))) {
            printf("  %s\n", bad[i]);
        }
    }
    char text[600] = "gs_usb:";
    memset(text + 7, 'x', 500);
    struct rig_bus_address got;
    CHECK(!rig_bus_parse(text, &got));
    text[7 + sizeof got.path] = '\0';
    CHECK(!rig_bus_parse(text, &got));
    text[7 + sizeof got.path - 1U] = '\0'; // the longest that has room
    CHECK(rig_bus_parse(text, &got) && strcmp(got.path, text + 7) == 0);
}

// ---------------------------------------------------------------- adapters on pseudo-terminals

static struct rig_buses buses;
static struct rig rig;
static struct linux_clock clock_;
static int master[AXIS_COUNT];
static char text[AXIS_COUNT][80];

static int plug_in(char *bus, size_t size) {
    const int end = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    CHECK(end >= 0 && grantpt(end) == 0 && unlockpt(end) == 0);
    snprintf(bus, size, "slcan:%s", ptsname(end));
    return end;
}

/// So many buses of two drives, pan's and tilt's; they are numbers 1 and 2, and answer on 0x241
/// and 0x242.
static void open_buses(unsigned count) {
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        const unsigned own = count == 1U ? AXIS_PAN : axis;
        if (own == axis) {
            master[own] = plug_in(text[own], sizeof text[own]);
        }
        rig.controller.axis[axis].drive = (struct drive_config){
            .kind = DRIVE_RMD, .rmd = {.id = (uint8_t)(axis + 1U), .reply_offset = 0x100}};
        rig.bus[axis] = text[own];
    }
    linux_clock_open(&clock_, 0);
    CHECK(rig_buses_find(&buses, &rig, &clock_.hal));
    CHECK_EQ(buses.count, count);
    CHECK_EQ(rig_buses_open(&buses), HAL_OK);
    CHECK(rig_buses_newly_lost(&buses) == NULL && !rig_buses_incomplete(&buses));
}

/// What an adapter has heard since the last time; the kernel takes its time.
static void expect_heard(unsigned axis, const char *wanted) {
    char heard[256];
    size_t size = 0;
    struct pollfd end = {.fd = master[axis], .events = POLLIN};
    while (size < strlen(wanted) && poll(&end, 1, 30000) == 1) {
        const ssize_t got = read(master[axis], heard + size, sizeof heard - 1U - size);
        if (got <= 0) {
            break;
        }
        size += (size_t)got;
    }
    heard[size] = '\0';
    if (!CHECK(strcmp(heard, wanted) == 0)) {
        printf("  heard %s\n", heard);
    }
}

/// An adapter says something; returns when its driver can read it.
static void say(unsigned axis, const char *said) {
    const int fd = buses.bus[axis].slcan.serial.fd;
    int readable = 0;
    CHECK_EQ(write(master[axis], said, strlen(said)), strlen(said));
    for (int i = 0; i < 300000 && readable < (int)strlen(said); i++) {
        CHECK_EQ(ioctl(fd, FIONREAD, &readable), 0);
        usleep(readable < (int)strlen(said) ? 100 : 0);
    }
    CHECK_EQ(readable, (int)strlen(said));
}

static void refuse(unsigned axis) {
    say(axis, "\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a\a");
}

static enum hal_status send(uint32_t id) {
    const struct can_frame frame = {.id = id, .length = 1, .data = {0x92}};
    return hal_can_send(buses.hal, &frame);
}

/// The next frame's identifier; otherwise less than 0: the status.
static int receive(void) {
    struct can_frame frame;
    uint32_t at_us;
    const enum hal_status status = hal_can_receive(buses.hal, &frame, &at_us);
    return status == HAL_OK ? (int)frame.id : (int)status;
}

static struct hal_can_state state_of(void) {
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    CHECK_EQ(hal_can_state(buses.hal, &state), HAL_OK);
    return state;
}

#define OPENING "\r\rC\rS8\rO\rF\r"

/// Held open, it would come back under another name.
static void a_serial_adapter_that_leaves_is_let_go(void) {
    open_buses(1);
    expect_heard(AXIS_PAN, OPENING);
    CHECK_EQ(send(0x142), HAL_OK);
    expect_heard(AXIS_PAN, "t142192\r");
    say(AXIS_PAN, "t2410\rt1410\rt2420\rT000002410\rr2410\r"); // replies, and what is none
    CHECK_EQ(receive(), 0x241);
    CHECK_EQ(receive(), 0x242);
    CHECK_EQ(receive(), HAL_EMPTY);
    refuse(AXIS_PAN);
    CHECK_EQ(receive(), HAL_EMPTY);
    CHECK_EQ(state_of().health, HAL_CAN_OFF);
    CHECK_EQ(send(0x141), HAL_ERROR_DOWN);
    CHECK_EQ(hal_can_restart(buses.hal), HAL_OK);
    expect_heard(AXIS_PAN, OPENING);
    close(master[AXIS_PAN]);
    CHECK_EQ(receive(), HAL_ERROR_GONE);
    const char *line = rig_buses_newly_lost(&buses);
    CHECK(line != NULL && strstr(line, "the device has left; plug it in again") != NULL);
    CHECK(line != NULL && strncmp(line, text[AXIS_PAN] + 6, strlen(text[AXIS_PAN] + 6)) == 0);
    CHECK(rig_buses_newly_lost(&buses) == NULL);
    CHECK_EQ(buses.bus[0].slcan.serial.fd, -1);
    CHECK(rig_buses_incomplete(&buses));
    struct hal_can_state state;
    CHECK_EQ(send(0x141), HAL_ERROR_GONE);
    CHECK_EQ(receive(), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_state(buses.hal, &state), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_restart(buses.hal), HAL_ERROR_GONE);
    rig_buses_close(&buses);
}

/// A request goes to the bus of its drive; replies come of both, and of each only its own drive's.
static void two_buses_look_like_one(void) {
    open_buses(2);
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        expect_heard(axis, OPENING);
    }
    CHECK_EQ(send(0x142), HAL_OK);
    expect_heard(AXIS_TILT, "t142192\r");
    CHECK_EQ(send(0x141), HAL_OK);
    expect_heard(AXIS_PAN, "t141192\r");
    CHECK_EQ(send(0x143), HAL_ERROR_ARGUMENT);
    CHECK_EQ(send(0x142), HAL_OK);
    expect_heard(AXIS_TILT, "t142192\r"); // and of 0x141 nothing before it
    CHECK_EQ(buses.dropped, 0);

    say(AXIS_PAN, "t2420\rt2410\r");
    say(AXIS_TILT, "t2410\rt2420\r");
    CHECK_EQ(receive() + receive(), 0x241 + 0x242);
    CHECK_EQ(receive(), HAL_EMPTY);
    CHECK_EQ(hal_can_set_filters(buses.hal, NULL, 0), HAL_ERROR_UNSUPPORTED);
    rig_buses_close(&buses);
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        expect_heard(axis, "C\r");
        struct pollfd end = {.fd = master[axis]};
        CHECK(poll(&end, 1, 30000) == 1 && (end.revents & POLLHUP) != 0); // nobody has it open
        close(master[axis]);
    }
}

/// The state is that of the worse one; what both lost is added up. Overruns and errors as the
/// adapters tell them.
static void the_state_of_two_buses(void) {
    open_buses(2);
    say(AXIS_PAN, "F08\rF08\r");
    say(AXIS_TILT, "F08\rF08\rF08\r");
    CHECK_EQ(receive(), HAL_EMPTY);
    CHECK_EQ(state_of().lost_count, 5);
    CHECK_EQ(state_of().health, HAL_CAN_ACTIVE);
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        say(axis, "F20\r");
        CHECK_EQ(receive(), HAL_EMPTY);
        CHECK_EQ(state_of().health, HAL_CAN_PASSIVE);
        CHECK_EQ(state_of().transmit_error_count, 128);
        CHECK_EQ(state_of().lost_count, 5);
        say(axis, "F00\r");
        CHECK_EQ(receive(), HAL_EMPTY);
        CHECK_EQ(state_of().health, HAL_CAN_ACTIVE);
    }
    rig_buses_close(&buses);
    close(master[AXIS_PAN]);
    close(master[AXIS_TILT]);
}

/// One is off: what it does not take is dropped and counted, it is restarted, and the other goes
/// on.
static void one_of_two_buses_is_off(void) {
    for (unsigned off = AXIS_PAN; off <= AXIS_TILT; off++) {
        const unsigned other = AXIS_PAN + AXIS_TILT - off;
        open_buses(2);
        expect_heard(off, OPENING);
        expect_heard(other, OPENING);
        refuse(off);
        CHECK_EQ(receive(), HAL_EMPTY);
        CHECK_EQ(state_of().health, HAL_CAN_OFF);
        CHECK_EQ(send(0x141U + other), HAL_OK);
        CHECK_EQ(buses.dropped, 0);
        CHECK_EQ(send(0x141U + off), HAL_OK);
        CHECK_EQ(buses.dropped, 1);
        expect_heard(off, OPENING);
        CHECK_EQ(state_of().health, HAL_CAN_ACTIVE);
        CHECK_EQ(send(0x141U + off), HAL_OK);
        CHECK_EQ(buses.dropped, 1);
        expect_heard(off, off == AXIS_PAN ? "t141192\r" : "t142192\r");
        expect_heard(other, off == AXIS_PAN ? "t142192\r" : "t141192\r");
        refuse(off);
        CHECK_EQ(receive(), HAL_EMPTY);
        CHECK_EQ(hal_can_restart(buses.hal), HAL_OK);
        expect_heard(off, OPENING);
        CHECK_EQ(state_of().health, HAL_CAN_ACTIVE);
        rig_buses_close(&buses);
        close(master[off]);
        close(master[other]);
    }
}

/// One has gone: all tell so, the other's frames come and go; it is opened anew.
static void one_of_two_buses_leaves(void) {
    for (unsigned lost = AXIS_PAN; lost <= AXIS_TILT; lost++) {
        const unsigned other = AXIS_PAN + AXIS_TILT - lost;
        struct hal_can_state state;
        open_buses(2);
        expect_heard(other, OPENING);
        close(master[lost]);
        CHECK_EQ(receive(), HAL_ERROR_GONE);
        const char *line = rig_buses_newly_lost(&buses);
        CHECK(line != NULL && strncmp(line, text[lost] + 6, strlen(text[lost] + 6)) == 0);
        CHECK(rig_buses_newly_lost(&buses) == NULL && rig_buses_incomplete(&buses));
        CHECK_EQ(hal_can_state(buses.hal, &state), HAL_ERROR_GONE);
        say(other, other == AXIS_PAN ? "t2410\r" : "t2420\r");
        CHECK_EQ(receive(), 0x241 + (int)other);
        CHECK_EQ(receive(), HAL_ERROR_GONE);
        CHECK_EQ(send(0x141U + lost), HAL_OK);
        CHECK_EQ(buses.dropped, 1);
        CHECK_EQ(send(0x141U + other), HAL_OK);
        expect_heard(other, other == AXIS_PAN ? "t141192\r" : "t142192\r");
        refuse(other);
        CHECK_EQ(receive(), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_restart(buses.hal), HAL_ERROR_GONE);
        expect_heard(other, OPENING); // restarted all the same

        CHECK(!rig_bus_reopen(&buses, &buses.bus[lost])); // still away
        master[lost] = plug_in(text[lost], sizeof text[lost]);
        CHECK(rig_bus_parse(text[lost], &buses.bus[lost].address)); // under another name, here
        CHECK(rig_bus_reopen(&buses, &buses.bus[lost]));
        buses.bus[lost].lost = false;
        CHECK(!rig_buses_incomplete(&buses) && rig_buses_newly_lost(&buses) == NULL);
        expect_heard(lost, OPENING);
        CHECK_EQ(send(0x141U + lost), HAL_OK);
        expect_heard(lost, lost == AXIS_PAN ? "t141192\r" : "t142192\r");
        CHECK_EQ(hal_can_state(buses.hal, &state), HAL_OK);
        rig_buses_close(&buses);
        close(master[lost]);
        close(master[other]);
    }
}

/// An axis whose drive needs no bus has none; a rig of such axes neither.
static void axes_without_a_bus(void) {
    open_buses(2);
    rig_buses_close(&buses);
    rig.controller.axis[AXIS_TILT].drive = (struct drive_config){.kind = DRIVE_PWM};
    CHECK(rig_buses_find(&buses, &rig, &clock_.hal));
    CHECK_EQ(rig_buses_open(&buses), HAL_OK);
    CHECK_EQ(buses.count, 1);
    CHECK_EQ(send(0x141), HAL_OK);
    rig_buses_close(&buses);
    rig.controller.axis[AXIS_PAN].drive = (struct drive_config){.kind = DRIVE_PWM};
    CHECK(rig_buses_find(&buses, &rig, &clock_.hal));
    CHECK_EQ(rig_buses_open(&buses), HAL_OK);
    CHECK(buses.hal == NULL && rig_buses_newly_lost(&buses) == NULL &&
          !rig_buses_incomplete(&buses));
    rig_buses_close(&buses);
    close(master[AXIS_PAN]);
    close(master[AXIS_TILT]);
}

/// The second one is missing: its line is told, and the first one let go of.
static void a_bus_that_can_not_be_opened(void) {
    open_buses(2);
    rig_buses_close(&buses);
    expect_heard(AXIS_PAN, OPENING "C\r");
    snprintf(text[AXIS_TILT], sizeof text[AXIS_TILT], "slcan:/dev/ttyNONE7");
    CHECK(rig_buses_find(&buses, &rig, &clock_.hal));
    CHECK_EQ(rig_buses_open(&buses), HAL_ERROR_GONE);
    CHECK(strncmp(buses.error.line, "/dev/ttyNONE7: no such file", 27) == 0);
    rig_buses_close(&buses);
    expect_heard(AXIS_PAN, OPENING "C\r");
    close(master[AXIS_PAN]);
    close(master[AXIS_TILT]);
}

int main(void) {
    TEST(texts_that_are_buses);
    TEST(texts_that_are_none);
    TEST(a_serial_adapter_that_leaves_is_let_go);
    TEST(two_buses_look_like_one);
    TEST(the_state_of_two_buses);
    TEST(one_of_two_buses_is_off);
    TEST(one_of_two_buses_leaves);
    TEST(axes_without_a_bus);
    TEST(a_bus_that_can_not_be_opened);
    return check_finish();
}
