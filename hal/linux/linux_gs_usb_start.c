#include "linux/linux_gs_usb_private.h"

#include <stdio.h>
#include <string.h>

#define TIMEOUT_US 200000U ///< of a request

enum request {
    REQUEST_FORMAT = 0,
    REQUEST_TIMING = 1,
    REQUEST_MODE = 2,
    REQUEST_LIMITS = 4,
    REQUEST_CONFIG = 5
};
#define MODE_START    1U
#define FEATURE_CLOCK (UINT32_C(1) << 4) ///< and the flag of MODE that asks for its times
#define CONFIG_BYTES  12U
#define LIMITS_BYTES  40U
#define CHANNELS_AT   3U ///< in the config: their number less one

enum hal_status linux_gs_usb_set_gone(struct linux_gs_usb *gs) {
    gs->gone = true;
    linux_error_set(&gs->error, gs->name, "the adapter has left", "plug it in again");
    return HAL_ERROR_GONE;
}

static void ask(struct linux_gs_usb *gs, uint8_t request, uint16_t value, uint16_t size, bool in) {
    gs->control = (struct hal_usb_transfer){.kind = HAL_USB_CONTROL,
                                            .setup = {in ? 0xC1U : 0x41U, request, value, 0},
                                            .data = gs->control_data,
                                            .size_bytes = size,
                                            .timeout_us = TIMEOUT_US};
}

static void fill_timing(struct linux_gs_usb *gs) {
    struct linux_gs_usb_timing timing = {0};
    (void)!linux_gs_usb_timing(&gs->limits, gs->bitrate, &timing); // true: it was tried before
    linux_gs_usb_put(gs->control_data, timing.segment1 / 2U);
    linux_gs_usb_put(gs->control_data + 4, timing.segment1 - timing.segment1 / 2U);
    linux_gs_usb_put(gs->control_data + 8, timing.segment2);
    linux_gs_usb_put(gs->control_data + 12, 1U);
    linux_gs_usb_put(gs->control_data + 16, timing.divider);
    ask(gs, REQUEST_TIMING, gs->channel, 20, false);
}

void linux_gs_usb_begin(struct linux_gs_usb *gs, enum linux_gs_usb_step step) {
    gs->step = (int)step;
    memset(gs->control_data, 0, sizeof gs->control_data);
    switch (step) {
    case GS_USB_FORMAT:
        linux_gs_usb_put(gs->control_data, 0x0000BEEF);
        ask(gs, REQUEST_FORMAT, 1, 4, false);
        break;
    case GS_USB_CONFIG:
        ask(gs, REQUEST_CONFIG, 1, CONFIG_BYTES, true);
        break;
    case GS_USB_LIMITS:
        ask(gs, REQUEST_LIMITS, gs->channel, LIMITS_BYTES, true);
        break;
    case GS_USB_TIMING:
        fill_timing(gs);
        break;
    case GS_USB_START:
        linux_gs_usb_put(gs->control_data, MODE_START);
        linux_gs_usb_put(gs->control_data + 4, gs->has_clock ? FEATURE_CLOCK : 0U);
        ask(gs, REQUEST_MODE, gs->channel, 8, false);
        break;
    default: // GS_USB_RESET, GS_USB_HALT: mode 0
        ask(gs, REQUEST_MODE, gs->channel, 8, false);
        break;
    }
    const enum hal_status status = hal_usb_submit(gs->usb, &gs->control);
    gs->waiting = status != HAL_OK;
    if (status == HAL_ERROR_GONE) {
        (void)linux_gs_usb_set_gone(gs);
    }
}

void linux_gs_usb_begin_again(struct linux_gs_usb *gs) {
    linux_gs_usb_begin(gs, gs->limits.clock_hz != 0U ? GS_USB_RESET : GS_USB_FORMAT);
}

void linux_gs_usb_halt(struct linux_gs_usb *gs) {
    for (unsigned i = 0; i < LINUX_GS_USB_SLOTS; i++) {
        gs->slot[i].used = false;
        if (gs->slot[i].transfer.status == HAL_BUSY) {
            (void)!hal_usb_cancel(gs->usb, &gs->slot[i].transfer);
        }
    }
    gs->used_count = 0;
    gs->restart_wanted = false;
    linux_can_set_health(&gs->state, HAL_CAN_OFF);
    linux_gs_usb_begin(gs, GS_USB_HALT);
}

