/// The SocketCAN driver in the virtual machine, as root: a virtual bus, and two cards on one bus.
#include "linux/linux_can.h"
#include "contract/support/can_suite.h"
#include "contract/support/contract.h"
#include "contract/support/failing_can.h"
#include "contract/support/lives.h"
#include "contract/support/syscalls.h"
#include "devices/fake_clock.h"
#include "linux/linux_clock.h"
#include "vm/support/nobody.h"
#include "vm/support/shell.h"

#include <errno.h>
#include <net/if.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#define can_frame kernel_can_frame
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#undef can_frame

static struct linux_clock clock_;
static struct linux_can a, b;

/// Two ends of a bus, and a witness at each, by which settle knows when everything has arrived.
struct pair {
    const char *a, *b;
    int witness_a, witness_b;
    bool emulated;
};

/// An end that counts what it takes.
struct counted {
    struct hal_can hal;
    const struct hal_can *inside;
    uint32_t sent;
};
static struct counted counted_a, counted_b;
static struct failing_can failing; ///< in front of that of a

static enum hal_status counted_send(void *ctx, const struct can_frame *frame) {
    struct counted *end = ctx;
    const enum hal_status status = hal_can_send(end->inside, frame);
    end->sent += status == HAL_OK;
    return status;
}
static enum hal_status counted_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    return hal_can_receive(((struct counted *)ctx)->inside, frame, at_us);
}
static enum hal_status counted_state(void *ctx, struct hal_can_state *state) {
    return hal_can_state(((struct counted *)ctx)->inside, state);
}
static enum hal_status counted_filters(void *ctx, const struct hal_can_filter *filters,
                                       uint32_t count) {
    return hal_can_set_filters(((struct counted *)ctx)->inside, filters, count);
}
static enum hal_status counted_restart(void *ctx) {
    return hal_can_restart(((struct counted *)ctx)->inside);
}

static void count(struct counted *end, const struct hal_can *inside) {
    static const struct hal_can_ops ops = {counted_send, counted_receive, counted_state,
                                           counted_filters, counted_restart};
    *end = (struct counted){.inside = inside};
    CHECK_EQ(hal_can_bind(&end->hal, &ops, end), HAL_OK);
}

static int raw_socket(const char *name) {
    const int fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    const struct sockaddr_can address = {.can_family = AF_CAN,
                                         .can_ifindex = (int)if_nametoindex(name)};
    CHECK(bind(fd, (const struct sockaddr *)&address, sizeof address) == 0);
    return fd;
}

/// Waits until a witness has seen so many frames of its own end and so many from elsewhere. A check
/// fails if one is missing for 30 s.
static void await(int witness, uint32_t own, uint32_t others) {
    while (own > 0U || others > 0U) {
        struct kernel_can_frame frame;
        struct pollfd ready = {witness, POLLIN, 0};
        struct iovec data = {&frame, sizeof frame};
        struct msghdr message = {.msg_iov = &data, .msg_iovlen = 1};
        if (!CHECK(poll(&ready, 1, 30000) == 1) || !CHECK(recvmsg(witness, &message, 0) > 0)) {
            return;
        }
        uint32_t *seen = (message.msg_flags & MSG_DONTROUTE) != 0 ? &own : &others;
        CHECK(*seen > 0U);
        *seen -= *seen > 0U;
    }
}

static void settle(void *context) {
    const struct pair *pair = context;
    if (pair->witness_a >= 0 && pair->emulated) {
        await(pair->witness_b, counted_b.sent, counted_a.sent);
        await(pair->witness_a, counted_a.sent, counted_b.sent);
    } else if (pair->witness_a >= 0) { // all that a virtual bus carries is this machine's own
        await(pair->witness_a, counted_a.sent + counted_b.sent, 0);
    }
    counted_a.sent = counted_b.sent = 0;
    // The kernel may serve the witness first.
    usleep(pair->emulated ? 1000 : 100);
}

static void fail_kernel(bool on) {
    syscalls_at(on ? 1 : 0, SYSCALLS_FAIL_ON, EIO);
}

static void reset(void *context) {
    struct pair *pair = context;
    settle(pair);
    linux_can_close(&a);
    linux_can_close(&b);
    CHECK_EQ(linux_can_open(&a, pair->a, &clock_.hal), HAL_OK);
    CHECK_EQ(linux_can_open(&b, pair->b, &clock_.hal), HAL_OK);
    count(&counted_a, &a.hal);
    count(&counted_b, &b.hal);
    failing_can_init(&failing, &counted_a.hal, fail_kernel);
}

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    return failing_can_at(&failing, nth, status);
}

