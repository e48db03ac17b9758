/// The [event] sections of a scenario: commands at a time. For scenario.c only.
/// Shown: tests/cli/drive.sh, tests/scenario/test_sim.c.
#ifndef LINUX_SCENARIO_EVENT_H
#define LINUX_SCENARIO_EVENT_H

#include "ini_schema.h"

#include "sim.h"

struct scenario_event {
    const char *label;
    int64_t at_us;
    int action;
    int64_t object, duration_us;
    int path;
};

enum { SCENARIO_EVENT_KEY_COUNT = 5 };
extern const struct ini_key scenario_event_keys[SCENARIO_EVENT_KEY_COUNT];

/// What the events command, in the order of their times.
void scenario_read_events(const struct scenario_event *events, uint32_t count,
                          struct sim_command *commands);

#endif
