#include "linux/linux_maestro.h"

#include <stdio.h>
#include <string.h>

#define VENDOR       0x1FFBU
#define STEP_NS      250U
#define PERIOD_NS    20000000U
#define PULSE_NS_MAX (65535U * STEP_NS) ///< what a target has room for
#define TIMEOUT_US   500000U

enum request {
    GET_VARIABLES = 0x83,
    SET_SERVO_VARIABLE = 0x84,
    SET_TARGET = 0x85,
    CLEAR_ERRORS = 0x86,
    GET_SERVO_SETTINGS = 0x87, // Mini only: the Micro has them in its variables
};
#define ACCELERATION 0x80U ///< of SET_SERVO_VARIABLE's index

// The Micro's variables, and the record of a servo.
#define MICRO_CHANNELS     6U
#define MICRO_ERRORS_AT    2U
#define MICRO_SERVOS_AT    98U
#define MICRO_BYTES        140U
#define MINI_BYTES         8U
#define SERVO_RECORD_BYTES 7U

static const struct linux_usb_id models[] = {
    {VENDOR, 0x0089}, {VENDOR, 0x008A}, {VENDOR, 0x008B}, {VENDOR, 0x008C}};
static const uint32_t channels_of[] = {6, 12, 18, 24};

// ---------------------------------------------------------------- requests

static enum hal_status submit(struct linux_maestro *maestro, struct hal_usb_transfer *transfer) {
    const enum hal_status status = hal_usb_submit(maestro->usb, transfer);
    maestro->gone = maestro->gone || status == HAL_ERROR_GONE;
    if (status == HAL_ERROR_GONE || status == HAL_ERROR_IO) {
        maestro->error = maestro->own_usb.error;
    }
    return status;
}

static struct hal_usb_transfer request(uint8_t what, uint16_t value, uint16_t index) {
    return (struct hal_usb_transfer){
        .kind = HAL_USB_CONTROL,
        .setup = {.request_type = 0x40, .request = what, .value = value, .index = index},
        .timeout_us = TIMEOUT_US};
}

static struct hal_usb_transfer question(uint8_t what, uint8_t *data, uint16_t size) {
    struct hal_usb_transfer transfer = request(what, 0, 0);
    transfer.setup.request_type = 0x40 | HAL_USB_IN;
    transfer.data = data;
    transfer.size_bytes = size;
    return transfer;
}

static enum hal_status send_target(struct linux_maestro *maestro, uint32_t index) {
    struct linux_maestro_channel *channel = &maestro->channel[index];
    channel->transfer = request(SET_TARGET, channel->wanted_qus, (uint16_t)index);
    const enum hal_status status = submit(maestro, &channel->transfer);
    channel->dirty = status == HAL_BUSY; // too much under way: later
    return status == HAL_BUSY ? HAL_OK : status;
}

// ---------------------------------------------------------------- pulses

static enum hal_status maestro_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    const struct linux_maestro *maestro = ctx;
    if (maestro->gone || channel >= maestro->channel_count) {
        return maestro->gone ? HAL_ERROR_GONE : HAL_ERROR_ARGUMENT;
    }
    *limits = (struct hal_pwm_limits){PERIOD_NS, PERIOD_NS, PERIOD_NS, STEP_NS};
    return HAL_OK;
}

static enum hal_status maestro_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    const struct linux_maestro *maestro = ctx;
    if (maestro->gone) {
        return HAL_ERROR_GONE;
    }
    return channel < maestro->channel_count && period_ns == PERIOD_NS ? HAL_OK : HAL_ERROR_ARGUMENT;
}

static enum hal_status maestro_set_pulse(void *ctx, uint32_t index, uint32_t pulse_ns) {
    struct linux_maestro *maestro = ctx;
    if (maestro->gone) {
        return HAL_ERROR_GONE;
    }
    if (index >= maestro->channel_count || pulse_ns > PULSE_NS_MAX) {
        return HAL_ERROR_ARGUMENT;
    }
    struct linux_maestro_channel *channel = &maestro->channel[index];
    channel->wanted_qus = (uint16_t)(hal_pwm_round_ns(pulse_ns, STEP_NS) / STEP_NS);
    if (channel->transfer.status == HAL_BUSY) {
        channel->dirty = true;
        return HAL_OK;
    }
    return send_target(maestro, index);
}

static const struct hal_pwm_ops ops = {maestro_limits, maestro_set_period, maestro_set_pulse};

// ---------------------------------------------------------------- answers

