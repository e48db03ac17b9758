#include "linux/linux_gs_usb_private.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#define START_US         500000U ///< all requests that start it
#define STOP_US          50000U
#define RESTART_PAUSE_US 100000U ///< what has been tried is not tried again sooner
#define TRANSFERS_A_CALL 64      ///< taken in at most, so that a storm can't hold a call up
#define READER_TRIES     32U     ///< failures in a row that make an adapter count as gone
#define FRAME_BYTES      20U     ///< without the adapter's time
#define FROM_BUS         UINT32_MAX
#define DEFAULT_IN       0x81U
#define DEFAULT_OUT      0x02U

#define FLAG_OVERFLOW 1U ///< of a frame
#define FLAG_FD       2U
#define ID_EXTENDED   (UINT32_C(1) << 31)
#define ID_REMOTE     (UINT32_C(1) << 30)
#define ID_ERROR      (UINT32_C(1) << 29)

static const struct linux_usb_id adapters[] = {
    {0x1D50, 0x606F}, {0x1209, 0x2323}, {0x1CD2, 0x606F}, {0x16D0, 0x10B8}};
#define ADAPTER_COUNT (sizeof adapters / sizeof *adapters)

// ---------------------------------------------------------------- from the adapter

/// The adapter's time on our clock: its clock is ahead of ours by what the fastest frame shows, and
/// drifts less than 1 in 4096.
static uint32_t arrival_us(struct linux_gs_usb *gs, uint32_t adapter_us, uint32_t now_us) {
    const uint32_t offset_us = now_us - adapter_us;
    const uint32_t above_us = offset_us - gs->offset_us;
    if (!gs->offset_known || above_us >= UINT32_C(0x80000000)) {
        gs->offset_us = offset_us;
        gs->offset_at_us = now_us;
        gs->offset_known = true;
    } else if (now_us - gs->offset_at_us >= 4096U) {
        const uint32_t drift_us = (now_us - gs->offset_at_us) / 4096U;
        gs->offset_us += drift_us < above_us ? drift_us : above_us;
        gs->offset_at_us = now_us;
    }
    return adapter_us + gs->offset_us;
}

static void take_echo(struct linux_gs_usb *gs, uint32_t index, uint32_t now_us) {
    // Slots by number alone, as the kernel's driver has them: no adapter has met anything else. An
    // echo of before a restart may free a slot early; it then holds one frame more.
    if (index < LINUX_GS_USB_SLOTS && gs->slot[index].used) {
        gs->slot[index].used = false;
        gs->used_count--;
        gs->progress_us = now_us;
    }
}

static bool passes(const struct linux_gs_usb *gs, const struct can_frame *frame) {
    for (uint32_t i = 0; i < gs->filter_count; i++) {
        if (hal_can_filter_passes(&gs->filters[i], frame)) {
            return true;
        }
    }
    return false;
}

static void take_heard(struct linux_gs_usb *gs, const uint8_t *data, uint32_t at_us) {
    const uint32_t id = linux_gs_usb_get(data + 4);
    const bool extended = (id & ID_EXTENDED) != 0U;
    struct can_frame frame = {
        .id = id & (extended ? CAN_FRAME_EXTENDED_ID_MAX : CAN_FRAME_STANDARD_ID_MAX),
        .length = data[8]};
    frame.flags |= extended ? CAN_FRAME_EXTENDED : 0;
    frame.flags |= (id & ID_REMOTE) != 0U ? CAN_FRAME_REMOTE : 0;
    memcpy(frame.data, data + 12, sizeof frame.data);
    if (!can_frame_is_valid(&frame) || !passes(gs, &frame)) {
        return;
    }
    if (gs->count == LINUX_GS_USB_QUEUE) {
        gs->state.lost_count++;
        return;
    }
    gs->received[(gs->first + gs->count) % LINUX_GS_USB_QUEUE] =
        (struct linux_gs_usb_received){frame, at_us};
    gs->count++;
}

static void take_error(struct linux_gs_usb *gs, const uint8_t *data) {
    if (gs->step == GS_USB_RUNNING &&
        linux_can_digest_error(&gs->state, linux_gs_usb_get(data + 4), data + 12)) {
        linux_error_set(&gs->error, gs->name, "bus-off",
                        "check cable, termination and bit rate; it is restarted");
        linux_gs_usb_halt(gs);
    }
}

