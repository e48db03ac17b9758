/// The slcan driver between two adapters that the test plays on pseudo-terminals.
#include "linux/linux_slcan.h"
#include "contract/support/can_suite.h"
#include "contract/support/contract.h"
#include "contract/support/failing_can.h"
#include "contract/support/slcan_adapter.h"
#include "contract/support/syscalls.h"
#include "devices/fake_clock.h"
#include "linux/linux_clock.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static struct linux_clock clock_;

static struct slcan_adapter a, b;
static struct failing_can failing; ///< in front of a

static void settle(void *context) {
    (void)context;
    syscalls_watch(false);
    slcan_adapter_settle(&a, &b);
    slcan_adapter_settle(&b, &a);
    syscalls_watch(true);
}

/// Every call of the kernel, below the driver of a.
static void fail_kernel(bool on) {
    syscalls_at(on ? 1 : 0, SYSCALLS_FAIL_ON, ENOMEM);
}

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    return failing_can_at(&failing, nth, status);
}

static void reset(void *context) {
    (void)context;
    slcan_adapter_plug_in(&a, &clock_.hal);
    slcan_adapter_plug_in(&b, &clock_.hal);
    settle(NULL);
    CHECK(a.open && b.open);
    failing_can_init(&failing, &a.port.hal, fail_kernel);
}

// ---------------------------------------------------------------- the text

/// What the driver has said since the last time.
static void expect_heard(struct slcan_adapter *adapter, const char *wanted) {
    settle(NULL);
    for (int i = 0; i < 300000 && adapter->heard_size < strlen(wanted); i++) {
        usleep(100); // of a port that is closed
        slcan_adapter_serve(adapter, adapter == &a ? &b : &a);
    }
    adapter->heard[adapter->heard_size] = '\0';
    if (!CHECK(strcmp(adapter->heard, wanted) == 0)) {
        printf("  heard %s\n", adapter->heard);
    }
    adapter->heard_size = 0;
}

/// The first frames of each are those of python-can's slcan interface, as recorded.
static void text_of_frames(void) {
    static const struct {
        struct can_frame frame;
        const char *text;
    } cases[] = {
        {{0x141, 0, 8, {0xA4, 0, 0xF4, 0x01, 0xA0, 0x8C, 0, 0}}, "t1418A400F401A08C0000\r"},
        {{0x404, CAN_FRAME_EXTENDED, 4, {1, 2, 3, 4}}, "T00000404401020304\r"},
        {{0x7FF, 0, 0, {0}}, "t7FF0\r"},
        {{0x1FFFFFFF, CAN_FRAME_EXTENDED, 1, {0xAB}}, "T1FFFFFFF1AB\r"},
        {{0x123, CAN_FRAME_REMOTE, 4, {0}}, "r1234\r"},
        {{0x12345678, CAN_FRAME_REMOTE | CAN_FRAME_EXTENDED, 8, {0}}, "R123456788\r"},
    };
    reset(NULL);
    a.heard_size = b.heard_size = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        CHECK_EQ(hal_can_send(&a.port.hal, &cases[i].frame), HAL_OK);
        expect_heard(&a, cases[i].text);
        struct can_frame got;
        uint32_t at_us;
        CHECK_EQ(hal_can_receive(&b.port.hal, &got, &at_us), HAL_OK);
        CHECK(can_frame_equal(&got, &cases[i].frame));
    }
}

static void text_of_opening_and_closing(void) {
    reset(NULL);
    a.heard[a.heard_size] = '\0';
    CHECK(strcmp(a.heard, "\r\rC\rS8\rO\rF\r") == 0);
    a.heard_size = 0;
    linux_slcan_close(&a.port);
    expect_heard(&a, "C\r");
    CHECK(!a.open);
    static const uint32_t speeds[] = {10000,  20000,  50000,  100000, 125000,
                                      250000, 500000, 800000, 1000000};
    for (unsigned i = 0; i < 9U; i++) {
        CHECK_EQ(linux_slcan_open(&a.port, a.path, speeds[i], &clock_.hal), HAL_OK);
        char wanted[] = "\r\rC\rS0\rO\rF\r";
        wanted[5] = (char)('0' + i);
        expect_heard(&a, wanted);
        linux_slcan_close(&a.port);
        expect_heard(&a, "C\r");
    }
}

