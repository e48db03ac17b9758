#include "rig_bus.h"

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

// ---------------------------------------------------------------- one bus

static void count_restart(struct rig_buses *buses, struct rig_bus *bus, enum hal_status status) {
    buses->restarts += status == HAL_OK && !bus->restarted;
    bus->restarted = bus->restarted || status == HAL_OK;
}

bool rig_bus_is_at_hand(struct rig_buses *buses, struct rig_bus *bus) {
    if (bus->restart_begun && side_job_is_over(&bus->restart)) {
        bus->restart_begun = false;
        count_restart(buses, bus, bus->restart_status);
    }
    return !bus->lost && !bus->restart_begun;
}

static enum hal_status bus_send(struct rig_buses *buses, struct rig_bus *bus,
                                const struct can_frame *frame) {
    struct rig_bus_condition *condition = &bus->condition;
    if (!rig_bus_is_at_hand(buses, bus)) {
        return bus->lost ? HAL_ERROR_GONE : HAL_ERROR_DOWN;
    }
    const enum hal_status status = hal_can_send(bus->hal, frame);
    if (status != HAL_BUSY) {
        condition->refused = 0;
    } else if (condition->refused++ == 0U) {
        condition->refused_since_us = hal_clock_now_us(buses->clock);
    }
    bus->restarted = bus->restarted && status != HAL_OK;
    return status;
}

static enum hal_status bus_receive(struct rig_buses *buses, struct rig_bus *bus,
                                   struct can_frame *frame, uint32_t *at_us) {
    if (!rig_bus_is_at_hand(buses, bus)) {
        return bus->lost ? HAL_ERROR_GONE : HAL_EMPTY;
    }
    return hal_can_receive(bus->hal, frame, at_us);
}

static enum hal_status bus_state(struct rig_buses *buses, struct rig_bus *bus,
                                 struct hal_can_state *state) {
    if (rig_bus_is_at_hand(buses, bus)) {
        return hal_can_state(bus->hal, state);
    }
    *state = (struct hal_can_state){HAL_CAN_OFF, 256, 0, bus->condition.lost_count};
    return bus->lost ? HAL_ERROR_GONE : HAL_OK;
}

static void restart_aside(void *context) {
    struct rig_bus *bus = context;
    bus->restart_status = hal_can_restart(bus->hal);
}

static enum hal_status bus_restart(struct rig_buses *buses, struct rig_bus *bus) {
    const uint32_t now_us = hal_clock_now_us(buses->clock);
    if (!rig_bus_is_at_hand(buses, bus)) {
        return bus->lost ? HAL_ERROR_GONE : HAL_OK;
    }
    if (bus->address.kind != RIG_BUS_SOCKETCAN) { // the driver only begins it
        const enum hal_status status = hal_can_restart(bus->hal);
        count_restart(buses, bus, status);
        return status;
    }
    if (!bus->restart_tried || hal_clock_span_us(bus->restart_us, now_us) >= RIG_BUS_RESTART_US) {
        bus->restart_tried = true;
        bus->restart_us = now_us;
        bus->restart_begun = side_job_start(&bus->restart, restart_aside, bus);
    }
    return HAL_OK;
}

// ---------------------------------------------------------------- several as one

static enum hal_status together_send(void *ctx, const struct can_frame *frame) {
    struct rig_buses *buses = ctx;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (frame->id != buses->request_id[axis]) {
            continue;
        }
        struct rig_bus *bus = buses->bus_of[axis];
        const enum hal_status status = bus_send(buses, bus, frame);
        if (status == HAL_ERROR_DOWN) {
            (void)bus_restart(buses, bus);
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
        const enum hal_status status = bus_receive(buses, &buses->bus[i], frame, at_us);
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
        const enum hal_status status = bus_state(buses, &buses->bus[i], &one);
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
        const enum hal_status status = bus_restart(buses, &buses->bus[i]);
        worst = status != HAL_OK ? status : worst;
    }
    return worst;
}

// One alone is itself, as long as it is there.

static enum hal_status alone_send(void *ctx, const struct can_frame *frame) {
    struct rig_buses *buses = ctx;
    return bus_send(buses, &buses->bus[0], frame);
}

static enum hal_status alone_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    struct rig_buses *buses = ctx;
    return bus_receive(buses, &buses->bus[0], frame, at_us);
}

static enum hal_status alone_state(void *ctx, struct hal_can_state *state) {
    struct rig_buses *buses = ctx;
    return bus_state(buses, &buses->bus[0], state);
}

static enum hal_status alone_restart(void *ctx) {
    struct rig_buses *buses = ctx;
    return bus_restart(buses, &buses->bus[0]);
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
    side_job_wait(&bus->restart);
    bus->restart_begun = false;
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

const struct linux_error *rig_bus_error(const struct rig_bus *bus) {
    return bus->address.kind == RIG_BUS_SOCKETCAN ? &bus->can.error
           : bus->address.kind == RIG_BUS_SLCAN   ? &bus->slcan.error
                                                  : &bus->gs_usb.error;
}

const char *rig_buses_newly_lost(struct rig_buses *buses) {
    struct hal_can_state state;
    for (unsigned i = 0; i < buses->count; i++) {
        struct rig_bus *bus = &buses->bus[i];
        if (!bus->lost && bus_state(buses, bus, &state) == HAL_ERROR_GONE) {
            bus->lost = true;
            bus->restarted = false;
            bus->condition = (struct rig_bus_condition){0};
            buses->error = *rig_bus_error(bus);
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
