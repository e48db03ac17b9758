/// The slcan driver through a real serial line: a USB adapter under the kernel's own driver for it,
/// and at the other end of the cable a second one that the kernel's slcan makes a CAN interface of.
/// The kernel's parser and printer of that text share nothing with ours.
///
/// Usage: linux_slcan TTY LINK, TTY ours, LINK the interface at the other end.
#include "linux/linux_slcan.h"
#include "contract/support/can_suite.h"
#include "contract/support/contract.h"
#include "linux/linux_can.h"
#include "linux/linux_clock.h"
#include "vm/support/shell.h"

#include <limits.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#define can_frame kernel_can_frame
#include <linux/can.h>
#include <linux/can/raw.h>
#undef can_frame

#define PATIENCE_US 10000000U
#define WAITING     64U

static const char *tty, *link_name;
static char usb_device[256]; ///< its folder in sysfs
static struct linux_clock clock_;
static struct linux_slcan slcan;
static struct linux_can peer;
static int marker = -1; ///< a socket on LINK

// ---------------------------------------------------------------- the two ends

/// No frame of the suite's looks like this one.
static struct can_frame mark(uint32_t number) {
    struct can_frame frame = {.id = 0x1ABCDEF0, .flags = CAN_FRAME_EXTENDED, .length = 8};
    memcpy(frame.data, "mark", 4);
    memcpy(frame.data + 4, &number, sizeof number);
    return frame;
}

static bool is_mark(const struct can_frame *frame) {
    return frame->id == mark(0).id && memcmp(frame->data, "mark", 4) == 0;
}

/// In front of an end: frames that settle has taken out wait here, and marks are none of the
/// suite's.
struct end {
    struct hal_can hal;
    const struct hal_can *inside;
    uint32_t first, count;
    struct can_frame waiting[WAITING];
    uint32_t arrived_us[WAITING];
};
static struct end a, b;

static enum hal_status end_send(void *ctx, const struct can_frame *frame) {
    return hal_can_send(((struct end *)ctx)->inside, frame);
}
static enum hal_status end_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    struct end *end = ctx;
    struct can_frame got;
    uint32_t got_us;
    if (end->count > 0U) {
        *frame = end->waiting[end->first % WAITING];
        *at_us = end->arrived_us[end->first % WAITING];
        end->first++;
        end->count--;
        return HAL_OK;
    }
    enum hal_status status;
    do {
        status = hal_can_receive(end->inside, &got, &got_us);
    } while (status == HAL_OK && is_mark(&got));
    if (status == HAL_OK) {
        *frame = got;
        *at_us = got_us;
    }
    return status;
}
static enum hal_status end_state(void *ctx, struct hal_can_state *state) {
    return hal_can_state(((struct end *)ctx)->inside, state);
}
static enum hal_status end_filters(void *ctx, const struct hal_can_filter *filters,
                                   uint32_t count) {
    return hal_can_set_filters(((struct end *)ctx)->inside, filters, count);
}
static enum hal_status end_restart(void *ctx) {
    return hal_can_restart(((struct end *)ctx)->inside);
}

static void put_in_front(struct end *end, const struct hal_can *inside) {
    static const struct hal_can_ops ops = {end_send, end_receive, end_state, end_filters,
                                           end_restart};
    *end = (struct end){.inside = inside};
    CHECK_EQ(hal_can_bind(&end->hal, &ops, end), HAL_OK);
}

/// Takes what arrives at our end, up to a mark.
static void take_until(const struct can_frame *wanted) {
    const uint32_t since_us = hal_clock_now_us(&clock_.hal);
    bool seen = false;
    while (!seen && hal_clock_span_us(since_us, hal_clock_now_us(&clock_.hal)) < PATIENCE_US) {
        struct can_frame frame;
        uint32_t at_us;
        if (hal_can_receive(a.inside, &frame, &at_us) != HAL_OK) {
            usleep(100);
            continue;
        }
        seen = can_frame_equal(&frame, wanted);
        if (!is_mark(&frame) && CHECK(a.count < WAITING)) {
            a.waiting[(a.first + a.count) % WAITING] = frame;
            a.arrived_us[(a.first + a.count) % WAITING] = at_us;
            a.count++;
        }
    }
    CHECK(seen);
}

/// Lets the marker's socket see ours.
static void await(const struct can_frame *wanted) {
    struct kernel_can_frame got;
    do {
        if (!CHECK(recv(marker, &got, sizeof got, 0) == sizeof got)) { // it has waited long
            return;
        }
    } while ((got.can_id & CAN_EFF_MASK) != wanted->id || memcmp(got.data, wanted->data, 8) != 0);
}

/// What was sent before a mark has arrived when the mark has: one each way.
static void settle(void *context) {
    static uint32_t number;
    (void)context;
    const struct can_frame theirs = mark(++number), ours = mark(++number);
    struct kernel_can_frame frame = {.can_id = theirs.id | CAN_EFF_FLAG, .len = 8};
    memcpy(frame.data, theirs.data, 8);
    CHECK_EQ(write(marker, &frame, sizeof frame), sizeof frame);
    CHECK_EQ(hal_can_send(a.inside, &ours), HAL_OK);
    take_until(&theirs);
    await(&ours);
}

