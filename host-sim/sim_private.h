/// The parts of the simulator. For host-sim/sim*.c only.
#ifndef SIM_PRIVATE_H
#define SIM_PRIVATE_H

#include "sim.h"

/// Bus, drives and plant, to a time.
void sim_run_plant(struct sim *sim, uint64_t until_ns);

/// The targets of the schedule that are due.
void sim_feed_targets(struct sim *sim);

/// The HAL of the simulator: virtual clock and pulse channels (the bus has devices/bus_node_hal.h).
bool sim_hal_bind(struct sim *sim);

void sim_check_init(struct sim *sim);
/// Forgets the axes: their controller begins anew.
void sim_check_init_axes(struct sim *sim);
/// After the controller's step: I1, I2, I4, I5, I9.
void sim_check_step(struct sim *sim);
/// After the plant's step, when the controller is elsewhere: I1, I2.
void sim_check_served(struct sim *sim);
/// A frame on the bus that commands motion, seen by the observer: I4.
void sim_check_frame(struct sim *sim, const struct can_transfer *transfer);

/// The obstacles. False: no memory, or their settings are out of range.
bool sim_world_init(struct sim *sim);
/// Keeps a report of a target for the next frame, where a board is the controller. False: it hears
/// of it as it is.
bool sim_world_take(struct sim *sim, const struct target_update *update);
/// Moves the obstacles, and gives a board the updates of a frame when one is due.
void sim_world_step(struct sim *sim);
/// After a step of the controller here: what it heard of the targets is what the policy asks for.
void sim_world_heard(struct sim *sim);

void sim_measure_init(struct sim *sim);
/// Applies an update, as it really is, to the truth.
void sim_measure_update(struct sim *sim, const struct target_update *update);

/// From now on the truth is that of this choice of targets.
void sim_measure_choose(struct sim *sim, struct framing_choice choice);
/// What is optimal, if the targets have changed.
void sim_measure_follow(struct sim *sim);
/// 100 times a second.
void sim_measure_step(struct sim *sim);

#endif
