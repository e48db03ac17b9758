/// The SocketCAN driver on an adapter that can break: a two-channel gs_usb (candleLight) device,
/// emulated below the kernel's USB stack, with its channels on one bus. Bus-off, restart, a bus
/// that carries nothing, unplugging: by the kernel's own gs_usb driver.
#include "contract/support/candle_model.h"
#include "contract/support/contract.h"
#include "linux/linux_can.h"
#include "linux/linux_clock.h"
#include "vm/support/shell.h"
#include "vm/support/usb_port.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// ---------------------------------------------------------------- plugging

static struct candle_bus *bus;
static struct candle adapter; ///< its copy in a child process serves
static struct usb_port port;
static struct linux_clock clock_;
static struct linux_can a, b;
static char names[2][LINUX_CAN_NAME_BYTES];

static bool find_names(void) {
    glob_t found = {0};
    const bool there =
        glob("/sys/bus/usb/drivers/gs_usb/*/net/*", 0, NULL, &found) == 0 && found.gl_pathc == 2U;
    for (size_t i = 0; there && i < 2U; i++) {
        snprintf(names[i], sizeof names[i], "%.15s", strrchr(found.gl_pathv[i], '/') + 1);
    }
    globfree(&found);
    return there;
}

static void plug(void) {
    adapter = (struct candle){.bus = bus, .channel_count = 2};
    const struct usb_model model = {.device = candle_device,
                                    .configuration = candle_configuration,
                                    .strings = {"emulated", "gs_usb", "0001"},
                                    .speed = USB_FULL_SPEED,
                                    .ctx = &adapter,
                                    .control = candle_control,
                                    .bulk_out = candle_bulk_out,
                                    .bulk_in = candle_bulk_in};
    memset(bus, 0, sizeof *bus);
    usb_port_plug(&port, 1, &model);
    int tries = 1000;
    while (tries > 0 && !find_names()) {
        usleep(10000);
        tries--;
    }
    CHECK(tries > 0);
    shell(
        "ip link set %s up type can bitrate 1000000 && ip link set %s up type can bitrate 1000000",
        names[0], names[1]);
}

static void open_both(void) {
    CHECK_EQ(linux_can_open(&a, names[0], &clock_.hal), HAL_OK);
    CHECK_EQ(linux_can_open(&b, names[1], &clock_.hal), HAL_OK);
}

/// Frames that the drivers were given, and those that have got to the adapters.
static unsigned sent_count;

static unsigned taken_count(void) {
    return bus->node[0].taken + bus->node[1].taken;
}

/// The bus carries until all that was sent has arrived (unless it got lost), and nothing has moved
/// for a while.
static void settle(void) {
    unsigned before;
    bus->carries = true;
    for (int ms = 0; ms < 3000 && taken_count() != sent_count; ms++) {
        usleep(1000);
    }
    do {
        before = taken_count();
        usleep(60000);
    } while (taken_count() != before || bus->held_count > 0U ||
             bus->node[0].waiting + bus->node[1].waiting > 0U);
    sent_count = taken_count();
    bus->carries = false;
}

static struct can_frame numbered(uint32_t number) {
    return (struct can_frame){
        .id = 0x141, .length = 4, .data = {number & 255U, number >> 8 & 255U, 0xA5, 0x5A}};
}

/// On a busy machine a frame may take longer than the pause that `settle` takes for rest.
static void expect(const struct linux_can *can, uint32_t number) {
    struct can_frame got, wanted = numbered(number);
    uint32_t at_us;
    enum hal_status status = hal_can_receive(&can->hal, &got, &at_us);
    for (int tries = 0; status == HAL_EMPTY && tries < 3000; tries++) {
        bus->carries = true;
        usleep(10000);
        status = hal_can_receive(&can->hal, &got, &at_us);
    }
    bus->carries = false;
    CHECK_EQ(status, HAL_OK);
    CHECK(can_frame_equal(&got, &wanted));
}

static void expect_nothing(const struct linux_can *can) {
    struct can_frame got;
    uint32_t at_us;
    CHECK_EQ(hal_can_receive(&can->hal, &got, &at_us), HAL_EMPTY);
}

static enum hal_status send(const struct linux_can *can, uint32_t number) {
    const struct can_frame frame = numbered(number);
    const enum hal_status status = hal_can_send(&can->hal, &frame);
    sent_count += status == HAL_OK ? 1U : 0U;
    return status;
}

// ---------------------------------------------------------------- tests

