/// The Maestro driver on a fake USB port: what goes over the wire, and what fails.
#include "linux/linux_maestro.h"
#include "contract/support/contract.h"
#include "contract/support/maestro_model.h"
#include "contract/support/pwm_suite.h"
#include "devices/fake_clock.h"
#include "devices/fake_usb.h"

#include <stdio.h>
#include <string.h>

static struct fake_clock clock_;
static struct fake_usb usb;
static struct maestro_model model;
static struct linux_maestro maestro;
static bool busy, refusing;
static uint16_t answer_bytes_max; ///< longer answers break off
static char wire[4096];           ///< every request as text: type request value index length

/// A Mini with so many channels, which answers with other bytes: errors alone, and the servos.
static struct {
    bool there;
    uint16_t channel_count, errors, position[24], target[24];
} mini;

static int answer_mini(uint8_t request, uint8_t *data) {
    memset(data, 0, 256);
    if (request == 0x83U) {
        data[2] = (uint8_t)mini.errors;
        data[3] = (uint8_t)(mini.errors >> 8);
        return 8;
    }
    for (unsigned i = 0; i < mini.channel_count; i++) {
        data[7U * i] = (uint8_t)mini.position[i];
        data[7U * i + 1U] = (uint8_t)(mini.position[i] >> 8);
        data[7U * i + 2U] = (uint8_t)mini.target[i];
        data[7U * i + 3U] = (uint8_t)(mini.target[i] >> 8);
    }
    return request == 0x87U ? 7 * mini.channel_count : -1;
}

static enum hal_status answer(void *ctx, struct hal_usb_transfer *transfer) {
    (void)ctx;
    if (busy) {
        return HAL_BUSY;
    }
    const struct hal_usb_setup *setup = &transfer->setup;
    const size_t at = strlen(wire);
    snprintf(wire + at, sizeof wire - at, "%02x %02x %04x %04x %u;", setup->request_type,
             setup->request, setup->value, setup->index, transfer->size_bytes);
    const uint8_t bytes[8] = {setup->request_type,           setup->request,
                              (uint8_t)setup->value,         (uint8_t)(setup->value >> 8),
                              (uint8_t)setup->index,         (uint8_t)(setup->index >> 8),
                              (uint8_t)transfer->size_bytes, 0};
    uint8_t data[256];
    const int count = refusing     ? -1
                      : mini.there ? answer_mini(setup->request, data)
                                   : maestro_model_control(&model, bytes, data, 0);
    if (count < 0) {
        return HAL_ERROR_UNSUPPORTED;
    }
    const uint16_t room =
        transfer->size_bytes < answer_bytes_max ? transfer->size_bytes : answer_bytes_max;
    transfer->actual_bytes = count < room ? (uint16_t)count : room;
    if (transfer->actual_bytes > 0U) {
        memcpy(transfer->data, data, transfer->actual_bytes);
    }
    return HAL_OK;
}

static const struct fake_usb_model port = {.identity = {0x1FFB, 0x0089, 0x0104, "1"},
                                           .answer = answer};

static void reset(void *context) {
    (void)context;
    memset(&model, 0, sizeof model);
    memset(&mini, 0, sizeof mini);
    busy = refusing = false;
    answer_bytes_max = UINT16_MAX;
    wire[0] = '\0';
    fake_clock_init(&clock_, 0);
    fake_usb_init(&usb, &clock_.hal, &port);
    CHECK_EQ(linux_maestro_bind(&maestro, &usb.hal, 6), HAL_OK);
}

static void expect_wire(const char *wanted) {
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
    if (!CHECK(strcmp(wire, wanted) == 0)) {
        printf("  wire %s\n", wire);
    }
    wire[0] = '\0';
}

/// Request 0x85, the pulse in quarter microseconds: 1500 us is 6000.
static void requests_byte_for_byte(void) {
    reset(NULL);
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 2, 1500000), HAL_OK);
    expect_wire("40 85 1770 0002 0;");
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 5, 992125), HAL_OK); // rounds to the nearest
    expect_wire("40 85 0f81 0005 0;");
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 0), HAL_OK); // off
    expect_wire("40 85 0000 0000 0;");
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 1), HAL_OK); // never rounds to off
    expect_wire("40 85 0001 0000 0;");
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 16383750), HAL_OK);
    expect_wire("40 85 ffff 0000 0;");
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 0, 16383751), HAL_ERROR_ARGUMENT);
    CHECK_EQ(linux_maestro_limit_speed(&maestro, 3, 300), HAL_OK);
    expect_wire("40 84 012c 0003 0;");
    CHECK_EQ(linux_maestro_limit_accel(&maestro, 3, 4), HAL_OK);
    expect_wire("40 84 0004 0083 0;");
    CHECK_EQ(linux_maestro_limit_accel(&maestro, 0, 255), HAL_OK);
    expect_wire("40 84 00ff 0080 0;");
    CHECK_EQ(linux_maestro_limit_speed(&maestro, 6, 1), HAL_ERROR_ARGUMENT);
    CHECK_EQ(linux_maestro_clear_errors(&maestro), HAL_OK);
    expect_wire("40 86 0000 0000 0;");
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_OK);
    expect_wire("c0 83 0000 0000 140;");
    CHECK(maestro.known);
    CHECK_EQ(maestro.position_ns[2], 1500000);
    CHECK_EQ(model.unknown, 0);
    CHECK_EQ(linux_maestro_bind(&maestro, &usb.hal, 18), HAL_OK); // a Mini
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_OK);
    expect_wire("c0 83 0000 0000 8;c0 87 0000 0000 126;");
}

static void ask(void) {
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_OK);
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
}

