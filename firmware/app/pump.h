/// The pump between hardware and controller: one call reads the devices, runs a tick, writes the
/// devices.
///
/// Board, Linux program and simulator run this same code with different HALs behind it.
/// Shown: tests/unit/test_pump.c.
#ifndef APP_PUMP_H
#define APP_PUMP_H

#include "control/controller.h"
#include "fixed/must_check.h"
#include "hal/can.h"
#include "hal/clock.h"
#include "hal/pwm.h"

#include <stdbool.h>
#include <stdint.h>

/// Version and commit of this build.
extern const char build_id[];

/// Devices that a rig lacks are NULL.
struct pump_devices {
    const struct hal_clock *clock;
    const struct hal_can *can;
    const struct hal_pwm *pwm;
};

/// Counted since the start; none stops the pump.
struct pump_errors {
    uint32_t can_send_failed; ///< ticks that could not send all their frames; the rest is dropped
    uint32_t can_receive_failed;
    uint32_t can_restarts;    ///< how often a bus that was off began to restart
    uint32_t pwm_failed;      ///< a pulse that fails is written again in the next tick
    uint32_t updates_dropped; ///< more came between two ticks than PUMP_UPDATES_MAX
};

#define PUMP_UPDATES_MAX 128U ///< a source that gets `false` keeps the rest for the next tick

/// What the controller hears instead of the queue, where something stands between the two
/// (app/pump_occlusion.h): that takes from the queue and fills this ring before a tick.
#define PUMP_DETOUR_MAX 32U
struct pump_detour {
    bool forget; ///< what is on its way
    uint32_t first, count;
    struct target_update update[PUMP_DETOUR_MAX];
};

struct pump {
    struct pump_devices devices;
    struct controller *controller;
    struct pump_detour *detour; ///< NULL: none
    uint32_t update_first, update_count;
    uint32_t held_count; ///< the last ones in the ring that wait for pump_release
    bool holds;
    struct target_update update[PUMP_UPDATES_MAX]; ///< waiting for a tick, a ring
    uint32_t as_is[PUMP_UPDATES_MAX / 32U];        ///< a bit each: past what may hide it
    uint32_t commands;
    bool pan_set;
    struct controller_pan pan;
    uint32_t pulse_ns[AXIS_COUNT];   ///< as last written; UINT32_MAX: never
    struct controller_input input;   ///< of the last tick, for a recorder
    struct controller_output output; ///< of the last tick
    struct pump_errors errors;
    bool can_restarting; ///< it has taken no frame since
};

/// Returns false if a device that the controller's drives need is missing.
bool pump_init(struct pump *pump, struct controller *controller,
               const struct pump_devices *devices) MUST_CHECK;

/// Queues a target update for the next tick; later ones wait for the ticks after it, in order.
/// Returns false, and counts it, if the queue is full.
bool pump_push(struct pump *pump, const struct target_update *update) MUST_CHECK;

/// The same for an aim by hand, which nothing hides.
bool pump_push_as_is(struct pump *pump, const struct target_update *update) MUST_CHECK;

/// Takes the next update from the queue. False: none, or it is held back.
bool pump_take(struct pump *pump, struct target_update *update, bool *as_is) MUST_CHECK;

/// Holds back the updates that are pushed from now on until pump_release, so that those of one
/// frame reach the controller in ticks that follow each other and make one aim: an aim that moves
/// in pieces looks like a target that darts about. When the queue is full, no more is held back.
void pump_hold(struct pump *pump);
void pump_release(struct pump *pump);

/// Drops the updates that wait.
void pump_forget(struct pump *pump);

/// Gives commands to the next tick. Several before one tick are or-ed.
void pump_command(struct pump *pump, uint32_t commands);

/// Gives a pan to the next tick. Of several before one tick the last counts.
void pump_pan(struct pump *pump, const struct controller_pan *pan);

/// One tick. Call it once per config->tick_us. Never blocks.
void pump_step(struct pump *pump);

#endif
