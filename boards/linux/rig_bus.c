#include "rig_bus.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BITRATE     1000000U
#define REQUEST_IDS 0x140U

// ---------------------------------------------------------------- the text

/// A number behind a mark, up to the end or the next mark. Moves *at behind it.
static bool take_number(const char **at, uint32_t most, uint32_t *number) {
    char *end;
    const char *digits = *at + 1;
    const unsigned long value = strtoul(digits, &end, 10);
    if (*digits < '0' || *digits > '9' || value > most) {
        return false;
    }
    *number = (uint32_t)value;
    *at = end;
    return true;
}

bool rig_bus_parse(const char *text, struct rig_bus_address *address) {
    static const struct {
        const char *name, *ends;
        enum rig_bus_kind kind;
    } schemes[] = {{"can", "", RIG_BUS_SOCKETCAN},
                   {"slcan", "@", RIG_BUS_SLCAN},
                   {"gs_usb", "/@", RIG_BUS_GS_USB}};
    const size_t name_size = strcspn(text, ":/@");
    size_t scheme = 0;
    while (scheme < 3U && (strlen(schemes[scheme].name) != name_size ||
                           memcmp(schemes[scheme].name, text, name_size) != 0)) {
        scheme++;
    }
    if (scheme == 3U) {
        return false;
    }
    *address = (struct rig_bus_address){.kind = schemes[scheme].kind, .bitrate = BITRATE};
    const char *at = text + name_size;
    if (*at == ':') {
        const size_t size = strcspn(++at, schemes[scheme].ends);
        if (size == 0U || size >= sizeof address->path) {
            return false;
        }
        memcpy(address->path, at, size);
        at += size;
    } else if (address->kind != RIG_BUS_GS_USB) {
        return false;
    }
    uint32_t channel = 0;
    if (*at == '/' && !take_number(&at, 255, &channel)) {
        return false;
    }
    address->channel = (uint8_t)channel;
    if (*at == '@' &&
        (!take_number(&at, UINT32_MAX, &address->bitrate) || address->bitrate == 0U)) {
        return false;
    }
    return *at == '\0';
}

// ---------------------------------------------------------------- several as one

static enum hal_status bus_send(struct rig_bus *bus, const struct hal_clock *clock,
                                const struct can_frame *frame) {
    struct rig_bus_condition *condition = &bus->condition;
    const enum hal_status status = bus->lost ? HAL_ERROR_GONE : hal_can_send(bus->hal, frame);
    if (status == HAL_BUSY && !condition->full) {
        condition->full_since_us = hal_clock_now_us(clock);
    }
    condition->full = status == HAL_BUSY;
    condition->restarting = condition->restarting && status != HAL_OK;
    return status;
}

static enum hal_status together_send(void *ctx, const struct can_frame *frame) {
    struct rig_buses *buses = ctx;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (frame->id != buses->request_id[axis]) {
            continue;
        }
        struct rig_bus *bus = buses->bus_of[axis];
        const enum hal_status status = bus_send(bus, buses->clock, frame);
        if (status == HAL_ERROR_DOWN && hal_can_restart(bus->hal) == HAL_OK) {
            buses->restarts += !bus->condition.restarting;
            bus->condition.restarting = true;
        }
        buses->dropped += status != HAL_OK;
        return HAL_OK;
    }
    return HAL_ERROR_ARGUMENT;
}

static enum hal_status together_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    struct rig_buses *buses = ctx;
    enum hal_status worst = HAL_EMPTY;
    for (unsigned i = 0; i < buses->count; i++) {
        const struct rig_bus *bus = &buses->bus[i];
        const enum hal_status status =
            bus->lost ? HAL_ERROR_GONE : hal_can_receive(bus->hal, frame, at_us);
        if (status == HAL_OK) {
            return HAL_OK;
        }
        worst = status != HAL_EMPTY ? status : worst;
    }
    return worst;
}

