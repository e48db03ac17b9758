/// Measures what a rig's axes can do, by moving them: where they end, how long they take, how far
/// they lag behind.
///
/// Every motion goes through the controller, as a target that is aimed at, so limits, speeds,
/// switches and the emergency stop of the rig file hold. Only axes that measure their position can
/// be measured.
/// - Ends: the aim creeps toward each limit of the file. A switch that is pressed, or an axis that
///   stays behind and comes no further, is the end; the axis is led back at once. (Behind alone is
///   also a rig that is slow to answer.)
/// - Moves: CALIBRATE_MOVES amplitudes within the ends, each there and back; the time from the new
///   aim to where the axis stays within 0.1 degree of it, the longer of the two. While the program
///   is kept from running the setpoint stands still: that time is taken off.
/// - Latency: how long after the setpoint the axis is at the same place, the median over the fast
///   part of the longest move; not where the setpoint stood still meanwhile.
/// - Times are those of the drive's answers (of the kernel's stamps on SocketCAN), not of the ticks
///   that find them. All moves are repeated until two rounds agree, or the middle half of more, up
///   to CALIBRATE_ROUNDS; the median counts. Where they never agree that is told: noisy.
/// - The camera's latency and focal length: pan swings to and fro while the camera looks at
///   whatever it finds that stands still (camera_latency.h). Nobody follows what it finds
///   meanwhile.
/// Shown: tests/cli/calibrate.sh (against the simulator's drives and camera, whose ends, lag and
/// latency are known), tests/vm/guest/calibrate.sh (the same over SocketCAN, on a machine that
/// pauses).
#ifndef LINUX_CALIBRATE_H
#define LINUX_CALIBRATE_H

#include "camera_latency.h"
#include "runner.h"

enum {
    CALIBRATE_MOVES = 3,
    CALIBRATE_ROUNDS = 6,
    CALIBRATE_SETPOINTS = 16384,
    CALIBRATE_SIGHTS = 4096
};

enum calibrate_end {
    CALIBRATE_END_LIMIT,  ///< the axis reaches the limit of the rig file
    CALIBRATE_END_SWITCH, ///< a limit switch comes before it
    CALIBRATE_END_STOP    ///< something stops the axis before it
};

struct calibrate_axis {
    bool measured; ///< false: it has no feedback
    enum calibrate_end end[2];
    double end_deg[2]; ///< low and high: how far it may go
    uint32_t move_count;
    double move_deg[CALIBRATE_MOVES], move_s[CALIBRATE_MOVES];
    double latency_ms, speed_dps; ///< the latter over 40 ms; 0: it could not be told
    uint32_t rounds;
    /// How far the rounds were apart; of four and more the middle half.
    double move_spread_s[CALIBRATE_MOVES], latency_spread_ms;
    bool noisy; ///< they did not agree
};

/// A move: what was asked for at every tick, and what the drive answered.
struct calibrate_trace {
    uint32_t setpoint_count, sight_count;
    uint64_t setpoint_us[CALIBRATE_SETPOINTS], sight_us[CALIBRATE_SIGHTS];
    double setpoint_deg[CALIBRATE_SETPOINTS], sight_deg[CALIBRATE_SIGHTS];
};

struct calibrate_camera {
    bool measured;
    const char *why_not; ///< NULL: it was, or there is none
    double latency_ms, rms_deg;
    double fx_px;                    ///< by how the thing went through the picture
    double given_fx_px, given_fy_px; ///< as the rig file has them
    uint32_t sights;
};

struct calibrate_settings {
    const char *command; ///< for messages
    const char *rig_file;
    bool with_ends;   ///< false: the limits of the file are the ends
    bool only_camera; ///< nothing but its latency
};

struct calibrate {
    struct runner runner;
    struct calibrate_axis axis[2];
    struct calibrate_camera camera;

    // Private from here on.
    double aim_deg[2];
    uint64_t aimed_us;
    struct calibrate_trace trace;
    double sorted[2 * CALIBRATE_SIGHTS]; ///< of a round: there and back
    uint32_t sorted_count, speed_count;
    double speeds[2 * CALIBRATE_SIGHTS];
    struct camera_latency sights;
};

/// Starts the rig, measures, and brings it to rest. Returns: EXIT_STATUS_OK, or another after lines
/// on stderr.
enum exit_status calibrate_run(struct calibrate *calibrate,
                               const struct calibrate_settings *settings);
/// Closes the rig. In any case.
void calibrate_close(struct calibrate *calibrate);

#endif