/// A Micro may leave out the last byte of its variables. What is shorter says nothing.
static void answers_of_a_micro(void) {
    for (uint16_t bytes = 130; bytes <= 141U; bytes++) {
        reset(NULL);
        answer_bytes_max = bytes;
        model.errors = 0x0102;
        for (unsigned i = 0; i < 6U; i++) {
            model.target[i] = (uint16_t)(4000U + 300U * i);
        }
        ask();
        CHECK_EQ(maestro.known, bytes >= 139U);
        CHECK_EQ(maestro.error_bits, bytes >= 139U ? 0x0102 : 0);
        for (unsigned i = 0; i < 6U; i++) {
            const uint32_t wanted_ns = bytes >= 139U ? 250U * (4000U + 300U * i) : 0U;
            CHECK_EQ(maestro.position_ns[i], wanted_ns);
            CHECK_EQ(maestro.target_ns[i], wanted_ns);
        }
    }
}

/// Two answers: the errors, and 7 bytes for each servo.
static void answers_of_a_mini(void) {
    static const uint16_t counts[] = {12, 18, 24};
    for (unsigned k = 0; k < 6U; k++) {
        const uint16_t count = counts[k / 2U];
        reset(NULL);
        mini.there = true;
        mini.channel_count = count;
        mini.errors = 0x0204;
        for (unsigned i = 0; i < count; i++) {
            mini.position[i] = (uint16_t)(4000U + i);
            mini.target[i] = (uint16_t)(8000U + 256U * i);
        }
        CHECK_EQ(linux_maestro_bind(&maestro, &usb.hal, count), HAL_OK);
        answer_bytes_max = (uint16_t)(7U * count - k % 2U);
        ask();
        CHECK_EQ(maestro.error_bits, 0x0204);
        CHECK_EQ(maestro.known, k % 2U == 0U);
        for (unsigned i = 0; i < count; i++) {
            CHECK_EQ(maestro.position_ns[i], maestro.known ? 250U * (4000U + i) : 0U);
            CHECK_EQ(maestro.target_ns[i], maestro.known ? 250U * (8000U + 256U * i) : 0U);
        }
        answer_bytes_max = 7;
        mini.errors = 0;
        ask();
        CHECK_EQ(maestro.error_bits, 0x0204); // too short to say so
    }
}

/// While a pulse is on its way, only the newest of those that follow is sent.
static void newest_pulse_wins(void) {
    for (uint32_t channel = 0; channel < 6U; channel++) {
        char wanted[64];
        reset(NULL);
        busy = true;
        for (uint32_t us = 1000; us <= 2000U; us += 100U) {
            CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, channel, us * 1000U), HAL_OK);
        }
        CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
        busy = false;
        snprintf(wanted, sizeof wanted, "40 85 0fa0 %04x 0;40 85 1f40 %04x 0;", (unsigned)channel,
                 (unsigned)channel);
        expect_wire(wanted);
        CHECK_EQ(model.target[channel], 8000);
    }
}

/// Where too much is under way it goes out later.
static void a_pulse_that_finds_no_room(void) {
    reset(NULL);
    fake_failures_at(&usb.failures, 1, 1, HAL_BUSY);
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 4, 1500000), HAL_OK);
    expect_wire("40 85 1770 0004 0;");
}

static void refusals_and_losses_are_counted(void) {
    reset(NULL);
    refusing = true;
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 1, 1500000), HAL_OK);
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_OK);
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
    CHECK_EQ(maestro.refused, 2);
    CHECK(!maestro.known);
    refusing = false;
    busy = true;
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 1, 1500000), HAL_OK);
    fake_clock_advance(&clock_, 600000);
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
    CHECK_EQ(maestro.failed, 1);
    busy = false;
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK); // what got lost is sent again
    CHECK_EQ(model.target[1], 6000);
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 1, 1250000), HAL_OK);
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_OK);
    CHECK_EQ(model.target[1], 5000);
}

static void unplugged(void) {
    reset(NULL);
    struct hal_pwm_limits limits;
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 1, 1500000), HAL_OK);
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_OK);
    fake_usb_unplug(&usb);
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_ERROR_GONE);
    CHECK(!maestro.known);
    CHECK_EQ(hal_pwm_limits(&maestro.hal, 1, &limits), HAL_ERROR_GONE); // which asks nobody
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 1, 1500000), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_set_period(&maestro.hal, 1, 20000000), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_limits(&maestro.hal, 1, &limits), HAL_ERROR_GONE);
    CHECK_EQ(linux_maestro_ask(&maestro), HAL_ERROR_GONE);
    CHECK_EQ(linux_maestro_limit_speed(&maestro, 1, 1), HAL_ERROR_GONE);
    CHECK_EQ(linux_maestro_poll(&maestro), HAL_ERROR_GONE);
    reset(NULL);
    fake_usb_unplug(&usb);
    CHECK_EQ(hal_pwm_set_pulse(&maestro.hal, 1, 1500000), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_limits(&maestro.hal, 1, &limits), HAL_ERROR_GONE);
}

int main(void) {
    reset(NULL);
    // Without a measurement: a Maestro has no room for pulses as long as its period.
    pwm_suite(&(struct pwm_fixture){
        .name = "linux_maestro", .pwm = &maestro.hal, .channel_count = 6, .reset = reset});
    CONTRACT("linux_maestro", requests_byte_for_byte);
    CONTRACT("linux_maestro", answers_of_a_micro);
    CONTRACT("linux_maestro", answers_of_a_mini);
    CONTRACT("linux_maestro", newest_pulse_wins);
    CONTRACT("linux_maestro", a_pulse_that_finds_no_room);
    CONTRACT("linux_maestro", refusals_and_losses_are_counted);
    CONTRACT("linux_maestro", unplugged);
    return check_finish();
}