/// Lower case, time stamps; and what is no frame, of which nothing comes.
static void text_that_is_received(void) {
    reset(NULL);
    static const char good[] = "t12340a0B0c0D\rT18DAF11081122334455667788\rr1230\rt00121122ABCD\r";
    static const char bad[] =
        "t\rt12\rt123\rt1239001122334455667788\rt8000\rT200000000\rt1231\r"
        "t12310\rt1231GG\rtxyz0\rT1234567\rV1013\rt1231AA1\rt1231AA12345\r"
        "NXXXX\r\r\rt123411223344556677889900112233445566778899001122334455\r";
    struct can_frame got;
    uint32_t at_us;
    slcan_adapter_say(&a, bad, sizeof bad - 1U);
    settle(NULL);
    CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
    CHECK_EQ(a.port.state.lost_count, 16); // all but the empty lines
    slcan_adapter_say(&a, good, sizeof good - 1U);
    settle(NULL);
    const struct can_frame wanted[] = {
        {0x123, 0, 4, {10, 11, 12, 13}},
        {0x18DAF110, CAN_FRAME_EXTENDED, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}},
        {0x123, CAN_FRAME_REMOTE, 0, {0}},
        {0x001, 0, 2, {0x11, 0x22}}};
    for (size_t i = 0; i < 4U; i++) {
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_OK);
        CHECK(can_frame_equal(&got, &wanted[i]));
    }
    CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
}

/// Any bytes at all: nothing breaks (the sanitizers watch), and a frame afterwards is understood.
static void random_bytes(void) {
    reset(NULL);
    uint64_t seed = 88172645463325252;
    struct can_frame got;
    uint32_t at_us;
    for (int round = 0; round < 300; round++) {
        char bytes[64];
        for (size_t i = 0; i < sizeof bytes; i++) {
            static const char alphabet[] = "tTrRzZF0123456789ABCDEFabcdef\r\r\r\a\n\xff x";
            bytes[i] = alphabet[check_random(&seed) % (sizeof alphabet - 1U)];
        }
        slcan_adapter_say(&a, bytes, sizeof bytes);
        while (hal_can_receive(&a.port.hal, &got, &at_us) == HAL_OK) {
            CHECK(can_frame_is_valid(&got));
        }
    }
    slcan_adapter_say(&a, "\rt00101\r\rt0021EE\r", 17);
    bool understood = false;
    while (hal_can_receive(&a.port.hal, &got, &at_us) == HAL_OK) {
        understood = got.id == 2U && got.length == 1U && got.data[0] == 0xEE;
    }
    CHECK(understood);
}

// ---------------------------------------------------------------- the adapter's state

/// A clock that is set by hand.
static struct fake_clock hand;

/// What the adapter answers to the flags command is state, bit by bit.
static void flags_are_state(void) {
    reset(NULL);
    struct can_frame got;
    uint32_t at_us, lost = 0;
    struct hal_can_state state;
    for (unsigned bit = 0; bit < 8U; bit++) {
        char text[8];
        snprintf(text, sizeof text, "F%02X\r", 1U << bit);
        slcan_adapter_say(&a, text, 4);
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
        CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
        lost += bit == 3U;
        CHECK_EQ(state.lost_count, lost);
        CHECK_EQ(state.health, bit == 5U ? HAL_CAN_PASSIVE : HAL_CAN_ACTIVE);
        CHECK_EQ(state.transmit_error_count, bit == 5U ? 128 : 0);
        CHECK_EQ(state.receive_error_count, bit == 5U ? 128 : 0);
    }
}

