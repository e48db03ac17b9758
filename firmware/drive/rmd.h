/// MyActuator RMD servo drives on CAN (and LKTech, which speaks the older dialect): the bytes of
/// requests and replies. A pure codec: no state, no I/O, integers only.
///
/// Every frame has an 11-bit identifier and 8 bytes, little endian; byte 0 is the command, which
/// the reply repeats. A drive speaks only when asked. Requests go to 0x140 + id, id 1 to 32.
/// Replies come from 0x240 + id (MyActuator V3 and later) or from the identifier of the request
/// (LKTech and RMD V1, V2), which is why the decoder takes the offset as a parameter; the two
/// dialects also differ in the layout of replies, and the offset tells which one to read.
/// A drive that gets fewer than 8 bytes ignores the request.
///
/// Units: angles in 0.01 degree of the output shaft (`_cdeg`, multi-turn), speeds in degrees a
/// second (`_dps`) or hundredths of it (`_cdps`), currents in 0.01 A (`_ca`).
///
/// Source: MyActuator "Servo Motor Control Protocol" V4.2 (2024-05), sections 2 to 5; LKTech "MS/MF
/// CAN protocol" V2.35 for the differences. Shown: tests/unit/test_rmd.c (the examples of the
/// documents, and random frames: each decodes or is refused and leaves the output alone).
#ifndef DRIVE_RMD_H
#define DRIVE_RMD_H

#include "drive/can_frame.h"
#include "fixed/must_check.h"

#include <stdbool.h>
#include <stdint.h>

#define RMD_ID_MIN 1U
#define RMD_ID_MAX 32U

#define RMD_REPLY_OFFSET_V3 UINT32_C(0x100) ///< reply from 0x240 + id
#define RMD_REPLY_OFFSET_LK UINT32_C(0)     ///< reply from 0x140 + id

/// Bits of rmd_health.error_bits; several may be set.
#define RMD_ERROR_STALL             0x0002U
#define RMD_ERROR_LOW_VOLTAGE       0x0004U
#define RMD_ERROR_OVER_VOLTAGE      0x0008U
#define RMD_ERROR_OVER_CURRENT      0x0010U
#define RMD_ERROR_OVER_POWER        0x0040U
#define RMD_ERROR_CALIBRATION_WRITE 0x0080U
#define RMD_ERROR_OVER_SPEED        0x0100U
#define RMD_ERROR_OVER_TEMPERATURE  0x1000U
#define RMD_ERROR_ENCODER           0x2000U

enum rmd_status {
    RMD_OK = 0,
    RMD_BAD_FRAME = -1,   ///< extended, remote or error frame
    RMD_BAD_LENGTH = -2,  ///< not 8 bytes
    RMD_BAD_ID = -3,      ///< encode: id not 1 to 32; decode: not the reply of a drive 1 to 32
    RMD_BAD_COMMAND = -4, ///< encode: has parameters; decode: unknown in this dialect
    RMD_BAD_VALUE = -5,   ///< a parameter or a field out of its range
};

enum rmd_command {
    RMD_READ_ACCEL = 0x42,
    RMD_READ_MODE = 0x70,
    RMD_RESET = 0x76, ///< restarts the drive; no reply
    RMD_BRAKE_RELEASE = 0x77,
    RMD_BRAKE_LOCK = 0x78,
    RMD_BUS_ID = 0x79,
    RMD_SHUTDOWN = 0x80, ///< output off, no mode
    RMD_STOP = 0x81,     ///< speed 0, stays in closed loop
    RMD_LK_RUN = 0x88,   ///< LKTech only: needed after power-on before any motion
    RMD_READ_ANGLE = 0x92,
    RMD_READ_STATUS = 0x9A,
    RMD_READ_STATUS_2 = 0x9C,
    RMD_TORQUE = 0xA1,
    RMD_SPEED = 0xA2,
    RMD_POSITION = 0xA4,
    RMD_INCREMENT = 0xA8,
    RMD_READ_UPTIME = 0xB1,
    RMD_READ_VERSION = 0xB2,
    RMD_WATCHDOG = 0xB3,
    RMD_READ_MODEL = 0xB5,
    RMD_REPORT = 0xB6,
};

/// Index of an acceleration (command 0x42).
enum rmd_accel {
    RMD_ACCEL_POSITION = 0, ///< 0 dps/s means that 0xA4 follows its target without a ramp
    RMD_DECEL_POSITION = 1,
    RMD_ACCEL_SPEED = 2,
    RMD_DECEL_SPEED = 3,
};

