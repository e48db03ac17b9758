#include "devices/rmd_drive.h"

#include "world/trace_hash.h"

#include <math.h>
#include <string.h>

#define RAD_PER_CDEG (AXIS_PLANT_PI / 18000.0)
#define RAD_PER_DEG  (AXIS_PLANT_PI / 180.0)
#define TWO_PI       (2.0 * AXIS_PLANT_PI)
#define MS_NS        UINT64_C(1000000)

#define AMBIENT_C             24.0
#define TRIP_C                100.0
#define WINDING_OHM           0.32
#define KELVIN_PER_WATT       1.03
#define JOULE_PER_KELVIN      14.0
#define THERMAL_SUBSTEPS      4U // a millisecond: temperature is slow
#define STALL_SUBSTEPS        2000U
#define STALL_RATE_RPS        0.01
#define STALL_TORQUE_FRACTION 0.95
#define JAM_NM                1.0e6
#define ERROR_STALL           0x0002U
#define ERROR_OVER_TEMP       0x1000U
#define VERSION_DATE          20250208U
static const char model[7] = {'X', '4', '-', '1', '0', ' ', ' '};

struct rmd_drive_config rmd_drive_defaults(uint8_t id) {
    return (struct rmd_drive_config){
        .id = id,
        .latency_ns_min = 60000,
        .latency_ns_max = 120000,
        .boot_ms = 300,
        .brake_nm = 5.0,
        .torque_limit_nm = 8.0,
        .torque_constant = 0.8,
        .position_gain = 80.0,
        .speed_gain = 4.5,
        .speed_integral = 200.0,
        .current_share = 0.75,
        .filter_angle = 0.4,
        .filter_rate = 0.06,
        .in_position_rad = 0.004 * RAD_PER_DEG,
    };
}

static double encoder_rad(const struct rmd_drive *d) {
    return (double)axis_plant_counts(d->plant) * d->rad_per_count;
}

static int64_t rounded(double value) {
    return (int64_t)(value + (value < 0.0 ? -0.5 : 0.5));
}

static double limited(double value, double limit) {
    return value > limit ? limit : value < -limit ? -limit : value;
}

static void output_off(struct rmd_drive *d) {
    d->mode = RMD_DRIVE_OFF;
    d->brake_locked = true;
    d->integral_nm = 0.0;
    d->planned_rps = 0.0;
    d->stalled_steps = 0;
}

static void restart(struct rmd_drive *d) {
    output_off(d);
    d->motor_nm = 0.0;
    d->error_bits = 0;
    d->comms_lost = false;
    d->lk_running = false;
    d->boot_ns = d->now_ns;
    d->last_frame_ns = d->now_ns;
    d->angle_rad = encoder_rad(d);
    d->rate_rps = 0.0;
    d->turns_rad = -(double)rounded(d->angle_rad / TWO_PI) * TWO_PI;
}

static can_receive_fn receive;

bool rmd_drive_init(struct rmd_drive *drive, const struct rmd_drive_config *config,
                    struct axis_plant *plant, struct can_bus *bus, uint64_t seed) {
    memset(drive, 0, sizeof *drive);
    drive->config = *config;
    drive->plant = plant;
    drive->bus = bus;
    drive->now_ns = bus->now_ns;
    drive->temperature_c = AMBIENT_C;
    drive->random = seed * UINT64_C(0x9E3779B97F4A7C15) | 1U;
    drive->rad_per_count = 1.0 / plant->counts_per_rad;
    restart(drive);
    return can_bus_attach(bus, &drive->node, receive, drive);
}

// ---------------------------------------------------------------- loops

/// The speed at which the position loop wants to go.
static double position_loop(struct rmd_drive *d, double error_rad) {
    const double accel = (double)d->config.accel_dps2[0] * RAD_PER_DEG;
    double rate = limited(d->config.position_gain * error_rad, d->rate_max_rps);
    if (accel == 0.0) {
        return rate;
    }
    // Ramp: not faster than it can still brake, and not gaining speed faster than allowed.
    const double decel = (double)d->config.accel_dps2[1] * RAD_PER_DEG;
    const double distance = error_rad < 0.0 ? -error_rad : error_rad;
    rate = limited(rate, sqrt(2.0 * (decel == 0.0 ? accel : decel) * distance));
    d->planned_rps += limited(rate - d->planned_rps, accel * AXIS_PLANT_SUBSTEP_S);
    const bool slower = (rate > 0.0) == (d->planned_rps > 0.0) &&
                        (rate > 0.0 ? rate < d->planned_rps : rate > d->planned_rps);
    d->planned_rps = slower ? rate : d->planned_rps;
    return d->planned_rps;
}