static void flags_are_asked_for(void) {
    struct can_frame got;
    uint32_t at_us;
    for (int knows = 1; knows >= 0; knows--) { // the command
        slcan_adapter_plug_in(&a, &clock_.hal);
        a.flagged = knows != 0;
        linux_slcan_close(&a.port);
        CHECK_EQ(linux_slcan_open(&a.port, a.path, 1000000, &hand.hal), HAL_OK);
        settle(NULL);
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
        a.heard_size = 0;
        for (int times = 0; times < 3; times++) {
            fake_clock_advance(&hand, 249999);
            CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
            expect_heard(&a, "");
            fake_clock_advance(&hand, 1);
            CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
            expect_heard(&a, knows != 0 ? "F\r" : "");
        }
    }
}

/// A question that is not answered for once is no refusal of a frame.
static void an_unanswered_question_is_no_refusal(void) {
    struct can_frame got;
    uint32_t at_us;
    struct hal_can_state state;
    slcan_adapter_plug_in(&a, &clock_.hal);
    a.flagged = true;
    linux_slcan_close(&a.port);
    CHECK_EQ(linux_slcan_open(&a.port, a.path, 1000000, &hand.hal), HAL_OK);
    settle(NULL);
    CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
    fake_clock_advance(&hand, 250000);
    CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY); // asks
    for (int i = 0; i < 33; i++) {
        CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
        CHECK(state.health != HAL_CAN_OFF);
        slcan_adapter_say(&a, "\a", 1);
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
    }
    CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
    CHECK_EQ(state.health, HAL_CAN_OFF);
}

/// 32 refusals in a row: off the bus. A restart opens the channel, and nothing of before is sent.
static void refusals_are_bus_off(void) {
    reset(NULL);
    const struct can_frame frame = {.id = 1};
    struct can_frame got;
    uint32_t at_us;
    struct hal_can_state state;
    a.refusing = true;
    for (int i = 0; i < 32; i++) {
        CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
        CHECK_EQ(state.health, HAL_CAN_ACTIVE);
        CHECK_EQ(hal_can_send(&a.port.hal, &frame), HAL_OK);
        settle(NULL);
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
    }
    CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
    CHECK_EQ(state.health, HAL_CAN_OFF);
    CHECK_EQ(state.transmit_error_count, 256);
    CHECK_EQ(hal_can_send(&a.port.hal, &frame), HAL_ERROR_DOWN);
    a.heard_size = 0;
    a.refusing = false;
    CHECK_EQ(hal_can_restart(&a.port.hal), HAL_OK);
    expect_heard(&a, "\r\rC\rS8\rO\rF\r");
    CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
    CHECK_EQ(state.health, HAL_CAN_ACTIVE);
    CHECK_EQ(hal_can_send(&a.port.hal, &frame), HAL_OK);
    settle(NULL);
    CHECK_EQ(hal_can_receive(&b.port.hal, &got, &at_us), HAL_OK);
    CHECK(can_frame_equal(&got, &frame));
}

/// An adapter that obeys nothing, not even the restart, is off the bus again and again.
static void refusals_after_a_restart(void) {
    struct can_frame got;
    uint32_t at_us;
    struct hal_can_state state;
    reset(NULL);
    for (int times = 0; times < 3; times++) {
        for (int i = 0; i < 40; i++) {
            slcan_adapter_say(&a, "\a", 1);
        }
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
        CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
        CHECK_EQ(state.health, HAL_CAN_OFF);
        CHECK_EQ(hal_can_restart(&a.port.hal), HAL_OK);
        CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
        CHECK_EQ(state.health, HAL_CAN_ACTIVE);
    }
}

