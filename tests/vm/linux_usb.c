/// The libusb driver and the Maestro driver on an emulated Maestro that is plugged into the
/// kernel's own USB stack.
#include "linux/linux_usb.h"
#include "contract/support/contract.h"
#include "contract/support/lives.h"
#include "contract/support/maestro_model.h"
#include "contract/support/syscalls.h"
#include "contract/support/usb_suite.h"
#include "linux/linux_maestro.h"
#include "vm/support/nobody.h"
#include "vm/support/usb_port.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static struct linux_usb usb;
static struct maestro_model *model;
static struct usb_port port;
static const struct linux_usb_id micro = {0x1FFB, 0x0089};
static const struct linux_usb_wanted wanted = {.ids = &micro,
                                               .id_count = 1,
                                               .serial_number = MAESTRO_MODEL_SERIAL,
                                               .interface = 0,
                                               .what = "Maestro"};

static void plug(void) {
    const struct usb_model plugged = {.device = maestro_model_device,
                                      .configuration = maestro_model_configuration,
                                      .strings = {"Pololu", "Maestro", MAESTRO_MODEL_SERIAL},
                                      .speed = USB_FULL_SPEED,
                                      .ctx = model,
                                      .control = maestro_model_control,
                                      .bulk_out = maestro_model_bulk_out,
                                      .bulk_in = maestro_model_bulk_in};
    if (port.child == 0) {
        memset(model, 0, sizeof *model);
        usb_port_plug(&port, 0, &plugged);
    }
}

/// Opens it as soon as the kernel has looked at it.
static void reset(void *context) {
    (void)context;
    linux_usb_close(&usb);
    plug();
    model->echo_size = 0;
    enum hal_status status = HAL_ERROR_GONE;
    for (int i = 0; i < 500 && status != HAL_OK; i++) {
        status = linux_usb_open(&usb, &wanted);
        if (status != HAL_OK) {
            usleep(10000);
        }
    }
    if (!CHECK_EQ(status, HAL_OK)) {
        printf("  %s\n", usb.error.line);
    }
}

static void settle(void *context) {
    (void)context;
    usleep(1000);
}

static void unplug(void *context) {
    (void)context;
    usb_port_unplug(&port);
}

// ---------------------------------------------------------------- lines for people

static void refusals_say_what_to_do(void) {
    reset(NULL);
    struct linux_usb other;
    const struct linux_usb_id absent = {0x1FFB, 0x0001};
    struct linux_usb_wanted strange = wanted;
    CHECK_EQ(linux_usb_open(&other, &wanted), HAL_ERROR_DENIED);
    CHECK(strcmp(other.error.line, "Maestro " MAESTRO_MODEL_SERIAL
                                   ": in use by another program; end that one first") == 0);
    linux_usb_close(&other);
    strange.ids = &absent;
    CHECK_EQ(linux_usb_open(&other, &strange), HAL_ERROR_GONE);
    CHECK(strcmp(other.error.line,
                 "Maestro " MAESTRO_MODEL_SERIAL ": no such USB device; is it plugged in? "
                 "`boresight probe` lists what is there") == 0);
    linux_usb_close(&other);
    strange = wanted;
    strange.serial_number = "00027182";
    CHECK_EQ(linux_usb_open(&other, &strange), HAL_ERROR_GONE);
    struct hal_usb_transfer *done;
    CHECK_EQ(hal_usb_poll(&other.hal, &done), HAL_ERROR_GONE); // as whoever keeps it finds it
    linux_usb_close(&other);
    struct hal_usb_identity found[8];
    CHECK_EQ(linux_usb_list(0x1FFB, found, 8), 1);
    CHECK(found[0].product == 0x0089U && strcmp(found[0].serial_number, MAESTRO_MODEL_SERIAL) == 0);
}

// ---------------------------------------------------------------- Maestro

static struct linux_maestro maestro;

