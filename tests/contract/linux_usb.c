/// The libusb driver, and what drives its devices (Maestro, gs_usb), on a model of the library:
/// every error of every call, transfers that end badly, devices that leave.
/// tests/vm/linux_usb.c has the same on the library itself and the kernel.
#include "linux/linux_usb.h"
#include "contract/support/candle_model.h"
#include "contract/support/contract.h"
#include "contract/support/libusb_model.h"
#include "contract/support/lives.h"
#include "contract/support/maestro_model.h"
#include "contract/support/syscalls.h"
#include "contract/support/usb_suite.h"
#include "devices/fake_clock.h"
#include "linux/linux_gs_usb.h"
#include "linux/linux_maestro.h"

#include <stdio.h>
#include <string.h>

#if HAVE_LIBUSB

#include <libusb-1.0/libusb.h>

static struct linux_usb usb;
static struct maestro_model maestro_model;
static struct candle_bus bus;
static struct candle candle = {.bus = &bus, .channel_count = 1};
static struct fake_clock clock_;

/// Also the standard request that every device answers.
static int control(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size) {
    if (setup[0] == HAL_USB_IN && setup[1] == 6U && setup[3] == 1U) {
        memcpy(data, maestro_model_device, sizeof maestro_model_device);
        return sizeof maestro_model_device;
    }
    return maestro_model_control(ctx, setup, data, size);
}

static const struct libusb_model plugged = {.vendor = 0x1FFB,
                                            .product = 0x0089,
                                            .release_bcd = 0x0104,
                                            .serial_number = MAESTRO_MODEL_SERIAL,
                                            .ctx = &maestro_model,
                                            .control = control,
                                            .bulk_out = maestro_model_bulk_out,
                                            .bulk_in = maestro_model_bulk_in};
static const struct libusb_model adapter = {.vendor = 0x1D50,
                                            .product = 0x606F,
                                            .serial_number = "0001",
                                            .ctx = &candle,
                                            .control = candle_control,
                                            .bulk_out = candle_bulk_out,
                                            .bulk_in = candle_bulk_in};
static const struct linux_usb_id micro = {0x1FFB, 0x0089};
static const struct linux_usb_wanted wanted = {.ids = &micro,
                                               .id_count = 1,
                                               .serial_number = MAESTRO_MODEL_SERIAL,
                                               .interface = 0,
                                               .what = "Maestro"};

// ---------------------------------------------------------------- the suite

static void reset(void *context) {
    (void)context;
    syscalls_at(0, SYSCALLS_FAIL, 0);
    linux_usb_close(&usb);
    CHECK_EQ(libusb_model_objects(), 0);
    memset(&libusb_model_faults, 0, sizeof libusb_model_faults);
    memset(&maestro_model, 0, sizeof maestro_model);
    libusb_model_plug(0, &plugged);
    libusb_model_plug(1, NULL);
    CHECK_EQ(linux_usb_open(&usb, &wanted), HAL_OK);
}

static void settle(void *context) {
    (void)context;
}

static void unplug(void *context) {
    (void)context;
    libusb_model_plug(0, NULL);
}

/// Each call of the driver is one of the library's, but for a poll with nothing under way.
static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    syscalls_at(nth, SYSCALLS_FAIL, LIBUSB_ERROR_IO);
    return status == HAL_ERROR_IO;
}

// ---------------------------------------------------------------- transfers that end badly

static struct hal_usb_transfer question(uint8_t data[140]) {
    return (struct hal_usb_transfer){.kind = HAL_USB_CONTROL,
                                     .setup = {.request_type = 0xC0, .request = 0x83},
                                     .data = data,
                                     .size_bytes = 140};
}

static enum hal_status answer_of(struct hal_usb_transfer *transfer) {
    struct hal_usb_transfer *done = NULL;
    CHECK_EQ(hal_usb_submit(&usb.hal, transfer), HAL_OK);
    CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_OK);
    CHECK(done == transfer);
    return transfer->status;
}

