/// The parts of calibrate.h: the axes (calibrate.c) and the camera (calibrate_camera.c). For them
/// only.
#ifndef LINUX_CALIBRATE_PRIVATE_H
#define LINUX_CALIBRATE_PRIVATE_H

#include "calibrate.h"

/// A tick of the rig. False: it is over, runner.status tells why.
bool calibrate_tick(struct calibrate *calibrate);

/// Where an axis is to go from now on, in degrees.
void calibrate_aim(struct calibrate *calibrate, unsigned axis, double deg);

double calibrate_clamp(double value, double least, double most);

/// What the camera finds is no target from now on, and it is not looked at either.
void calibrate_camera_rests(struct calibrate *calibrate);

/// Looks for something to measure by, and swings pan to and fro while the camera looks at it. A
/// camera that sees nothing is no failure. False: the rig was stopped.
bool calibrate_camera(struct calibrate *calibrate);

/// What came of it, once all stands still.
void calibrate_camera_fit(struct calibrate *calibrate);

#endif