static void open_maestro(void) {
    enum hal_status status = HAL_ERROR_GONE;
    for (int i = 0; i < 500 && status != HAL_OK; i++) {
        status = linux_maestro_open(&maestro, NULL);
        usleep(status == HAL_OK ? 0 : 10000);
    }
    CHECK_EQ(status, HAL_OK);
    CHECK_EQ(maestro.channel_count, 6);
}

static void run_maestro(int ms) {
    for (int i = 0; i < ms; i++) {
        CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
        usleep(1000);
    }
}

static void maestro_moves_servos(void) {
    linux_usb_close(&usb);
    plug();
    open_maestro();
    for (uint32_t i = 0; i < 6U; i++) {
        CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, i, 1000000U + i * 100000U), HAL_OK);
    }
    CHECK_EQ(linux_maestro_limit_speed(&maestro, 3, 40), HAL_OK);
    CHECK_EQ(linux_maestro_limit_accel(&maestro, 3, 7), HAL_BUSY);
    run_maestro(30);
    CHECK_EQ(linux_maestro_limit_accel(&maestro, 3, 7), HAL_OK);
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_OK);
    run_maestro(30);
    for (uint32_t i = 0; i < 6U; i++) {
        CHECK_EQ(model->target[i], 4000U + i * 400U);
        CHECK_EQ(maestro.position_ns[i], 1000000U + i * 100000U);
        CHECK_EQ(maestro.target_ns[i], 1000000U + i * 100000U);
    }
    CHECK_EQ(model->speed[3], 40);
    CHECK_EQ(model->acceleration[3], 7);
    CHECK_EQ(maestro.error_bits, 0);
    model->errors = LINUX_MAESTRO_SERIAL_TIMEOUT;
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_OK);
    run_maestro(30);
    CHECK_EQ(maestro.error_bits, LINUX_MAESTRO_SERIAL_TIMEOUT);
    CHECK_EQ(linux_maestro_clear_errors(&maestro), HAL_OK);
    run_maestro(30);
    CHECK_EQ(model->errors, 0);
    CHECK_EQ(maestro.refused + maestro.failed, 0);
}

/// While pulses are on their way; and back again.
static void maestro_leaves_and_returns(void) {
    for (uint32_t i = 0; i < 6U; i++) {
        CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, i, 1234000), HAL_OK);
    }
    usb_port_unplug(&port);
    enum hal_status status = HAL_OK;
    for (int i = 0; i < 1000 && status != HAL_ERROR_GONE; i++) {
        status = linux_maestro_poll(&maestro);
        usleep(1000);
    }
    CHECK_EQ(status, HAL_ERROR_GONE);
    CHECK(strcmp(maestro.error.line, "Maestro 1ffb:0089: the device has left; plug it in again") ==
          0);
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 1500000), HAL_ERROR_GONE);
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_ERROR_GONE);
    linux_maestro_close(&maestro);
    CHECK_EQ(linux_maestro_open(&maestro, NULL), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 1500000), HAL_ERROR_GONE);
    linux_maestro_close(&maestro);
    plug();
    open_maestro();
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 5, 1750000), HAL_OK);
    run_maestro(30);
    CHECK_EQ(model->target[5], 7000);
    linux_maestro_close(&maestro);
}

// ---------------------------------------------------------------- errors at every step

/// Whose nodes below /dev are root's.
static void forbidden(void) {
    reset(NULL);
    linux_usb_close(&usb);
    nobody_begin();
    CHECK_EQ(linux_usb_open(&usb, &wanted), HAL_ERROR_DENIED);
    CHECK(strcmp(usb.error.line,
                 "Maestro " MAESTRO_MODEL_SERIAL ": no permission; install the udev rules of "
                 "docs/rig.md, or run as root, and plug it in again") == 0);
    CHECK_EQ(linux_maestro_open(&maestro, MAESTRO_MODEL_SERIAL), HAL_ERROR_DENIED);
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 1500000), HAL_ERROR_GONE);
    nobody_end();
}

/// Until the device has been asked so often, and a moment for the answer.
static void await_requests(uint32_t count) {
    for (int ms = 0; ms < 30000 && model->requests < count; ms++) {
        usleep(1000);
    }
    usleep(2000);
}

