#include "run_log.h"

#include "event_loop.h"
#include "message.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
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

bool run_log_open(struct run_log *log, const char *target, uint64_t start_us) {
    *log = (struct run_log){.fd = -1, .name = target, .start_us = start_us};
    if (target == NULL) {
        return true;
    }
    log->is_journal = strcmp(target, "journal") == 0;
    log->fd = log->is_journal
                  ? open_journal()
                  : open(target, O_WRONLY | O_APPEND | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644);
    if (log->fd < 0) {
        message_at(log->is_journal ? run_log_journal : target, 0, "%s; %s", strerror(errno),
                   log->is_journal   ? "is systemd's journal running? --log FILE writes to a file"
                   : errno == ENOENT ? "create its folder first"
                   : errno == EACCES ? "name a file that this user may write"
                                     : "name another file");
        return false;
    }
    return true;
}

void run_log_close(struct run_log *log) {
    if (log->fd >= 0) {
        close(log->fd);
    }
    log->fd = -1;
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

void run_log_event(struct run_log *log, bool severe, const char *event, const char *format, ...) {
    char text[TEXT_BYTES], record[RECORD_BYTES];
    if (log->fd < 0) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    int size;
    if (log->is_journal) {
        for (char *at = text; (at = strchr(at, '\n')) != NULL;) {
            *at = ' '; // a field ends with its line
        }
        size =
            snprintf(record, sizeof record,
                     "PRIORITY=%d\nSYSLOG_IDENTIFIER=boresight\nBORESIGHT_EVENT=%s\nMESSAGE=%s\n",
                     severe ? 3 : 6, event, text);
    } else {
        char escaped[6 * TEXT_BYTES];
        escape(text, escaped);
        const uint64_t t_us = event_loop_now_us() - log->start_us;
        size =
            snprintf(record, sizeof record,
                     "{\"t_s\": %" PRIu64 ".%06" PRIu64 ", \"event\": \"%s\", \"text\": \"%s\"}\n",
                     t_us / 1000000U, t_us % 1000000U, event, escaped);
    }
    if (size < 0 || write(log->fd, record, (size_t)size) != (ssize_t)size) {
        if (log->dropped++ == 0U) { // the rig matters more
            message_at(log->name, 0, "%s; the rig goes on, log_dropped counts what is lost",
                       strerror(errno));
        }
    }
}