static void transfers_end_as_the_library_says(void) {
    static const struct {
        enum libusb_transfer_status with;
        enum hal_status status;
    } cases[] = {{LIBUSB_TRANSFER_ERROR, HAL_ERROR_IO},
                 {LIBUSB_TRANSFER_OVERFLOW, HAL_ERROR_IO},
                 {LIBUSB_TRANSFER_STALL, HAL_ERROR_UNSUPPORTED},
                 {LIBUSB_TRANSFER_TIMED_OUT, HAL_ERROR_TIMEOUT},
                 {LIBUSB_TRANSFER_CANCELLED, HAL_ERROR_CANCELLED},
                 {LIBUSB_TRANSFER_NO_DEVICE, HAL_ERROR_GONE}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint8_t data[140];
        struct hal_usb_transfer transfer = question(data), *done = NULL;
        reset(NULL);
        libusb_model_faults.spoil_next = 1;
        libusb_model_faults.spoil_with = (int)cases[i].with;
        CHECK_EQ(answer_of(&transfer), cases[i].status);
        CHECK_EQ(transfer.actual_bytes, 0);
        if (cases[i].status == HAL_ERROR_GONE) {
            CHECK_EQ(hal_usb_poll(&usb.hal, &done), HAL_ERROR_GONE);
            CHECK(strcmp(usb.error.line, "Maestro " MAESTRO_MODEL_SERIAL
                                         ": the device has left; plug it in again") == 0);
        } else {
            CHECK_EQ(answer_of(&transfer), HAL_OK);
        }
    }
}

/// Closing waits for what it has cancelled, but not for ever, and leaves nothing.
static void transfers_that_do_not_end(void) {
    uint8_t in[2][64];
    struct hal_usb_transfer reading[2];
    for (unsigned stuck = 0; stuck < 2U; stuck++) {
        reset(NULL);
        for (unsigned i = 0; i < 2U; i++) {
            reading[i] = (struct hal_usb_transfer){
                .kind = HAL_USB_BULK, .endpoint = 0x81, .data = in[i], .size_bytes = 64};
            CHECK_EQ(hal_usb_submit(&usb.hal, &reading[i]), HAL_OK);
        }
        libusb_model_faults.stuck = stuck != 0U;
        syscalls_at(stuck != 0U ? 0 : 1, SYSCALLS_FAIL, LIBUSB_ERROR_IO); // to cancel it
        linux_usb_close(&usb);
        syscalls_at(0, SYSCALLS_FAIL, 0);
        CHECK_EQ(libusb_model_objects(), 0);
        CHECK(stuck != 0U || reading[0].status == HAL_ERROR_CANCELLED);
    }
}

// ---------------------------------------------------------------- which device

static void expect_refusal(const struct linux_usb_wanted *which, enum hal_status status,
                           const char *line) {
    struct linux_usb refused;
    CHECK_EQ(linux_usb_open(&refused, which), status);
    if (!CHECK(strcmp(refused.error.line, line) == 0)) {
        printf("  %s\n", refused.error.line);
    }
    struct hal_usb_transfer *done;
    CHECK_EQ(hal_usb_poll(&refused.hal, &done), HAL_ERROR_GONE);
    linux_usb_close(&refused);
    CHECK_EQ(libusb_model_objects(), 0);
}

