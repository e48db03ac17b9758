#include "linux/linux_luma.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if HAVE_JPEG
#include <jpeglib.h>
#include <setjmp.h>
#endif

/// Room for so many bytes; NULL: no memory.
static uint8_t *room_for(struct linux_luma *luma, size_t size_bytes) {
    if (size_bytes > luma->size_bytes) {
        uint8_t *const grown = realloc(luma->pixels, size_bytes);
        if (grown == NULL) {
            return NULL;
        }
        luma->pixels = grown;
        luma->size_bytes = size_bytes;
    }
    return luma->pixels;
}

// ---------------------------------------------------------------- JPEG

#if HAVE_JPEG

struct trap {
    struct jpeg_error_mgr manager; ///< first: the library hands it back
    jmp_buf out;
};

static void leave(j_common_ptr common) {
    longjmp(((struct trap *)common->err)->out, 1);
}

/// The library would write to stderr.
static void keep_quiet(j_common_ptr common) {
    (void)common;
}

static void decode_lines(struct jpeg_decompress_struct *jpeg,
                         const struct hal_camera_format *format, uint8_t *pixels) {
    (void)jpeg_read_header(jpeg, TRUE);
    jpeg->out_color_space = JCS_GRAYSCALE;
    if (jpeg->image_width != format->width_px || jpeg->image_height != format->height_px ||
        !jpeg_start_decompress(jpeg) || jpeg->output_components != 1) {
        leave((j_common_ptr)jpeg);
    }
    while (jpeg->output_scanline < jpeg->output_height) {
        JSAMPROW line = pixels + (size_t)jpeg->output_scanline * format->width_px;
        (void)jpeg_read_scanlines(jpeg, &line, 1);
    }
    (void)jpeg_finish_decompress(jpeg);
}

/// False: the library gave up, and came back here by a long jump; so no variable of this function's
/// own is used after it.
__attribute__((noinline)) static bool decode(struct jpeg_decompress_struct *jpeg, struct trap *trap,
                                             const struct hal_camera_format *format,
                                             const struct hal_camera_frame *frame,
                                             uint8_t *pixels) {
    if (setjmp(trap->out) != 0) {
        return false;
    }
    jpeg_create_decompress(jpeg);
    jpeg_mem_src(jpeg, frame->data, frame->size_bytes);
    decode_lines(jpeg, format, pixels);
    return true;
}

static enum hal_status take_jpeg(struct linux_luma *luma, const struct hal_camera_format *format,
                                 const struct hal_camera_frame *frame,
                                 struct hal_camera_luma *out) {
    uint8_t *const pixels = room_for(luma, (size_t)format->width_px * format->height_px);
    if (pixels == NULL) {
        return HAL_ERROR_IO;
    }
    struct jpeg_decompress_struct jpeg = {0};
    struct trap trap;
    jpeg.err = jpeg_std_error(&trap.manager);
    trap.manager.error_exit = leave;
    trap.manager.output_message = keep_quiet;
    const bool decoded = decode(&jpeg, &trap, format, frame, pixels);
    out->damaged = out->damaged || trap.manager.num_warnings != 0;
    jpeg_destroy_decompress(&jpeg);
    out->luma = pixels;
    out->stride_bytes = format->width_px;
    return decoded ? HAL_OK : HAL_ERROR_IO;
}

const char *linux_luma_jpeg_library(void) {
    static char text[32];
    snprintf(text, sizeof text, "libjpeg-turbo %d.%d.%d", LIBJPEG_TURBO_VERSION_NUMBER / 1000000,
             LIBJPEG_TURBO_VERSION_NUMBER / 1000 % 1000, LIBJPEG_TURBO_VERSION_NUMBER % 1000);
    return text;
}

#else

static enum hal_status take_jpeg(struct linux_luma *luma, const struct hal_camera_format *format,
                                 const struct hal_camera_frame *frame,
                                 struct hal_camera_luma *out) {
    (void)luma;
    (void)format;
    (void)frame;
    (void)out;
    return HAL_ERROR_UNSUPPORTED;
}

const char *linux_luma_jpeg_library(void) {
    return NULL;
}

#endif

// ---------------------------------------------------------------- pixels as they are

/// A frame that ends early has lines that are missing: those are black, and it is damaged.
static enum hal_status take_plain(struct linux_luma *luma, const struct hal_camera_format *format,
                                  const struct hal_camera_frame *frame,
                                  struct hal_camera_luma *out) {
    const size_t step = format->pixels == HAL_CAMERA_YUYV ? 2U : 1U;
    const size_t line_bytes = (size_t)format->width_px * step;
    const size_t needed = (size_t)(format->height_px - 1U) * format->stride_bytes + line_bytes;
    const bool whole = frame->size_bytes >= needed;
    if (whole && step == 1U) {
        out->luma = frame->data;
        out->stride_bytes = format->stride_bytes;
        return HAL_OK;
    }
    uint8_t *const pixels = room_for(luma, (size_t)format->width_px * format->height_px);
    if (pixels == NULL || frame->size_bytes == 0U) {
        return HAL_ERROR_IO;
    }
    for (uint32_t y = 0; y < format->height_px; y++) {
        const size_t at = (size_t)y * format->stride_bytes;
        uint8_t *const to = pixels + (size_t)y * format->width_px;
        if (at + line_bytes > frame->size_bytes) {
            memset(to, 0, format->width_px);
            continue;
        }
        const uint8_t *const from = frame->data + at;
        for (uint32_t x = 0; x < format->width_px; x++) {
            to[x] = from[x * step];
        }
    }
    out->luma = pixels;
    out->stride_bytes = format->width_px;
    out->damaged = out->damaged || !whole;
    return HAL_OK;
}

enum hal_status linux_luma_take(struct linux_luma *luma, const struct hal_camera_format *format,
                                const struct hal_camera_frame *frame, struct hal_camera_luma *out) {
    if (format->width_px == 0U || format->height_px == 0U || format->pixels > HAL_CAMERA_MJPEG ||
        (unsigned)format->pixels == 0U) {
        return HAL_ERROR_ARGUMENT;
    }
    struct hal_camera_luma taken = {.width_px = format->width_px,
                                    .height_px = format->height_px,
                                    .exposed_us = frame->exposed_us,
                                    .sequence = frame->sequence,
                                    .damaged = frame->damaged};
    const enum hal_status status = format->pixels == HAL_CAMERA_MJPEG
                                       ? take_jpeg(luma, format, frame, &taken)
                                       : take_plain(luma, format, frame, &taken);
    if (status != HAL_OK) {
        luma->refused++;
        return status;
    }
    luma->damaged += taken.damaged ? 1U : 0U;
    *out = taken;
    return HAL_OK;
}

void linux_luma_free(struct linux_luma *luma) {
    free(luma->pixels);
    *luma = (struct linux_luma){0};
}
