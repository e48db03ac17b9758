/// The gs_usb driver on adapters that are plugged into the kernel's own USB stack: between two of
/// them, and against the kernel's own driver of the same adapters as a peer that shares no code.
/// Needs the kernel module gs_usb for the peer.
#include "linux/linux_gs_usb.h"
#include "contract/support/can_suite.h"
#include "contract/support/candle_model.h"
#include "contract/support/contract.h"
#include "contract/support/failing_can.h"
#include "contract/support/syscalls.h"
#include "linux/linux_can.h"
#include "linux/linux_clock.h"
#include "vm/support/nobody.h"
#include "vm/support/shell.h"
#include "vm/support/usb_port.h"

#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PEER_SERIAL "0003"

static struct linux_clock clock_;
static struct candle_bus *bus;
static struct candle adapters[3]; ///< nodes 0, 1: ours; 2: the kernel's
static struct usb_port ports[3];
static struct linux_gs_usb a, b;
static struct failing_can failing; ///< in front of a
static const char *const serials[] = {"0001", "0002", PEER_SERIAL};

static uint32_t adapter_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)((uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U) + 77777U;
}

static void plug(unsigned number) {
    adapters[number] = (struct candle){
        .bus = bus, .first_node = number, .channel_count = 1, .features = 16, .now_us = adapter_us};
    const struct usb_model model = {.device = candle_device,
                                    .configuration = candle_configuration,
                                    .strings = {"emulated", "gs_usb", serials[number]},
                                    .speed = USB_FULL_SPEED,
                                    .ctx = &adapters[number],
                                    .control = candle_control,
                                    .bulk_out = candle_bulk_out,
                                    .bulk_in = candle_bulk_in};
    if (ports[number].child == 0) {
        usb_port_plug(&ports[number], number, &model);
    }
}

/// As soon as the kernel has looked at it.
static void open_end(struct linux_gs_usb *gs, unsigned number) {
    enum hal_status status = HAL_ERROR_GONE;
    for (int i = 0; i < 1000 && status != HAL_OK; i++) {
        status = linux_gs_usb_open(gs, serials[number], 0, 1000000, &clock_.hal);
        usleep(status == HAL_OK ? 0 : 10000);
    }
    if (!CHECK_EQ(status, HAL_OK)) {
        printf("  %s\n", gs->error.line);
    }
}

// ---------------------------------------------------------------- hands

/// Whether an end and its adapter have told each other everything.
static bool is_quiet(struct linux_gs_usb *gs, unsigned number) {
    struct hal_can_state state;
    const struct candle_node *node = &bus->node[number];
    (void)!hal_can_state(&gs->hal, &state);
    bool under_way = gs->control.status == HAL_BUSY || gs->waiting;
    for (unsigned i = 0; i < LINUX_GS_USB_SLOTS; i++) {
        under_way = under_way || gs->slot[i].transfer.status == HAL_BUSY;
    }
    return !under_way && node->waiting == 0U && node->given == gs->given_count;
}

static void settle(void *context) {
    (void)context;
    bus->carries = true;
    const uint32_t start_us = hal_clock_now_us(&clock_.hal);
    bool quiet = false;
    while (!quiet && hal_clock_now_us(&clock_.hal) - start_us < 30000000U) {
        const bool first = is_quiet(&a, 0), second = is_quiet(&b, 1);
        quiet = first && second && bus->held_count == 0U && bus->node[0].waiting == 0U &&
                bus->node[1].waiting == 0U && is_quiet(&a, 0) && is_quiet(&b, 1);
        usb_port_kick(&ports[0]);
        usb_port_kick(&ports[1]);
        usleep(200);
    }
    CHECK(quiet);
    bus->carries = false;
}

/// Every call of the kernel, below libusb.
static void fail_kernel(bool on) {
    syscalls_at(on ? 1 : 0, SYSCALLS_FAIL_ON, EIO);
}

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    return failing_can_at(&failing, nth, status);
}

static void reset(void *context) {
    (void)context;
    linux_gs_usb_close(&a);
    linux_gs_usb_close(&b);
    for (unsigned i = 0; i < CANDLE_NODES; i++) {
        bus->node[i].waiting = bus->node[i].given = 0;
    }
    open_end(&a, 0);
    open_end(&b, 1);
    failing_can_init(&failing, &a.hal, fail_kernel);
}