/// What a reply holds.
enum rmd_reply_kind {
    RMD_REPLY_ACK,       ///< 0x77 0x78 0x80 0x81 0x88: no values
    RMD_REPLY_ANGLE,     ///< 0x92: value.angle_cdeg
    RMD_REPLY_HEALTH,    ///< 0x9A: value.health
    RMD_REPLY_MOTION,    ///< 0x9C 0xA1 0xA2 0xA4 0xA8: value.motion
    RMD_REPLY_MOTION_LK, ///< the same commands in the LKTech dialect: value.motion_lk
    RMD_REPLY_ACCEL,     ///< 0x42: value.accel
    RMD_REPLY_MODE,      ///< 0x70: value.mode: 1 current, 2 speed, 3 position
    RMD_REPLY_UPTIME,    ///< 0xB1: value.uptime_ms
    RMD_REPLY_VERSION,   ///< 0xB2: value.version_date, decimal yyyymmdd
    RMD_REPLY_WATCHDOG,  ///< 0xB3: value.watchdog_ms
    RMD_REPLY_MODEL,     ///< 0xB5: value.model
    RMD_REPLY_BUS_ID,    ///< 0x79: the id of the drive is in rmd_reply.id
};

struct rmd_health {
    int8_t temperature_c;
    bool brake_released;
    uint16_t supply_dv; ///< 0.1 V
    uint16_t error_bits;
};

/// The angle is coarse: use RMD_READ_ANGLE for control.
struct rmd_motion {
    int8_t temperature_c;
    int16_t current_ca;
    int16_t speed_dps;
    int16_t angle_deg;
};

/// current_raw: 2048 is 16.5 A (MF) or 33 A (MG). encoder_count: single turn of the motor.
struct rmd_motion_lk {
    int8_t temperature_c;
    int16_t current_raw;
    int16_t speed_dps;
    uint16_t encoder_count;
};

struct rmd_accel_value {
    uint8_t index; ///< enum rmd_accel
    int32_t accel_dps2;
};

struct rmd_reply {
    uint8_t id;      ///< 1 to 32
    uint8_t command; ///< byte 0
    enum rmd_reply_kind kind;
    union {
        int32_t angle_cdeg;
        struct rmd_health health;
        struct rmd_motion motion;
        struct rmd_motion_lk motion_lk;
        struct rmd_accel_value accel;
        uint8_t mode;
        uint32_t uptime_ms;
        uint32_t version_date;
        uint32_t watchdog_ms;
        char model[8]; ///< up to 7 characters, then 0
    } value;
};

/// A command without parameters: reads, brake, stop, shutdown, reset, run.
/// Returns RMD_BAD_COMMAND for one that has parameters. Not OK: *out is untouched (so for all
/// here).
MUST_CHECK enum rmd_status rmd_encode(uint8_t id, enum rmd_command command, struct can_frame *out);

/// Absolute multi-turn position. speed_dps_max 0: no limit but the drive's own.
MUST_CHECK enum rmd_status rmd_encode_position(uint8_t id, int32_t angle_cdeg,
                                               uint16_t speed_dps_max, struct can_frame *out);

MUST_CHECK enum rmd_status rmd_encode_speed(uint8_t id, int32_t speed_cdps, struct can_frame *out);

MUST_CHECK enum rmd_status rmd_encode_read_accel(uint8_t id, enum rmd_accel index,
                                                 struct can_frame *out);

/// The drive's own watchdog: after timeout_ms without a frame to it, it cuts the output and locks
/// the brake. 0 turns it off. Stored in the drive's flash: send it at start-up, not in a loop.
MUST_CHECK enum rmd_status rmd_encode_watchdog(uint8_t id, uint32_t timeout_ms,
                                               struct can_frame *out);

/// Unasked replies to `command` every interval_ms (a multiple of 10, up to 655,350; else
/// RMD_BAD_VALUE). The drive does not acknowledge, and answers `command` no more when asked.
MUST_CHECK enum rmd_status rmd_encode_report(uint8_t id, enum rmd_command command, bool enable,
                                             uint32_t interval_ms, struct can_frame *out);

/// Asks every drive on the bus for its id (only sensible with one drive connected). No id of its
/// own, so it can't fail.
void rmd_encode_read_bus_id(struct can_frame *out);

/// Impedance set point ("motion mode", request 0x400 + id): fields as the drive counts them,
/// position 16 bits over +-12.5 rad, the others 12 bits: speed +-45 rad/s, kp 0 to 500, kd 0 to 5,
/// torque +-24 Nm. RMD_BAD_VALUE above 4095.
struct rmd_impedance {
    uint16_t position_count, speed_count, kp_count, kd_count, torque_count;
};
MUST_CHECK enum rmd_status rmd_encode_impedance(uint8_t id, const struct rmd_impedance *set_point,
                                                struct can_frame *out);

/// Reads a reply. reply_offset: RMD_REPLY_OFFSET_V3 or RMD_REPLY_OFFSET_LK.
/// With the LKTech offset a request looks like the reply to it, so never feed it frames of our own;
/// it knows the commands 0x80, 0x81, 0x88, 0x92, 0x9C and the motion commands.
/// Returns RMD_OK and fills *out, or says why not and leaves *out untouched. Any frame is allowed.
MUST_CHECK enum rmd_status rmd_decode(const struct can_frame *frame, uint32_t reply_offset,
                                      struct rmd_reply *out);

#endif
