#include "drive/rmd.h"

#define REQUEST_BASE   UINT32_C(0x140)
#define BUS_ID_FRAME   UINT32_C(0x300)
#define IMPEDANCE_BASE UINT32_C(0x400)
#define FRAME_BYTES    8U

static void put_u16(uint8_t *bytes, uint16_t value) {
    bytes[0] = (uint8_t)value;
    bytes[1] = (uint8_t)(value >> 8);
}

static void put_u32(uint8_t *bytes, uint32_t value) {
    put_u16(bytes, (uint16_t)value);
    put_u16(bytes + 2, (uint16_t)(value >> 16));
}

static uint16_t get_u16(const uint8_t *bytes) {
    return (uint16_t)(bytes[0] | ((unsigned)bytes[1] << 8));
}

static uint32_t get_u32(const uint8_t *bytes) {
    return get_u16(bytes) | ((uint32_t)get_u16(bytes + 2) << 16);
}

/// Two's complement without the implementation-defined conversion.
static int32_t signed_u32(uint32_t value) {
    return value <= INT32_MAX ? (int32_t)value : -(int32_t)(UINT32_MAX - value) - 1;
}

static int16_t get_i16(const uint8_t *bytes) {
    const int32_t value = get_u16(bytes);
    return (int16_t)(value <= INT16_MAX ? value : value - 65536);
}

static int8_t get_i8(const uint8_t *bytes) {
    const int value = bytes[0];
    return (int8_t)(value <= INT8_MAX ? value : value - 256);
}

static bool id_valid(uint32_t id) {
    return id >= RMD_ID_MIN && id <= RMD_ID_MAX;
}

/// An empty request; the caller adds the parameters.
static enum rmd_status begin(uint8_t id, uint8_t command, struct can_frame *out) {
    if (!id_valid(id)) {
        return RMD_BAD_ID;
    }
    *out = (struct can_frame){REQUEST_BASE + id, 0, FRAME_BYTES, {command}};
    return RMD_OK;
}

enum rmd_status rmd_encode(uint8_t id, enum rmd_command command, struct can_frame *out) {
    switch (command) {
    case RMD_READ_MODE:
    case RMD_RESET:
    case RMD_BRAKE_RELEASE:
    case RMD_BRAKE_LOCK:
    case RMD_SHUTDOWN:
    case RMD_STOP:
    case RMD_LK_RUN:
    case RMD_READ_ANGLE:
    case RMD_READ_STATUS:
    case RMD_READ_STATUS_2:
    case RMD_READ_UPTIME:
    case RMD_READ_VERSION:
    case RMD_READ_MODEL:
        return begin(id, (uint8_t)command, out);
    default:
        return RMD_BAD_COMMAND;
    }
}

enum rmd_status rmd_encode_position(uint8_t id, int32_t angle_cdeg, uint16_t speed_dps_max,
                                    struct can_frame *out) {
    const enum rmd_status status = begin(id, RMD_POSITION, out);
    if (status == RMD_OK) {
        put_u16(out->data + 2, speed_dps_max);
        put_u32(out->data + 4, (uint32_t)angle_cdeg);
    }
    return status;
}

enum rmd_status rmd_encode_speed(uint8_t id, int32_t speed_cdps, struct can_frame *out) {
    const enum rmd_status status = begin(id, RMD_SPEED, out);
    if (status == RMD_OK) {
        put_u32(out->data + 4, (uint32_t)speed_cdps);
    }
    return status;
}

enum rmd_status rmd_encode_read_accel(uint8_t id, enum rmd_accel index, struct can_frame *out) {
    if ((unsigned)index > RMD_DECEL_SPEED) {
        return RMD_BAD_VALUE;
    }
    const enum rmd_status status = begin(id, RMD_READ_ACCEL, out);
    if (status == RMD_OK) {
        out->data[1] = (uint8_t)index;
    }
    return status;
}

