/// One actuator of an axis, whatever it speaks: setpoints in, position and health out.
///
/// An RMD servo drive on CAN, a hobby servo or a zoom lens by pulse width. The kinds are told apart
/// by a switch, not by function pointers, so that the call graph (and with it the stack bound) is
/// plain to see. Shown: tests/unit/test_drive.c, tests/unit/test_drive_rmd.c.
#ifndef DRIVE_DRIVE_H
#define DRIVE_DRIVE_H

#include "drive/can_frame.h"
#include "fixed/must_check.h"
#include "motion/axis.h"

#include <stdbool.h>
#include <stdint.h>

enum drive_kind { DRIVE_NONE, DRIVE_RMD, DRIVE_PWM };

/// Positions of an axis beyond 64 turns are taken for a fault of the drive, not for a position: no
/// gimbal has turned so far. Zeros reach 2,000 turns.
#define DRIVE_POSITION_Q48_MAX (64 * AXIS_TURN_Q48)
#define DRIVE_ZERO_Q48_MAX     (2000 * AXIS_TURN_Q48)

/// RMD over CAN. Motor angle = (reversed ? -1 : 1) * axis position + zero.
struct drive_rmd_config {
    uint8_t id;            ///< 1 to 32
    uint32_t reply_offset; ///< RMD_REPLY_OFFSET_V3 or _LK
    bool reversed;
    int64_t zero_q48;       ///< motor angle at axis position 0, within DRIVE_ZERO_Q48_MAX
    uint16_t speed_max_dps; ///< sent with every position; 0: the drive's own limit
    uint32_t watchdog_ms;   ///< the drive cuts its output after this long without a frame; 0: off
};

/// Pulse width: linear between two calibrated points, never outside the pulse limits.
struct drive_pwm_config {
    uint32_t channel;
    /// Two positions of the axis, low < high, at least 2^-24 turns apart, within
    /// DRIVE_POSITION_Q48_MAX.
    int64_t low_q48, high_q48;
    uint32_t low_pulse_ns, high_pulse_ns; ///< and their pulses, in either order, 1 ns to 20 ms
};

struct drive_config {
    enum drive_kind kind;
    union {
        struct drive_rmd_config rmd;
        struct drive_pwm_config pwm;
    };
};

/// What is wrong with a drive. All but the first are reasons to stop.
enum drive_fault {
    DRIVE_HEALTHY = 0,
    DRIVE_FAULT_SILENT,  ///< no reply for silence_us
    DRIVE_FAULT_REPORTED ///< the drive reports an error: drive.error_bits
};

struct drive {
    const struct drive_config *config;
    bool ready; ///< position and status are known: the axis is homed
    bool position_known;
    int64_t position_q48; ///< last measured
    uint64_t position_us; ///< when the answer with it arrived
    uint64_t heard_us;    ///< time of the last reply; start-up counts as one
    uint16_t error_bits;  ///< as the drive reports them
    int8_t temperature_c;
    int32_t accel_plan_dps2; ///< RMD: 0 means that positions are followed without a ramp of the
                             ///< drive's own
    uint16_t asked;          ///< start-up: which questions are answered
    uint32_t bad_replies;    ///< frames from this drive that could not be decoded or believed
};

/// What a drive wants sent in one tick.
struct drive_output {
    struct can_frame frame[2];
    uint32_t frame_count;
    bool pulse_set;    ///< PWM drives always say what the channel should give
    uint32_t pulse_ns; ///< 0: no pulses
};

/// Is the configuration usable?
bool drive_config_valid(const struct drive_config *config);

void drive_init(struct drive *drive, const struct drive_config *config, uint64_t now_us);

/// Start-up again: the drive must answer every question anew before it is ready.
void drive_forget(struct drive *drive);

/// Looks at a received frame, which arrived age_us ago. Returns whether it came from this drive. A
/// frame that can't be decoded, and an angle beyond DRIVE_POSITION_Q48_MAX, is counted and changes
/// nothing else.
bool drive_receive(struct drive *drive, const struct can_frame *frame, uint64_t now_us,
                   uint32_t age_us);

/// What to send in this tick. setpoint_q48: within DRIVE_POSITION_Q48_MAX (a PWM drive: any).
/// tick:    counts up; a cycle has DRIVE_CYCLE_TICKS (axes take turns by an offset). A position
/// command and a fine-angle request go out
///          once a cycle each, because 1 kHz of both for two axes does not fit on a 1 Mbit/s bus.
/// powered: whether the axis may be driven. If not, an RMD drive is only asked, and a PWM channel
/// gives no pulses.
#define DRIVE_CYCLE_TICKS 4U
void drive_tick(struct drive *drive, uint32_t tick, bool powered, int64_t setpoint_q48,
                struct drive_output *output);

/// silence_us: how long a drive that answers requests may say nothing. PWM drives can't say
/// anything.
enum drive_fault drive_check(const struct drive *drive, uint64_t now_us, uint32_t silence_us);

/// Is the position known, and measured within the last silence_us? Other replies keep a drive from
/// being silent, but to start from a stale position would be a jump. PWM drives: always true.
bool drive_position_is_fresh(const struct drive *drive, uint64_t now_us, uint32_t silence_us);

/// Does this kind measure its position?
bool drive_has_feedback(const struct drive *drive);

/// Hundredths of a degree, which RMD drives count in, from and to 2^48 units a turn; rounded to
/// nearest. Any position; angles up to 32,767 turns. There and back gives the same hundredths.
int64_t drive_cdeg_from_q48(int64_t position_q48);
int64_t drive_q48_from_cdeg(int64_t angle_cdeg);

#endif