static void bus_off(void *context) {
    (void)context;
    const unsigned starts = bus->node[0].starts;
    struct hal_can_state state = {.health = HAL_CAN_ACTIVE};
    bus->node[0].bus_off_wanted = true;
    for (int i = 0; i < 30000 && (state.health != HAL_CAN_OFF || bus->node[0].started); i++) {
        CHECK_EQ(hal_can_state(&a.hal, &state), HAL_OK);
        usleep(1000);
    }
    CHECK_EQ(bus->node[0].starts, starts); // it was stopped, and not started again
}

static struct can_frame numbered(uint32_t number) {
    return (struct can_frame){.id = 0x141, .length = 4, .data = {number & 255U, 2, 0xA5, 0x5A}};
}

// ---------------------------------------------------------------- the kernel's driver as a peer

static struct linux_can peer;

static bool find_peer(char name[LINUX_CAN_NAME_BYTES]) {
    glob_t found = {0};
    const bool there =
        glob("/sys/bus/usb/drivers/gs_usb/*/net/*", 0, NULL, &found) == 0 && found.gl_pathc == 1U;
    if (there) {
        snprintf(name, LINUX_CAN_NAME_BYTES, "%.15s", strrchr(found.gl_pathv[0], '/') + 1);
    }
    globfree(&found);
    return there;
}

static bool peer_hears(uint32_t number) {
    struct can_frame got = {.id = 0};
    const struct can_frame wanted = numbered(number);
    uint32_t at_us;
    int tries = 3000;
    while (tries > 0 && hal_can_receive(&peer.hal, &got, &at_us) != HAL_OK) {
        settle(NULL);
        usleep(1000);
        tries--;
    }
    return can_frame_equal(&got, &wanted);
}

static bool hears_peer(struct linux_gs_usb *gs, uint32_t number) {
    struct can_frame got = {.id = 0};
    const struct can_frame wanted = numbered(number);
    uint32_t at_us;
    bus->carries = true;
    for (int i = 0; i < 30000 && hal_can_receive(&gs->hal, &got, &at_us) != HAL_OK; i++) {
        usleep(1000);
    }
    bus->carries = false;
    return can_frame_equal(&got, &wanted);
}

/// Both kinds of driver start their adapters alike and understand each other's frames.
static void the_kernels_driver_agrees(void) {
    char name[LINUX_CAN_NAME_BYTES];
    reset(NULL);
    plug(2);
    int tries = 3000;
    while (tries > 0 && !find_peer(name)) {
        usleep(10000);
        tries--;
    }
    CHECK(tries > 0);
    shell("ip link set %s up type can bitrate 1000000", name);
    CHECK_EQ(linux_can_open(&peer, name, &clock_.hal), HAL_OK);
    for (uint32_t i = 0; i < 20U && check_clean(); i++) {
        struct can_frame frame = numbered(i);
        CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_OK);
        CHECK(peer_hears(i));
        frame = numbered(100U + i);
        CHECK_EQ(hal_can_send(&peer.hal, &frame), HAL_OK);
        CHECK(hears_peer(&a, 100U + i));
    }
    // Where a bit is sampled is a matter of taste; how long it lasts is not.
    const uint32_t *ours = bus->node[0].timing, *theirs = bus->node[2].timing;
    CHECK_EQ((1U + ours[0] + ours[1] + ours[2]) * ours[4], 48);
    CHECK_EQ((1U + theirs[0] + theirs[1] + theirs[2]) * theirs[4], 48);
    linux_can_close(&peer);
    usb_port_unplug(&ports[2]);
}

// ---------------------------------------------------------------- plugs, and lines for people

static void expect_line(const char *line) {
    if (!CHECK(strcmp(a.error.line, line) == 0)) {
        printf("  got    %s\n  wanted %s\n", a.error.line, line);
    }
}

