/// The controller: targets and feedback in, setpoints and status out, one tick at a time.
///
/// It does no I/O: a tick's input is a set of values (the time, received frames, target updates,
/// commands) and so is its output (frames, pulse widths, status). Board, Linux and simulator run it
/// alike (app/pump.h), and the same inputs give the same outputs, bit for bit, everywhere.
///
///   STARTING --drives answer--> READY --arm--> SETTLING --> TRACKING <--> HOLDING
///                                 ^                             |  stop        |
///                                 +-------- arm ---- STOPPED <--+--------------+
///   any fault: FAULTED: decelerate, hold, stay there until an arm command finds the cause gone.
/// An arm command in STARTING is kept until the drives answer; one while an axis still moves, until
/// it rests; a stop takes both back. With settings that are not valid nothing is sent at all.
///
/// Shown: tests/unit/test_controller*.c.
#ifndef CONTROL_CONTROLLER_H
#define CONTROL_CONTROLLER_H

#include "aim/framing.h"
#include "aim/pan.h"
#include "drive/drive.h"
#include "fixed/must_check.h"
#include "motion/axis.h"
#include "motion/lens.h"
#include "motion/limiter.h"
#include "motion/mount.h"
#include "motion/tracker.h"
#include "target/target_set.h"

#include <stdbool.h>
#include <stdint.h>

enum controller_axis { AXIS_PAN, AXIS_TILT, AXIS_ZOOM, AXIS_COUNT };

// ---------------------------------------------------------------- settings

struct controller_axis_config {
    struct limiter_config limits;
    struct drive_config drive; ///< DRIVE_NONE: the axis does not exist (zoom only)
    int64_t home_q48; ///< where an axis without feedback is taken to be when it is first powered
    /// How long the axis is behind its setpoint, which leads a goal that moves by as much: up to
    /// CONTROLLER_LATENCY_US_MAX. Not of the zoom.
    uint32_t latency_us;
};
#define CONTROLLER_LATENCY_US_MAX 500000U

/// What the picture is fitted to.
enum controller_frame {
    CONTROLLER_FRAME_CONE, ///< the circle of the narrowest cone
    CONTROLLER_FRAME_RECT  ///< the smallest picture of the sensor's aspect
};

struct controller_config {
    uint32_t tick_us;            ///< nominal, 100 to 20,000
    struct vec3_i64 position_um; ///< each |component| <= TARGET_POSITION_UM_MAX
    struct mount_attitude attitude;
    struct controller_axis_config axis[AXIS_COUNT];
    struct lens_config lens; ///< of the zoom axis; its sensor is the camera's also without zoom
    enum controller_frame frame;
    uint64_t target_expiry_us;
    struct tracker_config tracker; ///< of pan and tilt
    uint32_t silence_us;           ///< a drive is silent after this long
    uint32_t settle_us;       ///< after arming, how long axes without feedback get to reach home
    int64_t follow_error_q48; ///< a measured position farther than this from the setpoint ...
    uint32_t follow_error_us; ///< ... for this long is a fault
    bool arm_on_start;
};

// ---------------------------------------------------------------- one tick

enum controller_command {
    COMMAND_ARM = 1,  ///< leave READY, STOPPED or FAULTED
    COMMAND_STOP = 2, ///< decelerate and hold until armed again; wins over COMMAND_ARM
};

/// Look at something else from now on: at all targets, or at one object. In between, equation 18
/// with minimum-jerk weights; no direction needs to see both. Where the new one is not there yet,
/// the pan waits where it is.
struct controller_pan {
    struct framing_choice choice;
    uint32_t duration_us; ///< 0: at once
    enum pan_path path;
};

#define CONTROLLER_FRAMES_IN_MAX  16U ///< a 1 Mbit/s bus carries 9 a millisecond
#define CONTROLLER_FRAMES_OUT_MAX 4U
#define CONTROLLER_UPDATES_MAX    16U

struct controller_input {
    uint32_t now_us;   ///< wraps. If it runs backwards, no time passes and the tick counts as late
    uint32_t commands; ///< enum controller_command, or-ed
    bool pan_set;      ///< pan holds a command
    struct controller_pan pan;
    uint32_t frame_count, update_count;
    struct can_frame frame[CONTROLLER_FRAMES_IN_MAX];
    /// When each arrived, of the clock of now_us; one that is later counts as now. What a drive
    /// measured is of that moment, not of the tick that brings it.
    uint32_t frame_us[CONTROLLER_FRAMES_IN_MAX];
    struct target_update
        update[CONTROLLER_UPDATES_MAX]; ///< applied in order, all before the aim is solved
};

enum controller_mode {
    MODE_STARTING, ///< waiting for the drives; nothing is commanded
    MODE_READY,    ///< homed, not armed; nothing is commanded
    MODE_SETTLING, ///< armed; axes without feedback go home
    MODE_TRACKING, ///< armed, following the aim
    MODE_HOLDING,  ///< armed, nothing to aim at: decelerate and hold
    MODE_STOPPED,  ///< stopped by command: decelerate and hold
    MODE_FAULTED   ///< stopped by a fault: decelerate and hold
};

