/// The parts of calibrate.h: the axes (calibrate.c) and the camera (calibrate_camera.c). For them
/// only.
#ifndef LINUX_CALIBRATE_PRIVATE_H
#define LINUX_CALIBRATE_PRIVATE_H

#include "calibrate.h"

/// A tick of the rig. False: it is over, runner.status tells why.
bool calibrate_tick(struct calibrate *calibrate);

/// Where an axis is to go from now on, in degrees.
void calibrate_aim(struct calibrate *calibrate, unsigned axis, double deg);

#define CALIBRATE_ARRIVED_DEG 0.1

/// Why the axis can't be measured. Always false.
bool calibrate_give_up(struct calibrate *calibrate, unsigned axis, const char *why);

/// Goes to an angle and stays there for a while; calibrate->trace tells how. Returns whether it
/// arrived.
bool calibrate_go(struct calibrate *calibrate, unsigned axis, double deg) MUST_CHECK;

/// Times of moves, speed and latency, between the axis' ends. False: told why not.
bool calibrate_moves(struct calibrate *calibrate, unsigned axis) MUST_CHECK;

// ---------------------------------------------------------------- what a trace tells

void calibrate_trace_begin(struct calibrate_trace *trace);
/// After a tick at now_us. A measurement that is known already is not taken twice.
void calibrate_trace_add(struct calibrate_trace *trace, uint64_t now_us, double setpoint_deg,
                         uint64_t sight_us, double sight_deg);

/// How long the move to that angle took, less what ticks were missed of it.
double calibrate_trace_took_s(const struct calibrate_trace *trace, uint32_t tick_us, double to_deg);

/// Lags behind setpoints that go faster than fast_dps, in ms, and speeds where the setpoint goes
/// fastest, in degrees a second, both where no tick was missed. They go behind the *count that are
/// there, as far as `most`.
void calibrate_trace_lags(const struct calibrate_trace *trace, uint32_t tick_us, double fast_dps,
                          double *lag_ms, uint32_t *count, uint32_t most);
void calibrate_trace_speeds(const struct calibrate_trace *trace, uint32_t tick_us,
                            double *speed_dps, uint32_t *count, uint32_t most);

/// The value that so much of them (0 to 1) is below; sorts them.
double calibrate_quantile(double *values, uint32_t count, double part);

double calibrate_clamp(double value, double least, double most);

/// What the camera finds is no target from now on, and it is not looked at either.
void calibrate_camera_rests(struct calibrate *calibrate);

/// Looks for something to measure by, and swings pan to and fro while the camera looks at it. A
/// camera that sees nothing is no failure. False: the rig was stopped.
bool calibrate_camera(struct calibrate *calibrate);

/// What came of it, once all stands still.
void calibrate_camera_fit(struct calibrate *calibrate);

#endif
