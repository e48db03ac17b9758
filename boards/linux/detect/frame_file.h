/// Frames from files: PGM and PPM in binary (P5, P6; several after each other, as converters of
/// films write them to a pipe), and JPEG, a picture a file.
/// Shown: tests/cli/frame_files.c.
#ifndef DETECT_FRAME_FILE_H
#define DETECT_FRAME_FILE_H

#include "hal/camera.h"
#include "message.h"

#include "linux/linux_luma.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/// The widest and highest picture that is taken.
#define FRAME_FILE_SIDE_MAX 8192U

/// Zeroed at first.
struct frame_file {
    FILE *stream;
    const char *name; ///< as it stands in messages
    bool opened;
    unsigned long number; ///< of the picture read last in this file, from 1
    uint8_t *bytes;       ///< of the picture
    size_t capacity;
    struct linux_luma luma;
};

/// path: a file, or NULL or "-" for stdin. False: told on stderr why not.
bool frame_file_open(struct frame_file *file, const char *path);

enum frame_file_status {
    FRAME_FILE_OK,
    FRAME_FILE_END,
    FRAME_FILE_ERROR ///< not a picture, cut off, too large, or JPEG without its library: told
};

/// The next picture, valid until the next call.
enum frame_file_status frame_file_next(struct frame_file *file, struct hal_camera_luma *frame);

/// Keeps the memory for the next file.
void frame_file_close(struct frame_file *file);
void frame_file_free(struct frame_file *file);

#endif
