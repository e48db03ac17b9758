/// The simulator's drives on somebody else's bus.
#include "sim_private.h"

/// More than a bus can carry in a tick of 20 ms: so many at most are moved at a time.
#define FRAMES_A_TICK 256

static void bridge(const struct hal_can *from, const struct hal_can *to, uint64_t *carried,
                   uint64_t *lost) {
    struct can_frame frame;
    uint32_t at_us;
    for (int i = 0; i < FRAMES_A_TICK && hal_can_receive(from, &frame, &at_us) == HAL_OK; i++) {
        if (hal_can_send(to, &frame) == HAL_OK) {
            (*carried)++;
        } else {
            (*lost)++;
        }
    }
}

void sim_serve_step(struct sim *sim, const struct hal_can *outside) {
    struct sim_served *served = &sim->served;
    served->on = true;
    sim_feed_targets(sim);
    bridge(outside, &sim->node.hal, &served->frames_in, &served->frames_lost);
    sim->time_us += sim->config.controller->tick_us;
    sim->tick++;
    sim_run_plant(sim, sim->time_us * 1000U);
    sim_check_served(sim);
    if (sim->time_us % 10000U == 0U) {
        sim_measure_follow(sim);
    }
    bridge(&sim->node.hal, outside, &served->frames_out, &served->frames_lost);
}
