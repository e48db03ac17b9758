#include "linux/linux_slcan.h"

#include "linux/linux_can_errors.h"

#include <stdio.h>
#include <string.h>

#define SERIAL_BAUD      115200U ///< USB adapters ignore it
#define REFUSALS_MAX     32U
#define FLAGS_EVERY_US   250000U
#define READS_A_CALL_MAX 8

// Of the answer to the flags command.
#define FLAG_OVERRUN 0x08U
#define FLAG_PASSIVE 0x20U

static const uint32_t bitrates[] = {10000,  20000,  50000,  100000, 125000,
                                    250000, 500000, 800000, 1000000};

static bool is_gone(const struct linux_slcan *slcan) {
    return slcan->serial.fd < 0 || slcan->serial.gone;
}

// ---------------------------------------------------------------- out

/// Hands the port what it takes now.
static enum hal_status flush(struct linux_slcan *slcan) {
    while (slcan->out_size > 0U) {
        size_t written;
        const enum hal_status status =
            hal_serial_write(&slcan->serial.hal, slcan->out, slcan->out_size, &written);
        if (status != HAL_OK) {
            slcan->error = slcan->serial.error;
            return status;
        }
        slcan->out_size -= written;
        memmove(slcan->out, slcan->out + written, slcan->out_size);
    }
    return HAL_OK;
}

/// Only when nothing waits, or what waits is of no use any more: a line always has room.
static void put(struct linux_slcan *slcan, const char *text, size_t size) {
    memcpy(slcan->out, text, size);
    slcan->out_size = size;
}

static size_t format(const struct can_frame *frame, char *text, size_t capacity) {
    const bool extended = (frame->flags & CAN_FRAME_EXTENDED) != 0U;
    const bool remote = (frame->flags & CAN_FRAME_REMOTE) != 0U;
    const char kind = remote ? (extended ? 'R' : 'r') : (extended ? 'T' : 't');
    int size = snprintf(text, capacity, "%c%0*X%u", kind, extended ? 8 : 3, (unsigned)frame->id,
                        frame->length);
    for (unsigned i = 0; !remote && i < frame->length; i++) {
        size += snprintf(text + size, capacity - (size_t)size, "%02X", frame->data[i]);
    }
    size += snprintf(text + size, capacity - (size_t)size, "\r");
    return (size_t)size;
}

static enum hal_status linux_slcan_send(void *ctx, const struct can_frame *frame) {
    struct linux_slcan *slcan = ctx;
    if (is_gone(slcan)) {
        return HAL_ERROR_GONE;
    }
    if (slcan->state.health == HAL_CAN_OFF) {
        return HAL_ERROR_DOWN;
    }
    const enum hal_status before = flush(slcan);
    if (before != HAL_OK) {
        return before;
    }
    char text[40];
    size_t written = 0;
    const size_t size = format(frame, text, sizeof text);
    const enum hal_status status =
        hal_serial_write(&slcan->serial.hal, (const uint8_t *)text, size, &written);
    if (status != HAL_OK) {
        slcan->error = slcan->serial.error;
        return status;
    }
    // The port took its beginning: the rest is ours to send, before anything else.
    put(slcan, text + written, size - written);
    return HAL_OK;
}

// ---------------------------------------------------------------- in

/// Digits of a hexadecimal number; false if one is none.
static bool read_hex(const char *text, size_t digits, uint32_t *value) {
    *value = 0;
    for (size_t i = 0; i < digits; i++) {
        const char c = text[i];
        const int digit = c >= '0' && c <= '9'   ? c - '0'
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                                 : -1;
        if (digit < 0) {
            return false;
        }
        *value = *value << 4 | (uint32_t)digit;
    }
    return true;
}

/// A line that tells of a frame. What follows the data is the adapter's time stamp.
static bool read_frame(const char *line, size_t size, struct can_frame *frame) {
    const bool extended = line[0] == 'T' || line[0] == 'R';
    const bool remote = line[0] == 'r' || line[0] == 'R';
    const size_t id_digits = extended ? 8U : 3U;
    uint32_t length, byte;
    *frame = (struct can_frame){
        .flags = (uint8_t)((extended ? CAN_FRAME_EXTENDED : 0) | (remote ? CAN_FRAME_REMOTE : 0))};
    if (size < 2U + id_digits || !read_hex(line + 1, id_digits, &frame->id) ||
        !read_hex(line + 1 + id_digits, 1, &length)) {
        return false;
    }
    frame->length = (uint8_t)length;
    const size_t at = 2U + id_digits, data_digits = remote ? 0U : 2U * length;
    if (!can_frame_is_valid(frame) || (size != at + data_digits && size != at + data_digits + 4U)) {
        return false;
    }
    for (size_t i = 0; i < data_digits / 2U; i++) {
        if (!read_hex(line + at + 2U * i, 2, &byte)) {
            return false;
        }
        frame->data[i] = (uint8_t)byte;
    }
    return true;
}

