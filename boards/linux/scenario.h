/// Scenario files: which rig, which targets, how long. What `boresight sim` runs.
/// Shown: tests/cli/drive.sh.
#ifndef LINUX_SCENARIO_H
#define LINUX_SCENARIO_H

#include "ini.h"
#include "rig.h"
#include "scenario_camera.h"

#include "sim.h"

#define SCENARIO_EVENTS_MAX 64U

struct scenario {
    struct ini ini; ///< keeps the texts
    const char *name, *about;
    struct rig rig;
    struct schedule schedule;
    struct scenario_world *world; ///< NULL: no obstacles
    struct sim_command commands[SCENARIO_EVENTS_MAX];
    size_t command_count;
    bool has_camera;
    struct scenario_camera camera;
    struct sim_config sim; ///< ready for sim_create; points into this struct, which must not move
    uint64_t duration_us;
};

/// Reads a scenario with its rig and its targets. Paths in it are relative to its own folder.
/// Returns: EXIT_STATUS_OK, or another after lines on stderr. Free with scenario_free in any case.
enum exit_status scenario_read(const char *path, struct scenario *out);
void scenario_free(struct scenario *scenario);

#endif
