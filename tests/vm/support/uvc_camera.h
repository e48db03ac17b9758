/// A USB camera with pan, tilt and zoom as the USB Video Class document (1.0) describes it, for a
/// usb_port: formats YUY2, Y800 and MJPEG over a bulk endpoint, each at 320x240 and 160x120.
///
/// The kernel's own uvcvideo drives it. The structure lies in shared memory (usb_port_share), so
/// that a test sees what reached the camera and can make it misbehave while it is plugged in.
#ifndef VM_SUPPORT_UVC_CAMERA_H
#define VM_SUPPORT_UVC_CAMERA_H

#include "vm/support/usb_port.h"

#include <stdbool.h>
#include <stdint.h>

#define UVC_CAMERA_NAME     "Boresight test camera"
#define UVC_CAMERA_WIDTH    320U
#define UVC_CAMERA_HEIGHT   240U
#define UVC_CAMERA_PAN_MAX  324000 ///< arc-seconds; the lowest is the negative
#define UVC_CAMERA_PAN_STEP 36
#define UVC_CAMERA_ZOOM_MIN 100
#define UVC_CAMERA_ZOOM_MAX 500

struct uvc_camera {
    // What has reached it.
    volatile int32_t pan, tilt, zoom;
    volatile uint32_t settings;       ///< of pan and tilt, or zoom
    volatile uint32_t starts, frames; ///< frames that were begun
    volatile uint32_t width_px, height_px, interval_us;
    // How it misbehaves.
    volatile bool refuses;         ///< every request of its class is stalled
    volatile uint32_t refuse_next; ///< so many settings are stalled
    volatile uint32_t tear_next;   ///< so many frames end in the middle
    volatile uint32_t spoil_next;  ///< so many are marked as faulty by the camera
    volatile bool silent;          ///< no frames come
    volatile uint32_t slow_us;     ///< a setting takes so long

    /// Paints a picture of width_px * height_px bytes of brightness; NULL: every byte is the low
    /// byte of the frame's number (frames, from 0). Runs in the camera's process.
    void (*paint)(void *ctx, const struct uvc_camera *camera, uint8_t *picture);
    /// Is there something new to see? Until then the frame that is due waits. NULL: always.
    bool (*ready)(void *ctx);
    void *ctx;

    // Private from here on.
    uint8_t probe[26];
    uint32_t format; ///< 1 YUY2, 2 Y800, 3 MJPEG
    uint64_t due_us;
    uint32_t frame_bytes, sent_bytes;
    bool sending, tearing, spoiling, id;
    uint8_t luma[UVC_CAMERA_WIDTH * UVC_CAMERA_HEIGHT];
    uint8_t frame[UVC_CAMERA_WIDTH * UVC_CAMERA_HEIGHT * 2U];
};

/// A camera that was just made.
void uvc_camera_init(struct uvc_camera *camera);
/// Plugs it into a port, as it is.
void uvc_camera_plug(struct usb_port *port, unsigned number, struct uvc_camera *camera);

#endif