static void take_frame(struct linux_gs_usb *gs, const uint8_t *data, uint16_t size) {
    if (size < FRAME_BYTES || data[9] != gs->channel || (data[10] & FLAG_FD) != 0U) {
        return;
    }
    const uint32_t now_us = hal_clock_now_us(gs->clock);
    gs->state.lost_count += (data[10] & FLAG_OVERFLOW) != 0U;
    if (linux_gs_usb_get(data) != FROM_BUS) {
        take_echo(gs, linux_gs_usb_get(data), now_us);
    } else if ((linux_gs_usb_get(data + 4) & ID_ERROR) != 0U) {
        take_error(gs, data);
    } else {
        const bool timed = gs->has_clock && size >= FRAME_BYTES + 4U;
        take_heard(gs, data,
                   timed ? arrival_us(gs, linux_gs_usb_get(data + FRAME_BYTES), now_us) : now_us);
    }
}

// ---------------------------------------------------------------- moving what is under way

static void reader_done(struct linux_gs_usb *gs, struct linux_gs_usb_reader *reader) {
    gs->given_count++;
    if (reader->transfer.status == HAL_OK) {
        gs->failures = 0;
        take_frame(gs, reader->data, reader->transfer.actual_bytes);
    } else {
        gs->failed_count++;
        gs->failures++;
    }
}

static void slot_done(struct linux_gs_usb *gs, struct linux_gs_usb_slot *slot) {
    gs->taken_count++;
    if (slot->transfer.status != HAL_OK && slot->used) { // lost; its place is free again
        gs->failed_count++;
        slot->used = false;
        gs->used_count--;
    }
}

static void transfer_done(struct linux_gs_usb *gs, const struct hal_usb_transfer *done) {
    if (done->status == HAL_ERROR_GONE) {
        (void)linux_gs_usb_set_gone(gs);
        return;
    }
    if (done == &gs->control) {
        linux_gs_usb_request_done(gs);
        return;
    }
    for (unsigned i = 0; i < LINUX_GS_USB_READERS; i++) {
        if (done == &gs->reader[i].transfer) {
            reader_done(gs, &gs->reader[i]);
            return;
        }
    }
    for (unsigned i = 0; i < LINUX_GS_USB_SLOTS; i++) {
        if (done == &gs->slot[i].transfer) {
            slot_done(gs, &gs->slot[i]);
            return;
        }
    }
}

static void start_readers(struct linux_gs_usb *gs) {
    for (unsigned i = 0; i < LINUX_GS_USB_READERS && !gs->gone; i++) {
        struct linux_gs_usb_reader *reader = &gs->reader[i];
        if (reader->transfer.status == HAL_BUSY) {
            continue;
        }
        reader->transfer = (struct hal_usb_transfer){.kind = HAL_USB_BULK,
                                                     .endpoint = gs->endpoint_in,
                                                     .data = reader->data,
                                                     .size_bytes = sizeof reader->data};
        if (hal_usb_submit(gs->usb, &reader->transfer) == HAL_ERROR_GONE) {
            (void)linux_gs_usb_set_gone(gs);
        }
    }
}

/// Everything that is not one of our own calls happens here.
static void attend(struct linux_gs_usb *gs) {
    struct hal_usb_transfer *done;
    for (int i = 0; i < TRANSFERS_A_CALL && !gs->gone; i++) {
        const enum hal_status status = hal_usb_poll(gs->usb, &done);
        if (status == HAL_ERROR_GONE) {
            (void)linux_gs_usb_set_gone(gs);
        }
        if (status != HAL_OK) {
            break;
        }
        transfer_done(gs, done);
    }
    if (gs->failures >= READER_TRIES && !gs->gone) {
        (void)linux_gs_usb_set_gone(gs);
    }
    if (gs->waiting && !gs->gone) {
        linux_gs_usb_begin(gs, (enum linux_gs_usb_step)gs->step);
    }
    start_readers(gs);
    if (!gs->gone && gs->step == GS_USB_RUNNING && gs->used_count > 0U &&
        hal_clock_now_us(gs->clock) - gs->progress_us >= LINUX_GS_USB_PATIENCE_US) {
        linux_error_set(&gs->error, gs->name, "nobody on the bus acknowledges",
                        "check cable, termination, bit rate and the drives' power");
        linux_gs_usb_halt(gs);
    }
}