static void suite_on(const char *name, struct pair *pair) {
    pair->witness_a = raw_socket(pair->a); // opened before the ends, so it hears after them
    pair->witness_b = raw_socket(pair->b);
    reset(pair);
    can_suite(&(struct can_fixture){.name = name,
                                    .a = &failing.hal,
                                    .b = &counted_b.hal,
                                    .clock = &clock_.hal,
                                    .context = pair,
                                    .reset = reset,
                                    .settle = settle,
                                    .fail_at = fail_at,
                                    .some_cannot_fail = true, // state and restart ask nobody
                                    // QEMU 7.2 forgets to leave the data of remote frames out.
                                    .remote_length_lost = pair->emulated});
    close(pair->witness_a);
    close(pair->witness_b);
    pair->witness_a = pair->witness_b = -1;
}

static struct pair virtual_bus = {.a = "vcan0", .b = "vcan0"};
static struct pair cards = {.a = "can0", .b = "can1", .emulated = true};

// ---------------------------------------------------------------- error frames, on the virtual bus

static int injector = -1;

/// A frame of the kernel's, as a driver would give it to every listener.
static void inject(uint32_t classes, const uint8_t data[8]) {
    struct kernel_can_frame frame = {.can_id = CAN_ERR_FLAG | classes, .len = 8};
    memcpy(frame.data, data, 8);
    CHECK_EQ(write(injector, &frame, sizeof frame), sizeof frame);
}

static struct hal_can_state digested(void) {
    struct can_frame frame;
    uint32_t at_us;
    settle(&virtual_bus);
    CHECK_EQ(hal_can_receive(&a.hal, &frame, &at_us), HAL_EMPTY); // never handed on
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    CHECK_EQ(hal_can_state(&a.hal, &state), HAL_OK);
    return state;
}

static void expect_state(enum hal_can_health health, int transmit, int receive) {
    const struct hal_can_state state = digested();
    CHECK_EQ(state.health, health);
    CHECK_EQ(state.transmit_error_count, transmit);
    CHECK_EQ(state.receive_error_count, receive);
}

static void error_frames_become_health(void) {
    reset(&virtual_bus);
    inject(CAN_ERR_CRTL, (const uint8_t[8]){0, CAN_ERR_CRTL_TX_PASSIVE});
    expect_state(HAL_CAN_PASSIVE, 128, 128);
    inject(CAN_ERR_CRTL | CAN_ERR_CNT,
           (const uint8_t[8]){0, CAN_ERR_CRTL_RX_PASSIVE, 0, 0, 0, 0, 97, 130});
    expect_state(HAL_CAN_PASSIVE, 97, 130);
    inject(CAN_ERR_CRTL | CAN_ERR_CNT,
           (const uint8_t[8]){0, CAN_ERR_CRTL_TX_WARNING, 0, 0, 0, 0, 99, 3});
    expect_state(HAL_CAN_ACTIVE, 99, 3);
    inject(CAN_ERR_CRTL, (const uint8_t[8]){0, CAN_ERR_CRTL_ACTIVE});
    expect_state(HAL_CAN_ACTIVE, 0, 0);
    const uint32_t lost = digested().lost_count;
    inject(CAN_ERR_CRTL, (const uint8_t[8]){0, CAN_ERR_CRTL_RX_OVERFLOW});
    CHECK_EQ(digested().lost_count, lost + 1U);
    inject(CAN_ERR_BUSOFF, (const uint8_t[8]){0});
    expect_state(HAL_CAN_OFF, 256, 0);
    const struct can_frame frame = {.id = 1};
    CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_ERROR_DOWN);
    CHECK(strncmp(a.error.line, "vcan0: bus-off; ", 16) == 0);
    inject(CAN_ERR_RESTARTED, (const uint8_t[8]){0}); // restart-ms of the administrator
    expect_state(HAL_CAN_ACTIVE, 0, 0);
    CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_OK);
}

/// A storm of error frames hides no frame, and is digested a part at a time.
static void error_frames_are_bounded(void) {
    reset(&virtual_bus);
    for (int i = 0; i < 99; i++) {
        inject(CAN_ERR_CRTL, (const uint8_t[8]){0, CAN_ERR_CRTL_ACTIVE});
    }
    inject(CAN_ERR_CRTL, (const uint8_t[8]){0, CAN_ERR_CRTL_TX_PASSIVE});
    const struct can_frame sent = {.id = 7, .length = 1, .data = {9}};
    CHECK_EQ(hal_can_send(&b.hal, &sent), HAL_OK);
    settle(&virtual_bus);
    struct can_frame got = {.id = 0};
    uint32_t at_us;
    CHECK_EQ(hal_can_receive(&a.hal, &got, &at_us), HAL_OK);
    CHECK(can_frame_equal(&got, &sent));
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    int calls = 0;
    while (calls < 10 && state.health != HAL_CAN_PASSIVE) {
        CHECK_EQ(hal_can_state(&a.hal, &state), HAL_OK);
        calls++;
    }
    CHECK_EQ(calls, 4); // 32 a call
}

