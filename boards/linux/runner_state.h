/// What a running rig is doing at a moment, as facts: for the lines of `run --state` and the
/// summary.
/// Shown: tests/cli/camera_run.sh, tests/vm/guest/rig.sh.
#ifndef LINUX_RUNNER_STATE_H
#define LINUX_RUNNER_STATE_H

#include "facts.h"
#include "runner.h"

/// pan_deg, tilt_deg: where the joints are, as measured, or as commanded where nobody measures.
void runner_state_joints(const struct runner *runner, struct facts *facts);

/// pan_servo_us, pan_servo_deg and so on: the pulse that a servo controller says it gives now, and
/// the joint angle that stands for; null as long as it has not said. Nothing of axes whose device
/// does not say such things.
void runner_state_servos(const struct runner *runner, struct facts *facts);

/// Every settings.state_us a JSON line on stdout. Never waits: where stdout takes nothing the line
/// is dropped and counted (runner->states_dropped).
void runner_state_tick(struct runner *runner);

#endif
