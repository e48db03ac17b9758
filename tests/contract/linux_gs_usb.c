/// The gs_usb driver between two emulated adapters on fake USB ports: the contract of hal/can.h,
/// what goes over the wire, and what fails.
#include "linux/linux_gs_usb.h"
#include "contract/support/can_suite.h"
#include "contract/support/candle_model.h"
#include "contract/support/contract.h"
#include "contract/support/failing_can.h"
#include "devices/fake_clock.h"
#include "devices/fake_usb.h"

#include <stdio.h>
#include <string.h>

#define BITRATE 1000000U

static struct fake_clock clock_;
static struct candle_bus bus;

/// An end of the bus.
struct end {
    struct candle candle;
    struct fake_usb usb;
    struct fake_usb_model model;
    struct linux_gs_usb gs;
    uint32_t transfers, fail_nth; ///< transfers that were done; the one that fails, from 1
    enum hal_status failure;
};
static struct end a, b;
static struct failing_can failing; ///< in front of a
static char wire[1024];            ///< a's requests as text: type request value index: data
static uint32_t features;
static int32_t drift_ppm; ///< by which an adapter's clock is fast

static uint32_t adapter_us(void) {
    const uint32_t now_us = hal_clock_now_us(&clock_.hal);
    return now_us + 123456789U + (uint32_t)((int64_t)now_us * drift_ppm / 1000000);
}

static void note_request(const struct hal_usb_transfer *transfer) {
    const struct hal_usb_setup *setup = &transfer->setup;
    size_t at = strlen(wire);
    if (at > sizeof wire - 128U) {
        return; // nobody looks at the wire after so many
    }
    at +=
        (size_t)snprintf(wire + at, sizeof wire - at, "%02x %02x %04x %04x %u", setup->request_type,
                         setup->request, setup->value, setup->index, transfer->size_bytes);
    const bool in = (setup->request_type & HAL_USB_IN) != 0U;
    for (unsigned i = 0; !in && i < transfer->size_bytes; i++) {
        at += (size_t)snprintf(wire + at, sizeof wire - at, "%s%02x", i == 0U ? ":" : "",
                               transfer->data[i]);
    }
    snprintf(wire + at, sizeof wire - at, ";");
}

static int serve(struct end *end, struct hal_usb_transfer *transfer) {
    const struct hal_usb_setup *setup = &transfer->setup;
    const uint8_t bytes[8] = {setup->request_type,           setup->request,
                              (uint8_t)setup->value,         (uint8_t)(setup->value >> 8),
                              (uint8_t)setup->index,         (uint8_t)(setup->index >> 8),
                              (uint8_t)transfer->size_bytes, 0};
    if (transfer->kind == HAL_USB_CONTROL) {
        const int count = candle_control(&end->candle, bytes, transfer->data, transfer->size_bytes);
        if (end == &a && count != CANDLE_LATER) {
            note_request(transfer);
        }
        return count >= 0 && (setup->request_type & HAL_USB_IN) == 0U ? transfer->size_bytes
                                                                      : count;
    }
    const uint8_t number = transfer->endpoint & 15U;
    return (transfer->endpoint & HAL_USB_IN) != 0U
               ? candle_bulk_in(&end->candle, number, transfer->data, transfer->size_bytes)
               : candle_bulk_out(&end->candle, number, transfer->data, transfer->size_bytes);
}

static enum hal_status answer(void *ctx, struct hal_usb_transfer *transfer) {
    struct end *end = ctx;
    const bool reads = transfer->kind == HAL_USB_BULK && (transfer->endpoint & HAL_USB_IN) != 0U;
    if (!reads && ++end->transfers == end->fail_nth) {
        return end->failure;
    }
    const int count = serve(end, transfer);
    if (count == CANDLE_LATER) {
        end->transfers -= !reads;
        return HAL_BUSY;
    }
    transfer->actual_bytes = count > 0 ? (uint16_t)count : 0U;
    return count < 0 ? HAL_ERROR_UNSUPPORTED : HAL_OK;
}

static void plug_as(struct end *end, unsigned node, uint8_t channel, uint32_t bitrate) {
    memset(end, 0, sizeof *end);
    end->candle = (struct candle){.bus = &bus,
                                  .first_node = node,
                                  .channel_count = 1,
                                  .features = features,
                                  .now_us = adapter_us};
    end->model = (struct fake_usb_model){
        .identity = {0x1D50, 0x606F, 0x0100, "0001"}, .answer = answer, .ctx = end};
    fake_usb_init(&end->usb, &clock_.hal, &end->model);
    CHECK_EQ(linux_gs_usb_bind(&end->gs, &end->usb.hal, channel, bitrate, &clock_.hal), HAL_OK);
}

