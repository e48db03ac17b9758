/// What `boresight run` does: ticks by the clock, with the devices of a rig or, where the rig names
/// fakes only, with those of the simulator.
/// Shown: tests/cli/drive.sh, tests/cli/drives.sh, tests/vm/guest/run.sh.
#ifndef LINUX_RUNNER_H
#define LINUX_RUNNER_H

#include "camera_source.h"
#include "capacity.h"
#include "command.h"
#include "event_loop.h"
#include "occlusion_file.h"
#include "realtime.h"
#include "rig.h"
#include "rig_devices.h"
#include "rig_lines.h"
#include "run_log.h"
#include "side_job.h"
#include "target_source.h"

#include "sim.h"

struct runner_settings {
    const char *command;  ///< for messages
    const char *rig_file; ///< read again on SIGHUP
    const char *targets;  ///< NULL: none
    const char *log;      ///< as for run_log_open
    const char *scene;    ///< whose solids hide targets, instead of the rig's; NULL: the rig's
    bool see_through;     ///< nothing hides anything
    uint64_t limit_us;    ///< 0: until interrupted
    uint64_t state_us;    ///< a line of state every so often; 0: none
    bool arm;             ///< whatever the rig file says
    bool stay;            ///< a fault, a lost device do not end it
    bool wait;            ///< devices that can't be opened are tried again until they can
    bool hurry;           ///< simulated rigs do not wait for the clock
    bool fixed;           ///< SIGHUP changes nothing
};

struct runner {
    struct runner_settings settings;
    struct rig rig;
    struct rig next_rig; ///< read, to be used as soon as all stands still
    bool reloading;      ///< it is, and all comes to rest
    bool rebuilding;     ///< it takes its place in the background; no controller runs
    bool absent;         ///< a device of it could not be opened: between two tries
    bool reading;        ///< it is being read in the background
    bool read_again;     ///< SIGHUP came meanwhile
    struct side_job job; ///< for both
    enum exit_status job_status;
    char refusal[LINUX_ERROR_BYTES];      ///< why a device could not be opened, at the last try
    char told_refusal[LINUX_ERROR_BYTES]; ///< the person knows of; empty: none
    uint64_t tried_us;
    uint32_t held_signals; ///< that came while no controller ran
    /// Of the camera, once another file has changed only that: the one in use and the one before.
    struct rig camera_rig[2];
    unsigned camera_reloads; ///< since all was read; the one in use is (camera_reloads - 1) % 2
    struct target_source source;
    bool has_source;
    uint64_t source_since_ticks;                ///< the times of a recording count from here
    struct schedule schedule;                   ///< empty: targets come from the source
    struct sim *sim;                            ///< NULL: real devices
    struct occlusion_rig *hiding, *next_hiding; ///< NULL: nothing hides targets
    struct sim_obstacles obstacles;             ///< the same for the simulator
    struct rig_devices devices;
    bool devices_open;
    struct rig_lines lines;
    struct linux_clock clock; ///< of frames and poses
    struct camera_source camera;
    bool stop_pressed;   ///< emergency stop, as long as it is
    const char *pressed; ///< the line that was pressed last; NULL: none
    struct controller real_controller;
    struct pump real_pump;
    struct controller *controller; ///< whichever is driven
    struct pump *pump;
    struct event_loop loop;
    struct realtime realtime;
    struct run_log log;
    enum controller_mode told_mode;
    uint32_t told_faults;
    struct capacity capacity;
    bool stopping; ///< for good
    enum exit_status status;
    bool device_failed, line_stopped;
    bool outside[2];              ///< pan, tilt: beyond its limits, and told
    bool told_silent[AXIS_COUNT]; ///< that a drive does not answer
    bool was_missing;             ///< a device, when it was last looked
    uint64_t steps, starting_since_us, looked_us, reloads, state_due_us, states_dropped;
};

/// Runs to the end. Returns the exit status of the command, after lines on stderr. What the results
/// are taken from stays until runner_close, which is called in any case.
enum exit_status runner_run(struct runner *runner, const struct runner_settings *settings);
void runner_close(struct runner *runner);

/// The same in parts, for a caller that does something between the ticks. runner_tick returns false
/// at the end: runner->status tells why.
enum exit_status runner_start(struct runner *runner, const struct runner_settings *settings);
bool runner_tick(struct runner *runner);
/// Decelerates, holds and ends.
void runner_stop(struct runner *runner);

#endif