static enum hal_status together_state(void *ctx, struct hal_can_state *state) {
    struct rig_buses *buses = ctx;
    struct hal_can_state sum = {.health = HAL_CAN_ACTIVE};
    for (unsigned i = 0; i < buses->count; i++) {
        struct hal_can_state one;
        const struct rig_bus *bus = &buses->bus[i];
        const enum hal_status status = bus->lost ? HAL_ERROR_GONE : hal_can_state(bus->hal, &one);
        if (status != HAL_OK) {
            return status;
        }
        const uint32_t lost = sum.lost_count + one.lost_count;
        sum = one.health > sum.health ? one : sum;
        sum.lost_count = lost;
    }
    *state = sum;
    return HAL_OK;
}

/// Each bus has its filters, of its own drives.
static enum hal_status front_set_filters(void *ctx, const struct hal_can_filter *filters,
                                         uint32_t count) {
    (void)ctx;
    (void)filters;
    (void)count;
    return HAL_ERROR_UNSUPPORTED;
}

static enum hal_status together_restart(void *ctx) {
    struct rig_buses *buses = ctx;
    enum hal_status worst = HAL_OK;
    for (unsigned i = 0; i < buses->count; i++) {
        const struct rig_bus *bus = &buses->bus[i];
        const enum hal_status status = bus->lost ? HAL_ERROR_GONE : hal_can_restart(bus->hal);
        worst = status != HAL_OK ? status : worst;
    }
    return worst;
}

// One alone is itself, as long as it is there.

static enum hal_status alone_send(void *ctx, const struct can_frame *frame) {
    struct rig_buses *buses = ctx;
    return bus_send(&buses->bus[0], buses->clock, frame);
}

static enum hal_status alone_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    const struct rig_bus *bus = &((struct rig_buses *)ctx)->bus[0];
    return bus->lost ? HAL_ERROR_GONE : hal_can_receive(bus->hal, frame, at_us);
}

static enum hal_status alone_state(void *ctx, struct hal_can_state *state) {
    const struct rig_bus *bus = &((struct rig_buses *)ctx)->bus[0];
    return bus->lost ? HAL_ERROR_GONE : hal_can_state(bus->hal, state);
}

static enum hal_status alone_restart(void *ctx) {
    const struct rig_bus *bus = &((struct rig_buses *)ctx)->bus[0];
    return bus->lost ? HAL_ERROR_GONE : hal_can_restart(bus->hal);
}

static const struct hal_can_ops alone_ops = {alone_send, alone_receive, alone_state,
                                             front_set_filters, alone_restart};
static const struct hal_can_ops together_ops = {together_send, together_receive, together_state,
                                                front_set_filters, together_restart};

// ---------------------------------------------------------------- which there are

static struct rig_bus *bus_called(struct rig_buses *buses, const char *text) {
    for (unsigned i = 0; i < buses->count; i++) {
        if (strcmp(buses->bus[i].text, text) == 0) {
            return &buses->bus[i];
        }
    }
    struct rig_bus *bus = &buses->bus[buses->count];
    bus->text = text;
    bus->can.fd = bus->can.error_fd = bus->slcan.serial.fd = -1;
    return rig_bus_parse(text, &bus->address) ? &buses->bus[buses->count++] : NULL;
}

/// Replies of the rig's drives, and nothing else, are heard.
static void listen_to(struct rig_bus *bus, const struct drive_rmd_config *rmd) {
    bus->filters[bus->filter_count++] =
        (struct hal_can_filter){.id = REQUEST_IDS + rmd->reply_offset + rmd->id,
                                .id_mask = CAN_FRAME_EXTENDED_ID_MAX,
                                .flags = 0,
                                .flags_mask = CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE};
}

bool rig_buses_find(struct rig_buses *buses, const struct rig *rig, const struct hal_clock *clock) {
    static const char *const names[] = {"pan", "tilt"};
    memset(buses, 0, sizeof *buses);
    buses->clock = clock;
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        const struct drive_config *drive = &rig->controller.axis[axis].drive;
        if (drive->kind != DRIVE_RMD) {
            continue;
        }
        struct rig_bus *bus = bus_called(buses, rig->bus[axis]);
        if (bus == NULL) {
            ini_complain(&rig->ini, names[axis], "", "bus",
                         "is '%s'; on a rig with real devices it is can:NAME, slcan:DEVICE or "
                         "gs_usb",
                         rig->bus[axis]);
            return false;
        }
        listen_to(bus, &drive->rmd);
        buses->bus_of[axis] = bus;
        buses->request_id[axis] = REQUEST_IDS + drive->rmd.id;
    }
    return hal_can_bind(&buses->front, buses->count == 1U ? &alone_ops : &together_ops, buses) ==
           HAL_OK;
}