static void plug(struct end *end, unsigned node) {
    plug_as(end, node, 0, BITRATE);
}

static struct hal_can_state state_of(const struct linux_gs_usb *gs) {
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    CHECK_EQ(hal_can_state(&gs->hal, &state), HAL_OK);
    return state;
}

static void attend(int rounds) {
    struct hal_can_state state;
    for (int i = 0; i < rounds; i++) {
        (void)!hal_can_state(&a.gs.hal, &state);
        (void)!hal_can_state(&b.gs.hal, &state);
    }
}

static void fail_usb(bool on) {
    fake_failures_at(&a.usb.failures, on ? 1U : 0U, on ? UINT32_MAX : 0U, HAL_ERROR_IO);
}

static void reset(void *context) {
    (void)context;
    memset(&bus, 0, sizeof bus);
    wire[0] = '\0';
    plug(&a, 0);
    plug(&b, 1);
    attend(10);
    failing_can_init(&failing, &a.gs.hal, fail_usb);
}

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    return failing_can_at(&failing, nth, status);
}

static void settle(void *context) {
    (void)context;
    bus.carries = true;
    attend(10);
    fake_clock_advance(&clock_, 100);
    attend(10);
    bus.carries = false;
}

static void bus_off(void *context) {
    (void)context;
    bus.node[0].bus_off_wanted = true;
    attend(4);
}

static struct can_frame numbered(uint32_t number) {
    return (struct can_frame){
        .id = 0x141, .length = 4, .data = {number & 255U, number >> 8 & 255U, 0xA5, 0x5A}};
}

static enum hal_status send(const struct end *end, uint32_t number) {
    const struct can_frame frame = numbered(number);
    return hal_can_send(&end->gs.hal, &frame);
}

static bool arrives(const struct end *end, uint32_t number) {
    struct can_frame got;
    const struct can_frame wanted = numbered(number);
    uint32_t at_us;
    return hal_can_receive(&end->gs.hal, &got, &at_us) == HAL_OK && can_frame_equal(&got, &wanted);
}

static void run_suite(const char *name, uint32_t with) {
    features = with;
    reset(NULL);
    can_suite(&(struct can_fixture){.name = name,
                                    .a = &failing.hal,
                                    .b = &b.gs.hal,
                                    .clock = &clock_.hal,
                                    .reset = reset,
                                    .settle = settle,
                                    .bus_off = bus_off,
                                    .fail_at = fail_at,
                                    .some_cannot_fail = true, // only sending asks the adapter
                                    .receive_capacity = LINUX_GS_USB_QUEUE,
                                    .send_capacity = LINUX_GS_USB_SLOTS});
}

// ---------------------------------------------------------------- what goes over the wire

/// The protocol's example: at 48 MHz, 16 quanta, sampled at 87.5 %.
static void requests_byte_for_byte(void) {
    features = 0;
    reset(NULL);
    CHECK_EQ(state_of(&a.gs).health, HAL_CAN_ACTIVE);
    const char *wanted = "41 00 0001 0000 4:efbe0000;c1 05 0001 0000 12;c1 04 0000 0000 40;"
                         "41 02 0000 0000 8:0000000000000000;"
                         "41 01 0000 0000 20:0600000007000000020000000100000003000000;"
                         "41 02 0000 0000 8:0100000000000000;";
    if (!CHECK(strcmp(wire, wanted) == 0)) {
        printf("  wire %s\n", wire);
    }
    features = 16; // it has a clock: MODE asks for times
    reset(NULL);
    CHECK(strstr(wire, "41 02 0000 0000 8:0100000010000000;") != NULL);
    wire[0] = '\0';
    linux_gs_usb_close(&a.gs);
    CHECK(strcmp(wire, "41 02 0000 0000 8:0000000000000000;") == 0);
}

