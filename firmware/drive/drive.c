#include "drive/drive.h"

#include "drive/rmd.h"
#include "fixed/q30.h"
#include "fixed/wide.h"

/// What an RMD drive is asked before its axis counts as homed: bits of drive.asked once answered.
enum rmd_question {
    RMD_KNOWS_ANGLE = 1,
    RMD_KNOWS_HEALTH = 2,
    RMD_KNOWS_WATCHDOG = 4,
    RMD_KNOWS_ACCEL = 8,
    RMD_KNOWS_ALL = 15,
    RMD_RUNS = 16 ///< LKTech: the run command is confirmed
};

/// Every so many cycles the status request takes the place of the angle request: 64 ms at 1 ms a
/// tick.
#define HEALTH_CYCLES 16U

int64_t drive_cdeg_from_q48(int64_t position_q48) {
    // 36000 hundredths a turn are 1125 / 2^43 a unit; whole turns apart, so that the product fits.
    const int64_t turns = position_q48 >> 48, rest = position_q48 & (AXIS_TURN_Q48 - 1);
    return turns * 36000 + round_shift_i64(rest * 1125, 43U);
}

int64_t drive_q48_from_cdeg(int64_t angle_cdeg) {
    int64_t turns = angle_cdeg / 36000, rest = angle_cdeg % 36000;
    if (rest < 0) {
        rest += 36000;
        turns--;
    }
    return turns * AXIS_TURN_Q48 + ((rest << 43) + 562) / 1125;
}

static bool is_within(int64_t value, int64_t reach) {
    return value >= -reach && value <= reach;
}

static bool rmd_config_valid(const struct drive_rmd_config *config) {
    return config->id >= RMD_ID_MIN && config->id <= RMD_ID_MAX &&
           (config->reply_offset == RMD_REPLY_OFFSET_V3 ||
            config->reply_offset == RMD_REPLY_OFFSET_LK) &&
           is_within(config->zero_q48, DRIVE_ZERO_Q48_MAX);
}

static bool pulse_valid(uint32_t pulse_ns) {
    return pulse_ns != 0U && pulse_ns <= 20000000U;
}

static bool pwm_config_valid(const struct drive_pwm_config *config) {
    return is_within(config->low_q48, DRIVE_POSITION_Q48_MAX) &&
           is_within(config->high_q48, DRIVE_POSITION_Q48_MAX) &&
           config->high_q48 - config->low_q48 >= (int64_t)1 << 24 &&
           pulse_valid(config->low_pulse_ns) && pulse_valid(config->high_pulse_ns) &&
           config->low_pulse_ns != config->high_pulse_ns;
}

bool drive_config_valid(const struct drive_config *config) {
    switch (config->kind) {
    case DRIVE_RMD:
        return rmd_config_valid(&config->rmd);
    case DRIVE_PWM:
        return pwm_config_valid(&config->pwm);
    default:
        return false;
    }
}

void drive_init(struct drive *drive, const struct drive_config *config, uint64_t now_us) {
    *drive = (struct drive){.config = config, .heard_us = now_us};
    drive->ready = config->kind == DRIVE_PWM; // nothing to ask
}

void drive_forget(struct drive *drive) {
    drive->asked = 0;
    drive->ready = drive->config->kind == DRIVE_PWM;
    drive->position_known = false;
    drive->error_bits = 0;
}

bool drive_has_feedback(const struct drive *drive) {
    return drive->config->kind == DRIVE_RMD;
}

// ---------------------------------------------------------------- RMD

static bool speaks_lk(const struct drive_rmd_config *config) {
    return config->reply_offset == RMD_REPLY_OFFSET_LK;
}

/// So that no unit overflows on the way from the drive's angle to the axis position.
#define RMD_ANGLE_CDEG_MAX (30000 * 36000)

static int64_t axis_from_motor(const struct drive_rmd_config *config, int64_t motor_q48) {
    const int64_t from_zero = motor_q48 - config->zero_q48;
    return config->reversed ? -from_zero : from_zero;
}

static int64_t motor_from_axis(const struct drive_rmd_config *config, int64_t axis_q48) {
    return (config->reversed ? -axis_q48 : axis_q48) + config->zero_q48;
}