/// One that may not be looked at may be the one; another one that is there is no reason to say that
/// there is none.
static void devices_that_can_not_be_had(void) {
    static const char forbidden[] =
        "Maestro " MAESTRO_MODEL_SERIAL
        ": no permission; install the udev rules of docs/rig.md, or run as root, "
        "and plug it in again";
    static const char missing[] =
        "Maestro " MAESTRO_MODEL_SERIAL ": no such USB device; is it plugged in? "
        "`boresight probe` lists what is there";
    struct libusb_model other = plugged;
    struct linux_usb_wanted any = wanted;
    any.serial_number = NULL;
    other.serial_number = "00027182";
    reset(NULL);
    linux_usb_close(&usb);
    libusb_model_plug(1, &other);
    libusb_model_faults.open[0] = LIBUSB_ERROR_ACCESS;
    expect_refusal(&wanted, HAL_ERROR_DENIED, forbidden);
    CHECK_EQ(linux_usb_open(&usb, &any), HAL_OK); // the other will do
    CHECK(strcmp(usb.identity.serial_number, "00027182") == 0);
    linux_usb_close(&usb);
    libusb_model_faults.open[0] = 0;
    libusb_model_faults.busy = true;
    expect_refusal(&wanted, HAL_ERROR_DENIED,
                   "Maestro " MAESTRO_MODEL_SERIAL
                   ": in use by another program; end that one first");
    libusb_model_faults.busy = false;
    libusb_model_plug(0, NULL);
    expect_refusal(&wanted, HAL_ERROR_GONE, missing);
    libusb_model_plug(1, NULL);
    expect_refusal(&wanted, HAL_ERROR_GONE, missing);
    libusb_model_plug(0, &plugged);
    libusb_model_faults.serial_refused = true; // so it has none, and is not the one
    expect_refusal(&wanted, HAL_ERROR_GONE, missing);
    CHECK_EQ(linux_usb_open(&usb, &any), HAL_OK);
    CHECK_EQ(usb.identity.serial_number[0], '\0');
}

// ---------------------------------------------------------------- errors at every step

/// What the library answers, and what the headers make of it: while opening, and afterwards.
static const struct life_error errors[] = {
    {LIBUSB_ERROR_IO, LIFE_STATUS(HAL_ERROR_IO)},
    {LIBUSB_ERROR_NO_MEM, LIFE_STATUS(HAL_ERROR_IO)},
    {LIBUSB_ERROR_OTHER, LIFE_STATUS(HAL_ERROR_IO)},
    {LIBUSB_ERROR_NO_DEVICE, LIFE_STATUS(HAL_ERROR_GONE)},
    {LIBUSB_ERROR_ACCESS, LIFE_STATUS(HAL_ERROR_DENIED) | LIFE_STATUS(HAL_ERROR_IO)},
    {LIBUSB_ERROR_BUSY,
     LIFE_STATUS(HAL_ERROR_DENIED) | LIFE_STATUS(HAL_ERROR_IO) | LIFE_STATUS(HAL_BUSY)}};

static void each_failure(const char *device, void (*live)(void)) {
    linux_usb_close(&usb);
    lives_each_failure(&(struct lives){.device = device,
                                       .live = live,
                                       .errors = errors,
                                       .error_count = sizeof errors / sizeof *errors,
                                       .recover_every = 8,
                                       .dies = true});
    CHECK_EQ(libusb_model_objects(), 0);
}

static void note_transfer(struct hal_usb_transfer *transfer, bool cancel) {
    struct hal_usb_transfer *done = NULL;
    if (life_note("submit", hal_usb_submit(&usb.hal, transfer), &usb.error) != HAL_OK) {
        return;
    }
    if (cancel) {
        life_note("cancel", hal_usb_cancel(&usb.hal, transfer), &usb.error);
    }
    life_note("poll", hal_usb_poll(&usb.hal, &done), &usb.error);
    life_value("status", done == transfer ? (int64_t)transfer->status : 1);
    life_value("bytes", transfer->actual_bytes);
}

