/// The libusb driver and the Maestro driver on an emulated Maestro that is plugged into the
/// kernel's own USB stack.
#include "linux/linux_usb.h"
#include "contract/support/contract.h"
#include "contract/support/maestro_model.h"
#include "contract/support/usb_suite.h"
#include "linux/linux_maestro.h"
#include "vm/support/usb_port.h"

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
    linux_usb_close(&usb);
    usb_port_unplug(&port);
    return check_finish();
}
