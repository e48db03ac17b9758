/// Reading buses from a rig file; a serial adapter that leaves.
#include "rig_bus.h"

#include "check.h"
#include "linux/linux_clock.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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
}

/// Held open, it would come back under another name.
static void a_serial_adapter_that_leaves_is_let_go(void) {
    static struct rig_buses buses;
    static struct rig rig;
    static char text[80];
    struct linux_clock clock;
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    CHECK(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    snprintf(text, sizeof text, "slcan:%s", ptsname(master));
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        rig.controller.axis[axis].drive =
            (struct drive_config){.kind = DRIVE_RMD, .rmd = {.id = (uint8_t)(axis + 1U)}};
        rig.bus[axis] = text;
    }
    linux_clock_open(&clock, 0);
    CHECK(rig_buses_find(&buses, &rig, &clock.hal));
    CHECK_EQ(rig_buses_open(&buses), HAL_OK);
    CHECK(rig_buses_newly_lost(&buses) == NULL);
    close(master);
    struct can_frame frame;
    uint32_t at_us;
    CHECK_EQ(hal_can_receive(buses.hal, &frame, &at_us), HAL_ERROR_GONE);
    const char *line = rig_buses_newly_lost(&buses);
    CHECK(line != NULL && strstr(line, "the device has left; plug it in again") != NULL);
    CHECK_EQ(buses.bus[0].slcan.serial.fd, -1);
    CHECK(rig_buses_incomplete(&buses));
    rig_buses_close(&buses);
}

int main(void) {
    TEST(texts_that_are_buses);
    TEST(texts_that_are_none);
    TEST(a_serial_adapter_that_leaves_is_let_go);
    return check_finish();
}