void linux_gs_usb_refuse(struct linux_gs_usb *gs, enum hal_status why, const char *reason,
                         const char *remedy) {
    gs->step = GS_USB_HALTED;
    gs->refusal = why;
    linux_error_set(&gs->error, gs->name, reason, remedy);
}

static bool take_config(struct linux_gs_usb *gs) {
    gs->channel_count = (uint8_t)(gs->control_data[CHANNELS_AT] + 1U);
    if (gs->control.actual_bytes < CONFIG_BYTES || gs->channel >= gs->channel_count) {
        char reason[80];
        snprintf(reason, sizeof reason, "no channel %u, it has %u", gs->channel, gs->channel_count);
        linux_gs_usb_refuse(gs, HAL_ERROR_ARGUMENT, reason, "choose another one in the rig file");
        return false;
    }
    return true;
}

static bool take_limits(struct linux_gs_usb *gs) {
    const uint8_t *at = gs->control_data;
    struct linux_gs_usb_timing timing;
    gs->has_clock = (linux_gs_usb_get(at) & FEATURE_CLOCK) != 0U;
    gs->limits = (struct linux_gs_usb_limits){
        linux_gs_usb_get(at + 4),  linux_gs_usb_get(at + 8),  linux_gs_usb_get(at + 12),
        linux_gs_usb_get(at + 16), linux_gs_usb_get(at + 20), linux_gs_usb_get(at + 24),
        linux_gs_usb_get(at + 28), linux_gs_usb_get(at + 32), linux_gs_usb_get(at + 36)};
    if (gs->control.actual_bytes < LIMITS_BYTES ||
        !linux_gs_usb_timing(&gs->limits, gs->bitrate, &timing)) {
        char reason[80];
        snprintf(reason, sizeof reason, "can't do %u bit/s", (unsigned)gs->bitrate);
        linux_gs_usb_refuse(gs, HAL_ERROR_UNSUPPORTED, reason,
                            "1000000, 500000 and 250000 are usual");
        gs->limits.clock_hz = 0;
        return false;
    }
    return true;
}

static void run(struct linux_gs_usb *gs) {
    gs->step = GS_USB_RUNNING;
    gs->refusal = HAL_OK;
    gs->offset_known = false;
    linux_can_set_health(&gs->state, HAL_CAN_ACTIVE);
}

static void request_failed(struct linux_gs_usb *gs) {
    gs->failed_count++;
    if (gs->control.status == HAL_ERROR_TIMEOUT) {
        linux_gs_usb_refuse(gs, HAL_ERROR_TIMEOUT, "does not answer", "plug it in again");
    } else if (gs->control.status == HAL_ERROR_UNSUPPORTED) {
        char reason[64];
        snprintf(reason, sizeof reason, "refused request %u", gs->control.setup.request);
        linux_gs_usb_refuse(gs, HAL_ERROR_UNSUPPORTED, reason, "is its firmware candleLight's?");
    } else {
        linux_gs_usb_refuse(gs, HAL_ERROR_IO, "a request failed", "try another cable or port");
    }
}

void linux_gs_usb_request_done(struct linux_gs_usb *gs) {
    const enum linux_gs_usb_step step = (enum linux_gs_usb_step)gs->step;
    if (gs->control.status != HAL_OK) {
        request_failed(gs);
    } else if (step == GS_USB_HALT) {
        gs->step = GS_USB_HALTED;
    } else if (step == GS_USB_START) {
        run(gs);
    } else if ((step != GS_USB_CONFIG || take_config(gs)) &&
               (step != GS_USB_LIMITS || take_limits(gs))) {
        linux_gs_usb_begin(gs, step + 1);
    }
    if (gs->step == GS_USB_HALTED && gs->restart_wanted && !gs->gone) {
        gs->restart_wanted = false;
        linux_gs_usb_begin_again(gs);
    }
}
