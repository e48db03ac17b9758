/// Frames of the rig's camera in, target updates out: what `run` and the simulator do with a
/// camera.
///
/// The caller tells the pose of the gimbal every tick, hands in frames as they come, and takes the
/// updates when they are there. A detector takes tens of milliseconds, a tick is one: frames are
/// worked on in a thread of their own (eye_submit, eye_collect), or at once where time does not
/// matter (eye_look). The pose is looked up when a frame is handed in, so poses, frames and updates
/// belong to the caller's thread alone.
///
///     each tick:       eye_pose(eye, now_us, &pose);
///     a frame is in:   eye_submit(eye, &format, &frame); then give the frame back to the camera
///     eye_fd readable: eye_collect(eye, give, context);
/// Shown: tests/scenario/test_eye.c.
#ifndef DETECT_EYE_H
#define DETECT_EYE_H

#include "detect/camera_pose.h"
#include "detect/detector.h"
#include "fixed/must_check.h"
#include "hal/camera.h"
#include "target/target_set.h"

#include <stdbool.h>
#include <stdint.h>

struct eye_settings {
    struct camera_model model; ///< at zoom 1
    struct camera_seat seat;
    int32_t latency_us; ///< from the middle of a frame's exposure to its time stamp
    struct mount mount;
    struct detector_settings detectors;
};

/// Counted since the start.
struct eye_counts {
    uint64_t frames;      ///< worked on
    uint64_t busy;        ///< frames passed over because the one before was still worked on
    uint64_t unplaced;    ///< no pose is known for their time: nothing was told of them
    uint64_t undecodable; ///< no picture in them
    uint64_t updates, gone;
    uint64_t work_us, work_us_max; ///< of the detectors, in all and of the slowest frame
};

struct eye;

/// Returns: NULL: no memory, or no thread; errno tells.
struct eye *eye_create(const struct eye_settings *settings);
void eye_destroy(struct eye *eye);

/// The gimbal's pose at a time of the clock that frames are stamped with.
void eye_pose(struct eye *eye, uint32_t now_us, const struct camera_pose *pose);

enum eye_status {
    EYE_OK = 0,
    EYE_BUSY = 1,        ///< the one before is still worked on: this frame is passed over
    EYE_UNPLACED = 2,    ///< no pose is known for its time: passed over
    EYE_ERROR_FRAME = -1 ///< there is no picture in it
};

/// A frame as the camera gave it, of any of its formats. It is copied: give it back at once.
/// Returns: at once. Cost: one copy of the frame.
enum eye_status eye_submit(struct eye *eye, const struct hal_camera_format *format,
                           const struct hal_camera_frame *frame) MUST_CHECK;

/// Whether no frame is being worked on: then eye_destroy does not wait.
bool eye_is_idle(struct eye *eye);

/// Can be read (poll, epoll) while updates of a frame wait for eye_collect.
int eye_fd(const struct eye *eye);

/// Gives the updates of the frame that is done, if there is one: each detection as a direction in
/// the world, where it is at now_us (detect/foresight.h), with its angular radius, and TARGET_GONE
/// for those that were followed and are no more. Returns how many.
uint32_t eye_collect(struct eye *eye, uint32_t now_us,
                     void (*give)(void *context, const struct target_update *update),
                     void *context);

/// A frame, worked on at once in the caller's thread: eye_submit and eye_collect in one. For the
/// simulator; not while a submitted frame is out.
enum eye_status eye_look(struct eye *eye, const struct hal_camera_luma *frame, uint32_t now_us,
                         void (*give)(void *context, const struct target_update *update),
                         void *context) MUST_CHECK;

/// What was found in the frame collected last, in pixels.
const struct detections *eye_last(const struct eye *eye);

/// The time stamp of that frame, and the direction of one of its detections in the camera's axes.
/// False: the model has none for it.
uint32_t eye_last_stamp_us(const struct eye *eye);
bool eye_last_ray(const struct eye *eye, uint32_t index, double ray[3]) MUST_CHECK;

/// A detection as a target update for a camera in that place. False: the model has no direction for
/// it.
bool eye_update_of(const struct detection *detection, const struct camera_model *model,
                   const struct camera_view *view, struct target_update *update) MUST_CHECK;

struct eye_counts eye_counts_of(const struct eye *eye);

#endif
