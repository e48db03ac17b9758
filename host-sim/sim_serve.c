/// The simulator's drives on somebody else's bus.
#include "sim_private.h"

/// More than a bus can carry in a tick of 20 ms: so many at most are moved at a time.
#define FRAMES_A_TICK 256
/// The controller's end of the simulated bus has room for a few frames; the bus carries eight a
/// millisecond.
#define SLICE_US 1000U

/// From outside, as long as the simulated bus takes them. What it does not take now comes first the
/// next time.
static void carry_in(struct sim *sim, const struct hal_can *outside) {
    struct sim_served *served = &sim->served;
    uint32_t at_us;
    for (int i = 0; i < FRAMES_A_TICK; i++) {
        if (!served->has_next && hal_can_receive(outside, &served->next, &at_us) != HAL_OK) {
            return;
        }
        const enum hal_status status = hal_can_send(&sim->node.hal, &served->next);
        served->has_next = status == HAL_BUSY;
        if (served->has_next) {
            return;
        }
        served->frames_in += status == HAL_OK;
        served->frames_lost += status != HAL_OK;
    }
}

static void carry_out(struct sim *sim, const struct hal_can *outside) {
    struct can_frame frame;
    uint32_t at_us;
    for (int i = 0; i < FRAMES_A_TICK && hal_can_receive(&sim->node.hal, &frame, &at_us) == HAL_OK;
         i++) {
        const bool taken = hal_can_send(outside, &frame) == HAL_OK;
        sim->served.frames_out += taken;
        sim->served.frames_lost += !taken;
    }
}

void sim_serve_step(struct sim *sim, const struct hal_can *outside) {
    const uint64_t end_us = sim->time_us + sim->config.controller->tick_us;
    sim->served.on = true;
    sim_feed_targets(sim);
    while (sim->time_us < end_us) {
        sim->time_us = end_us - sim->time_us > SLICE_US ? sim->time_us + SLICE_US : end_us;
        carry_in(sim, outside);
        sim_run_plant(sim, sim->time_us * 1000U);
        carry_out(sim, outside);
    }
    sim->tick++;
    sim_check_served(sim);
    if (sim->time_us % 10000U == 0U) {
        sim_measure_follow(sim);
    }
}