/// What the socket had no room for is counted; the oldest stay.
static void overflow_is_counted(void) {
    reset(&virtual_bus);
    const uint32_t count = 3000;
    for (uint32_t i = 0; i < count; i++) {
        const struct can_frame frame = {
            .id = 0x100, .length = 4, .data = {i & 255U, i >> 8 & 255U}};
        while (hal_can_send(&b.hal, &frame) == HAL_BUSY) {
            usleep(100);
        }
    }
    usleep(20000);
    uint32_t received = 0;
    struct can_frame got;
    uint32_t at_us;
    while (hal_can_receive(&a.hal, &got, &at_us) == HAL_OK) {
        CHECK(received >= 100U || got.data[0] + 256U * got.data[1] == received);
        received++;
    }
    // The kernel tells of drops with the next frame that it delivers.
    const struct can_frame last = {.id = 0x200};
    CHECK_EQ(hal_can_send(&b.hal, &last), HAL_OK);
    settle(&virtual_bus);
    CHECK_EQ(hal_can_receive(&a.hal, &got, &at_us), HAL_OK);
    struct hal_can_state state;
    CHECK_EQ(hal_can_state(&a.hal, &state), HAL_OK);
    CHECK(received > 0U && received < count);
    CHECK_EQ(state.lost_count, count - received);
    check_note("frames that the socket holds", received);
}

// ---------------------------------------------------------------- interfaces come and go

static void link_down_and_up(struct pair *pair, const char *down, const char *up) {
    reset(pair);
    const struct can_frame frame = {.id = 5};
    struct can_frame got;
    uint32_t at_us;
    struct hal_can_state state;
    shell("%s", down);
    CHECK_EQ(hal_can_receive(&a.hal, &got, &at_us), HAL_EMPTY);
    CHECK_EQ(hal_can_state(&a.hal, &state), HAL_OK);
    CHECK_EQ(state.health, HAL_CAN_OFF);
    CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_ERROR_DOWN);
    CHECK_EQ(hal_can_restart(&a.hal), HAL_ERROR_DENIED);
    CHECK(strstr(a.error.line, ": the interface is down; sudo ip link set ") != NULL);
    shell("%s", up);
    CHECK_EQ(hal_can_restart(&a.hal), HAL_OK);
    CHECK_EQ(hal_can_state(&a.hal, &state), HAL_OK);
    CHECK_EQ(state.health, HAL_CAN_ACTIVE);
    CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_OK);
    usleep(200000); // taking a card up takes its time
    CHECK(hal_can_receive(&b.hal, &got, &at_us) == HAL_OK ||
          hal_can_receive(&b.hal, &got, &at_us) == HAL_OK); // first: that it was down
    CHECK(can_frame_equal(&got, &frame));
}

static void virtual_bus_down_and_up(void) {
    link_down_and_up(&virtual_bus, "ip link set vcan0 down", "ip link set vcan0 up");
}

static void card_down_and_up(void) {
    link_down_and_up(&cards, "ip link set can0 down", "ip link set can0 up");
}

/// Gone for good, until it is opened anew.
static void interface_leaves_and_returns(void) {
    shell("ip link add dev vcan7 type vcan && ip link set vcan7 up");
    struct linux_can late;
    CHECK_EQ(linux_can_open(&late, "vcan7", &clock_.hal), HAL_OK);
    shell("ip link del vcan7");
    struct can_frame frame = {.id = 5};
    uint32_t at_us;
    struct hal_can_state state;
    CHECK_EQ(hal_can_send(&late.hal, &frame), HAL_ERROR_GONE);
    CHECK(strncmp(late.error.line, "vcan7: the interface has gone; ", 31) == 0);
    CHECK_EQ(hal_can_receive(&late.hal, &frame, &at_us), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_state(&late.hal, &state), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_set_filters(&late.hal, &(struct hal_can_filter){0}, 1), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_restart(&late.hal), HAL_ERROR_GONE);
    linux_can_close(&late);
    CHECK_EQ(linux_can_open(&late, "vcan7", &clock_.hal), HAL_ERROR_GONE);
    shell("ip link add dev vcan7 type vcan && ip link set vcan7 up");
    CHECK_EQ(linux_can_open(&late, "vcan7", &clock_.hal), HAL_OK);
    CHECK_EQ(hal_can_send(&late.hal, &frame), HAL_OK);
    linux_can_close(&late);
    shell("ip link del vcan7");
}