static double speed_ramp(struct rmd_drive *d) {
    const double accel = (double)d->config.accel_dps2[2] * RAD_PER_DEG;
    const double change = d->rate_target_rps - d->planned_rps;
    d->planned_rps += accel == 0.0 ? change : limited(change, accel * AXIS_PLANT_SUBSTEP_S);
    return d->planned_rps;
}

static double torque_wanted(struct rmd_drive *d) {
    const struct rmd_drive_config *c = &d->config;
    if (d->mode == RMD_DRIVE_OFF) {
        return 0.0;
    }
    if (d->mode == RMD_DRIVE_TORQUE) {
        return limited(d->torque_target_nm, c->torque_limit_nm);
    }
    double rate_wanted;
    bool in_position = false;
    if (d->mode == RMD_DRIVE_POSITION) {
        const double error = d->target_rad - d->angle_rad;
        rate_wanted = position_loop(d, error);
        in_position = error < c->in_position_rad && error > -c->in_position_rad;
    } else {
        rate_wanted = speed_ramp(d);
    }
    const double error = rate_wanted - d->rate_rps;
    const double torque = c->speed_gain * error + d->integral_nm;
    const double given = limited(torque, c->torque_limit_nm);
    // Not while limited in the same direction, nor at rest on target.
    const bool saturated = torque != given && (error > 0.0) == (torque > 0.0);
    if (!saturated && !in_position) {
        d->integral_nm += c->speed_integral * error * AXIS_PLANT_SUBSTEP_S;
    }
    return given;
}

static void fault(struct rmd_drive *d, uint16_t bit) {
    d->error_bits |= bit;
    output_off(d);
}

static void watch_stall(struct rmd_drive *d) {
    const double torque = d->motor_nm < 0.0 ? -d->motor_nm : d->motor_nm;
    if (torque < STALL_TORQUE_FRACTION * d->config.torque_limit_nm ||
        d->rate_rps > STALL_RATE_RPS || d->rate_rps < -STALL_RATE_RPS) {
        d->stalled_steps = 0;
    } else if (++d->stalled_steps >= STALL_SUBSTEPS) {
        fault(d, ERROR_STALL);
    }
}

static void heat(struct rmd_drive *d) {
    d->torque_squares += d->motor_nm * d->motor_nm;
    if (++d->thermal_steps < THERMAL_SUBSTEPS) {
        return;
    }
    const double kt = d->config.torque_constant;
    const double heating_w = d->torque_squares * (3.0 * WINDING_OHM / THERMAL_SUBSTEPS) / (kt * kt);
    const double cooling_w = (d->temperature_c - AMBIENT_C) * (1.0 / KELVIN_PER_WATT);
    d->temperature_c +=
        (heating_w - cooling_w) * (THERMAL_SUBSTEPS * AXIS_PLANT_SUBSTEP_S / JOULE_PER_KELVIN);
    d->torque_squares = 0.0;
    d->thermal_steps = 0;
    if (d->temperature_c >= TRIP_C) {
        fault(d, ERROR_OVER_TEMP);
    }
}

static void substep(struct rmd_drive *d) {
    const struct rmd_drive_config *c = &d->config;
    const double predicted = d->angle_rad + d->rate_rps * AXIS_PLANT_SUBSTEP_S;
    const double surprise = encoder_rad(d) - predicted;
    d->angle_rad = predicted + c->filter_angle * surprise;
    d->rate_rps += c->filter_rate * (1.0 / AXIS_PLANT_SUBSTEP_S) * surprise;

    const double wanted = torque_wanted(d);
    d->motor_nm =
        d->mode == RMD_DRIVE_OFF ? 0.0 : d->motor_nm + (wanted - d->motor_nm) * c->current_share;
    const double brake = (d->brake_locked ? c->brake_nm : 0.0) + (d->jammed ? JAM_NM : 0.0);
    axis_plant_step(d->plant, d->motor_nm, brake);
    watch_stall(d);
    heat(d);
    if (c->watchdog_ms != 0U && !d->comms_lost &&
        d->now_ns - d->last_frame_ns > c->watchdog_ms * MS_NS) {
        d->comms_lost = true;
        output_off(d);
    }
}

void rmd_drive_advance(struct rmd_drive *drive, uint64_t t_ns) {
    while (drive->now_ns + AXIS_PLANT_SUBSTEP_NS <= t_ns) {
        drive->now_ns += AXIS_PLANT_SUBSTEP_NS;
        substep(drive);
        if (drive->booting && drive->now_ns - drive->boot_ns >= drive->config.boot_ms * MS_NS) {
            drive->booting = false;
        }
    }
}