// ---------------------------------------------------------------- operations

static struct linux_gs_usb_slot *free_slot(struct linux_gs_usb *gs) {
    for (unsigned i = 0; i < LINUX_GS_USB_SLOTS; i++) {
        if (!gs->slot[i].used && gs->slot[i].transfer.status != HAL_BUSY) {
            return &gs->slot[i];
        }
    }
    return NULL;
}

static enum hal_status gs_usb_send(void *ctx, const struct can_frame *frame) {
    struct linux_gs_usb *gs = ctx;
    attend(gs);
    if (gs->gone || gs->state.health == HAL_CAN_OFF) {
        return gs->gone ? HAL_ERROR_GONE : HAL_ERROR_DOWN;
    }
    struct linux_gs_usb_slot *slot = free_slot(gs);
    if (slot == NULL) {
        return HAL_BUSY;
    }
    uint32_t id = frame->id;
    id |= (frame->flags & CAN_FRAME_EXTENDED) != 0U ? ID_EXTENDED : 0U;
    id |= (frame->flags & CAN_FRAME_REMOTE) != 0U ? ID_REMOTE : 0U;
    memset(slot->data, 0, sizeof slot->data);
    linux_gs_usb_put(slot->data, (uint32_t)(slot - gs->slot));
    linux_gs_usb_put(slot->data + 4, id);
    slot->data[8] = frame->length;
    slot->data[9] = gs->channel;
    if ((frame->flags & CAN_FRAME_REMOTE) == 0U) {
        memcpy(slot->data + 12, frame->data, frame->length);
    }
    slot->transfer = (struct hal_usb_transfer){.kind = HAL_USB_BULK,
                                               .endpoint = gs->endpoint_out,
                                               .data = slot->data,
                                               .size_bytes = FRAME_BYTES};
    const enum hal_status status = hal_usb_submit(gs->usb, &slot->transfer);
    if (status == HAL_ERROR_GONE) {
        return linux_gs_usb_set_gone(gs);
    }
    if (status != HAL_OK) {
        linux_error_set(&gs->error, gs->name, "a frame could not be handed over",
                        "try another cable or port");
        return status;
    }
    slot->used = true;
    if (gs->used_count == 0U) {
        gs->progress_us = hal_clock_now_us(gs->clock);
    }
    gs->used_count++;
    return HAL_OK;
}

static enum hal_status gs_usb_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    struct linux_gs_usb *gs = ctx;
    attend(gs);
    if (gs->gone || gs->count == 0U) {
        return gs->gone ? HAL_ERROR_GONE : HAL_EMPTY;
    }
    *frame = gs->received[gs->first].frame;
    *received_us = gs->received[gs->first].at_us;
    gs->first = (gs->first + 1U) % LINUX_GS_USB_QUEUE;
    gs->count--;
    return HAL_OK;
}

static enum hal_status gs_usb_state(void *ctx, struct hal_can_state *state) {
    struct linux_gs_usb *gs = ctx;
    attend(gs);
    if (gs->gone) {
        return HAL_ERROR_GONE;
    }
    *state = gs->state;
    return HAL_OK;
}

static enum hal_status gs_usb_set_filters(void *ctx, const struct hal_can_filter *filters,
                                          uint32_t count) {
    struct linux_gs_usb *gs = ctx;
    attend(gs); // what has come went through the old ones
    if (gs->gone) {
        return HAL_ERROR_GONE;
    }
    if (count > 0U) {
        memcpy(gs->filters, filters, count * sizeof *filters);
    }
    gs->filter_count = count;
    return HAL_OK;
}

static enum hal_status gs_usb_restart(void *ctx) {
    struct linux_gs_usb *gs = ctx;
    attend(gs);
    if (gs->gone) {
        return HAL_ERROR_GONE;
    }
    const uint32_t now_us = hal_clock_now_us(gs->clock);
    if (gs->step == GS_USB_HALT) {
        gs->restart_wanted = true;
        gs->restarted_us = now_us;
    } else if (gs->step == GS_USB_HALTED &&
               (gs->refusal == HAL_OK || now_us - gs->restarted_us >= RESTART_PAUSE_US)) {
        gs->restarted_us = now_us;
        linux_gs_usb_begin_again(gs);
    }
    return gs->gone ? HAL_ERROR_GONE : HAL_OK;
}