/// Heard by the other end alone, and opened before the ends, so it hears after them.
static void open_marker(void) {
    const int loop = 0;
    const struct timeval patience = {.tv_sec = PATIENCE_US / 1000000U};
    const struct sockaddr_can address = {.can_family = AF_CAN,
                                         .can_ifindex = (int)if_nametoindex(link_name)};
    marker = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    CHECK(setsockopt(marker, SOL_CAN_RAW, CAN_RAW_LOOPBACK, &loop, sizeof loop) == 0);
    CHECK(setsockopt(marker, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0);
    CHECK(bind(marker, (const struct sockaddr *)&address, sizeof address) == 0);
}

static void reset(void *context) {
    (void)context;
    linux_slcan_close(&slcan);
    linux_can_close(&peer);
    close(marker);
    open_marker();
    CHECK_EQ(linux_can_open(&peer, link_name, &clock_.hal), HAL_OK);
    CHECK_EQ(linux_slcan_open(&slcan, tty, 1000000, &clock_.hal), HAL_OK);
    put_in_front(&a, &slcan.hal);
    put_in_front(&b, &peer.hal);
    settle(NULL);
    struct can_frame frame;
    uint32_t at_us;
    while (hal_can_receive(&a.hal, &frame, &at_us) == HAL_OK ||
           hal_can_receive(&b.hal, &frame, &at_us) == HAL_OK) {
    }
}

// ---------------------------------------------------------------- pulled out

static bool is_there(void) {
    struct stat about;
    return stat(tty, &about) == 0;
}

static void await_tty(bool there) {
    int tries = 3000;
    while (tries > 0 && is_there() != there) {
        usleep(10000);
        tries--;
    }
    CHECK(tries > 0);
}

/// In the middle of traffic both ways: every call says that it has gone, and then it is opened anew
/// under its old name.
static void pulled_out_and_back(void) {
    for (uint32_t round = 0; round < 3U; round++) {
        reset(NULL);
        const struct can_frame sent = {.id = 0x141, .length = 8, .data = {0xA4, (uint8_t)round}};
        struct can_frame got;
        struct hal_can_state state;
        uint32_t at_us, ends = 0;
        for (uint32_t i = 0; i < 20U; i++) { // what is not read yet may be lost, but nothing hangs
            CHECK_EQ(hal_can_send(&a.hal, &sent), HAL_OK);
            (void)!hal_can_send(&b.hal, &sent);
        }
        shell("echo 0 >%s/authorized", usb_device);
        enum hal_status status = HAL_OK;
        while (status != HAL_ERROR_GONE && ends < 30000U) {
            status = hal_can_receive(&a.hal, &got, &at_us);
            CHECK(status == HAL_OK || status == HAL_EMPTY || status == HAL_ERROR_GONE);
            ends += status != HAL_OK;
            usleep(status == HAL_EMPTY ? 1000 : 0);
        }
        CHECK_EQ(status, HAL_ERROR_GONE);
        CHECK(strstr(slcan.error.line, "the device has left; plug it in again") != NULL);
        CHECK_EQ(hal_can_send(&a.hal, &sent), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_state(&a.hal, &state), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_restart(&a.hal), HAL_ERROR_GONE);
        linux_slcan_close(&slcan);
        await_tty(false);
        CHECK_EQ(linux_slcan_open(&slcan, tty, 1000000, &clock_.hal), HAL_ERROR_GONE);
        shell("echo 1 >%s/authorized", usb_device);
        await_tty(true); // not another name: it had been closed
        reset(NULL);
        CHECK_EQ(hal_can_send(&a.hal, &sent), HAL_OK);
        CHECK_EQ(hal_can_send(&b.hal, &sent), HAL_OK);
        settle(NULL);
        CHECK(hal_can_receive(&b.hal, &got, &at_us) == HAL_OK && can_frame_equal(&got, &sent));
        CHECK(hal_can_receive(&a.hal, &got, &at_us) == HAL_OK && can_frame_equal(&got, &sent));
    }
}

static bool find_usb_device(void) {
    char path[128], folder[PATH_MAX];
    snprintf(path, sizeof path, "/sys/class/tty/%s/device/../..", strrchr(tty, '/') + 1);
    return realpath(path, folder) != NULL &&
           snprintf(usb_device, sizeof usb_device, "%s", folder) < (int)sizeof usb_device;
}

int main(int argc, char **argv) {
    if (argc != 3) {
        fprintf(stderr, "usage: linux_slcan TTY LINK\n");
        return 2;
    }
    tty = argv[1];
    link_name = argv[2];
    linux_clock_open(&clock_, UINT32_MAX - 1000000U);
    slcan.serial.fd = peer.fd = peer.error_fd = -1;
    CHECK(find_usb_device());
    reset(NULL);
    can_suite(&(struct can_fixture){.name = "linux_slcan_usb",
                                    .a = &a.hal,
                                    .b = &b.hal,
                                    .reset = reset,
                                    .settle = settle,
                                    .share = 20});
    CONTRACT("linux_slcan_usb", pulled_out_and_back);
    linux_slcan_close(&slcan);
    linux_can_close(&peer);
    return check_finish();
}