/// Of 100 frames that nobody takes the first 64 stay, and the others are counted.
static void frames_beyond_the_queue_are_counted(void) {
    struct can_frame got;
    uint32_t at_us;
    struct hal_can_state state;
    reset(NULL);
    for (unsigned i = 0; i < 100U; i++) {
        char text[16];
        snprintf(text, sizeof text, "t0421%02X\r", i);
        slcan_adapter_say(&a, text, 8);
    }
    for (unsigned i = 0; i < 64U; i++) {
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_OK);
        CHECK(got.id == 0x42U && got.length == 1U && got.data[0] == i);
    }
    CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
    CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
    CHECK_EQ(state.lost_count, 36);
    slcan_adapter_say(&a, "t0420\r", 6);
    CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_OK);
}

/// Refusals with obedience in between are no bus-off, whichever way the adapter obeys.
static void refusals_count_in_a_row(void) {
    static const char *const obeyed[] = {"\r", "z\r", "Z\r"};
    struct can_frame got;
    uint32_t at_us;
    struct hal_can_state state;
    reset(NULL);
    for (unsigned i = 0; i < 4U; i++) {
        for (int k = 0; k < 31; k++) {
            slcan_adapter_say(&a, "\a", 1);
        }
        slcan_adapter_say(&a, i < 3U ? obeyed[i] : "zz\r", i == 0U ? 1 : i < 3U ? 2 : 3);
        CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
        CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
        CHECK_EQ(state.health, HAL_CAN_ACTIVE);
    }
    slcan_adapter_say(&a, "\a", 1); // that line was not obedience
    CHECK_EQ(hal_can_receive(&a.port.hal, &got, &at_us), HAL_EMPTY);
    CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_OK);
    CHECK_EQ(state.health, HAL_CAN_OFF);
    CHECK(strstr(a.port.error.line, ": the adapter takes no frames; check cable") != NULL);
}

/// The port is full: not now; then everything that was taken arrives, whole and in order.
static void full_port_is_busy(void) {
    reset(NULL);
    a.heard_size = 0;
    uint32_t taken = 0;
    enum hal_status status = HAL_OK;
    while (status == HAL_OK && taken < 100000U) {
        const struct can_frame frame = {
            .id = 0x300, .length = 8, .data = {taken & 255U, taken >> 8 & 255U}};
        status = hal_can_send(&a.port.hal, &frame);
        taken += status == HAL_OK;
    }
    CHECK_EQ(status, HAL_BUSY);
    CHECK(taken > 10U);
    struct can_frame other; // what comes in is taken in all the same
    uint32_t other_us;
    slcan_adapter_say(&a, "t12310A\r", 8);
    CHECK_EQ(hal_can_receive(&a.port.hal, &other, &other_us), HAL_OK);
    CHECK_EQ(other.id, 0x123);
    uint32_t arrived = 0;
    for (int i = 0; i < 300000 && arrived < taken; i++) {
        struct can_frame got;
        uint32_t at_us;
        slcan_adapter_serve(&a, &b);
        (void)!hal_can_receive(&a.port.hal, &got, &at_us); // sends the rest of a cut line
        usleep(100);
        while (hal_can_receive(&b.port.hal, &got, &at_us) == HAL_OK) {
            CHECK_EQ(got.data[0] + 256U * got.data[1], arrived);
            arrived++;
        }
    }
    CHECK_EQ(arrived, taken);
    check_note("frames that the port takes", taken);
}

static void unplugged_while_listening(void) {
    reset(NULL);
    struct can_frame frame;
    uint32_t at_us;
    close(a.master);
    a.master = -1;
    CHECK_EQ(hal_can_receive(&a.port.hal, &frame, &at_us), HAL_ERROR_GONE);
    CHECK(strstr(a.port.error.line, "the device has left; plug it in again") != NULL);
}

