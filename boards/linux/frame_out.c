#include "frame_out.h"

#include "message.h"

#include "view/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEADER_BYTES_MAX 256U

bool frame_out_open(struct frame_out *out, const char *path, uint32_t width_px,
                    uint32_t height_px) {
    const size_t pixels = (size_t)width_px * height_px;
    struct stat about;
    *out = (struct frame_out){.path = path, .width_px = width_px, .height_px = height_px, .fd = -1};
    out->is_pipe = stat(path, &about) == 0 && S_ISFIFO(about.st_mode);
    out->picture = calloc(1, pixels);
    out->bytes = malloc(pixels + HEADER_BYTES_MAX);
    if (out->picture == NULL || out->bytes == NULL) {
        message_at(path, 0, "no memory for pictures");
        return false;
    }
    if (out->is_pipe) { // a reader that leaves is told by EPIPE
        (void)signal(SIGPIPE, SIG_IGN);
    } else if (!frame_out_send(out, "no picture yet")) {
        message_at(path, 0, "%s", strerror(errno));
        return false;
    }
    out->written = 0;
    return true;
}

void frame_out_close(struct frame_out *out) {
    if (out->path != NULL && out->fd >= 0) {
        close(out->fd);
    }
    free(out->picture);
    free(out->bytes);
    *out = (struct frame_out){.fd = -1};
}

void frame_out_tick(struct frame_out *out) {
    while (out->sent < out->size) {
        const ssize_t count = write(out->fd, out->bytes + out->sent, out->size - out->sent);
        if (count < 0 && errno != EAGAIN && errno != EINTR) { // the reader has left
            close(out->fd);
            out->fd = -1;
            out->size = out->sent = 0;
            out->dropped++;
        }
        if (count <= 0) {
            return;
        }
        out->sent += (size_t)count;
        out->written += out->sent == out->size;
    }
}

/// Makes the picture the one that is under way.
static void pack(struct frame_out *out, const char *comment) {
    const size_t pixels = (size_t)out->width_px * out->height_px;
    const int header = snprintf((char *)out->bytes, HEADER_BYTES_MAX, "P5\n# %.200s\n%u %u\n255\n",
                                comment, (unsigned)out->width_px, (unsigned)out->height_px);
    memcpy(out->bytes + header, out->picture, pixels);
    out->size = (size_t)header + pixels;
    out->sent = 0;
}

bool frame_out_send(struct frame_out *out, const char *comment) {
    if (!out->is_pipe) {
        pack(out, comment);
        const bool written = new_file_write(out->path, out->bytes, out->size);
        out->written += written;
        out->sent = out->size;
        return written;
    }
    frame_out_tick(out);
    if (out->fd < 0) {
        out->fd = open(out->path, O_WRONLY | O_NONBLOCK | O_CLOEXEC); // ENXIO: nobody reads
    }
    if (out->fd < 0 || out->sent < out->size) {
        out->dropped++;
        return true;
    }
    pack(out, comment);
    frame_out_tick(out);
    return true;
}
