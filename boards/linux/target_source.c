#include "target_source.h"

#include "message.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool target_source_open(struct target_source *source, const char *path) {
    memset(source, 0, sizeof *source);
    const bool is_stdin = path == NULL || strcmp(path, "-") == 0;
    source->name = is_stdin ? "stdin" : path;
    source->fd = is_stdin ? STDIN_FILENO : open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    source->opened = !is_stdin && source->fd >= 0;
    struct stat about;
    if (source->fd < 0 || fstat(source->fd, &about) != 0 || S_ISDIR(about.st_mode)) {
        message_at(source->name, 0, "%s", source->fd < 0 ? strerror(errno) : "is a directory");
        target_source_close(source);
        return false;
    }
    source->is_recording = S_ISREG(about.st_mode);
    json_object_seed(0); // else the first line opens /dev/urandom for it, in the middle of a tick
    return true;
}

void target_source_close(struct target_source *source) {
    if (source->opened) {
        close(source->fd);
        source->opened = false;
    }
}

/// Reads what is there. stdin may be shared with others, so it is not made non-blocking; poll says
/// whether it would be.
static void fill(struct target_source *source) {
    struct pollfd ready = {source->fd, POLLIN, 0};
    if (source->at_end || source->size == sizeof source->buffer || poll(&ready, 1, 0) <= 0) {
        return;
    }
    const ssize_t got =
        read(source->fd, source->buffer + source->size, sizeof source->buffer - source->size);
    if (got > 0) {
        source->size += (size_t)got;
    } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
        source->at_end = true;
    }
}

static void drop(struct target_source *source, size_t count) {
    source->size -= count;
    memmove(source->buffer, source->buffer + count, source->size);
}

static void take_line(struct target_source *source, const char *text, size_t size) {
    bool blank;
    source->line_number++;
    const char *wrong = target_line_read(text, size, &source->objects, &source->pending, &blank);
    if (wrong != NULL) {
        source->bad_lines++;
        message_at(source->name, source->line_number, "%s; the line is skipped", wrong);
        return;
    }
    source->has_pending = !blank;
    if (source->has_pending && source->pending.has_time && !source->has_first) {
        source->has_first = true;
        source->first_us = source->pending.time_us;
    }
}

/// Cuts the next line off the buffer. False: there is none yet.
static bool cut_line(struct target_source *source) {
    const char *end = memchr(source->buffer, '\n', source->size);
    if (end == NULL && source->size == sizeof source->buffer) {
        if (!source->skipping) {
            source->bad_lines++;
            message_at(source->name, source->line_number + 1U,
                       "longer than %zu bytes; the line is skipped", sizeof source->buffer - 1U);
        }
        source->skipping = true;
        source->size = 0;
        return true;
    }
    if (end == NULL && (!source->at_end || source->size == 0U)) {
        return false;
    }
    const size_t size = end != NULL ? (size_t)(end - source->buffer) : source->size;
    if (source->skipping) {
        source->skipping = false;
        source->line_number++;
    } else {
        take_line(source, source->buffer, size);
    }
    drop(source, end != NULL ? size + 1U : size);
    return true;
}

static bool is_due(const struct target_source *source, uint64_t now_us) {
    if (!source->is_recording || !source->pending.has_time) {
        return true;
    }
    return source->pending.time_us <= source->first_us ||
           source->pending.time_us - source->first_us <= now_us;
}

bool target_source_next(struct target_source *source, uint64_t now_us,
                        struct target_update *update) {
    while (!source->has_pending) {
        fill(source);
        if (!cut_line(source)) {
            return false;
        }
    }
    *update = source->pending.update;
    return is_due(source, now_us);
}

void target_source_taken(struct target_source *source) {
    source->has_pending = false;
}