static void live_as_usb(void) {
    static uint8_t data[140], out[4], in[2][64];
    static struct hal_usb_transfer transfer, writing, reading, waiting;
    transfer = question(data);
    writing = (struct hal_usb_transfer){
        .kind = HAL_USB_BULK, .endpoint = 2, .data = out, .size_bytes = sizeof out};
    reading = waiting = (struct hal_usb_transfer){
        .kind = HAL_USB_BULK, .endpoint = 0x81, .data = in[0], .size_bytes = sizeof in[0]};
    waiting.data = in[1];
    memset(&maestro_model, 0, sizeof maestro_model);
    if (life_note("open", linux_usb_open(&usb, &wanted), &usb.error) == HAL_OK) {
        struct hal_usb_identity identity;
        life_note("identity", hal_usb_identity(&usb.hal, &identity), &usb.error);
        life_value("serial", strcmp(identity.serial_number, MAESTRO_MODEL_SERIAL));
        life_value("endpoints", usb.bulk_in * 256 + usb.bulk_out);
        note_transfer(&transfer, false);
        note_transfer(&writing, false);
        note_transfer(&reading, false);
        note_transfer(&reading, true);
        life_note("submit", hal_usb_submit(&usb.hal, &waiting), &usb.error); // until it closes
    }
    linux_usb_close(&usb);
    CHECK(waiting.status != HAL_BUSY); // its owner has it back
    CHECK_EQ(libusb_model_objects(), 0);
}

static void usb_fails_at_every_step(void) {
    reset(NULL);
    each_failure("Maestro", live_as_usb);
}

/// Two rounds of polls: what could not be looked at in one is in the next.
static void live_as_maestro(void) {
    static struct linux_maestro maestro;
    const struct linux_error *error = &maestro.error;
    memset(&maestro_model, 0, sizeof maestro_model);
    if (life_note("open", linux_maestro_open(&maestro, NULL), error) != HAL_OK) {
        CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 1500000), HAL_ERROR_GONE);
        CHECK_EQ(libusb_model_objects(), 0);
        return;
    }
    for (uint32_t i = 0; i < 3U; i++) {
        life_note("pulse", hal_pwm_set_pulse(&maestro.hal, 1, 1000000U + i * 250000U), error);
        life_note("poll", linux_maestro_poll(&maestro), error);
        life_note("poll", linux_maestro_poll(&maestro), error);
    }
    life_note("speed", linux_maestro_limit_speed(&maestro, 1, 40), error);
    life_note("poll", linux_maestro_poll(&maestro), error);
    life_note("ask", linux_maestro_ask(&maestro), error);
    life_note("poll", linux_maestro_poll(&maestro), error);
    life_note("poll", linux_maestro_poll(&maestro), error);
    life_value("target", maestro_model.target[1]);
    life_value("speed", maestro_model.speed[1]);
    life_value("position", maestro.known ? (int64_t)maestro.position_ns[1] : -1);
    linux_maestro_close(&maestro);
    CHECK_EQ(libusb_model_objects(), 0);
}

static void maestro_fails_at_every_step(void) {
    reset(NULL);
    each_failure("Maestro", live_as_maestro);
}

/// Settled as the rig settles it: by calls at every tick.
static void live_as_adapter(void) {
    static struct linux_gs_usb gs;
    const struct linux_error *error = &gs.error;
    const struct can_frame out = {.id = 0x141, .length = 2, .data = {1, 2}};
    static const uint8_t heard[20] = {0xFF, 0xFF, 0xFF, 0xFF, 0x42, 2, 0, 0, 1, 0, 0, 0, 0xAB};
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    struct can_frame got = {.id = 0};
    uint32_t at_us;
    memset(&bus, 0, sizeof bus);
    bus.carries = true;
    clock_.step_us = 25000; // nobody waits for an answer for ever
    if (life_note("open", linux_gs_usb_open(&gs, NULL, 0, 1000000, &clock_.hal), error) != HAL_OK) {
        CHECK_EQ(hal_can_send(&gs.hal, &out), HAL_ERROR_GONE);
        CHECK_EQ(libusb_model_objects(), 0);
        return;
    }
    life_note("send", hal_can_send(&gs.hal, &out), error);
    for (int i = 0; i < 3; i++) {
        life_note("state", hal_can_state(&gs.hal, &state), error);
    }
    life_value("health", state.health);
    life_value("taken", bus.node[0].taken);
    candle_inject(&bus, 0, heard);
    life_note("state", hal_can_state(&gs.hal, &state), error);
    life_note("state", hal_can_state(&gs.hal, &state), error);
    life_note("receive", hal_can_receive(&gs.hal, &got, &at_us), error);
    life_value("heard", got.id);
    linux_gs_usb_close(&gs);
    CHECK_EQ(libusb_model_objects(), 0);
}