/// The kernel is asked every time, but not again within 100 ms. (vcan is only taken for bus-off.)
static void restarts_are_asked_for_in_time(void) {
    struct fake_clock hand;
    struct linux_can off;
    fake_clock_init(&hand, 0);
    CHECK_EQ(linux_can_open(&off, "vcan0", &hand.hal), HAL_OK);
    for (int times = 0; times < 3; times++) {
        off.state.health = HAL_CAN_OFF;
        CHECK(hal_can_restart(&off.hal) == HAL_OK && off.state.health == HAL_CAN_ACTIVE);
        off.state.health = HAL_CAN_OFF;
        fake_clock_advance(&hand, 99999);
        CHECK(hal_can_restart(&off.hal) == HAL_OK && off.state.health == HAL_CAN_OFF);
        fake_clock_advance(&hand, 1);
    }
    linux_can_close(&off);
    CHECK(off.fd == -1 && off.error_fd == -1); // closed twice, it is nobody else's file
}

// ---------------------------------------------------------------- lines for people

static void expect_refusal(const char *name, enum hal_status status, const char *line) {
    struct linux_can refused;
    CHECK_EQ(linux_can_open(&refused, name, &clock_.hal), status);
    if (!CHECK(strcmp(refused.error.line, line) == 0)) {
        printf("  got    %s\n  wanted %s\n", refused.error.line, line);
    }
    CHECK_EQ(refused.fd, -1);
    linux_can_close(&refused);
}

static void refusals_say_what_to_do(void) {
    expect_refusal("can9", HAL_ERROR_GONE,
                   "can9: no such interface; is the adapter plugged in? `boresight probe` lists "
                   "what is there");
    expect_refusal("lo", HAL_ERROR_UNSUPPORTED,
                   "lo: not a CAN interface; `boresight probe` lists them");
    expect_refusal("", HAL_ERROR_ARGUMENT,
                   ": not the name of a network interface; name one like can0");
    expect_refusal("averylongname123", HAL_ERROR_ARGUMENT,
                   "averylongname123: not the name of a network interface; name one like can0");
    shell("ip link set vcan0 down");
    expect_refusal("vcan0", HAL_ERROR_DOWN,
                   "vcan0: the interface is down; sudo ip link set vcan0 up");
    shell("ip link set vcan0 up");
    expect_refusal("can2", HAL_ERROR_DOWN,
                   "can2: the interface is down; sudo ip link set can2 up type can bitrate "
                   "1000000");
}

// ---------------------------------------------------------------- errors at every step

/// What a life has left down. Without a process: there are many lives.
static void take_up(const char *name) {
    struct ifreq request = {.ifr_flags = 0};
    snprintf(request.ifr_name, sizeof request.ifr_name, "%s", name);
    CHECK_EQ(ioctl(injector, SIOCGIFFLAGS, &request), 0);
    if ((request.ifr_flags & IFF_UP) == 0) {
        request.ifr_flags = (short)(request.ifr_flags | IFF_UP);
        CHECK_EQ(ioctl(injector, SIOCSIFFLAGS, &request), 0);
    }
}

/// From opening to closing; in between it is taken for down, and for bus-off, so that it is
/// restarted both ways: vcan can't be, and is taken down and up.
static void live(void) {
    const struct linux_error *error = &a.error;
    const struct can_frame frame = {.id = 5, .length = 1, .data = {7}};
    struct can_frame got = {.id = 0};
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    uint32_t at_us;
    syscalls_watch(false);
    take_up("vcan0");
    syscalls_watch(true);
    if (life_note("open", linux_can_open(&a, "vcan0", &clock_.hal), error) != HAL_OK) {
        CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_ERROR_GONE);
        return;
    }
    life_note("filters", hal_can_set_filters(&a.hal, &(struct hal_can_filter){0}, 1), error);
    life_note("send", hal_can_send(&a.hal, &frame), error);
    syscalls_watch(false);
    const int other = raw_socket("vcan0"); // a new one: what is down for a moment tells all others
    CHECK_EQ(write(other, &(struct kernel_can_frame){.can_id = 9}, 16), 16);
    close(other);
    CHECK_EQ(poll(&(struct pollfd){a.fd, POLLIN, 0}, 1, 30000), 1);
    syscalls_watch(true);
    life_note("receive", hal_can_receive(&a.hal, &got, &at_us), error);
    life_value("id", got.id);
    life_note("state", hal_can_state(&a.hal, &state), error);
    life_value("health", state.health);
    for (int down = 0; down < 2; down++) {
        a.state.health = HAL_CAN_OFF;
        a.link_down = down != 0;
        life_note("restart", hal_can_restart(&a.hal), error);
        life_note("state", hal_can_state(&a.hal, &state), error);
        life_value("health", state.health);
    }
    life_note("send", hal_can_send(&a.hal, &frame), error);
    linux_can_close(&a);
    CHECK_EQ(hal_can_send(&a.hal, &frame), HAL_ERROR_GONE);
}

