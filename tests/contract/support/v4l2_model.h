/// A video device as V4L2 describes it, below the C library: what the drivers of hal/linux ask of
/// the kernel by ioctl is answered here (syscalls.h), opening and mapping are those of a file.
///
/// Formats GREY, YUYV and MJPG at 320x240 and 160x120, 10 or 30 pictures a second; pan, tilt and
/// zoom. Frames come by the test's clock; every byte of one is the low byte of its number. The file
/// has no last close that would end a stream: v4l2_model_reset is that.
#ifndef CONTRACT_SUPPORT_V4L2_MODEL_H
#define CONTRACT_SUPPORT_V4L2_MODEL_H

#include "hal/clock.h"

#include <stdbool.h>
#include <stdint.h>

#define V4L2_MODEL_PAN_MAX  648000
#define V4L2_MODEL_PAN_STEP 3600
#define V4L2_MODEL_ZOOM_MIN 100
#define V4L2_MODEL_ZOOM_MAX 500

/// What it does wrong; each count goes down by one with every frame that has it.
struct v4l2_model_faults {
    uint32_t flag;  ///< frames that the kernel marks as damaged (V4L2_BUF_FLAG_ERROR)
    uint32_t cut;   ///< frames of which only half has come
    uint32_t empty; ///< frames without any picture
    uint32_t swell; ///< frames that claim to be larger than their buffer
    uint32_t lose;  ///< frames that never come
    bool busy;      ///< another program streams
    bool no_frames; ///< it is an output, or whatever else
    /// Formats that it does not have: 1 GREY, 2 YUYV, 4 MJPG.
    unsigned missing;
    bool slow_pixels; ///< no more than 2 pictures a second but as MJPG
    uint32_t without; ///< a control that it does not have
    int refuse;       ///< settings fail with that errno
    /// Questions about controls fail with an errno: so many of them.
    int control_error;
    uint32_t control_errors;
};
extern struct v4l2_model_faults v4l2_model_faults;

/// Makes the file, and serves it from now on. Returns its path.
const char *v4l2_model_plug(const struct hal_clock *clock);
/// As it is when nobody has it open: no stream, no faults, looking ahead.
void v4l2_model_reset(void);
/// It answers ENODEV to everything from now on, until reset.
void v4l2_model_unplug(void);

/// Where it looks, and its zoom; settings that it took.
int32_t v4l2_model_value(uint32_t id);
uint32_t v4l2_model_settings(void);
/// Buffers that it holds, of those that were asked for.
uint32_t v4l2_model_queued(void);

#endif