static void enqueue(struct linux_slcan *slcan, const struct can_frame *frame) {
    bool wanted = false;
    for (uint32_t i = 0; i < slcan->filter_count && !wanted; i++) {
        wanted = hal_can_filter_passes(&slcan->filters[i], frame);
    }
    if (!wanted) {
        return;
    }
    if (slcan->count == LINUX_SLCAN_QUEUE) {
        slcan->state.lost_count++;
        return;
    }
    slcan->received[(slcan->first + slcan->count) % LINUX_SLCAN_QUEUE] =
        (struct linux_slcan_received){*frame, hal_clock_now_us(slcan->clock)};
    slcan->count++;
}

static void take_flags(struct linux_slcan *slcan, uint32_t flags) {
    slcan->answers_flags = true;
    slcan->flags_pending = false;
    slcan->state.lost_count += (flags & FLAG_OVERRUN) != 0U;
    if (slcan->state.health != HAL_CAN_OFF) {
        linux_can_set_health(&slcan->state,
                             (flags & FLAG_PASSIVE) != 0U ? HAL_CAN_PASSIVE : HAL_CAN_ACTIVE);
    }
}

static void take_refusal(struct linux_slcan *slcan) {
    if (slcan->flags_pending) { // not every adapter knows the command, and that is all it says
        slcan->flags_pending = false;
        return;
    }
    slcan->refusals++;
    if (slcan->refusals == REFUSALS_MAX) {
        linux_can_set_health(&slcan->state, HAL_CAN_OFF);
        linux_error_set(&slcan->error, slcan->serial.path, "the adapter takes no frames",
                        "check cable, termination and bit rate; its channel is opened again");
    }
}

/// One that can't be read has been damaged on the way, and may have been a frame.
static void take_line(struct linux_slcan *slcan) {
    const char *line = slcan->line;
    const size_t size = slcan->line_size;
    const bool fits = size < sizeof slcan->line;
    struct can_frame frame;
    uint32_t flags;
    slcan->line_size = 0;
    if (size == 0U || (size == 1U && (line[0] == 'z' || line[0] == 'Z'))) {
        slcan->refusals = 0; // a command was obeyed
    } else if (size == 3U && line[0] == 'F' && read_hex(line + 1, 2, &flags)) {
        take_flags(slcan, flags);
    } else if (fits && memchr("tTrR", line[0], 4) != NULL && read_frame(line, size, &frame)) {
        enqueue(slcan, &frame);
    } else {
        slcan->state.lost_count += slcan->in_step;
    }
}

static void take_byte(struct linux_slcan *slcan, uint8_t byte) {
    if (byte == '\r') {
        take_line(slcan);
        slcan->in_step = true;
    } else if (byte == '\a') {
        slcan->state.lost_count += slcan->line_size > 0U && slcan->in_step;
        slcan->line_size = 0;
        slcan->in_step = true;
        take_refusal(slcan);
    } else if (slcan->line_size < sizeof slcan->line) { // a line that fills it is none of ours
        slcan->line[slcan->line_size++] = (char)byte;
    }
}

/// Takes in what the port has, bounded.
static enum hal_status listen(struct linux_slcan *slcan) {
    for (int i = 0; i < READS_A_CALL_MAX; i++) {
        uint8_t bytes[256];
        size_t count;
        const enum hal_status status =
            hal_serial_read(&slcan->serial.hal, bytes, sizeof bytes, &count);
        if (status != HAL_OK) {
            if (status != HAL_EMPTY) {
                slcan->error = slcan->serial.error;
            }
            return status;
        }
        for (size_t k = 0; k < count; k++) {
            take_byte(slcan, bytes[k]);
        }
    }
    return HAL_OK;
}

static void ask_flags(struct linux_slcan *slcan) {
    const uint32_t now_us = hal_clock_now_us(slcan->clock);
    if (slcan->answers_flags && slcan->out_size == 0U &&
        now_us - slcan->flags_asked_us >= FLAGS_EVERY_US) {
        put(slcan, "F\r", 2);
        slcan->flags_asked_us = now_us;
        slcan->flags_pending = true;
    }
}