void rmd_drive_fail(struct rmd_drive *drive, enum rmd_drive_failure failure, bool on) {
    switch (failure) {
    case RMD_DRIVE_FAIL_SILENT:
        drive->silent = on;
        break;
    case RMD_DRIVE_FAIL_IDLE:
        if (on) {
            const bool locked = drive->brake_locked;
            output_off(drive);
            drive->brake_locked = locked;
        }
        break;
    case RMD_DRIVE_FAIL_REBOOT:
        if (on) {
            drive->booting = true;
            restart(drive);
        }
        break;
    case RMD_DRIVE_FAIL_JAM:
        drive->jammed = on;
        break;
    case RMD_DRIVE_FAIL_HEAT:
        drive->temperature_c = on ? TRIP_C + 1.0 : drive->temperature_c;
        break;
    }
}

// ---------------------------------------------------------------- protocol

int32_t rmd_drive_angle_cdeg(const struct rmd_drive *drive) {
    const double reading = encoder_rad(drive) + drive->turns_rad;
    return (int32_t)rounded(reading / RAD_PER_CDEG) + drive->config.zero_cdeg;
}

/// Little endian.
static void store(uint8_t *bytes, unsigned count, int64_t value) {
    for (unsigned i = 0; i < count; i++) {
        bytes[i] = (uint8_t)((uint64_t)value >> (8U * i));
    }
}

