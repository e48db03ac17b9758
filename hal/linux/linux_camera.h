/// hal/camera.h on a video device of Linux (V4L2), by frames in memory that is shared with the
/// kernel.
///
/// Give it the number of no other: /dev/video0, a link that stays the same as
/// /dev/v4l/by-id/usb-...-video-index0, or the camera's name as `boresight probe` shows it. It
/// never waits: fd can be polled while it streams (readable: dequeue answers something else than
/// HAL_EMPTY). Exposure times are the kernel's time stamps; of a device that stamps the end of a
/// frame, one interval before. Controls go to the device in the background
/// (linux_camera_controls.h); one that fails later shows in linux_camera_failed_settings, and the
/// control is back where it was.
///
/// A device that leaves answers HAL_ERROR_GONE from then on: close it, and open it when it is back.
/// Shown: tests/contract/linux_camera.c (the contract suite in virtual time, each system call
/// failing with each error), tests/vm/linux_camera.c and tests/vm/linux_vivid.c (the same and more,
/// on an emulated USB camera and on the kernel's vivid: stalled requests, lost, torn and faulty
/// frames, silence, unplugging at every step).
#ifndef HAL_LINUX_CAMERA_H
#define HAL_LINUX_CAMERA_H

#include "fixed/must_check.h"
#include "hal/camera.h"
#include "hal/clock.h"
#include "linux/linux_camera_controls.h"
#include "linux/linux_error.h"

/// What is asked for; the device may give from 2 to LINUX_CAMERA_BUFFERS_MAX.
#define LINUX_CAMERA_BUFFERS     4U
#define LINUX_CAMERA_BUFFERS_MAX 8U
#define LINUX_CAMERA_PATH_BYTES  128
#define LINUX_CAMERA_NAME_BYTES  33

struct linux_camera {
    struct hal_camera hal;
    /// Why the last call failed.
    struct linux_error error;
    int fd; ///< -1: not open
    char path[LINUX_CAMERA_PATH_BYTES];
    char name[LINUX_CAMERA_NAME_BYTES];
    struct hal_camera_format format; ///< as negotiated last
    uint32_t buffer_count;           ///< while it streams

    // Private from here on.
    const struct hal_clock *clock;
    bool gone, streaming, negotiated, any_frame;
    uint32_t first_sequence; ///< the kernel's, of the first frame
    struct linux_camera_buffer {
        uint8_t *data;
        size_t size_bytes;
        uint32_t sequence;
        bool out;
        bool owed; ///< neither out nor the device's: it is given back at the next chance
    } buffer[LINUX_CAMERA_BUFFERS_MAX];
    struct linux_camera_controls controls;
};

/// device: a path, or a camera's name. clock: what exposures are stamped with; it runs on
/// CLOCK_MONOTONIC (linux_clock.h).
/// Returns:  HAL_OK: camera->hal is bound, close it in the end;
///           HAL_ERROR_GONE: no such device; HAL_ERROR_DENIED; HAL_ERROR_UNSUPPORTED: it is no
///           camera, or none that streams; HAL_ERROR_IO.
///           If not HAL_OK, nothing is open, camera->error has the line, and camera->hal answers
///           HAL_ERROR_GONE. Must not move in memory afterwards.
/// Cost:     milliseconds; of a USB camera that was just plugged in, up to seconds.
enum hal_status linux_camera_open(struct linux_camera *camera, const char *device,
                                  const struct hal_clock *clock) MUST_CHECK;

/// Ends the stream, and waits for a control that is being set.
void linux_camera_close(struct linux_camera *camera);

/// Settings of controls that the device refused after control_set had taken them, and those that it
/// took.
uint32_t linux_camera_failed_settings(struct linux_camera *camera);
uint32_t linux_camera_taken_settings(struct linux_camera *camera);

/// A camera as `boresight probe` shows it.
struct linux_camera_info {
    char path[LINUX_CAMERA_PATH_BYTES]; ///< one that stays the same, if there is one
    char name[LINUX_CAMERA_NAME_BYTES];
    uint32_t pixels;              ///< bit 1 << enum hal_camera_pixels
    uint32_t controls;            ///< bit 1 << enum hal_camera_control
    uint32_t width_px, height_px; ///< of the largest picture
    struct hal_camera_range zoom;
    bool has_id;              ///< it has a link by its serial number
    struct linux_error error; ///< why it could not be opened; empty: it could
};

#define LINUX_CAMERA_MISSING "is it plugged in? `boresight probe` lists the cameras"

/// The path of the camera of that name. HAL_ERROR_GONE: there is none; HAL_ERROR_DENIED,
/// HAL_ERROR_IO: none, but some can't be asked for theirs; HAL_ERROR_ARGUMENT: several. error: why
/// it is not found.
enum hal_status linux_camera_find(const char *name, char *path, size_t size,
                                  struct linux_error *error) MUST_CHECK;

/// All video devices that give frames, up to capacity. Returns how many there are.
uint32_t linux_camera_list(struct linux_camera_info *cameras, uint32_t capacity);

#endif