/// Why it stopped; or-ed, latched until re-armed.
enum controller_fault {
    FAULT_CONFIG = 1,       ///< the settings are not valid: never arms
    FAULT_DRIVE_SILENT = 2, ///< a drive does not answer
    FAULT_DRIVE_ERROR = 4,  ///< a drive reports an error
    FAULT_FOLLOWING = 8,    ///< an axis does not follow its setpoint
    FAULT_OVERRUN = 16      ///< ticks came late again and again
};

struct controller_axis_status {
    int64_t setpoint_q48; ///< what the limiter put out
    int64_t goal_q48;     ///< where the aim wants it
    int64_t measured_q48;
    uint64_t measured_us; ///< when, as time_us of the status
    bool measured_known;
    uint32_t restarts; ///< how often the setpoint began anew from where the axis is
};

struct controller_status {
    uint64_t time_us; ///< since the first tick
    enum controller_mode mode;
    uint32_t faults;    ///< enum controller_fault
    uint8_t fault_axis; ///< which axis raised the last fault
    struct controller_axis_status axis[AXIS_COUNT];
    struct framing framing; ///< of the targets now; during a pan, between the two
    bool panning;
    uint32_t focal_um; ///< of the setpoint; 0 without zoom
    uint32_t target_count;
    uint32_t updates_rejected, frames_ignored; ///< counted since the start
    uint32_t aims_solved;
};

struct controller_output {
    uint32_t frame_count;
    struct can_frame frame[CONTROLLER_FRAMES_OUT_MAX];
    bool pulse_set[AXIS_COUNT]; ///< PWM axes
    uint32_t pulse_channel[AXIS_COUNT];
    uint32_t pulse_ns[AXIS_COUNT]; ///< 0: no pulses
    struct controller_status status;
};

// ---------------------------------------------------------------- the controller

/// What is looked at, and its frame.
struct controller_view {
    struct framing_choice choice;
    struct framing_memory memory;
    struct framing framing;
    uint32_t framed_version; ///< of the target set that it was solved for
    bool held;               ///< not solved any more: where a pan was broken off
};

/// A tick that brings CONTROLLER_UPDATES_MAX updates is taken for a part of a frame: the aim waits
/// for the rest, so that it is not worked out for half of a frame. At most so many ticks in a row.
#define CONTROLLER_WAIT_TICKS_MAX (TARGET_CAPACITY / CONTROLLER_UPDATES_MAX)

/// Pan and tilt wait so many ticks for the end of the aim's search, then follow it as it is.
#define CONTROLLER_REFINING_TICKS_MAX 8U

/// About 20 KiB (make size); no pointers but to its configuration, so it can be copied.
struct controller {
    const struct controller_config *config;
    struct mount mount;
    struct target_set targets;
    struct framing_workspace framing_workspace;
    struct framing framing;            ///< what is aimed at: the view's, or between two
    struct controller_view view, from; ///< from: of a pan
    bool panning;
    uint64_t pan_started_us;
    uint32_t pan_duration_us;
    enum pan_path pan_path;
    uint32_t framed_version; ///< of the target set that framing was solved for
    uint32_t refining_ticks; ///< in a row, that waited for the end of a search
    uint32_t full_ticks;     ///< in a row, that brought CONTROLLER_UPDATES_MAX updates
    uint32_t aim_reports;    ///< targets.rest_reports when the trackers were last told
    struct limiter limiter[AXIS_COUNT];
    struct drive drive[AXIS_COUNT];
    struct tracker tracker[2]; ///< pan, tilt
    int64_t goal_q48[AXIS_COUNT], goal_rate_q48[AXIS_COUNT];
    int64_t setpoint_q48[AXIS_COUNT];
    bool powered[AXIS_COUNT]; ///< setpoints go out
    bool ever_powered[AXIS_COUNT];
    uint32_t restarts[AXIS_COUNT];
    uint64_t following_since_us[AXIS_COUNT]; ///< last time the axis was near its setpoint
    uint64_t time_us, settled_us;
    uint32_t last_now_us, tick, late_ticks;
    bool started, arm_wanted;
    enum controller_mode mode;
    uint32_t faults;
    uint8_t fault_axis;
    struct mount_joints zoom_joints; ///< that the zoom goal was worked out for
    uint32_t zoom_version;
    uint32_t updates_rejected, frames_ignored, aims_solved;
};

/// Starts a controller. config must outlive it.
/// Returns: false if the settings are not usable: the controller then stays in MODE_FAULTED with
/// FAULT_CONFIG.
bool controller_init(struct controller *controller, const struct controller_config *config);

/// Takes up settings that were changed in place since: the expiry of targets and the lens' margin.
/// The tracker's are looked at in every tick; all others need controller_init.
void controller_take_settings(struct controller *controller);

/// One tick. Bounded work, no I/O. Inputs beyond the maxima are cut off by their counts (the pump
/// keeps the rest). Shown: tests/unit/test_controller.c and every scenario.
void controller_step(struct controller *controller, const struct controller_input *input,
                     struct controller_output *output);

/// Words for a mode and for the lowest fault bit: "tracking", "a drive does not answer".
const char *controller_mode_name(enum controller_mode mode);
const char *controller_fault_name(uint32_t faults);

#endif
