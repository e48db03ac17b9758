/// Frames of the rig's camera for the event loop: a camera that leaves, falls silent and comes back
/// is the feed's business, and never blocks the loop.
///
/// Opening a USB camera takes up to a second, so after the first time it is done in the background,
/// twice a second until it succeeds. Until then the camera is the background's alone; while frames
/// come it belongs to the loop. Of frames that wait together the newest is handed on: the others
/// are late. A simulated camera (stage_camera.h) is the same, but asked at every tick.
/// Shown: tests/scenario/test_camera_feed.c (a model of V4L2: formats, counts, silence, leaving),
/// tests/vm/guest/camera.sh (an emulated USB camera: pulled out, silent, back again).
#ifndef LINUX_CAMERA_FEED_H
#define LINUX_CAMERA_FEED_H

#include "event_loop.h"
#include "side_job.h"
#include "stage_camera.h"

#include "linux/linux_camera.h"

/// Without a frame for so long (or ten intervals, if that is longer) a camera is taken for hung,
/// and opened anew.
#define CAMERA_FEED_SILENCE_US 3000000U

struct camera_feed_settings {
    const char *device;
    struct stage_camera *stage; ///< simulated, in place of the device; NULL: none
    struct hal_camera_format wish;
    const struct hal_clock *clock;
    /// Gets every frame that is handed on; valid during the call.
    void (*take)(void *context, const struct hal_camera_format *format,
                 const struct hal_camera_frame *frame);
    void *context;
};

struct camera_feed {
    struct camera_feed_settings settings;
    struct hal_camera_format format; ///< what the camera gives
    const char *path;                ///< what messages call it
    // Counted since the start.
    uint64_t frames;  ///< that came
    uint64_t lost;    ///< by their numbers
    uint64_t late;    ///< older than another that waited
    uint64_t damaged; ///< handed on all the same
    uint64_t failures, silences, returns;
    char news[LINUX_ERROR_BYTES]; ///< what the person should know; empty: nothing new

    // Private from here on.
    struct linux_camera camera;
    const struct hal_camera *hal; ///< of the one or the other
    struct event_loop *loop;      ///< NULL: nothing is watched
    bool streaming;               ///< the camera is the loop's
    bool any_frame, silent;
    uint32_t next_sequence;
    uint64_t heard_us;
    bool told; ///< the person knows whether it is there
    struct side_job attempt;
    bool opened;      ///< by the background, for the loop to take
    bool closing;     ///< for good
    uint64_t next_us; ///< of the next attempt
};

/// Opens the camera, agrees on a format and starts it. Returns HAL_OK; else the line is in
/// feed->news and nothing is open. Must not move in memory afterwards.
enum hal_status camera_feed_open(struct camera_feed *feed,
                                 const struct camera_feed_settings *settings) MUST_CHECK;

/// The same in the background, from the first tick on: the news tell what has become of it.
/// settings and loop must last.
void camera_feed_open_later(struct camera_feed *feed, const struct camera_feed_settings *settings,
                            struct event_loop *loop);

/// From now on frames are taken when they come. False: the loop has no room.
bool camera_feed_watch(struct camera_feed *feed, struct event_loop *loop) MUST_CHECK;

/// At every tick, with the loop's time.
void camera_feed_tick(struct camera_feed *feed, uint64_t now_us);

/// Whether frames can come: the camera is there.
bool camera_feed_is_there(const struct camera_feed *feed);

/// Lets go of the camera in the background. Call it at every tick, in place of camera_feed_tick,
/// until it returns true: then camera_feed_close does not wait.
bool camera_feed_end(struct camera_feed *feed) MUST_CHECK;

/// The loop lets go of it; only camera_feed_close may follow, in any thread.
void camera_feed_unwatch(struct camera_feed *feed);

/// Waits for what is under way.
void camera_feed_close(struct camera_feed *feed);

#endif