static uint16_t u16_at(const uint8_t *bytes) {
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

static void take_servos(struct linux_maestro *maestro, const uint8_t *records) {
    for (uint32_t i = 0; i < maestro->channel_count; i++) {
        const uint8_t *record = records + i * SERVO_RECORD_BYTES;
        maestro->position_ns[i] = u16_at(record) * STEP_NS;
        maestro->target_ns[i] = u16_at(record + 2) * STEP_NS;
    }
    maestro->known = true;
}

/// The firmware's header counts the Micro's variables one byte short; either will do.
static void take_answer(struct linux_maestro *maestro, const struct hal_usb_transfer *transfer) {
    const bool micro = maestro->channel_count == MICRO_CHANNELS;
    if (transfer == &maestro->asking_errors && transfer->actual_bytes >= MINI_BYTES) {
        maestro->error_bits = u16_at(maestro->errors_answer + MICRO_ERRORS_AT);
    } else if (transfer == &maestro->asking && micro &&
               transfer->actual_bytes >= MICRO_BYTES - 1U) {
        maestro->error_bits = u16_at(maestro->answer + MICRO_ERRORS_AT);
        take_servos(maestro, maestro->answer + MICRO_SERVOS_AT);
    } else if (transfer == &maestro->asking && !micro &&
               transfer->actual_bytes >= SERVO_RECORD_BYTES * maestro->channel_count) {
        take_servos(maestro, maestro->answer);
    }
}

/// A pulse that got lost on its way is sent again; one that is refused would be again.
static void take_failure(struct linux_maestro *maestro, const struct hal_usb_transfer *transfer) {
    const bool refused = transfer->status == HAL_ERROR_UNSUPPORTED;
    maestro->refused += refused ? 1U : 0U;
    maestro->failed += refused ? 0U : 1U;
    for (uint32_t i = 0; i < maestro->channel_count && !refused; i++) {
        maestro->channel[i].dirty =
            maestro->channel[i].dirty || transfer == &maestro->channel[i].transfer;
    }
}

enum hal_status linux_maestro_poll(struct linux_maestro *maestro) {
    struct hal_usb_transfer *done;
    enum hal_status status = HAL_EMPTY;
    while (!maestro->gone && (status = hal_usb_poll(maestro->usb, &done)) == HAL_OK) {
        if (done->status == HAL_OK) {
            take_answer(maestro, done);
        } else {
            take_failure(maestro, done);
        }
    }
    maestro->failed += status == HAL_ERROR_IO ? 1U : 0U;
    if (maestro->gone || status == HAL_ERROR_GONE) {
        maestro->gone = true;
        maestro->known = false;
        maestro->error = maestro->own_usb.error;
        return HAL_ERROR_GONE;
    }
    for (uint32_t i = 0; i < maestro->channel_count; i++) {
        if (maestro->channel[i].dirty && maestro->channel[i].transfer.status != HAL_BUSY) {
            if (send_target(maestro, i) != HAL_OK) {
                maestro->channel[i].dirty = true; // again at the next poll
            }
        }
    }
    return HAL_OK;
}

enum hal_status linux_maestro_ask(struct linux_maestro *maestro) {
    if (maestro->gone) {
        return HAL_ERROR_GONE;
    }
    if (maestro->asking.status == HAL_BUSY || maestro->asking_errors.status == HAL_BUSY) {
        return HAL_BUSY;
    }
    if (maestro->channel_count == MICRO_CHANNELS) {
        maestro->asking = question(GET_VARIABLES, maestro->answer, MICRO_BYTES);
        return submit(maestro, &maestro->asking);
    }
    maestro->asking_errors = question(GET_VARIABLES, maestro->errors_answer, MINI_BYTES);
    maestro->asking = question(GET_SERVO_SETTINGS, maestro->answer,
                               (uint16_t)(SERVO_RECORD_BYTES * maestro->channel_count));
    const enum hal_status status = submit(maestro, &maestro->asking_errors);
    return status == HAL_OK ? submit(maestro, &maestro->asking) : status;
}

static enum hal_status set(struct linux_maestro *maestro, struct hal_usb_transfer transfer) {
    if (maestro->gone) {
        return HAL_ERROR_GONE;
    }
    if (maestro->setting.status == HAL_BUSY) {
        return HAL_BUSY;
    }
    maestro->setting = transfer;
    return submit(maestro, &maestro->setting);
}

enum hal_status linux_maestro_limit_speed(struct linux_maestro *maestro, uint32_t channel,
                                          uint16_t speed) {
    return channel < maestro->channel_count
               ? set(maestro, request(SET_SERVO_VARIABLE, speed, (uint16_t)channel))
               : HAL_ERROR_ARGUMENT;
}

enum hal_status linux_maestro_limit_accel(struct linux_maestro *maestro, uint32_t channel,
                                          uint8_t acceleration) {
    return channel < maestro->channel_count
               ? set(maestro,
                     request(SET_SERVO_VARIABLE, acceleration, (uint16_t)(channel | ACCELERATION)))
               : HAL_ERROR_ARGUMENT;
}

enum hal_status linux_maestro_clear_errors(struct linux_maestro *maestro) {
    return set(maestro, request(CLEAR_ERRORS, 0, 0));
}

// ---------------------------------------------------------------- opening

enum hal_status linux_maestro_bind(struct linux_maestro *maestro, const struct hal_usb *usb,
                                   uint32_t channel_count) {
    memset(maestro, 0, sizeof *maestro);
    maestro->usb = usb;
    maestro->channel_count = channel_count;
    return hal_pwm_bind(&maestro->hal, &ops, maestro);
}

enum hal_status linux_maestro_open(struct linux_maestro *maestro, const char *serial_number) {
    const struct linux_usb_wanted wanted = {.ids = models,
                                            .id_count = 4,
                                            .serial_number = serial_number,
                                            .interface = -1,
                                            .what = "Maestro"};
    enum hal_status status = linux_maestro_bind(maestro, &maestro->own_usb.hal, MICRO_CHANNELS);
    const enum hal_status opened = linux_usb_open(&maestro->own_usb, &wanted);
    status = status == HAL_OK ? opened : status;
    for (unsigned i = 0; i < 4U; i++) {
        if (maestro->own_usb.identity.product == models[i].product) {
            maestro->channel_count = channels_of[i];
        }
    }
    maestro->error = maestro->own_usb.error;
    maestro->gone = status != HAL_OK;
    return status;
}

void linux_maestro_close(struct linux_maestro *maestro) {
    if (maestro->usb == &maestro->own_usb.hal) {
        linux_usb_close(&maestro->own_usb);
    }
    maestro->gone = true;
}