// ---------------------------------------------------------------- opening

static enum hal_status open_bus(struct rig_buses *buses, struct rig_bus *bus) {
    const struct rig_bus_address *address = &bus->address;
    enum hal_status status;
    switch (address->kind) {
    case RIG_BUS_SOCKETCAN:
        status = linux_can_open(&bus->can, address->path, buses->clock);
        bus->error = bus->can.error;
        bus->hal = &bus->can.hal;
        break;
    case RIG_BUS_SLCAN:
        status = linux_slcan_open(&bus->slcan, address->path, address->bitrate, buses->clock);
        bus->error = bus->slcan.error;
        bus->hal = &bus->slcan.hal;
        break;
    default:
        status = linux_gs_usb_open(&bus->gs_usb, address->path[0] != '\0' ? address->path : NULL,
                                   address->channel, address->bitrate, buses->clock);
        bus->error = bus->gs_usb.error;
        bus->hal = &bus->gs_usb.hal;
        break;
    }
    return status == HAL_OK ? hal_can_set_filters(bus->hal, bus->filters, bus->filter_count)
                            : status;
}

static void close_bus(struct rig_bus *bus) {
    if (bus->hal == NULL) {
        return; // it was never opened
    }
    if (bus->address.kind == RIG_BUS_SOCKETCAN) {
        linux_can_close(&bus->can);
    } else if (bus->address.kind == RIG_BUS_SLCAN) {
        linux_slcan_close(&bus->slcan);
    } else {
        linux_gs_usb_close(&bus->gs_usb);
    }
}

enum hal_status rig_buses_open(struct rig_buses *buses) {
    enum hal_status status = HAL_OK;
    for (unsigned i = 0; i < buses->count && status == HAL_OK; i++) {
        status = open_bus(buses, &buses->bus[i]);
        buses->error = buses->bus[i].error;
    }
    buses->hal = buses->count == 0U ? NULL : &buses->front;
    return status;
}

void rig_buses_close(struct rig_buses *buses) {
    for (unsigned i = 0; i < buses->count; i++) {
        close_bus(&buses->bus[i]);
    }
}

// ---------------------------------------------------------------- leaving and coming back

static const struct linux_error *error_of(const struct rig_bus *bus) {
    return bus->address.kind == RIG_BUS_SOCKETCAN ? &bus->can.error
           : bus->address.kind == RIG_BUS_SLCAN   ? &bus->slcan.error
                                                  : &bus->gs_usb.error;
}

const char *rig_buses_newly_lost(struct rig_buses *buses) {
    struct hal_can_state state;
    for (unsigned i = 0; i < buses->count; i++) {
        struct rig_bus *bus = &buses->bus[i];
        if (!bus->lost && hal_can_state(bus->hal, &state) == HAL_ERROR_GONE) {
            bus->lost = true;
            bus->condition = (struct rig_bus_condition){0};
            buses->error = *error_of(bus);
            if (bus->address.kind == RIG_BUS_SLCAN) {
                linux_slcan_close(&bus->slcan); // else it comes back under another name
            }
            return buses->error.line;
        }
    }
    return NULL;
}

bool rig_buses_incomplete(const struct rig_buses *buses) {
    return (buses->count > 0U && buses->bus[0].lost) || (buses->count > 1U && buses->bus[1].lost);
}

bool rig_bus_reopen(struct rig_buses *buses, struct rig_bus *bus) {
    close_bus(bus);
    return open_bus(buses, bus) == HAL_OK;
}

// ---------------------------------------------------------------- news

#define REMEDY "check cable, termination, bit rate and the drives' power"

static bool is_past(uint32_t then_us, uint32_t now_us, uint32_t span_us) {
    return hal_clock_span_us(then_us, now_us) >= span_us;
}