enum rmd_status rmd_encode_watchdog(uint8_t id, uint32_t timeout_ms, struct can_frame *out) {
    const enum rmd_status status = begin(id, RMD_WATCHDOG, out);
    if (status == RMD_OK) {
        put_u32(out->data + 4, timeout_ms);
    }
    return status;
}

enum rmd_status rmd_encode_report(uint8_t id, enum rmd_command command, bool enable,
                                  uint32_t interval_ms, struct can_frame *out) {
    if (interval_ms % 10U != 0U || interval_ms / 10U > UINT16_MAX) {
        return RMD_BAD_VALUE;
    }
    const enum rmd_status status = begin(id, RMD_REPORT, out);
    if (status == RMD_OK) {
        out->data[1] = (uint8_t)command;
        out->data[2] = enable ? 1U : 0U;
        put_u16(out->data + 3, (uint16_t)(interval_ms / 10U));
    }
    return status;
}

void rmd_encode_read_bus_id(struct can_frame *out) {
    *out = (struct can_frame){BUS_ID_FRAME, 0, FRAME_BYTES, {RMD_BUS_ID, 0, 1}};
}

enum rmd_status rmd_encode_impedance(uint8_t id, const struct rmd_impedance *set_point,
                                     struct can_frame *out) {
    const struct rmd_impedance s = *set_point;
    if (!id_valid(id)) {
        return RMD_BAD_ID;
    }
    if ((s.speed_count | s.kp_count | s.kd_count | s.torque_count) > 0xFFFU) {
        return RMD_BAD_VALUE;
    }
    // The one message that is big endian: 16, then four times 12 bits.
    *out = (struct can_frame){
        IMPEDANCE_BASE + id,
        0,
        FRAME_BYTES,
        {(uint8_t)(s.position_count >> 8), (uint8_t)s.position_count, (uint8_t)(s.speed_count >> 4),
         (uint8_t)((s.speed_count & 15U) << 4 | s.kp_count >> 8), (uint8_t)s.kp_count,
         (uint8_t)(s.kd_count >> 4), (uint8_t)((s.kd_count & 15U) << 4 | s.torque_count >> 8),
         (uint8_t)s.torque_count}};
    return RMD_OK;
}

static enum rmd_status decode_bus_id(const uint8_t *data, struct rmd_reply *reply) {
    if (data[0] != RMD_BUS_ID) {
        return RMD_BAD_COMMAND;
    }
    const uint32_t id = (uint32_t)get_u16(data + 6) - (REQUEST_BASE + RMD_REPLY_OFFSET_V3);
    if (data[2] != 1U || !id_valid(id)) {
        return RMD_BAD_VALUE;
    }
    reply->id = (uint8_t)id;
    reply->kind = RMD_REPLY_BUS_ID;
    return RMD_OK;
}

