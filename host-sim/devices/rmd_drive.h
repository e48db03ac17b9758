/// A MyActuator RMD servo drive on the simulated CAN bus, turning one axis of the plant.
///
/// It reads and writes the real bytes with a decoder of its own: it shares no code with
/// firmware/drive/rmd.c, so that one can't hide the mistakes of the other.
///
/// Loops, every AXIS_PLANT_SUBSTEP_NS: rotor encoder -> tracking filter (angle and speed) ->
/// position P, limited to the speed of the command -> speed PI -> torque limit -> current loop
/// (first order). The integrator rests while the axis stands within in_position_rad of its target:
/// with static friction above Coulomb friction it would otherwise hunt for ever.
/// A target streamed every 4 ms is followed with a lag of speed / position_gain and no overshoot;
/// at rest the error is below 0.005 degrees (tests/scenario/test_rmd_drive_loops.c).
///
/// Answered: 0x42 0x43 0x60 0x70 0x77 0x78 0x80 0x81 0x92 0x9A 0x9C 0xA1 0xA2 0xA4 0xA8 0xB1 0xB2
/// 0xB3 0xB5, to its own identifier and to 0x280; 0x76 resets without an answer. Anything else is
/// counted and ignored, as is a frame of less than 8 bytes. LKTech dialect: also 0x88, which is
/// needed before any motion; 0x92 has 56 bits, motion replies carry the encoder.
///
/// Behaviour the makers leave open, decided here:
/// - At power-on, after 0x80, 0x78, an error or the watchdog: output off, brake locked. A speed or
///   position command opens the brake; a torque command needs 0x77 first.
/// - Watchdog (0xB3): expires when no frame came to this drive for longer than the time set; runs
///   again after two frames closer together than that, on the next motion command.
/// - An error stays until 0x76 (or a reboot), and motion commands are answered but not obeyed.
/// - After a restart the angle is the one of the output encoder, within half a turn of zero: turns
///   are forgotten.
/// - Stall: 0.5 s at the torque limit without moving.
///
/// Thermal model from the stall table of the X4-10 sheet (plant/axis_plant.h): 1.03 K/W to the
/// ambient, 14 J/K, three windings of 0.32 ohm; it trips at 100 C (assumed).
/// Cost: with its plant about 35 ns a substep under way, 15 ns at rest
/// (tests/property/plant_speed.c).
#ifndef DEVICES_RMD_DRIVE_H
#define DEVICES_RMD_DRIVE_H

#include "devices/can_bus.h"
#include "plant/axis_plant.h"

#include <stdbool.h>
#include <stdint.h>

enum rmd_drive_mode {
    RMD_DRIVE_OFF = 0,
    RMD_DRIVE_TORQUE = 1,
    RMD_DRIVE_SPEED = 2,
    RMD_DRIVE_POSITION = 3,
};

struct rmd_drive_config {
    uint8_t id; ///< 1 to 32
    bool lktech;
    uint32_t latency_ns_min,
        latency_ns_max;     ///< from the end of a request to its answer being ready
    uint32_t boot_ms;       ///< deaf after a restart
    uint32_t watchdog_ms;   ///< as kept in its flash; 0: off
    uint32_t accel_dps2[4]; ///< position up, down, speed up, down; 0: no ramp
    int32_t zero_cdeg;      ///< what it reads at the plant's angle 0
    double brake_nm;        ///< holding torque; 0: no brake fitted
    double torque_limit_nm;
    double torque_constant; ///< Nm/A, for the current it reports
    double position_gain;   ///< 1/s
    double speed_gain;      ///< Nm per rad/s
    double speed_integral;  ///< Nm per rad
    double current_share;   ///< of the torque error that the current loop closes in a substep
    double filter_angle, filter_rate; ///< gains of the tracking filter
    double in_position_rad;
};

enum rmd_drive_failure {
    RMD_DRIVE_FAIL_SILENT, ///< hears and says nothing, goes on with its last command
    RMD_DRIVE_FAIL_IDLE,   ///< once: output off, no mode, brake as it was, no error bit
    RMD_DRIVE_FAIL_REBOOT, ///< once
    RMD_DRIVE_FAIL_JAM,    ///< the axis can't move
    RMD_DRIVE_FAIL_HEAT,   ///< once: the windings are at the trip temperature
};

struct rmd_drive {
    // State.
    uint64_t now_ns, boot_ns, last_frame_ns;
    enum rmd_drive_mode mode;
    uint16_t error_bits;
    bool brake_locked, booting, comms_lost, silent, jammed, lk_running;
    double angle_rad, rate_rps; ///< tracking filter, in the plant's angle
    double target_rad, rate_target_rps, rate_max_rps, torque_target_nm;
    double planned_rps; ///< ramp
    double integral_nm, motor_nm;
    double turns_rad; ///< added to the plant's angle: whole turns since the restart
    double temperature_c, torque_squares;
    uint32_t stalled_steps, thermal_steps;
    uint64_t random;
    uint64_t requests, ignored, replies_lost;
    // Constants.
    struct rmd_drive_config config;
    double rad_per_count;
    struct axis_plant *plant;
    struct can_bus *bus;
    struct can_node node;
};

/// Tuned for the axes of the default gimbal, with and without payload.
struct rmd_drive_config rmd_drive_defaults(uint8_t id);

/// Powered and booted, output off, and attached to the bus. False if the bus is full.
/// The drive moves the plant; nobody else may step it. seed: any, for the latencies.
bool rmd_drive_init(struct rmd_drive *drive, const struct rmd_drive_config *config,
                    struct axis_plant *plant, struct can_bus *bus, uint64_t seed);

/// Runs all substeps that end up to t_ns. The bus does so on its own before a request is obeyed;
/// the world calls it once a tick, after can_bus_run_until.
void rmd_drive_advance(struct rmd_drive *drive, uint64_t t_ns);

/// Starts a failure or (SILENT, JAM) ends it with on = false.
void rmd_drive_fail(struct rmd_drive *drive, enum rmd_drive_failure failure, bool on);

/// The angle it would report now.
int32_t rmd_drive_angle_cdeg(const struct rmd_drive *drive);

/// Folds the state into hash (world/trace_hash.h); the plant's is separate.
uint64_t rmd_drive_hash(const struct rmd_drive *drive, uint64_t hash);

#endif