static void frames_cross(void) {
    for (uint32_t i = 0; i < 5U; i++) {
        CHECK_EQ(send(&a, i), HAL_OK);
        CHECK_EQ(send(&b, 100U + i), HAL_OK);
    }
    settle();
    for (uint32_t i = 0; i < 5U; i++) {
        expect(&b, i);
        expect(&a, 100U + i);
    }
    expect_nothing(&a);
    expect_nothing(&b);
}

/// Nobody takes frames from the queue: ENOBUFS is "not now". Then all that was taken arrives.
static void full_queue_is_busy(void) {
    uint32_t taken = 0;
    enum hal_status status = HAL_OK;
    for (int idle = 0; idle < 20 && taken < 1000U;) { // the kernel fetches some in the background
        status = send(&a, taken);
        taken += status == HAL_OK;
        idle = status == HAL_OK ? 0 : idle + 1;
        usleep(status == HAL_OK ? 0 : 5000);
    }
    CHECK_EQ(status, HAL_BUSY);
    check_note("frames that wait in the kernel", taken);
    CHECK(taken >= 10U && taken < 1000U);
    settle();
    for (uint32_t i = 0; i < taken && check_clean(); i++) {
        expect(&b, i);
    }
    CHECK_EQ(send(&a, taken), HAL_OK);
    settle();
    expect(&b, taken);
}

static struct hal_can_state state_of(const struct linux_can *can) {
    struct hal_can_state state = {.health = HAL_CAN_ACTIVE};
    CHECK_EQ(hal_can_state(&can->hal, &state), HAL_OK);
    return state;
}

/// As tests/contract/support/can_suite.c has it, which would take too long here as a whole.
static void bus_off_and_restart(void) {
    for (uint32_t round = 0; round < 3U; round++) {
        CHECK_EQ(send(&b, 1), HAL_OK);
        settle();
        CHECK_EQ(send(&a, 2), HAL_OK); // waits, and is lost with the bus
        usleep(50000);
        bus->node[0].bus_off_wanted = true;
        usleep(200000);
        CHECK_EQ(state_of(&a).health, HAL_CAN_OFF);
        CHECK_EQ(state_of(&a).transmit_error_count, 256);
        CHECK_EQ(send(&a, 3), HAL_ERROR_DOWN);
        settle();
        CHECK_EQ(state_of(&a).health, HAL_CAN_OFF); // not by itself
        expect(&a, 1);                              // had arrived before
        expect_nothing(&a);
        expect_nothing(&b);
        CHECK_EQ(hal_can_restart(&a.hal), HAL_OK);
        CHECK_EQ(hal_can_restart(&a.hal), HAL_OK);
        settle();
        CHECK_EQ(state_of(&a).health, HAL_CAN_ACTIVE);
        expect_nothing(&b);
        CHECK_EQ(send(&a, 4), HAL_OK);
        CHECK_EQ(send(&b, 5), HAL_OK);
        settle();
        expect(&b, 4);
        expect(&a, 5);
    }
}

static void await_departure(const struct linux_can *can) {
    struct can_frame frame;
    uint32_t at_us;
    int tries = 500;
    while (tries > 0 && hal_can_receive(&can->hal, &frame, &at_us) != HAL_ERROR_GONE) {
        usleep(10000);
        tries--;
    }
    CHECK(tries > 0);
}

static void unplugged_and_back(void) {
    CHECK_EQ(send(&a, 1), HAL_OK);
    usb_port_unplug(&port);
    await_departure(&a);
    await_departure(&b); // the kernel takes away one after the other
    CHECK_EQ(send(&a, 2), HAL_ERROR_GONE);
    CHECK_EQ(send(&b, 2), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_restart(&a.hal), HAL_ERROR_GONE);
    CHECK(strstr(a.error.line, ": the interface has gone; plug the adapter in again") != NULL);
    linux_can_close(&a);
    linux_can_close(&b);
    plug();
    open_both();
    frames_cross();
}

int main(void) {
    linux_clock_open(&clock_, 0);
    a.fd = b.fd = a.error_fd = b.error_fd = -1;
    bus = usb_port_share(sizeof *bus);
    plug();
    open_both();
    CONTRACT("gs_usb", frames_cross);
    CONTRACT("gs_usb", full_queue_is_busy);
    CONTRACT("gs_usb", bus_off_and_restart);
    CONTRACT("gs_usb", unplugged_and_back);
    linux_can_close(&a);
    linux_can_close(&b);
    usb_port_unplug(&port);
    return check_finish();
}
