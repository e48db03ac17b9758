/// A hobby servo driven by pulse width, and a zoom lens turned by one.
///
/// The servo measures one pulse every frame (20 ms), at a moment that the controller doesn't know:
/// the phase comes from the seed. A pulse outside its window is ignored, and the last good one
/// stays in force. Without pulses for three frames it lets go: no torque, and the gear keeps the
/// shaft where it is. Inside the dead band it rests; otherwise it turns toward the target, at full
/// speed until it is near and then in proportion to what is left. There is no feedback to the
/// controller.
///
/// One step is a millisecond. Only + - * / : the same bits with every compiler.
/// Not modelled: load dependent speed, gear play, jitter of the pulse itself.
/// Cost: about 8 ns a step (tests/property/plant_speed.c). Shown: tests/scenario/test_pwm_servo.c.
///
/// Constants of pwm_servo_defaults: Savox SC-1258TG at 4.8 V, 0.10 s for 60 degrees (maker's table,
/// quoted in public surveys of 2026; 0.08 s at 6.0 V). Assumed, where the table is silent: dead
/// band 2 us, 90 degrees a millisecond of pulse about 1,500 us, accepted pulses 800 to 2,200 us,
/// slowing down over the last 6 degrees.
#ifndef DEVICES_PWM_SERVO_H
#define DEVICES_PWM_SERVO_H

#include <stdbool.h>
#include <stdint.h>

struct pwm_servo_config {
    uint32_t frame_ns;
    uint32_t pulse_ns_min, pulse_ns_max, pulse_ns_centre; ///< others than min to max are ignored
    uint32_t dead_band_ns;                                ///< total width
    double deg_per_us;
    double speed_dps_max;
    double approach; ///< 1/s: speed for each degree left, near the target
};

struct pwm_servo {
    // State.
    uint64_t now_ns, next_sample_ns;
    uint32_t pulse_ns;    ///< what the controller sends; 0: no pulses
    uint32_t accepted_ns; ///< the last good pulse; 0: none yet
    uint32_t frames_without;
    bool stuck; ///< failure: the shaft stays where it is
    double angle_deg, rate_dps;
    uint64_t ignored; ///< pulses out of range
    // Constants.
    struct pwm_servo_config config;
};

struct pwm_servo_config pwm_servo_defaults(void);

/// At angle_deg (0 at the centre pulse), without pulses. seed: any, for the phase of the frames.
void pwm_servo_init(struct pwm_servo *servo, const struct pwm_servo_config *config,
                    double angle_deg, uint64_t now_ns, uint64_t seed);

/// From now on the line carries pulses of this width; 0 for none.
void pwm_servo_set_pulse(struct pwm_servo *servo, uint32_t pulse_ns);

/// Runs all milliseconds that end up to t_ns.
void pwm_servo_advance(struct pwm_servo *servo, uint64_t t_ns);

/// True while pulses keep it under power.
bool pwm_servo_powered(const struct pwm_servo *servo);

/// Folds the state into hash (world/trace_hash.h).
uint64_t pwm_servo_hash(const struct pwm_servo *servo, uint64_t hash);

enum { ZOOM_LENS_POINTS = 9 };

/// A zoom lens: the servo's way from wide_deg to tele_deg turns the zoom ring from end to end.
struct zoom_lens_config {
    struct pwm_servo_config servo;
    double wide_deg, tele_deg;
    /// Focal length at equal parts of the way, rising; linear between them.
    double focal_mm[ZOOM_LENS_POINTS];
};

struct zoom_lens {
    struct pwm_servo servo;
    struct zoom_lens_config config;
};

/// 6 to 60 mm, the same factor for each eighth of the way, end to end in 2 s; 1,000 us is wide and
/// 2,000 us tele. An assumed lens: typical of motorised 10x lenses for cameras of a third of an
/// inch.
struct zoom_lens_config zoom_lens_defaults(void);

/// At the wide end.
void zoom_lens_init(struct zoom_lens *lens, const struct zoom_lens_config *config, uint64_t now_ns,
                    uint64_t seed);

double zoom_lens_focal_mm(const struct zoom_lens *lens);

#endif