static void fails_at_every_step(void) {
    const struct life_error errors[] = {
        LIFE_EIO,
        LIFE_ENODEV,
        {EACCES, LIFE_STATUS(HAL_ERROR_DENIED) | LIFE_STATUS(HAL_ERROR_IO)},
        {EPERM, LIFE_STATUS(HAL_ERROR_DENIED) | LIFE_STATUS(HAL_ERROR_IO)}};
    linux_can_close(&a);
    linux_can_close(&b);
    lives_each_failure(&(struct lives){.device = "vcan0",
                                       .live = live,
                                       .errors = errors,
                                       .error_count = 4,
                                       .share_out = true,
                                       .stride = LIVES_VM_STRIDE,
                                       .recover_every = 4,
                                       .dies = true});
}

/// Whoever may use the bus may not restart it, nor anything else of the administrator's.
static void forbidden(void) {
    reset(&cards);
    nobody_begin();
    a.state.health = HAL_CAN_OFF;
    CHECK_EQ(hal_can_restart(&a.hal), HAL_ERROR_DENIED);
    CHECK(strcmp(a.error.line,
                 "can0: bus-off, and this user may not restart it; run as root, or "
                 "set restart-ms (sudo ip link set can0 type can restart-ms 100)") == 0);
    linux_can_close(&a);
    CHECK_EQ(linux_can_open(&a, "can0", &clock_.hal), HAL_OK); // which everybody may
    nobody_end();
    a.state.health = HAL_CAN_OFF; // what restart-ms restarts takes no orders, and needs none
    CHECK_EQ(hal_can_restart(&a.hal), HAL_OK);
}

static const struct linux_can_link *link_of(const struct linux_can_link *links, uint32_t count,
                                            const char *name) {
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(links[i].name, name) == 0) {
            return &links[i];
        }
    }
    return NULL;
}

static void list_tells_what_ip_link_set(void) {
    struct linux_can_link links[16];
    uint32_t count;
    struct linux_error error;
    CHECK_EQ(linux_can_list(links, 16, &count, &error), HAL_OK);
    CHECK_EQ(count, 4); // vcan0, and the three cards
    CHECK(link_of(links, count, "lo") == NULL);
    const struct linux_can_link *card = link_of(links, count, "can0");
    CHECK(card != NULL && card->up && card->has_controller && card->bitrate == 1000000U &&
          card->restart_ms == 250U && card->health == HAL_CAN_ACTIVE);
    const struct linux_can_link *idle = link_of(links, count, "can2");
    CHECK(idle != NULL && !idle->up && idle->has_controller && idle->bitrate == 0U);
    const struct linux_can_link *vcan = link_of(links, count, "vcan0");
    CHECK(vcan != NULL && vcan->up && !vcan->has_controller);
    CHECK(linux_can_list(links, 2, &count, &error) == HAL_OK && count == 2U);
}

int main(void) {
    linux_clock_open(&clock_, UINT32_MAX - 1000000U);
    a.fd = b.fd = a.error_fd = b.error_fd = -1;
    suite_on("linux_can_virtual", &virtual_bus);
    suite_on("linux_can_cards", &cards);
    injector = raw_socket("vcan0");
    TEST(error_frames_become_health);
    TEST(error_frames_are_bounded);
    TEST(overflow_is_counted);
    TEST(virtual_bus_down_and_up);
    TEST(card_down_and_up);
    TEST(interface_leaves_and_returns);
    TEST(restarts_are_asked_for_in_time);
    TEST(refusals_say_what_to_do);
    TEST(list_tells_what_ip_link_set);
    CONTRACT("linux_can", fails_at_every_step);
    CONTRACT("linux_can", forbidden);
    return check_finish();
}
