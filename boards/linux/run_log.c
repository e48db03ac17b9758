#include "run_log.h"

#include "event_loop.h"
#include "message.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define TEXT_BYTES   512
#define RECORD_BYTES (6 * TEXT_BYTES + 128)

const char *run_log_journal = "/run/systemd/journal/socket";

static int open_journal(void) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    snprintf(address.sun_path, sizeof address.sun_path, "%s", run_log_journal);
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd >= 0 && connect(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        const int why = errno;
        close(fd);
        errno = why;
        return -1;
    }
    return fd;
}

static int open_file(const char *path) {
    return open(path, O_WRONLY | O_APPEND | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644);
}

/// The text as the inside of a JSON string. out: six times the room of the text.
static void escape(const char *text, char *out) {
    for (; *text != '\0'; text++) {
        const unsigned char byte = (unsigned char)*text;
        if (byte == '"' || byte == '\\') {
            *out++ = '\\';
            *out++ = *text;
        } else if (byte < 0x20U) {
            out += sprintf(out, "\\u%04x", byte);
        } else {
            *out++ = *text;
        }
    }
    *out = '\0';
}

// ---------------------------------------------------------------- in the thread that writes

/// Was the file renamed or removed? Then the next line begins another.
static void follow_name(struct run_log *log) {
    struct stat named, opened;
    const bool same = stat(log->name, &named) == 0 && fstat(log->fd, &opened) == 0 &&
                      named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
    const int fd = same ? -1 : open_file(log->name);
    if (fd >= 0) {
        close(log->fd);
        log->fd = fd;
        log->told_lost = false;
    } else if (!same && !log->told_lost) {
        message_at(log->name, 0, "can't be made anew, so the log goes on where it was: %s",
                   strerror(errno));
        log->told_lost = true;
    }
}

static bool put(const struct run_log *log, const char *record, int size) {
    return size >= 0 && log->fd >= 0 && write(log->fd, record, (size_t)size) == (ssize_t)size;
}

static bool put_to_journal(struct run_log *log, const struct aside_line *line, char *record,
                           size_t room) {
    const int size = snprintf(
        record, room, "PRIORITY=%d\nSYSLOG_IDENTIFIER=boresight\nBORESIGHT_EVENT=%s\nMESSAGE=%s\n",
        line->severe ? 3 : 6, line->event, line->text);
    if (put(log, record, size)) {
        return true;
    }
    if (log->fd >= 0 && (errno == EAGAIN || errno == ENOBUFS)) {
        return false; // it is there, and has too much to do
    }
    if (log->fd >= 0) {
        close(log->fd);
    }
    log->fd = open_journal();
    return put(log, record, size);
}

static bool put_to_file(struct run_log *log, const struct aside_line *line, char *record,
                        size_t room) {
    char escaped[6 * TEXT_BYTES];
    escape(line->text, escaped);
    const uint64_t t_us = line->at_us - log->start_us;
    const int size = snprintf(
        record, room, "{\"t_s\": %" PRIu64 ".%06" PRIu64 ", \"event\": \"%s\", \"text\": \"%s\"}\n",
        t_us / 1000000U, t_us % 1000000U, line->event, escaped);
    follow_name(log);
    return put(log, record, size);
}

static void write_line(void *context, const struct aside_line *line) {
    struct run_log *const log = context;
    char record[RECORD_BYTES];
    const bool good = log->is_journal ? put_to_journal(log, line, record, sizeof record)
                                      : put_to_file(log, line, record, sizeof record);
    if (!good && atomic_fetch_add(&log->failed, 1U) == 0U) { // the rig matters more
        message_at(log->name, 0, "%s; the rig goes on, log_dropped counts what is lost",
                   strerror(errno));
    }
}

// ---------------------------------------------------------------- for the loop

/// A service's stderr ends in the journal: systemd.exec(5), JOURNAL_STREAM.
static bool is_stderr_in_journal(void) {
    const char *stream = getenv("JOURNAL_STREAM");
    uintmax_t device, inode;
    struct stat opened;
    return stream != NULL && sscanf(stream, "%" SCNuMAX ":%" SCNuMAX, &device, &inode) == 2 &&
           fstat(STDERR_FILENO, &opened) == 0 && device == (uintmax_t)opened.st_dev &&
           inode == (uintmax_t)opened.st_ino;
}

bool run_log_open(struct run_log *log, const char *target, uint64_t start_us) {
    log->is_open = log->takes_stderr = false;
    log->name = target;
    log->start_us = start_us;
    log->told_lost = false;
    atomic_store(&log->failed, 0U);
    if (target == NULL) {
        return true;
    }
    log->is_journal = strcmp(target, "journal") == 0;
    log->fd = log->is_journal ? open_journal() : open_file(target);
    log->is_open = log->fd >= 0 && aside_open(&log->lines, write_line, log);
    log->takes_stderr = log->is_open && log->is_journal && is_stderr_in_journal();
    if (!log->is_open) {
        message_at(log->is_journal ? run_log_journal : target, 0, "%s; %s", strerror(errno),
                   log->is_journal   ? "is systemd's journal running? --log FILE writes to a file"
                   : errno == ENOENT ? "create its folder first"
                   : errno == EACCES ? "name a file that this user may write"
                                     : "name another file");
        if (log->fd >= 0) {
            close(log->fd);
        }
    }
    return log->is_open;
}

void run_log_close(struct run_log *log) {
    if (log->is_open) {
        aside_close(&log->lines);
        if (log->fd >= 0) {
            close(log->fd);
        }
    }
    log->is_open = false;
}

uint64_t run_log_dropped(struct run_log *log) {
    if (!log->is_open) {
        return 0;
    }
    aside_flush(&log->lines);
    return atomic_load(&log->failed) + aside_dropped(&log->lines);
}

void run_log_event(struct run_log *log, bool severe, const char *event, const char *format, ...) {
    if (!log->is_open) {
        return;
    }
    struct aside_line line = {.at_us = event_loop_now_us(), .severe = severe};
    char text[TEXT_BYTES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *at = text; log->is_journal && (at = strchr(at, '\n')) != NULL;) {
        *at = ' '; // a field ends with its line
    }
    snprintf(line.text, sizeof line.text, "%s", text);
    snprintf(line.event, sizeof line.event, "%s", event);
    aside_push(&log->lines, &line);
}

void run_log_tell(struct run_log *log, const char *command, bool severe, const char *event,
                  const char *text) {
    if (!log->takes_stderr) {
        message_command(command, "%s", text);
    }
    run_log_event(log, severe, event, "%s", text);
}

void run_log_tell_at(struct run_log *log, const char *file, const char *event, const char *text) {
    if (!log->takes_stderr) {
        message_at(file, 0, "%s", text);
    }
    run_log_event(log, true, event, "%s", text);
}
