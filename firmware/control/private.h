/// The parts of controller_step, in the order of their calls. For control/ only.
#ifndef CONTROL_PRIVATE_H
#define CONTROL_PRIVATE_H

#include "control/controller.h"

/// Takes up a pan.
void controller_start_pan(struct controller *controller, const struct controller_pan *pan);

/// Works out where to look: the framing of the view, or between two. Returns whether it is new.
bool controller_look(struct controller *controller);

/// Solves the framing if the targets changed, and turns it into goals for the axes.
void controller_aim(struct controller *controller);

/// One tick of every powered axis through its limiter.
void controller_move(struct controller *controller);

/// Frames, pulses and status of this tick.
void controller_report(struct controller *controller, struct controller_output *output);

#endif
