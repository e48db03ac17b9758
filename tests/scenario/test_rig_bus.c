/// Reading buses from a rig file.
#include "rig_bus.h"

#include "check.h"

#include <stdio.h>
#include <string.h>

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

int main(void) {
    TEST(texts_that_are_buses);
    TEST(texts_that_are_none);
    return check_finish();
}
