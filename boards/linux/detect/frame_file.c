#include "detect/frame_file.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/// A JPEG file may be so large.
enum { JPEG_BYTES_MAX = 64 << 20 };

bool frame_file_open(struct frame_file *file, const char *path) {
    file->number = 0;
    file->opened = path != NULL && strcmp(path, "-") != 0;
    file->name = file->opened ? path : "stdin";
    file->stream = file->opened ? fopen(path, "rb") : stdin;
    if (file->stream == NULL) {
        message_at(path, 0, "%s", strerror(errno));
        return false;
    }
    return true;
}

void frame_file_close(struct frame_file *file) {
    if (file->opened && file->stream != NULL) {
        fclose(file->stream);
    }
    file->stream = NULL;
}

void frame_file_free(struct frame_file *file) {
    frame_file_close(file);
    linux_luma_free(&file->luma);
    free(file->bytes);
    memset(file, 0, sizeof *file);
}

static enum frame_file_status complain(const struct frame_file *file, const char *what) {
    message_at(file->name, 0, "picture %lu: %s", file->number, what);
    return FRAME_FILE_ERROR;
}

static bool make_room(struct frame_file *file, size_t size) {
    if (size > file->capacity) {
        uint8_t *larger = realloc(file->bytes, size);
        if (larger == NULL) {
            return false;
        }
        file->bytes = larger;
        file->capacity = size;
    }
    return true;
}

// ---------------------------------------------------------------- PGM and PPM

/// A whole number of the header, after blanks and comments. Negative: there is none.
static long header_number(FILE *stream) {
    int c = getc(stream);
    while (isspace(c) || c == '#') {
        if (c == '#') {
            while (c != '\n' && c != EOF) {
                c = getc(stream);
            }
        }
        c = getc(stream);
    }
    long value = -1;
    while (c >= '0' && c <= '9') {
        value = (value < 0 ? 0 : value) * 10 + (c - '0');
        if (value > 1000000) {
            return -1;
        }
        c = getc(stream);
    }
    // The one blank after the number belongs to it.
    return isspace(c) ? value : -1;
}

/// Red, green and blue to brightness, in place; the weights of ITU-R BT.601 in 1/256.
static void to_grey(uint8_t *bytes, size_t pixels) {
    for (size_t i = 0; i < pixels; i++) {
        const unsigned sum =
            77U * bytes[3U * i] + 150U * bytes[3U * i + 1U] + 29U * bytes[3U * i + 2U] + 128U;
        bytes[i] = (uint8_t)(sum >> 8);
    }
}

static enum frame_file_status read_pnm(struct frame_file *file, bool colour,
                                       struct hal_camera_luma *frame) {
    const long width = header_number(file->stream);
    const long height = width > 0 ? header_number(file->stream) : -1;
    const long most = height > 0 ? header_number(file->stream) : -1;
    if (width <= 0 || height <= 0 || most <= 0) {
        return complain(file, "its header is not that of a PGM or PPM picture");
    }
    if (width > (long)FRAME_FILE_SIDE_MAX || height > (long)FRAME_FILE_SIDE_MAX) {
        return complain(file, "larger than 8192 x 8192 pixels");
    }
    if (most > 255) {
        return complain(file, "has more than 8 bits a sample");
    }
    const size_t pixels = (size_t)width * (size_t)height, size = pixels * (colour ? 3U : 1U);
    if (!make_room(file, size)) {
        return complain(file, "no memory for it");
    }
    if (fread(file->bytes, 1, size, file->stream) != size) {
        return complain(file, "is cut off");
    }
    if (colour) {
        to_grey(file->bytes, pixels);
    }
    for (size_t i = 0; most < 255 && i < pixels; i++) {
        const unsigned wide = (file->bytes[i] * 255U + (unsigned)most / 2U) / (unsigned)most;
        file->bytes[i] = (uint8_t)(wide < 255U ? wide : 255U);
    }
    *frame = (struct hal_camera_luma){.luma = file->bytes,
                                      .width_px = (uint32_t)width,
                                      .height_px = (uint32_t)height,
                                      .stride_bytes = (uint32_t)width};
    return FRAME_FILE_OK;
}

// ---------------------------------------------------------------- JPEG

/// Width and height from the frame header, the first of the segments that has them.
static bool jpeg_size(const uint8_t *bytes, size_t size, struct hal_camera_format *format) {
    size_t at = 2;
    while (at + 9U < size && bytes[at] == 0xFFU) {
        const uint8_t kind = bytes[at + 1U];
        const size_t length = (size_t)bytes[at + 2U] << 8 | bytes[at + 3U];
        const bool frame =
            kind >= 0xC0U && kind <= 0xCFU && kind != 0xC4U && kind != 0xC8U && kind != 0xCCU;
        if (frame) {
            format->height_px = (uint32_t)bytes[at + 5U] << 8 | bytes[at + 6U];
            format->width_px = (uint32_t)bytes[at + 7U] << 8 | bytes[at + 8U];
            return format->width_px > 0U && format->height_px > 0U &&
                   format->width_px <= FRAME_FILE_SIDE_MAX &&
                   format->height_px <= FRAME_FILE_SIDE_MAX;
        }
        if (kind == 0xFFU) {
            at++; // padding
        } else {
            at += 2U + length;
        }
    }
    return false;
}

static enum frame_file_status read_jpeg(struct frame_file *file, struct hal_camera_luma *frame) {
    size_t size = 2;
    for (;;) {
        if (size >= JPEG_BYTES_MAX || !make_room(file, size + (1U << 20))) {
            return complain(file, "too large, or no memory for it");
        }
        file->bytes[0] = 0xFF;
        file->bytes[1] = 0xD8;
        const size_t got = fread(file->bytes + size, 1, file->capacity - size, file->stream);
        size += got;
        if (got == 0U) {
            break;
        }
    }
    if (linux_luma_jpeg_library() == NULL) {
        return complain(file, "this program was built without libjpeg-turbo: install "
                              "libjpeg62-turbo-dev and build it again");
    }
    struct hal_camera_format format = {.pixels = HAL_CAMERA_MJPEG};
    const struct hal_camera_frame whole = {.data = file->bytes, .size_bytes = (uint32_t)size};
    if (!jpeg_size(file->bytes, size, &format) ||
        linux_luma_take(&file->luma, &format, &whole, frame) != HAL_OK) {
        return complain(file, "is no JPEG picture that can be read");
    }
    if (frame->damaged) {
        return complain(file, "is damaged");
    }
    return FRAME_FILE_OK;
}

// ---------------------------------------------------------------- either

enum frame_file_status frame_file_next(struct frame_file *file, struct hal_camera_luma *frame) {
    int first = getc(file->stream);
    while (file->number > 0U && isspace(first)) {
        first = getc(file->stream);
    }
    file->number++;
    if (first == EOF) {
        if (ferror(file->stream)) {
            return complain(file, strerror(errno));
        }
        return file->number > 1U ? FRAME_FILE_END : complain(file, "is empty");
    }
    const int second = getc(file->stream);
    if (first == 'P' && (second == '5' || second == '6')) {
        return read_pnm(file, second == '6', frame);
    }
    if (first == 0xFF && second == 0xD8) {
        return read_jpeg(file, frame);
    }
    return complain(file, "is no PGM (P5), PPM (P6) or JPEG picture");
}
