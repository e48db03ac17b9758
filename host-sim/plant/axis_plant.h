/// One axis of a gimbal as physics: motor, gear, friction, load, end stops, encoder.
///
///     inertia * acceleration = motor - viscous * speed - friction(speed) - gravity + disturbance
///
/// Everything is seen from the output shaft (after the gear), in SI units and double precision.
/// - Friction: static at rest (the axis does not move until the torque exceeds it), then falling to
///   Coulomb friction over the Stribeck speed as 1 / (1 + (v/vs)^2); a brake adds to both.
/// - Motor: torque up to the drive's peak, and up to what the supply can push against the back-EMF;
///   braking torque has only the first limit.
/// - Gravity: a load whose centre of mass is off the axis. Moment * cos(angle + lever angle).
/// - End stops: stiff and without bounce. Encoder: on the rotor, rounded down to a count.
///
/// One step is one substep of AXIS_PLANT_SUBSTEP_NS, semi-implicit (first speed, then angle with
/// the new speed). When friction would turn the speed round within a step, the axis stops there.
/// Only + - * / and no library: gcc and clang give the same bits (with -ffp-contract=off).
/// Not modelled: backlash and elasticity of the gear (the sheet gives 15 arc minutes of backlash at
/// most, but the drive's second encoder sits on the output), cogging, electrical time constant (the
/// current loop is the drive's, devices/rmd_drive.h), cable drag.
///
/// Cost: with its drive about 35 ns a step under way, 15 ns at rest (tests/property/plant_speed.c).
/// Shown: tests/scenario/test_axis_plant.c (against closed formulas of motion).
///
/// Constants, unless the caller changes them: MYACTUATOR "RMD-X V4 Series Product Manual", 2025,
/// model X4-10 (RMD-X4-P12-10-E): 24 V; gear 12.5; no-load speed 317 rpm at 1 A; rated 4 Nm at 238
/// rpm; peak 10 Nm; back-EMF 6 Vdc a 1,000 rpm of the motor; module torque constant 0.8 Nm/A(rms);
/// phase resistance 0.32 ohm, star; back-drive torque 0.8 Nm; inertia 0.25 kg cm^2; encoder 17 bit
/// on the rotor, 18 bit on the output; rated torque at a rise of 60 K. (Another print of the table
/// has gear 12.6.)
/// Assumed, where the sheet is silent:
/// - the inertia is the rotor's, so 0.25e-4 * 12.5^2 = 0.0039 kg m^2 at the output;
/// - static friction = back-drive torque; Coulomb 0.6 Nm and viscous 0.002 Nm s, which together are
///   what the no-load current says (24 W less 1.8 W for the electronics, at 33.2 rad/s: 0.67 Nm);
///   Stribeck speed 0.1 rad/s;
/// - payload: a camera of 1.5 kg, 200 x 90 x 90 mm, 0.0060 kg m^2, its centre of mass 10 mm
///   ahead of the tilt axis; cradle 0.002; the pan axis also turns the tilt drive (0.33 kg at 70
///   mm) and the yoke (0.5 kg at 80 mm), 0.0048;
/// - end stops at +-200 degrees (pan, cable) and -100 to +110 degrees (tilt).
#ifndef PLANT_AXIS_PLANT_H
#define PLANT_AXIS_PLANT_H

#include <stdbool.h>
#include <stdint.h>

#define AXIS_PLANT_SUBSTEP_NS UINT64_C(250000)
#define AXIS_PLANT_SUBSTEP_S  0.00025
#define AXIS_PLANT_PI         3.14159265358979323846

struct axis_plant_config {
    double inertia_kgm2;
    double static_nm, coulomb_nm; ///< static not below Coulomb
    double stribeck_rps;          ///< rad/s
    double viscous_nms;           ///< Nm per rad/s
    double gravity_nm;            ///< weight times distance of the centre of mass from the axis
    double lever_rad;             ///< elevation of the centre of mass at angle 0
    double peak_nm;
    double supply_v;
    double emf_vs;      ///< back-EMF per rad/s of the output; also Nm per DC ampere
    double winding_ohm; ///< between two phases
    double stop_min_rad, stop_max_rad;
    double gear;
    double encoder_counts; ///< per turn of the rotor
};

struct axis_plant {
    // State.
    double angle_rad, rate_rps;
    double motor_nm;                   ///< what the motor gave in the last step
    double disturbance_nm;             ///< set by the caller: wind, a hand
    int at_stop;                       ///< -1, 0, 1: resting against the lower, no, the upper stop
    double gravity_nm, gravity_at_rad; ///< a function of the angle, kept while it stays
    // Constants.
    struct axis_plant_config config;
    double step_per_inertia, inverse_stribeck, counts_per_rad;
    double torque_per_volt, knee_rps; ///< above the knee the supply limits the torque
};

/// The axes of the default gimbal.
struct axis_plant_config axis_plant_pan(void);
struct axis_plant_config axis_plant_tilt(void);

/// At rest at angle_rad.
void axis_plant_init(struct axis_plant *plant, const struct axis_plant_config *config,
                     double angle_rad);

/// One substep with the motor commanded to torque_nm and the brake pressing with brake_nm (0:
/// open).
void axis_plant_step(struct axis_plant *plant, double torque_nm, double brake_nm);

/// The encoder on the rotor, counted through turns; 0 at angle 0.
static inline int64_t axis_plant_counts(const struct axis_plant *plant) {
    const double exact = plant->angle_rad * plant->counts_per_rad;
    const int64_t toward_zero = (int64_t)exact;
    return toward_zero - ((double)toward_zero > exact ? 1 : 0);
}

/// Largest torque in the direction of motion at this speed.
double axis_plant_torque_max(const struct axis_plant *plant, double rate_rps);

/// cos(x), |x| < 1e6, within 3e-9: only + - * /, for the same bits everywhere.
double axis_plant_cos(double x_rad);

/// Folds the state into hash (world/trace_hash.h).
uint64_t axis_plant_hash(const struct axis_plant *plant, uint64_t hash);

#endif