static uint32_t load_u32(const uint8_t *bytes) {
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static int32_t load_i32(const uint8_t *bytes) {
    return (int32_t)load_u32(bytes);
}

static int16_t load_i16(const uint8_t *bytes) {
    return (int16_t)(bytes[0] | bytes[1] << 8);
}

static bool may_move(const struct rmd_drive *d) {
    return d->error_bits == 0U && !d->comms_lost && (!d->config.lktech || d->lk_running);
}

static void enter(struct rmd_drive *d, enum rmd_drive_mode mode) {
    if (d->mode != mode) {
        d->integral_nm = 0.0;
        d->planned_rps = d->rate_rps;
    }
    d->mode = mode;
    d->brake_locked = d->brake_locked && mode == RMD_DRIVE_TORQUE;
}

static void command_position(struct rmd_drive *d, const uint8_t *data, double from_rad) {
    const uint16_t speed_dps = (uint16_t)load_i16(data + 2);
    enter(d, RMD_DRIVE_POSITION);
    d->target_rad = from_rad + (double)load_i32(data + 4) * RAD_PER_CDEG;
    d->rate_max_rps = speed_dps == 0U ? 1.0e9 : (double)speed_dps * RAD_PER_DEG;
}

/// True for a motion command, obeyed or not.
static bool command_motion(struct rmd_drive *d, const uint8_t *data) {
    const bool obey = may_move(d);
    switch (data[0]) {
    case 0xA1:
        if (obey) {
            enter(d, RMD_DRIVE_TORQUE);
            d->torque_target_nm = 0.01 * load_i16(data + 4) * d->config.torque_constant;
        }
        return true;
    case 0xA2:
        if (obey) {
            enter(d, RMD_DRIVE_SPEED);
            d->rate_target_rps = 0.01 * load_i32(data + 4) * RAD_PER_DEG;
        }
        return true;
    case 0xA4:
        if (obey) {
            command_position(d, data, -d->turns_rad - d->config.zero_cdeg * RAD_PER_CDEG);
        }
        return true;
    case 0xA8:
        if (obey) {
            command_position(d, data, encoder_rad(d));
        }
        return true;
    default:
        return false;
    }
}

/// Commands whose answer repeats the request.
static bool command_echoed(struct rmd_drive *d, uint8_t *data) {
    switch (data[0]) {
    case 0x43: {
        const int32_t accel = load_i32(data + 4);
        if (data[1] < 4U && accel >= 100 && accel <= 60000) {
            d->config.accel_dps2[data[1]] = (uint32_t)accel;
        }
        return true;
    }
    case 0x77:
        d->brake_locked = false;
        return true;
    case 0x78:
    case 0x80:
        output_off(d);
        return true;
    case 0x81:
        if (d->mode != RMD_DRIVE_OFF) {
            enter(d, RMD_DRIVE_SPEED);
            d->rate_target_rps = 0.0;
        }
        return true;
    case 0x88:
        d->lk_running = d->config.lktech;
        return d->config.lktech;
    case 0xB3:
        d->config.watchdog_ms = load_u32(data + 4);
        return true;
    default:
        return false;
    }
}

static void put_motion(const struct rmd_drive *d, uint8_t *data) {
    store(data + 1, 1, rounded(d->temperature_c));
    const double amps = d->plant->motor_nm / d->config.torque_constant;
    store(data + 2, 2, rounded(d->config.lktech ? amps * (2048.0 / 33.0) : amps * 100.0));
    store(data + 4, 2, rounded(d->rate_rps / RAD_PER_DEG));
    const int64_t degrees = rounded((double)rmd_drive_angle_cdeg(d) * 0.01);
    store(data + 6, 2, d->config.lktech ? axis_plant_counts(d->plant) : degrees);
}

/// Fills the answer to a question; false if there is none. index: byte 1 of the question.
static bool answer(const struct rmd_drive *d, uint8_t index, uint8_t *data) {
    switch (data[0]) {
    case 0x42:
        data[1] = index;
        store(data + 4, 4, index < 4U ? d->config.accel_dps2[index] : 0);
        return true;
    case 0x60:
        store(data + 4, 4, axis_plant_counts(d->plant) + rounded(d->turns_rad / d->rad_per_count));
        return true;
    case 0x70:
        data[7] = (uint8_t)d->mode;
        return true;
    case 0x92:
        store(data + (d->config.lktech ? 1 : 4), d->config.lktech ? 7 : 4, rmd_drive_angle_cdeg(d));
        return true;
    case 0x9A:
        store(data + 1, 1, rounded(d->temperature_c));
        data[3] = d->brake_locked ? 0 : 1;
        store(data + 4, 2, rounded(d->plant->config.supply_v * 10.0));
        store(data + 6, 2, d->error_bits);
        return true;
    case 0x9C:
        put_motion(d, data);
        return true;
    case 0xB1:
        store(data + 4, 4, (int64_t)((d->now_ns - d->boot_ns) / MS_NS));
        return true;
    case 0xB2:
        store(data + 4, 4, VERSION_DATE);
        return true;
    case 0xB5:
        memcpy(data + 1, model, sizeof model);
        return true;
    default:
        return false;
    }
}

static uint64_t latency_ns(struct rmd_drive *d) {
    uint64_t x = d->random;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    d->random = x;
    const uint64_t r = (x * UINT64_C(0x2545F4914F6CDD1D)) >> 32;
    const uint64_t span = d->config.latency_ns_max - d->config.latency_ns_min;
    return d->config.latency_ns_min + (r * span >> 32);
}

static void keep_watchdog_quiet(struct rmd_drive *d, uint64_t now_ns) {
    if (d->comms_lost && now_ns - d->last_frame_ns <= d->config.watchdog_ms * MS_NS) {
        d->comms_lost = false;
    }
    d->last_frame_ns = now_ns;
}

static void receive(void *context, const struct can_frame *frame, uint64_t now_ns) {
    struct rmd_drive *d = context;
    if ((frame->id != 0x140U + d->config.id && frame->id != 0x280U) || d->silent) {
        return;
    }
    rmd_drive_advance(d, now_ns);
    if (d->booting || frame->length != 8U || frame->flags != 0U) {
        d->ignored++;
        return;
    }
    d->requests++;
    keep_watchdog_quiet(d, now_ns);
    struct can_frame reply = *frame;
    reply.id = (d->config.lktech ? 0x140U : 0x240U) + d->config.id;
    if (frame->data[0] == 0x76U) {
        d->booting = true;
        restart(d);
        return;
    }
    if (command_motion(d, frame->data)) {
        memset(reply.data + 1, 0, 7);
        put_motion(d, reply.data);
    } else if (!command_echoed(d, reply.data)) {
        memset(reply.data + 1, 0, 7);
        if (!answer(d, frame->data[1], reply.data)) {
            d->ignored++;
            return;
        }
    }
    d->replies_lost += can_bus_send(d->bus, &d->node, &reply, now_ns + latency_ns(d)) ? 0U : 1U;
}

uint64_t rmd_drive_hash(const struct rmd_drive *d, uint64_t hash) {
    const uint64_t flags = (uint64_t)d->brake_locked | (uint64_t)d->booting << 1 |
                           (uint64_t)d->comms_lost << 2 | (uint64_t)d->silent << 3 |
                           (uint64_t)d->jammed << 4 | (uint64_t)d->lk_running << 5 |
                           (uint64_t)d->mode << 8 | (uint64_t)d->error_bits << 16;
    hash = trace_hash_u64(hash, flags);
    hash = trace_hash_f64(hash, d->angle_rad);
    hash = trace_hash_f64(hash, d->rate_rps);
    hash = trace_hash_f64(hash, d->target_rad);
    hash = trace_hash_f64(hash, d->integral_nm);
    hash = trace_hash_f64(hash, d->motor_nm);
    hash = trace_hash_f64(hash, d->temperature_c);
    return trace_hash_u64(hash, d->random);
}
