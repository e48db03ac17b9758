/// The sections [mover NAME] of a scenario: targets that move.
/// Shown: tests/cli/obstacle.sh, tests/scenario/test_obstacle.c.
#ifndef LINUX_SCENARIO_MOVERS_H
#define LINUX_SCENARIO_MOVERS_H

#include "ini_schema.h"

#include "world/schedule.h"

/// As in the file, scaled.
struct scenario_mover {
    const char *label;
    int64_t id, object, from_us, until_us, period_us, radius_um, phase_mdeg, turn_mdps, noise_um;
    struct ini_numbers start_um, velocity_umps;
};

enum { SCENARIO_MOVER_KEY_COUNT = 11 };
extern const struct ini_key scenario_mover_keys[SCENARIO_MOVER_KEY_COUNT];

/// Adds them to the schedule. False: told on stderr what is wrong with one.
bool scenario_movers_add(const struct scenario_mover *movers, uint32_t count, const struct ini *ini,
                         struct schedule *schedule);

#endif
