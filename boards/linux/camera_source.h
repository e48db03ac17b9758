/// The rig's camera as a source of targets: frames by camera_feed, detectors by detect/eye, updates
/// to the controller.
///
/// When the camera leaves, what it had found is gone, too: the gimbal holds, or follows what other
/// sources tell.
/// Shown: tests/vm/guest/camera.sh (an emulated camera that shows what the simulator renders).
#ifndef LINUX_CAMERA_SOURCE_H
#define LINUX_CAMERA_SOURCE_H

#include "camera_feed.h"
#include "facts.h"
#include "rig.h"

#include "detect/eye.h"
#include "detect/gimbal_pose.h"

enum { CAMERA_SOURCE_UPDATES = 512, CAMERA_SOURCE_IDS = 512 };

struct camera_source {
    struct camera_feed feed;
    struct eye *eye; ///< NULL: the rig has no camera that detects

    struct camera_pose pose; ///< of the gimbal, as it was told last ...
    uint32_t pose_us;        ///< ... by the clock of the frames
    /// For calibrate: gets every frame that was looked at, of which the controller hears nothing.
    /// NULL: nobody does. While `resting` no frame is looked at.
    void (*seen)(void *context, const struct eye *eye);
    void *seen_context;
    bool resting;

    // Private from here on.
    const struct rig *rig;
    const struct rig *next_rig; ///< whose camera takes its place as soon as it is let go of
    const struct hal_clock *clock;
    struct event_loop *loop;
    bool waits; ///< for the detectors: time is not real
    struct stage_camera stage;
    struct stage_camera *staged; ///< NULL: the camera is a real one
    struct gimbal_pose gimbal;
    bool was_there;
    uint64_t passed_over; ///< frames that the eye did not take
    uint64_t dropped;     ///< updates for which there was no room
    uint32_t head, tail;  ///< of the ring, counted up
    struct target_update update[CAMERA_SOURCE_UPDATES];
    uint32_t id_count;
    uint32_t id[CAMERA_SOURCE_IDS]; ///< of targets that it has told of
    char news[LINUX_ERROR_BYTES];   ///< of its own, besides the feed's
};

/// Nothing, if the rig has no camera that detects. clock: what frames and poses are stamped with; a
/// real camera needs the computer's (linux_clock.h). waits: of a simulated camera, each frame's
/// targets come in the tick that brings the frame, however long the detectors take. Must not move
/// in memory afterwards, nor may rig.
/// Returns: EXIT_STATUS_OK; EXIT_STATUS_DEVICE, and source->news is the line for the person;
/// another after a line on stderr.
enum exit_status camera_source_open(struct camera_source *source, const struct rig *rig,
                                    const struct hal_clock *clock, bool waits);
bool camera_source_watch(struct camera_source *source, struct event_loop *loop) MUST_CHECK;
/// The loop lets go of it; only camera_source_close may follow, in any thread.
void camera_source_unwatch(struct camera_source *source);
void camera_source_close(struct camera_source *source);

/// From now on the camera of that rig, which may have none, or other numbers for the same one. The
/// old one is let go of and the new one opened over the next ticks, without waiting for either; the
/// old rig is in use until camera_source_is_changing says no more.
void camera_source_change(struct camera_source *source, const struct rig *rig);
bool camera_source_is_changing(const struct camera_source *source);

/// After each step of the controller; at_us: now, by its time. truth: where the gimbal really is,
/// which a simulated camera sees; NULL: where the controller says.
void camera_source_pose(struct camera_source *source, const struct controller_status *status,
                        uint64_t at_us, const struct camera_pose *truth);

/// After each tick.
void camera_source_tick(struct camera_source *source);

/// The next update, which stays until camera_source_taken. NULL: none waits.
const struct target_update *camera_source_next(const struct camera_source *source);
void camera_source_taken(struct camera_source *source);

/// What the person should know, once; NULL: nothing new. *lost: the camera has left or is silent.
const char *camera_source_news(struct camera_source *source, bool *lost);

/// What it did, for the summary of a run.
void camera_source_facts(const struct camera_source *source, struct facts *facts);

#endif