static enum rmd_status decode_v3(const uint8_t *data, struct rmd_reply *reply) {
    switch (data[0]) {
    case RMD_BRAKE_RELEASE:
    case RMD_BRAKE_LOCK:
    case RMD_SHUTDOWN:
    case RMD_STOP:
        reply->kind = RMD_REPLY_ACK;
        return RMD_OK;
    case RMD_READ_ANGLE:
        reply->kind = RMD_REPLY_ANGLE;
        reply->value.angle_cdeg = signed_u32(get_u32(data + 4));
        return RMD_OK;
    case RMD_READ_STATUS:
        reply->kind = RMD_REPLY_HEALTH;
        reply->value.health = (struct rmd_health){get_i8(data + 1), data[3] == 1U,
                                                  get_u16(data + 4), get_u16(data + 6)};
        return data[3] <= 1U ? RMD_OK : RMD_BAD_VALUE;
    case RMD_READ_STATUS_2:
    case RMD_TORQUE:
    case RMD_SPEED:
    case RMD_POSITION:
    case RMD_INCREMENT:
        reply->kind = RMD_REPLY_MOTION;
        reply->value.motion = (struct rmd_motion){get_i8(data + 1), get_i16(data + 2),
                                                  get_i16(data + 4), get_i16(data + 6)};
        return RMD_OK;
    case RMD_READ_ACCEL:
        reply->kind = RMD_REPLY_ACCEL;
        reply->value.accel = (struct rmd_accel_value){data[1], signed_u32(get_u32(data + 4))};
        return data[1] <= RMD_DECEL_SPEED ? RMD_OK : RMD_BAD_VALUE;
    case RMD_READ_MODE:
        reply->kind = RMD_REPLY_MODE;
        reply->value.mode = data[7];
        return RMD_OK;
    case RMD_READ_UPTIME:
        reply->kind = RMD_REPLY_UPTIME;
        reply->value.uptime_ms = get_u32(data + 4);
        return RMD_OK;
    case RMD_READ_VERSION:
        reply->kind = RMD_REPLY_VERSION;
        reply->value.version_date = get_u32(data + 4);
        return RMD_OK;
    case RMD_WATCHDOG:
        reply->kind = RMD_REPLY_WATCHDOG;
        reply->value.watchdog_ms = get_u32(data + 4);
        return RMD_OK;
    case RMD_READ_MODEL:
        reply->kind = RMD_REPLY_MODEL;
        for (unsigned i = 0; i < 7U; i++) {
            reply->value.model[i] = (char)data[1U + i];
        }
        reply->value.model[7] = '\0';
        return RMD_OK;
    default:
        return RMD_BAD_COMMAND;
    }
}

/// Bytes 1 to 7 as a signed 56-bit number of 0.01 degrees.
static enum rmd_status decode_angle_lk(const uint8_t *data, struct rmd_reply *reply) {
    const uint32_t low = get_u32(data + 1), high = get_u16(data + 5) | ((uint32_t)data[7] << 16);
    const uint32_t extension = low > (uint32_t)INT32_MAX ? UINT32_C(0xFFFFFF) : 0U;
    if (high != extension) {
        return RMD_BAD_VALUE; // beyond +-59,652 turns
    }
    reply->kind = RMD_REPLY_ANGLE;
    reply->value.angle_cdeg = signed_u32(low);
    return RMD_OK;
}

static enum rmd_status decode_lk(const uint8_t *data, struct rmd_reply *reply) {
    switch (data[0]) {
    case RMD_SHUTDOWN:
    case RMD_STOP:
    case RMD_LK_RUN:
        reply->kind = RMD_REPLY_ACK;
        return RMD_OK;
    case RMD_READ_ANGLE:
        return decode_angle_lk(data, reply);
    case RMD_READ_STATUS_2:
    case RMD_TORQUE:
    case RMD_SPEED:
    case RMD_POSITION:
    case RMD_INCREMENT:
        reply->kind = RMD_REPLY_MOTION_LK;
        reply->value.motion_lk = (struct rmd_motion_lk){get_i8(data + 1), get_i16(data + 2),
                                                        get_i16(data + 4), get_u16(data + 6)};
        return RMD_OK;
    default:
        return RMD_BAD_COMMAND;
    }
}

enum rmd_status rmd_decode(const struct can_frame *frame, uint32_t reply_offset,
                           struct rmd_reply *out) {
    if (frame->flags != 0U) {
        return RMD_BAD_FRAME;
    }
    if (frame->length != FRAME_BYTES) {
        return RMD_BAD_LENGTH;
    }
    const bool lk = reply_offset == RMD_REPLY_OFFSET_LK;
    struct rmd_reply reply = {.id = 0, .command = frame->data[0]};
    enum rmd_status status;
    if (frame->id == BUS_ID_FRAME && !lk) {
        status = decode_bus_id(frame->data, &reply);
    } else {
        const uint32_t id = frame->id - (REQUEST_BASE + reply_offset);
        if (!id_valid(id)) {
            return RMD_BAD_ID;
        }
        reply.id = (uint8_t)id;
        status = lk ? decode_lk(frame->data, &reply) : decode_v3(frame->data, &reply);
    }
    if (status == RMD_OK) {
        *out = reply;
    }
    return status;
}
