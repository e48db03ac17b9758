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

    // Private from here on.
    const struct rig *rig;
    const struct hal_clock *clock;
    struct event_loop *loop;
    struct gimbal_pose gimbal;
    bool was_there;
    uint64_t passed_over; ///< frames that the eye did not take
    uint64_t dropped;     ///< updates for which there was no room
    uint32_t head, tail;  ///< of the ring, counted up
    struct target_update update[CAMERA_SOURCE_UPDATES];
    uint32_t id_count;
    uint32_t id[CAMERA_SOURCE_IDS]; ///< of targets that it has told of
};

/// Nothing, if the rig has no camera that detects. clock: what frames and poses are stamped with;
/// controller: for the mount. Must not move in memory afterwards, nor may rig.
/// Returns: EXIT_STATUS_OK; another after a line on stderr.
enum exit_status camera_source_open(struct camera_source *source, const struct rig *rig,
                                    const struct hal_clock *clock);
bool camera_source_watch(struct camera_source *source, struct event_loop *loop) MUST_CHECK;
void camera_source_close(struct camera_source *source);

/// After each tick: where the gimbal is now.
void camera_source_tick(struct camera_source *source, const struct controller_status *status);

/// The next update, which stays until camera_source_taken. NULL: none waits.
const struct target_update *camera_source_next(const struct camera_source *source);
void camera_source_taken(struct camera_source *source);

/// What the person should know, once; NULL: nothing new. *lost: the camera has left or is silent.
const char *camera_source_news(struct camera_source *source, bool *lost);

/// What it did, for the summary of a run.
void camera_source_facts(const struct camera_source *source, struct facts *facts);

#endif