/// candleLight and its kin, by the numbers that the kernel's driver has, too; none that is one off.
static void adapters_by_their_numbers(void) {
    static const uint16_t known[][2] = {
        {0x1D50, 0x606F}, {0x1209, 0x2323}, {0x1CD2, 0x606F}, {0x16D0, 0x10B8}};
    static struct linux_gs_usb gs;
    reset(NULL);
    linux_usb_close(&usb);
    clock_.step_us = 25000;
    for (unsigned i = 0; i < 4U; i++) {
        for (int off = 0; off < 5; off++) { // of one number or the other, by one
            const uint16_t vendor = (uint16_t)(known[i][0] + (off == 1) - (off == 2));
            const uint16_t product = (uint16_t)(known[i][1] + (off == 3) - (off == 4));
            struct libusb_model model = adapter;
            model.vendor = vendor;
            model.product = product;
            memset(&bus, 0, sizeof bus);
            libusb_model_plug(0, &model);
            CHECK_EQ(linux_gs_usb_open(&gs, NULL, 0, 1000000, &clock_.hal),
                     off == 0 ? HAL_OK : HAL_ERROR_GONE);
            const struct hal_usb_identity identity = {.vendor = vendor, .product = product};
            CHECK_EQ(linux_gs_usb_is_one(&identity), off == 0);
            linux_gs_usb_close(&gs);
        }
    }
    CHECK_EQ(libusb_model_objects(), 0);
}

/// Port 0 has a CAN adapter, and nobody has opened it.
static void plug_adapter(void) {
    reset(NULL);
    linux_usb_close(&usb);
    libusb_model_plug(0, &adapter);
}

/// Frames of another channel and of CAN FD, echoes of what was never sent: nothing is heard,
/// nothing breaks, and what comes behind them is understood.
static void frames_that_are_none_of_ours(void) {
    static const uint8_t others[][20] = {
        {0xFF, 0xFF, 0xFF, 0xFF, 0x42, 2, 0, 0, 1, 0, 0, 0, 0xAB}, // of the other channel
        {0xFF, 0xFF, 0xFF, 0xFF, 0x42, 2, 0, 0, 1, 0, 2, 0, 0xAB}, // FD
        {0xFF, 0xFF, 0xFF, 0xFF, 0x42, 2, 0, 0, 9, 0, 0, 0, 0xAB}, // 9 bytes
        {0, 0, 0, 0, 0x42, 2, 0, 0, 1, 0, 0, 0, 0xAB},             // echoes
        {0xFE, 0xFF, 0xFF, 0xFF, 0x42, 2, 0, 0, 1, 0, 0, 0, 0xAB},
        {0, 1, 0, 0, 0x42, 2, 0, 0, 1, 0, 0, 0, 0xAB}};
    static const uint8_t good[20] = {0xFF, 0xFF, 0xFF, 0xFF, 0x43, 2, 0, 0, 1, 0, 0, 0, 0xCD};
    static struct linux_gs_usb gs;
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    struct can_frame got;
    uint32_t at_us;
    plug_adapter();
    memset(&bus, 0, sizeof bus);
    candle.channel_count = 2;
    clock_.step_us = 25000;
    CHECK_EQ(linux_gs_usb_open(&gs, NULL, 0, 1000000, &clock_.hal), HAL_OK);
    for (unsigned i = 0; i < sizeof others / sizeof *others; i++) {
        candle_inject(&bus, i == 0U ? 1U : 0U, others[i]);
    }
    candle_inject(&bus, 0, good);
    for (int i = 0; i < 20; i++) {
        CHECK_EQ(hal_can_state(&gs.hal, &state), HAL_OK);
    }
    CHECK_EQ(hal_can_receive(&gs.hal, &got, &at_us), HAL_OK);
    CHECK(got.id == 0x243U && got.length == 1U && got.data[0] == 0xCDU);
    CHECK_EQ(hal_can_receive(&gs.hal, &got, &at_us), HAL_EMPTY);
    CHECK_EQ(state.lost_count, 0);
    CHECK_EQ(bus.node[1].waiting, 0);
    linux_gs_usb_close(&gs);
    candle.channel_count = 1;
    CHECK_EQ(libusb_model_objects(), 0);
}

