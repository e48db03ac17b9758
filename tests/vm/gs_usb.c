/// The SocketCAN driver on an adapter that can break: a two-channel gs_usb (candleLight) device,
/// emulated below the kernel's USB stack, with its channels on one bus. Bus-off, restart, a bus
/// that carries nothing, unplugging: by the kernel's own gs_usb driver.
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

#define FRAME_BYTES 20
#define QUEUE_MAX   512U
#define FROM_BUS    "\xff\xff\xff\xff"

// ---------------------------------------------------------------- the adapter, in a child process

struct queue {
    unsigned first, count;
    uint8_t frame[QUEUE_MAX][FRAME_BYTES];
};

struct adapter {
    volatile bool carries;        ///< by the test: the bus runs
    volatile bool bus_off_wanted; ///< by the test: channel 0 loses the bus
    volatile unsigned taken;      ///< frames from the host
    volatile bool started[2], off[2];
    struct queue held; ///< on their way to the bus
    struct queue in;   ///< to the host
};

static void put(struct queue *queue, const uint8_t *frame) {
    if (queue->count < QUEUE_MAX) {
        memcpy(queue->frame[(queue->first + queue->count) % QUEUE_MAX], frame, FRAME_BYTES);
        queue->count++;
    }
}

static void take(struct queue *queue, uint8_t *frame) {
    memcpy(frame, queue->frame[queue->first], FRAME_BYTES);
    queue->first = (queue->first + 1U) % QUEUE_MAX;
    queue->count--;
}

static int control(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size) {
    static const uint8_t config[12] = {0, 0, 0, 1, 2, 0, 0, 0, 1}; // two channels
    static const uint32_t timing[10] = {0, 48000000, 1, 16, 1, 8, 4, 1, 1024, 1};
    struct adapter *adapter = ctx;
    (void)size;
    if (setup[0] == 0xC1 && setup[1] == 5) {
        memcpy(data, config, sizeof config);
        return sizeof config;
    }
    if (setup[0] == 0xC1 && setup[1] == 4) {
        memcpy(data, timing, sizeof timing); // little endian, as this machine is
        return sizeof timing;
    }
    if (setup[0] == 0x41 && setup[1] == 2 && setup[2] < 2U) {
        adapter->started[setup[2]] = data[0] == 1U;
        adapter->off[setup[2]] = false;
    }
    return setup[0] == 0x41 ? 0 : USB_MODEL_STALL;
}

static int bulk_out(void *ctx, uint8_t endpoint, const uint8_t *data, uint32_t size) {
    struct adapter *adapter = ctx;
    if (endpoint == 2U && size >= FRAME_BYTES && !adapter->off[data[9] & 1U]) {
        put(&adapter->held, data);
    }
    adapter->taken++;
    return (int)size;
}

/// Off the bus, with what it had to send. The kernel is told by an error frame.
static void lose_the_bus(struct adapter *adapter) {
    static const uint8_t error[FRAME_BYTES] = {0xFF, 0xFF, 0xFF, 0xFF, 0x40, 0, 0, 0x20, 8, 0};
    adapter->bus_off_wanted = false;
    adapter->off[0] = true;
    for (unsigned left = adapter->held.count; left > 0U; left--) {
        uint8_t frame[FRAME_BYTES];
        take(&adapter->held, frame);
        if (frame[9] != 0U) {
            put(&adapter->held, frame);
        }
    }
    put(&adapter->in, error);
}

static int bulk_in(void *ctx, uint8_t endpoint, uint8_t *data, uint32_t capacity) {
    struct adapter *adapter = ctx;
    if (adapter->bus_off_wanted) {
        lose_the_bus(adapter);
    }
    while (adapter->carries && adapter->held.count > 0U) {
        uint8_t frame[FRAME_BYTES];
        take(&adapter->held, frame);
        put(&adapter->in, frame); // the echo: it has been sent
        const unsigned other = frame[9] ^ 1U;
        if (adapter->started[other] && !adapter->off[other]) {
            memcpy(frame, FROM_BUS, 4);
            frame[9] = (uint8_t)other;
            put(&adapter->in, frame);
        }
    }
    if (endpoint != 1U || capacity < FRAME_BYTES || adapter->in.count == 0U) {
        return USB_MODEL_LATER;
    }
    take(&adapter->in, data);
    return FRAME_BYTES;
}

// ---------------------------------------------------------------- plugging

static struct adapter *adapter;
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
    static const uint8_t device[18] = {18,   1,    0,    2, 0, 0, 0, 64, 0x50,
                                       0x1D, 0x6F, 0x60, 0, 0, 1, 2, 3,  1};
    static const uint8_t configuration[32] = {9,  2, 32, 0,    1,    1,    0, 0x80, 50, 9,    4,
                                              0,  0, 2,  0xFF, 0xFF, 0xFF, 0, 7,    5,  0x81, 2,
                                              64, 0, 0,  7,    5,    0x02, 2, 64,   0,  0};
    const struct usb_model model = {.device = device,
                                    .configuration = configuration,
                                    .strings = {"emulated", "gs_usb", "0001"},
                                    .speed = USB_FULL_SPEED,
                                    .ctx = adapter,
                                    .control = control,
                                    .bulk_out = bulk_out,
                                    .bulk_in = bulk_in};
    memset(adapter, 0, sizeof *adapter);
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

/// The bus carries until nothing has moved for a while.
static void settle(void) {
    unsigned before;
    adapter->carries = true;
    do {
        before = adapter->taken;
        usleep(60000);
    } while (adapter->taken != before || adapter->held.count > 0U || adapter->in.count > 0U);
    adapter->carries = false;
}

static struct can_frame numbered(uint32_t number) {
    return (struct can_frame){
        .id = 0x141, .length = 4, .data = {number & 255U, number >> 8 & 255U, 0xA5, 0x5A}};
}

static void expect(const struct linux_can *can, uint32_t number) {
    struct can_frame got, wanted = numbered(number);
    uint32_t at_us;
    CHECK_EQ(hal_can_receive(&can->hal, &got, &at_us), HAL_OK);
    CHECK(can_frame_equal(&got, &wanted));
}

static void expect_nothing(const struct linux_can *can) {
    struct can_frame got;
    uint32_t at_us;
    CHECK_EQ(hal_can_receive(&can->hal, &got, &at_us), HAL_EMPTY);
}

static enum hal_status send(const struct linux_can *can, uint32_t number) {
    const struct can_frame frame = numbered(number);
    return hal_can_send(&can->hal, &frame);
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
        adapter->bus_off_wanted = true;
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
    adapter = usb_port_share(sizeof *adapter);
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