static const struct hal_can_ops ops = {gs_usb_send, gs_usb_receive, gs_usb_state,
                                       gs_usb_set_filters, gs_usb_restart};

// ---------------------------------------------------------------- opening

static enum hal_status prepare(struct linux_gs_usb *gs, uint8_t channel, uint32_t bitrate,
                               const struct hal_clock *clock) {
    memset(gs, 0, sizeof *gs);
    gs->gone = true;
    gs->channel = channel;
    gs->bitrate = bitrate;
    gs->clock = clock;
    gs->filter_count = 1; // all zeros: everything passes
    gs->endpoint_in = DEFAULT_IN;
    gs->endpoint_out = DEFAULT_OUT;
    snprintf(gs->name, sizeof gs->name, "CAN adapter");
    linux_can_set_health(&gs->state, HAL_CAN_OFF);
    return hal_can_bind(&gs->hal, &ops, gs);
}

enum hal_status linux_gs_usb_bind(struct linux_gs_usb *gs, const struct hal_usb *usb,
                                  uint8_t channel, uint32_t bitrate,
                                  const struct hal_clock *clock) {
    const enum hal_status status = prepare(gs, channel, bitrate, clock);
    gs->usb = usb;
    gs->gone = status != HAL_OK;
    if (!gs->gone) {
        linux_gs_usb_begin(gs, GS_USB_FORMAT);
    }
    return status;
}

/// Lets it come to a step, or not.
static void await(struct linux_gs_usb *gs, enum linux_gs_usb_step step, uint32_t patience_us) {
    const uint32_t start_us = hal_clock_now_us(gs->clock);
    attend(gs);
    while (!gs->gone && gs->step != (int)step && gs->step != GS_USB_HALTED &&
           hal_clock_now_us(gs->clock) - start_us < patience_us) {
        nanosleep(&(struct timespec){0, 500000}, NULL);
        attend(gs);
    }
}

enum hal_status linux_gs_usb_open(struct linux_gs_usb *gs, const char *serial_number,
                                  uint8_t channel, uint32_t bitrate,
                                  const struct hal_clock *clock) {
    const struct linux_usb_wanted wanted = {.ids = adapters,
                                            .id_count = ADAPTER_COUNT,
                                            .serial_number = serial_number,
                                            .interface = 0,
                                            .what = "CAN adapter"};
    enum hal_status status = prepare(gs, channel, bitrate, clock);
    status = status == HAL_OK ? linux_usb_open(&gs->own_usb, &wanted) : status;
    if (status != HAL_OK) {
        gs->error = gs->own_usb.error;
        return status;
    }
    gs->usb = &gs->own_usb.hal;
    memcpy(gs->name, gs->own_usb.name, sizeof gs->name);
    gs->endpoint_in = gs->own_usb.bulk_in != 0U ? gs->own_usb.bulk_in : DEFAULT_IN;
    gs->endpoint_out = gs->own_usb.bulk_out != 0U ? gs->own_usb.bulk_out : DEFAULT_OUT;
    gs->gone = false;
    linux_gs_usb_begin(gs, GS_USB_FORMAT);
    await(gs, GS_USB_RUNNING, START_US);
    if (gs->step == GS_USB_RUNNING && !gs->gone) {
        return HAL_OK;
    }
    if (!gs->gone && gs->refusal == HAL_OK) {
        linux_gs_usb_refuse(gs, HAL_ERROR_TIMEOUT, "does not answer", "plug it in again");
    }
    status = gs->gone ? HAL_ERROR_GONE : gs->refusal;
    linux_gs_usb_close(gs);
    return status;
}

void linux_gs_usb_close(struct linux_gs_usb *gs) {
    if (gs->usb != NULL && !gs->gone && gs->step == GS_USB_RUNNING) {
        linux_gs_usb_halt(gs);
        await(gs, GS_USB_HALTED, STOP_US);
    }
    if (gs->usb == &gs->own_usb.hal) {
        linux_usb_close(&gs->own_usb);
    }
    gs->usb = NULL;
    gs->gone = true;
}

bool linux_gs_usb_is_one(const struct hal_usb_identity *identity) {
    for (size_t i = 0; i < ADAPTER_COUNT; i++) {
        if (identity->vendor == adapters[i].vendor && identity->product == adapters[i].product) {
            return true;
        }
    }
    return false;
}