static void unplugged_and_back(void) {
    for (int round = 0; round < 3; round++) {
        reset(NULL);
        struct can_frame frame = numbered(1), got;
        uint32_t at_us;
        for (uint32_t i = 0; i < 5U; i++) {
            CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_OK); // on their way
        }
        usb_port_unplug(&ports[0]);
        int tries = 30000;
        while (tries > 0 && hal_can_receive(&a.hal, &got, &at_us) != HAL_ERROR_GONE) {
            usleep(1000);
            tries--;
        }
        CHECK(tries > 0);
        CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_restart(&a.hal), HAL_ERROR_GONE);
        expect_line("CAN adapter 0001: the adapter has left; plug it in again");
        linux_gs_usb_close(&a);
        CHECK_EQ(linux_gs_usb_open(&a, serials[0], 0, 1000000, &clock_.hal), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_ERROR_GONE);
        bus->held_count = 0;
        plug(0);
        open_end(&a, 0);
        bus->node[0].given = 0;
        a.given_count = 0;
        CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_OK);
        settle(NULL);
        CHECK_EQ(hal_can_receive(&b.hal, &got, &at_us), HAL_OK);
        CHECK(can_frame_equal(&got, &frame));
    }
}

static void refusals_say_what_to_do(void) {
    reset(NULL);
    linux_gs_usb_close(&a);
    CHECK_EQ(linux_gs_usb_open(&a, "9999", 0, 1000000, &clock_.hal), HAL_ERROR_GONE);
    expect_line("CAN adapter 9999: no such USB device; is it plugged in? `boresight probe` "
                "lists what is there");
    CHECK_EQ(linux_gs_usb_open(&a, serials[0], 0, 999, &clock_.hal), HAL_ERROR_UNSUPPORTED);
    expect_line("CAN adapter 0001: can't do 999 bit/s; 1000000, 500000 and 250000 are usual");
    CHECK_EQ(linux_gs_usb_open(&a, serials[0], 1, 1000000, &clock_.hal), HAL_ERROR_ARGUMENT);
    expect_line("CAN adapter 0001: no channel 1, it has 1; choose another one in the rig file");
    CHECK_EQ(linux_gs_usb_open(&a, serials[1], 0, 1000000, &clock_.hal), HAL_ERROR_DENIED);
    expect_line("CAN adapter 0002: in use by another program; end that one first");
    open_end(&a, 0); // none of this has left anything behind
}

static void forbidden(void) {
    reset(NULL);
    linux_gs_usb_close(&a);
    nobody_begin();
    CHECK_EQ(linux_gs_usb_open(&a, serials[0], 0, 1000000, &clock_.hal), HAL_ERROR_DENIED);
    nobody_end();
    expect_line("CAN adapter 0001: no permission; install the udev rules of docs/rig.md, or "
                "run as root, and plug it in again");
    open_end(&a, 0);
}

int main(void) {
    if (linux_usb_library() == NULL) {
        contract_skip("linux_gs_usb", "all", "built without libusb");
        return 0;
    }
    linux_clock_open(&clock_, UINT32_MAX - 2000000U);
    bus = usb_port_share(sizeof *bus);
    memset(bus, 0, sizeof *bus);
    a.gone = b.gone = true;
    plug(0);
    plug(1);
    reset(NULL);
    can_suite(&(struct can_fixture){.name = "linux_gs_usb",
                                    .a = &failing.hal,
                                    .b = &b.hal,
                                    .clock = &clock_.hal,
                                    .reset = reset,
                                    .settle = settle,
                                    .bus_off = bus_off,
                                    .fail_at = fail_at,
                                    .share = 10, // the others in tests/contract/linux_gs_usb.c
                                    .some_cannot_fail = true, // only sending asks the adapter
                                    .receive_capacity = LINUX_GS_USB_QUEUE,
                                    .send_capacity = LINUX_GS_USB_SLOTS});
    CONTRACT("linux_gs_usb", the_kernels_driver_agrees);
    CONTRACT("linux_gs_usb", unplugged_and_back);
    CONTRACT("linux_gs_usb", refusals_say_what_to_do);
    CONTRACT("linux_gs_usb", forbidden);
    linux_gs_usb_close(&a);
    linux_gs_usb_close(&b);
    for (unsigned i = 0; i < 3U; i++) {
        usb_port_unplug(&ports[i]);
    }
    return check_finish();
}