/// Takes in what the driver says.
static void look(struct rig_buses *buses, struct rig_bus *bus) {
    struct rig_bus_condition *condition = &bus->condition;
    struct hal_can_state state;
    if (bus->lost || hal_can_state(bus->hal, &state) != HAL_OK) {
        return;
    }
    if (state.health == HAL_CAN_OFF && condition->health != HAL_CAN_OFF) {
        condition->went_off = true;
        buses->offs++;
    }
    if (state.health == HAL_CAN_OFF) {
        condition->off = *error_of(bus); // which may turn into why it can't be restarted
    }
    condition->health = state.health;
    condition->frames_lost += state.lost_count - condition->lost_count;
    buses->frames_lost += state.lost_count - condition->lost_count;
    condition->lost_count = state.lost_count;
}

static enum rig_bus_trouble trouble_of(const struct rig_bus_condition *condition, uint32_t now_us) {
    if (condition->health == HAL_CAN_OFF || condition->went_off) {
        return RIG_BUS_OFF;
    }
    if (condition->full && is_past(condition->full_since_us, now_us, RIG_BUS_FULL_US)) {
        return RIG_BUS_FULL;
    }
    return condition->health == HAL_CAN_PASSIVE ? RIG_BUS_PASSIVE : RIG_BUS_WELL;
}

static void describe(const struct rig_bus *bus, enum rig_bus_trouble trouble,
                     struct linux_error *line) {
    switch (trouble) {
    case RIG_BUS_OFF:
        *line = bus->condition.off;
        break;
    case RIG_BUS_FULL:
        linux_error_set(line, bus->text, "takes no frames, nobody on the bus acknowledges", REMEDY);
        break;
    case RIG_BUS_PASSIVE:
        linux_error_set(line, bus->text, "error-passive, many frames fail", REMEDY);
        break;
    default:
        snprintf(line->line, sizeof line->line, "%s: the bus works again", bus->text);
        break;
    }
}

/// Whether what is wrong with it has changed: the line is in condition->line then.
static bool trouble_is_new(struct rig_bus *bus, uint32_t now_us, bool *severe) {
    struct rig_bus_condition *condition = &bus->condition;
    const enum rig_bus_trouble trouble = trouble_of(condition, now_us);
    struct linux_error line = {.line = ""};
    if (trouble == RIG_BUS_WELL && condition->told == RIG_BUS_WELL) {
        return false;
    }
    describe(bus, trouble, &line);
    const bool same = trouble == condition->told && !condition->went_off &&
                      strcmp(line.line, condition->line.line) == 0;
    if (same || (condition->any_told && !is_past(condition->told_us, now_us, RIG_BUS_NEWS_US))) {
        return false;
    }
    condition->went_off = false;
    condition->any_told = true;
    condition->told_us = now_us;
    condition->told = trouble;
    condition->line = line;
    *severe = trouble != RIG_BUS_WELL;
    return true;
}

static bool loss_is_new(struct rig_bus *bus, uint32_t now_us) {
    struct rig_bus_condition *condition = &bus->condition;
    if (condition->frames_lost == condition->lost_told ||
        (condition->any_lost_told &&
         !is_past(condition->lost_told_us, now_us, RIG_BUS_LOST_NEWS_US))) {
        return false;
    }
    condition->any_lost_told = true;
    condition->lost_told_us = now_us;
    condition->lost_told = condition->frames_lost;
    return true;
}

const char *rig_buses_news(struct rig_buses *buses, bool *severe) {
    const uint32_t now_us = hal_clock_now_us(buses->clock);
    for (unsigned i = 0; i < buses->count; i++) {
        look(buses, &buses->bus[i]);
    }
    for (unsigned i = 0; i < buses->count; i++) {
        struct rig_bus *bus = &buses->bus[i];
        if (bus->lost) {
            continue;
        }
        if (trouble_is_new(bus, now_us, severe)) {
            return bus->condition.line.line;
        }
        if (loss_is_new(bus, now_us)) {
            snprintf(buses->error.line, sizeof buses->error.line,
                     "%s: %u frames came damaged, or faster than they were read", bus->text,
                     (unsigned)bus->condition.frames_lost);
            *severe = true;
            return buses->error.line;
        }
    }
    return NULL;
}