static enum hal_status linux_slcan_receive(void *ctx, struct can_frame *frame,
                                           uint32_t *received_us) {
    struct linux_slcan *slcan = ctx;
    enum hal_status status = HAL_OK;
    if (slcan->count == 0U && is_gone(slcan)) {
        return HAL_ERROR_GONE;
    }
    if (slcan->count == 0U) {
        ask_flags(slcan);
        status = flush(slcan);
        status = status == HAL_OK || status == HAL_BUSY ? listen(slcan) : status;
    }
    if (slcan->count == 0U) {
        return status == HAL_OK ? HAL_EMPTY : status;
    }
    *frame = slcan->received[slcan->first].frame;
    *received_us = slcan->received[slcan->first].at_us;
    slcan->first = (slcan->first + 1U) % LINUX_SLCAN_QUEUE;
    slcan->count--;
    return HAL_OK;
}

// ---------------------------------------------------------------- state

static enum hal_status linux_slcan_state(void *ctx, struct hal_can_state *state) {
    const struct linux_slcan *slcan = ctx;
    if (is_gone(slcan)) {
        return HAL_ERROR_GONE;
    }
    *state = slcan->state;
    return HAL_OK;
}

/// What has arrived was meant for the old filters.
static enum hal_status linux_slcan_set_filters(void *ctx, const struct hal_can_filter *filters,
                                               uint32_t count) {
    struct linux_slcan *slcan = ctx;
    if (is_gone(slcan)) {
        return HAL_ERROR_GONE;
    }
    const enum hal_status status = listen(slcan);
    if (status != HAL_OK && status != HAL_EMPTY) {
        return status;
    }
    for (uint32_t i = 0; i < count; i++) {
        slcan->filters[i] = filters[i];
    }
    slcan->filter_count = count;
    return HAL_OK;
}

/// Old text is forgotten, the channel closed, its bit rate set, opened. The first carriage return
/// ends whatever the adapter has half of.
static enum hal_status open_channel(struct linux_slcan *slcan) {
    char text[24];
    const int size = snprintf(text, sizeof text, "\r\rC\rS%c\rO\rF\r", slcan->speed);
    slcan->flags_pending = true;
    put(slcan, text, (size_t)size);
    const enum hal_status status = flush(slcan);
    return status == HAL_BUSY ? HAL_OK : status;
}

static enum hal_status linux_slcan_restart(void *ctx) {
    struct linux_slcan *slcan = ctx;
    if (is_gone(slcan)) {
        return HAL_ERROR_GONE;
    }
    if (slcan->state.health != HAL_CAN_OFF) {
        return HAL_OK;
    }
    const enum hal_status status = open_channel(slcan);
    if (status != HAL_OK) {
        slcan->out_size = 0; // what has gone out opens nothing, and the next try begins anew
        return status;
    }
    linux_can_set_health(&slcan->state, HAL_CAN_ACTIVE);
    slcan->refusals = 0;
    return HAL_OK;
}

static const struct hal_can_ops ops = {linux_slcan_send, linux_slcan_receive, linux_slcan_state,
                                       linux_slcan_set_filters, linux_slcan_restart};

// ---------------------------------------------------------------- opening

enum hal_status linux_slcan_open(struct linux_slcan *slcan, const char *path, uint32_t bitrate,
                                 const struct hal_clock *clock) {
    memset(slcan, 0, sizeof *slcan);
    slcan->clock = clock;
    slcan->filter_count = 1; // a filter of zeros lets everything pass
    slcan->flags_asked_us = hal_clock_now_us(clock);
    enum hal_status status = hal_can_bind(&slcan->hal, &ops, slcan);
    for (unsigned i = 0; i < sizeof bitrates / sizeof *bitrates; i++) {
        slcan->speed = bitrates[i] == bitrate ? (char)('0' + i) : slcan->speed;
    }
    const enum hal_status opened = linux_serial_open(&slcan->serial, path, SERIAL_BAUD);
    status = status == HAL_OK ? opened : status;
    slcan->error = slcan->serial.error;
    if (status == HAL_OK && slcan->speed == '\0') {
        char reason[60];
        snprintf(reason, sizeof reason, "slcan has no bit rate of %u", (unsigned)bitrate);
        linux_error_set(&slcan->error, path, reason, "use 125000, 250000, 500000 or 1000000");
        status = HAL_ERROR_ARGUMENT;
    }
    if (status == HAL_OK) {
        status = open_channel(slcan);
    }
    if (status != HAL_OK) {
        linux_serial_close(&slcan->serial);
    }
    return status;
}

void linux_slcan_close(struct linux_slcan *slcan) {
    if (!is_gone(slcan) && flush(slcan) == HAL_OK) {
        put(slcan, "C\r", 2);
        (void)flush(slcan);
    }
    linux_serial_close(&slcan->serial);
}