static void frames_byte_for_byte(void) {
    features = 0;
    reset(NULL);
    const struct can_frame frames[] = {
        {.id = 0x141, .length = 3, .data = {1, 2, 3, 99}},
        {.id = 0x1ABCDEF0,
         .flags = CAN_FRAME_EXTENDED,
         .length = 8,
         .data = {8, 7, 6, 5, 4, 3, 2, 1}},
        {.id = 0x7FF, .flags = CAN_FRAME_REMOTE, .length = 5, .data = {77}}};
    const uint8_t wanted[3][20] = {
        {0, 0, 0, 0, 0x41, 0x01, 0, 0, 3, 0, 0, 0, 1, 2, 3},
        {1, 0, 0, 0, 0xF0, 0xDE, 0xBC, 0x9A, 8, 0, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1},
        {2, 0, 0, 0, 0xFF, 0x07, 0, 0x40, 5, 0, 0, 0}};
    for (unsigned i = 0; i < 3U; i++) {
        CHECK_EQ(hal_can_send(&a.gs.hal, &frames[i]), HAL_OK);
    }
    attend(1);
    CHECK_EQ(bus.held_count, 3);
    for (unsigned i = 0; i < 3U; i++) {
        CHECK(memcmp(bus.held[i].frame, wanted[i], 20) == 0);
    }
}

/// By the adapter's own clock: the time between two frames is right although both are read late.
static void times_are_the_adapters(void) {
    features = 16;
    reset(NULL);
    uint32_t heard_us[3];
    CHECK_EQ(send(&b, 0), HAL_OK);
    settle(NULL);
    for (uint32_t i = 1; i < 3U; i++) {
        CHECK_EQ(send(&b, i), HAL_OK);
        struct hal_can_state state;
        bus.carries = true;
        for (int k = 0; k < 4; k++) {
            CHECK_EQ(hal_can_state(&b.gs.hal, &state), HAL_OK); // a does not look
        }
        bus.carries = false;
        fake_clock_advance(&clock_, 7000);
    }
    struct can_frame frame;
    for (uint32_t i = 0; i < 3U; i++) {
        CHECK_EQ(hal_can_receive(&a.gs.hal, &frame, &heard_us[i]), HAL_OK);
    }
    CHECK_EQ(heard_us[2] - heard_us[1], 7000);
    CHECK(heard_us[1] - heard_us[0] <= 200U);
}

/// Half an hour with a frame a second, by an adapter whose clock is slow or fast by 100 millionths
/// (crystals are better): each is told within 0.2 ms of when it was on the bus.
static void clocks_may_drift(void) {
    features = 16;
    for (drift_ppm = -100; drift_ppm <= 100; drift_ppm += 100) {
        uint32_t worst_us = 0;
        fake_clock_set(&clock_, 0);
        reset(NULL);
        for (uint32_t i = 0; i < 1800U && check_clean(); i++) {
            struct can_frame frame;
            uint32_t heard_us = 0;
            const uint32_t sent_us = hal_clock_now_us(&clock_.hal);
            CHECK_EQ(send(&b, i), HAL_OK);
            settle(NULL);
            CHECK_EQ(hal_can_receive(&a.gs.hal, &frame, &heard_us), HAL_OK);
            const uint32_t off_us = heard_us - sent_us + 100U;
            worst_us = off_us > worst_us ? off_us : worst_us;
            fake_clock_advance(&clock_, 1000000);
        }
        CHECK(worst_us <= 300U);
    }
    drift_ppm = 0;
}

static void errors_become_health(void) {
    features = 0;
    reset(NULL);
    uint8_t error[20] = {0xFF, 0xFF, 0xFF, 0xFF, 0x04, 0x02, 0, 0x20, 8};
    error[13] = 0x20; // transmitter passive, with counters
    error[18] = 135;
    error[19] = 3;
    candle_inject(&bus, 0, error);
    struct hal_can_state state = state_of(&a.gs);
    CHECK_EQ(state.health, HAL_CAN_PASSIVE);
    CHECK_EQ(state.transmit_error_count, 135);
    CHECK_EQ(state.receive_error_count, 3);
    error[13] = 0x40;
    error[18] = error[19] = 0;
    candle_inject(&bus, 0, error);
    CHECK_EQ(state_of(&a.gs).health, HAL_CAN_ACTIVE);
    error[13] = 0x01;
    candle_inject(&bus, 0, error);
    CHECK_EQ(state_of(&a.gs).lost_count, 1);
    const uint8_t marked[20] = {0xFF, 0xFF, 0xFF, 0xFF, 0x41, 0x01, 0,    0,
                                4,    0,    1,    0,    5,    0,    0xA5, 0x5A};
    candle_inject(&bus, 0, marked); // heard, and one before it was not
    CHECK_EQ(state_of(&a.gs).lost_count, 2);
    CHECK(arrives(&a, 5));
}