/// A few transfers that fail are nothing; an adapter that fails again and again has gone.
static void transfers_that_fail_on_and_on(void) {
    static const uint8_t good[20] = {0xFF, 0xFF, 0xFF, 0xFF, 0x43, 2, 0, 0, 1, 0, 0, 0, 0xCD};
    static struct linux_gs_usb gs;
    struct hal_can_state state;
    struct can_frame got;
    uint32_t at_us;
    plug_adapter();
    memset(&bus, 0, sizeof bus);
    clock_.step_us = 25000;
    CHECK_EQ(linux_gs_usb_open(&gs, NULL, 0, 1000000, &clock_.hal), HAL_OK);
    libusb_model_faults.spoil_with = LIBUSB_TRANSFER_ERROR;
    for (int times = 0; times < 3; times++) { // in a row is what counts
        libusb_model_faults.spoil_next = 20;
        candle_inject(&bus, 0, good);
        for (int i = 0; i < 100; i++) {
            CHECK_EQ(hal_can_state(&gs.hal, &state), HAL_OK);
        }
        CHECK_EQ(libusb_model_faults.spoil_next, 0);
        CHECK_EQ(hal_can_receive(&gs.hal, &got, &at_us), HAL_OK);
    }
    libusb_model_faults.spoil_next = 1000;
    candle_inject(&bus, 0, good);
    enum hal_status status = HAL_OK;
    for (int i = 0; i < 1000 && status == HAL_OK; i++) {
        status = hal_can_state(&gs.hal, &state);
    }
    CHECK_EQ(status, HAL_ERROR_GONE);
    libusb_model_faults.spoil_next = 0;
    linux_gs_usb_close(&gs);

    memset(&bus, 0, sizeof bus);
    candle.mute = true;
    CHECK_EQ(linux_gs_usb_open(&gs, NULL, 0, 1000000, &clock_.hal), HAL_ERROR_TIMEOUT);
    CHECK(strstr(gs.error.line, ": does not answer; plug it in again") != NULL);
    candle.mute = false;
    CHECK_EQ(libusb_model_objects(), 0);
}

static void adapter_fails_at_every_step(void) {
    plug_adapter();
    each_failure("CAN adapter", live_as_adapter);
}

int main(void) {
    fake_clock_init(&clock_, 0xFFFF0000U);
    reset(NULL);
    usb_suite(&(struct usb_fixture){.name = "linux_usb",
                                    .usb = &usb.hal,
                                    .identity = {0x1FFB, 0x0089, 0x0104, MAESTRO_MODEL_SERIAL},
                                    .reset = reset,
                                    .settle = settle,
                                    .unplug = unplug,
                                    .fail_at = fail_at,
                                    .echo_out = 2,
                                    .echo_in = 0x81});
    CONTRACT("linux_usb", transfers_end_as_the_library_says);
    CONTRACT("linux_usb", transfers_that_do_not_end);
    CONTRACT("linux_usb", devices_that_can_not_be_had);
    CONTRACT("linux_usb", usb_fails_at_every_step);
    CONTRACT("linux_maestro", maestro_fails_at_every_step);
    CONTRACT("linux_gs_usb", adapters_by_their_numbers);
    CONTRACT("linux_gs_usb", frames_that_are_none_of_ours);
    CONTRACT("linux_gs_usb", transfers_that_fail_on_and_on);
    CONTRACT("linux_gs_usb", adapter_fails_at_every_step);
    linux_usb_close(&usb);
    CHECK_EQ(libusb_model_objects(), 0);
    return check_finish();
}

#else

int main(void) {
    contract_skip("linux_usb", "all", "built without libusb");
    return check_finish();
}

#endif
