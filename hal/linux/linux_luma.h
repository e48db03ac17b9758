/// Frames of a camera as brightness alone, which is what detectors work on.
///
/// GREY is handed on as it is, of YUYV every second byte is copied, and a JPEG picture is decoded
/// by libjpeg-turbo (its colours are never computed). Pictures without Huffman tables, as many
/// cameras send them, get the tables of the standard. Shown: tests/contract/linux_luma.c (against
/// pictures whose pixels are known; every cut and every changed byte of a JPEG picture).
#ifndef HAL_LINUX_LUMA_H
#define HAL_LINUX_LUMA_H

#include "fixed/must_check.h"
#include "hal/camera.h"

#include <stddef.h>

/// Zeroed at first.
struct linux_luma {
    uint8_t *pixels; ///< of the frame converted last
    size_t size_bytes;
    /// Frames that could not be decoded, and those that were only in part.
    uint32_t refused, damaged;
};

/// The brightness of a frame in that format.
/// luma:    valid until the next call, until linux_luma_free, or until the frame is given back;
///          damaged also if the frame is shorter than its format or the decoder found fault.
/// Returns: HAL_OK; HAL_ERROR_IO: there is no picture in it (luma is as it was);
///          HAL_ERROR_UNSUPPORTED: JPEG, and this program was built without the library;
///          HAL_ERROR_ARGUMENT: a format without pixels.
/// Cost:    one pass over the picture, none for GREY; memory the first time and when a picture is
///          larger than any before.
enum hal_status linux_luma_take(struct linux_luma *luma, const struct hal_camera_format *format,
                                const struct hal_camera_frame *frame,
                                struct hal_camera_luma *out) MUST_CHECK;

void linux_luma_free(struct linux_luma *luma);

/// Version of the JPEG library; NULL: built without it.
const char *linux_luma_jpeg_library(void);

#endif
