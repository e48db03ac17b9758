/// The parts of controller_step, in the order of their calls. For control/ only.
#ifndef CONTROL_PRIVATE_H
#define CONTROL_PRIVATE_H

#include "control/controller.h"

/// Solves the framing if the targets changed, and turns it into goals for the axes.
void controller_aim(struct controller *controller);

/// One tick of every powered axis through its limiter.
void controller_move(struct controller *controller);

/// Frames, pulses and status of this tick.
void controller_report(struct controller *controller, struct controller_output *output);

#endif