/// The axis position that an angle means. False if it is beyond belief.
static bool position_from_cdeg(const struct drive_rmd_config *config, int32_t angle_cdeg,
                               int64_t *position_q48) {
    if (!is_within(angle_cdeg, RMD_ANGLE_CDEG_MAX)) {
        return false;
    }
    *position_q48 = axis_from_motor(config, drive_q48_from_cdeg(angle_cdeg));
    return is_within(*position_q48, DRIVE_POSITION_Q48_MAX);
}

/// Takes what a reply says. False if it can't be believed.
static bool take_reply(struct drive *drive, const struct rmd_reply *reply, uint64_t arrived_us) {
    const struct drive_rmd_config *config = &drive->config->rmd;
    int64_t position_q48;
    switch (reply->kind) {
    case RMD_REPLY_ANGLE:
        if (!position_from_cdeg(config, reply->value.angle_cdeg, &position_q48)) {
            return false;
        }
        drive->position_q48 = position_q48;
        drive->position_us = arrived_us;
        drive->position_known = true;
        drive->asked |= RMD_KNOWS_ANGLE;
        break;
    case RMD_REPLY_HEALTH:
        drive->error_bits = reply->value.health.error_bits;
        drive->temperature_c = reply->value.health.temperature_c;
        drive->asked |= RMD_KNOWS_HEALTH;
        break;
    case RMD_REPLY_WATCHDOG: // another value is the answer to somebody else, or was refused
        drive->asked |= reply->value.watchdog_ms == config->watchdog_ms ? RMD_KNOWS_WATCHDOG : 0U;
        break;
    case RMD_REPLY_ACCEL:
        if (reply->value.accel.index == RMD_ACCEL_POSITION) {
            drive->accel_plan_dps2 = reply->value.accel.accel_dps2;
            drive->asked |= RMD_KNOWS_ACCEL;
        }
        break;
    case RMD_REPLY_ACK:
        drive->asked |= reply->command == RMD_LK_RUN ? RMD_RUNS : 0U;
        break;
    default:
        break;
    }
    // The LKTech dialect has no status, watchdog or acceleration commands: its angle is all there
    // is to know.
    const unsigned wanted = speaks_lk(config) ? RMD_KNOWS_ANGLE : RMD_KNOWS_ALL;
    drive->ready = (drive->asked & wanted) == wanted;
    return true;
}

bool drive_receive(struct drive *drive, const struct can_frame *frame, uint64_t now_us,
                   uint32_t age_us) {
    if (drive->config->kind != DRIVE_RMD) {
        return false;
    }
    const struct drive_rmd_config *config = &drive->config->rmd;
    if (frame->flags != 0U || frame->id != 0x140U + config->id + config->reply_offset) {
        return false;
    }
    struct rmd_reply reply;
    if (rmd_decode(frame, config->reply_offset, &reply) == RMD_OK &&
        take_reply(drive, &reply, now_us > age_us ? now_us - age_us : 0U)) {
        drive->heard_us = now_us;
    } else {
        drive->bad_replies++;
    }
    return true;
}

static void add_frame(struct drive_output *output, enum rmd_status status,
                      const struct can_frame *frame) {
    if (status == RMD_OK) { // every parameter was checked by drive_config_valid
        output->frame[output->frame_count++] = *frame;
    }
}

/// The start-up questions in turn, one a cycle, until each is answered. They move nothing. LKTech
/// drives know the first of them only.
static void ask_next(const struct drive *drive, uint32_t cycle, struct drive_output *output) {
    const struct drive_rmd_config *config = &drive->config->rmd;
    struct can_frame frame;
    switch (speaks_lk(config) ? 0U : cycle % 4U) {
    case 0:
        add_frame(output, rmd_encode(config->id, RMD_READ_ANGLE, &frame), &frame);
        break;
    case 1:
        add_frame(output, rmd_encode(config->id, RMD_READ_STATUS, &frame), &frame);
        break;
    case 2: // kept in the drive's flash: written only until it is confirmed
        if ((drive->asked & RMD_KNOWS_WATCHDOG) == 0U) {
            add_frame(output, rmd_encode_watchdog(config->id, config->watchdog_ms, &frame), &frame);
        }
        break;
    default:
        add_frame(output, rmd_encode_read_accel(config->id, RMD_ACCEL_POSITION, &frame), &frame);
        break;
    }
}