// ---------------------------------------------------------------- a bus on which nobody answers

static void unanswered_frames_are_thrown_away(void) {
    features = 0;
    reset(NULL);
    for (uint32_t i = 0; i < LINUX_GS_USB_SLOTS; i++) {
        CHECK_EQ(send(&a, i), HAL_OK);
    }
    fake_clock_advance(&clock_, LINUX_GS_USB_PATIENCE_US - 1000U);
    CHECK_EQ(send(&a, 99), HAL_BUSY);
    fake_clock_advance(&clock_, 1000);
    attend(4);
    CHECK_EQ(state_of(&a.gs).health, HAL_CAN_OFF);
    CHECK(strstr(a.gs.error.line, ": nobody on the bus acknowledges; check ") != NULL);
    CHECK_EQ(send(&a, 99), HAL_ERROR_DOWN);
    CHECK_EQ(hal_can_restart(&a.gs.hal), HAL_OK);
    attend(6);
    CHECK_EQ(state_of(&a.gs).health, HAL_CAN_ACTIVE);
    CHECK_EQ(send(&a, 100), HAL_OK);
    settle(NULL);
    CHECK(arrives(&b, 100)); // and none of before
}

// ---------------------------------------------------------------- adapters that fail

static void expect_refusal(const char *line) {
    attend(10);
    CHECK_EQ(state_of(&a.gs).health, HAL_CAN_OFF);
    CHECK_EQ(send(&a, 1), HAL_ERROR_DOWN);
    if (!CHECK(strcmp(a.gs.error.line, line) == 0)) {
        printf("  got    %s\n  wanted %s\n", a.gs.error.line, line);
    }
}

static void refusals_say_what_to_do(void) {
    features = 0;
    reset(NULL);
    plug_as(&a, 0, 1, BITRATE);
    expect_refusal("CAN adapter: no channel 1, it has 1; choose another one in the rig file");
    plug_as(&a, 0, 0, 999);
    expect_refusal("CAN adapter: can't do 999 bit/s; 1000000, 500000 and 250000 are usual");
    plug(&a, 0);
    a.candle.refusing = true;
    expect_refusal("CAN adapter: refused request 0; is its firmware candleLight's?");
    plug(&a, 0);
    a.candle.mute = true;
    attend(2);
    fake_clock_advance(&clock_, 300000);
    expect_refusal("CAN adapter: does not answer; plug it in again");
    a.candle.mute = false; // what was mute may be restarted
    CHECK_EQ(hal_can_restart(&a.gs.hal), HAL_OK);
    attend(10);
    CHECK_EQ(state_of(&a.gs).health, HAL_CAN_ACTIVE);
}

/// What the pump does at every tick, until frames go both ways.
static bool comes_round(void) {
    for (uint32_t i = 0; i < 60U; i++) {
        if (send(&a, 1000U + i) == HAL_ERROR_DOWN) {
            CHECK_EQ(hal_can_restart(&a.gs.hal), HAL_OK);
        }
        CHECK_EQ(send(&b, 2000U + i), HAL_OK);
        settle(NULL);
        fake_clock_advance(&clock_, 20000);
        struct can_frame got;
        uint32_t at_us;
        bool heard_a = false, heard_b = false;
        while (hal_can_receive(&a.gs.hal, &got, &at_us) == HAL_OK) {
            heard_a = heard_a || (got.data[0] | got.data[1] << 8) == (int)(2000U + i);
        }
        while (hal_can_receive(&b.gs.hal, &got, &at_us) == HAL_OK) {
            heard_b = heard_b || (got.data[0] | got.data[1] << 8) == (int)(1000U + i);
        }
        if (heard_a && heard_b) {
            return true;
        }
    }
    return false;
}

/// The nth transfer of start, traffic, bus-off and restart fails, for every n: it comes round.
static void a_transfer_fails_whichever(void) {
    const enum hal_status failures[] = {HAL_ERROR_UNSUPPORTED, HAL_ERROR_TIMEOUT, HAL_ERROR_IO};
    features = 16;
    for (unsigned k = 0; k < 3U; k++) {
        a.transfers = UINT32_MAX;
        for (uint32_t nth = 1; nth <= a.transfers && check_clean(); nth++) {
            memset(&bus, 0, sizeof bus);
            plug(&a, 0);
            plug(&b, 1);
            a.fail_nth = nth;
            a.failure = failures[k];
            attend(10);
            CHECK(comes_round());
            bus_off(NULL);
            CHECK(comes_round());
        }
    }
    check_note("transfers of start, traffic, bus-off and restart", a.transfers);
}