static void unplugged_and_back(void) {
    reset(NULL);
    struct can_frame frame = {.id = 1};
    uint32_t at_us;
    struct hal_can_state state;
    close(a.master);
    a.master = -1;
    enum hal_status status = HAL_OK;
    for (int i = 0; i < 10 && status != HAL_ERROR_GONE; i++) {
        status = hal_can_send(&a.port.hal, &frame);
    }
    CHECK_EQ(status, HAL_ERROR_GONE);
    CHECK(strstr(a.port.error.line, "the device has left; plug it in again") != NULL);
    CHECK_EQ(hal_can_receive(&a.port.hal, &frame, &at_us), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_state(&a.port.hal, &state), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_set_filters(&a.port.hal, NULL, 0), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_restart(&a.port.hal), HAL_ERROR_GONE);
    linux_slcan_close(&a.port);
    CHECK_EQ(linux_slcan_open(&a.port, "/dev/ttyNONE7", 1000000, &clock_.hal), HAL_ERROR_GONE);
    CHECK(strncmp(a.port.error.line, "/dev/ttyNONE7: no such file or device; ", 39) == 0);
    CHECK_EQ(hal_can_send(&a.port.hal, &frame), HAL_ERROR_GONE);
    CHECK_EQ(hal_can_receive(&a.port.hal, &frame, &at_us), HAL_ERROR_GONE);
    linux_slcan_close(&a.port);
    CHECK_EQ(linux_slcan_open(&a.port, b.path, 1000000, &clock_.hal), HAL_ERROR_DENIED); // in use
    CHECK_EQ(linux_slcan_open(&a.port, "/dev/null", 1000000, &clock_.hal), HAL_ERROR_UNSUPPORTED);
    slcan_adapter_plug_in(&a, &clock_.hal);
    CHECK_EQ(linux_slcan_open(&b.port, a.path, 333333, &clock_.hal), HAL_ERROR_DENIED);
    linux_slcan_close(&a.port);
    CHECK_EQ(linux_slcan_open(&b.port, a.path, 333333, &clock_.hal), HAL_ERROR_ARGUMENT);
    CHECK_EQ(b.port.serial.fd, -1);
    CHECK_EQ(hal_can_send(&b.port.hal, &frame), HAL_ERROR_GONE);
    CHECK(strstr(b.port.error.line, ": slcan has no bit rate of 333333; use 125000") != NULL);
}

int main(void) {
    linux_clock_open(&clock_, UINT32_MAX - 1000000U);
    fake_clock_init(&hand, 0);
    a.master = b.master = -1;
    a.port.serial.fd = b.port.serial.fd = -1;
    reset(NULL);
    // Without a clock to compare with: the text has no time of arrival.
    can_suite(&(struct can_fixture){.name = "linux_slcan",
                                    .a = &failing.hal,
                                    .b = &b.port.hal,
                                    .reset = reset,
                                    .settle = settle,
                                    .fail_at = fail_at,
                                    .some_cannot_fail = true}); // state and restart ask nobody
    CONTRACT("linux_slcan", text_of_frames);
    CONTRACT("linux_slcan", text_of_opening_and_closing);
    CONTRACT("linux_slcan", text_that_is_received);
    CONTRACT("linux_slcan", random_bytes);
    CONTRACT("linux_slcan", flags_are_state);
    CONTRACT("linux_slcan", flags_are_asked_for);
    CONTRACT("linux_slcan", an_unanswered_question_is_no_refusal);
    CONTRACT("linux_slcan", refusals_are_bus_off);
    CONTRACT("linux_slcan", refusals_after_a_restart);
    CONTRACT("linux_slcan", frames_beyond_the_queue_are_counted);
    CONTRACT("linux_slcan", refusals_count_in_a_row);
    CONTRACT("linux_slcan", full_port_is_busy);
    CONTRACT("linux_slcan", unplugged_while_listening);
    CONTRACT("linux_slcan", unplugged_and_back);
    linux_slcan_close(&a.port);
    linux_slcan_close(&b.port);
    return check_finish();
}