/// A powered drive's command of a cycle: the setpoint, or what has to come before it.
static void command_rmd(const struct drive *drive, int64_t setpoint_q48,
                        struct drive_output *output) {
    const struct drive_rmd_config *config = &drive->config->rmd;
    struct can_frame frame;
    if (speaks_lk(config) && (drive->asked & RMD_RUNS) == 0U) {
        add_frame(output, rmd_encode(config->id, RMD_LK_RUN, &frame), &frame);
        return;
    }
    const int64_t angle_cdeg = drive_cdeg_from_q48(motor_from_axis(config, setpoint_q48));
    add_frame(output,
              rmd_encode_position(config->id, (int32_t)angle_cdeg, config->speed_max_dps, &frame),
              &frame);
}

static void tick_rmd(const struct drive *drive, uint32_t tick, bool powered, int64_t setpoint_q48,
                     struct drive_output *output) {
    const struct drive_rmd_config *config = &drive->config->rmd;
    const uint32_t slot = tick % DRIVE_CYCLE_TICKS, cycle = tick / DRIVE_CYCLE_TICKS;
    if (slot == 0U && powered) {
        command_rmd(drive, setpoint_q48, output);
    } else if (slot == 2U && !drive->ready) {
        ask_next(drive, cycle, output);
    } else if (slot == 2U) {
        const bool health = !speaks_lk(config) && cycle % HEALTH_CYCLES == 0U;
        struct can_frame frame;
        add_frame(output, rmd_encode(config->id, health ? RMD_READ_STATUS : RMD_READ_ANGLE, &frame),
                  &frame);
    }
}

// ---------------------------------------------------------------- pulse width

/// Linear between the two points, rounded to nearest.
static uint32_t pulse_for(const struct drive_pwm_config *config, int64_t position_q48) {
    if (position_q48 <= config->low_q48) {
        return config->low_pulse_ns;
    }
    if (position_q48 >= config->high_q48) {
        return config->high_pulse_ns;
    }
    const uint64_t part = (uint64_t)(position_q48 - config->low_q48),
                   whole = (uint64_t)(config->high_q48 - config->low_q48);
    const bool rises = config->high_pulse_ns > config->low_pulse_ns;
    const uint32_t rise = rises ? config->high_pulse_ns - config->low_pulse_ns
                                : config->low_pulse_ns - config->high_pulse_ns;
    uint64_t rest;
    const uint32_t way = (uint32_t)u128_div_u64(
        u128_add(u128_mul(rise, part), (struct u128){whole / 2U, 0}), whole, &rest);
    return rises ? config->low_pulse_ns + way : config->low_pulse_ns - way;
}

// ---------------------------------------------------------------- either

void drive_tick(struct drive *drive, uint32_t tick, bool powered, int64_t setpoint_q48,
                struct drive_output *output) {
    *output = (struct drive_output){0};
    if (drive->config->kind == DRIVE_RMD) {
        tick_rmd(drive, tick, powered, setpoint_q48, output);
    } else if (drive->config->kind == DRIVE_PWM) {
        output->pulse_set = true;
        output->pulse_ns = powered ? pulse_for(&drive->config->pwm, setpoint_q48) : 0U;
        drive->position_q48 = setpoint_q48; // what it was told; nobody knows where it is
    }
}

enum drive_fault drive_check(const struct drive *drive, uint64_t now_us, uint32_t silence_us) {
    if (!drive_has_feedback(drive)) {
        return DRIVE_HEALTHY;
    }
    if (now_us - drive->heard_us > silence_us) {
        return DRIVE_FAULT_SILENT;
    }
    return drive->error_bits != 0U ? DRIVE_FAULT_REPORTED : DRIVE_HEALTHY;
}

bool drive_position_is_fresh(const struct drive *drive, uint64_t now_us, uint32_t silence_us) {
    return !drive_has_feedback(drive) ||
           (drive->position_known && now_us - drive->position_us <= silence_us);
}