/// Frames that the adapter did not take make room for others at once.
static void a_frame_that_fails_frees_its_place(void) {
    features = 0;
    reset(NULL);
    for (uint32_t i = 0; i < 3U * LINUX_GS_USB_SLOTS; i++) {
        a.fail_nth = a.transfers + 1U;
        a.failure = HAL_ERROR_IO;
        CHECK_EQ(send(&a, i), HAL_OK);
        attend(1);
    }
    CHECK_EQ(a.gs.failed_count, 3U * LINUX_GS_USB_SLOTS);
    CHECK_EQ(state_of(&a.gs).health, HAL_CAN_ACTIVE);
    a.fail_nth = 0;
    CHECK_EQ(send(&a, 7), HAL_OK);
    settle(NULL);
    CHECK(arrives(&b, 7));
}

/// A call of the USB layer fails, whichever.
static void a_call_fails_whichever(void) {
    features = 0;
    for (uint32_t nth = 1; nth <= 400U && check_clean(); nth += 1U + nth / 40U) {
        memset(&bus, 0, sizeof bus);
        plug(&a, 0);
        plug(&b, 1);
        fake_failures_at(&a.usb.failures, nth, 3, HAL_ERROR_IO);
        attend(10);
        struct can_frame frame = numbered(7);
        enum hal_status status = hal_can_send(&a.gs.hal, &frame);
        CHECK(status == HAL_OK || status == HAL_ERROR_IO || status == HAL_ERROR_DOWN);
        fake_clock_advance(&clock_, 300000);
        CHECK(comes_round());
    }
}

/// It leaves at any moment; whatever is called says so, and nothing is touched that it held.
static void unplugged_at_any_moment(void) {
    features = 0;
    for (uint32_t nth = 1; nth <= 200U && check_clean(); nth++) {
        memset(&bus, 0, sizeof bus);
        plug(&b, 1);
        plug(&a, 0);
        const uint32_t before = a.usb.failures.call_count;
        struct can_frame frame = numbered(7);
        uint32_t at_us;
        struct hal_can_state state;
        const struct hal_can_filter filter = {0};
        bus.carries = true;
        while (a.usb.failures.call_count - before < nth) {
            (void)!hal_can_send(&a.gs.hal, &frame);
            (void)!hal_can_receive(&a.gs.hal, &frame, &at_us);
        }
        fake_usb_unplug(&a.usb);
        int calls = 0;
        while (calls < 3 && hal_can_receive(&a.gs.hal, &frame, &at_us) != HAL_ERROR_GONE) {
            calls++;
        }
        CHECK(calls < 3);
        CHECK_EQ(hal_can_send(&a.gs.hal, &frame), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_state(&a.gs.hal, &state), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_set_filters(&a.gs.hal, &filter, 1), HAL_ERROR_GONE);
        CHECK_EQ(hal_can_restart(&a.gs.hal), HAL_ERROR_GONE);
        CHECK(strcmp(a.gs.error.line, "CAN adapter: the adapter has left; plug it in again") == 0);
        linux_gs_usb_close(&a.gs);
    }
}

int main(void) {
    fake_clock_init(&clock_, UINT32_MAX - 20000U);
    run_suite("linux_gs_usb", 0);
    run_suite("linux_gs_usb_timed", 16);
    CONTRACT("linux_gs_usb", requests_byte_for_byte);
    CONTRACT("linux_gs_usb", frames_byte_for_byte);
    CONTRACT("linux_gs_usb", times_are_the_adapters);
    CONTRACT("linux_gs_usb", clocks_may_drift);
    CONTRACT("linux_gs_usb", errors_become_health);
    CONTRACT("linux_gs_usb", unanswered_frames_are_thrown_away);
    CONTRACT("linux_gs_usb", refusals_say_what_to_do);
    CONTRACT("linux_gs_usb", a_transfer_fails_whichever);
    CONTRACT("linux_gs_usb", a_frame_that_fails_frees_its_place);
    CONTRACT("linux_gs_usb", a_call_fails_whichever);
    CONTRACT("linux_gs_usb", unplugged_at_any_moment);
    return check_finish();
}