/// From opening to closing, with a read under way in the end.
static void live(void) {
    static uint8_t data[140], in[64];
    static struct hal_usb_transfer question, reading;
    struct hal_usb_transfer *done = NULL;
    const uint32_t before = model->requests;
    question = (struct hal_usb_transfer){.kind = HAL_USB_CONTROL,
                                         .setup = {.request_type = 0xC0, .request = 0x83},
                                         .data = data,
                                         .size_bytes = sizeof data,
                                         .timeout_us = 300000};
    reading = (struct hal_usb_transfer){
        .kind = HAL_USB_BULK, .endpoint = 0x81, .data = in, .size_bytes = sizeof in};
    if (life_note("open", linux_usb_open(&usb, &wanted), &usb.error) != HAL_OK) {
        CHECK_EQ(hal_usb_submit(&usb.hal, &question), HAL_ERROR_GONE);
        return;
    }
    life_value("serial", strcmp(usb.identity.serial_number, MAESTRO_MODEL_SERIAL));
    life_value("endpoints", usb.bulk_in * 256 + usb.bulk_out);
    if (life_note("ask", hal_usb_submit(&usb.hal, &question), &usb.error) == HAL_OK) {
        await_requests(before + 1U);
        enum hal_status status = HAL_EMPTY;
        for (int i = 0; i < 30000 && status == HAL_EMPTY; i++) {
            status = hal_usb_poll(&usb.hal, &done);
            usleep(status == HAL_EMPTY ? 1000 : 0);
        }
        life_note("poll", status, &usb.error);
        life_value("bytes", question.actual_bytes);
    }
    life_note("read", hal_usb_submit(&usb.hal, &reading), &usb.error);
    linux_usb_close(&usb);
    CHECK(reading.status != HAL_BUSY && question.status != HAL_BUSY);
}

/// Below the library, which has its own mind about errors: a device that it can't look at is none.
/// The files that it looks at in many hundred calls are spared, and writing, by which its threads
/// call each other: they would wait for ever. tests/contract/linux_usb.c has every error of every
/// call of the library's own.
static void fails_at_every_step(void) {
    const uint32_t any = LIFE_STATUS(HAL_ERROR_IO) | LIFE_STATUS(HAL_ERROR_GONE);
    const struct life_error errors[] = {
        {EIO, any}, {ENODEV, any}, {ENOMEM, any}, {EACCES, any | LIFE_STATUS(HAL_ERROR_DENIED)}};
    reset(NULL);
    linux_usb_close(&usb);
    lives_each_failure(
        &(struct lives){.device = "Maestro",
                        .live = live,
                        .errors = errors,
                        .error_count = 4,
                        .share_out = true,
                        .stride = LIVES_VM_STRIDE,
                        .spared = "write read close access readlink fopen opendir poll fstat "
                                  "open ",
                        .recover_every = 20});
}

int main(void) {
    if (linux_usb_library() == NULL) {
        contract_skip("linux_usb", "all", "built without libusb");
        return 0;
    }
    model = usb_port_share(sizeof *model);
    reset(NULL);
    usb_suite(&(struct usb_fixture){.name = "linux_usb",
                                    .usb = &usb.hal,
                                    .identity = {0x1FFB, 0x0089, 0x0104, MAESTRO_MODEL_SERIAL},
                                    .reset = reset,
                                    .settle = settle,
                                    .unplug = unplug,
                                    .replug_is_slow = true,
                                    .echo_out = 2,
                                    .echo_in = 0x81});
    CONTRACT("linux_usb", refusals_say_what_to_do);
    CONTRACT("linux_maestro", maestro_moves_servos);
    CONTRACT("linux_maestro", maestro_leaves_and_returns);
    CONTRACT("linux_usb", forbidden);
    CONTRACT("linux_usb", fails_at_every_step);
    linux_usb_close(&usb);
    usb_port_unplug(&port);
    return check_finish();
}
