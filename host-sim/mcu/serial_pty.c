#include "mcu/serial_pty.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

/// That of the boards' consoles. A pseudo-terminal ignores it.
#define SPEED B115200

static bool make_raw(int fd) {
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0) {
        return false;
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    cfsetispeed(&settings, SPEED);
    cfsetospeed(&settings, SPEED);
    return tcsetattr(fd, TCSANOW, &settings) == 0;
}

static bool make_link(struct serial_pty *pty, const char *name, const char *link) {
    struct stat about;
    if (strlen(link) >= sizeof pty->link) {
        errno = ENAMETOOLONG;
        return false;
    }
    if (lstat(link, &about) == 0 && S_ISLNK(about.st_mode) && unlink(link) != 0) {
        return false;
    }
    if (symlink(name, link) != 0) {
        return false;
    }
    memcpy(pty->link, link, strlen(link) + 1U);
    return true;
}

/// A terminal that is there, by its name or a link to it, and no pseudo-terminal of an earlier run.
static bool is_real_line(const char *path) {
    struct stat about;
    char place[PATH_MAX];
    return stat(path, &about) == 0 && S_ISCHR(about.st_mode) && realpath(path, place) != NULL &&
           strncmp(place, "/dev/pts/", 9) != 0;
}

static bool open_line(struct serial_pty *pty, const char *path) {
    pty->board_end = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (pty->board_end >= 0 && make_raw(pty->board_end)) {
        return true;
    }
    const int error_number = errno;
    serial_pty_close(pty);
    errno = error_number;
    return false;
}

bool serial_pty_open(struct serial_pty *pty, const char *link) {
    *pty = (struct serial_pty){.board_end = -1, .other_end = -1};
    if (is_real_line(link)) {
        return open_line(pty, link);
    }
    pty->board_end = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    const bool unlocked =
        pty->board_end >= 0 && grantpt(pty->board_end) == 0 && unlockpt(pty->board_end) == 0;
    const char *name = unlocked ? ptsname(pty->board_end) : NULL;
    pty->other_end = name != NULL ? open(name, O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
    if (pty->other_end < 0 || !make_raw(pty->other_end) || !make_link(pty, name, link)) {
        const int error_number = errno;
        serial_pty_close(pty);
        errno = error_number;
        return false;
    }
    return true;
}

void serial_pty_close(struct serial_pty *pty) {
    if (pty->link[0] != '\0') {
        (void)unlink(pty->link);
        pty->link[0] = '\0';
    }
    if (pty->other_end >= 0) {
        close(pty->other_end);
    }
    if (pty->board_end >= 0) {
        close(pty->board_end);
    }
    pty->board_end = pty->other_end = -1;
}

void serial_pty_write(struct serial_pty *pty, uint8_t byte) {
    const ssize_t count = write(pty->board_end, &byte, 1);
    (void)count; // full: nobody reads, and the byte is lost
}

void serial_pty_pass(struct serial_pty *pty, struct usart *usart) {
    uint8_t bytes[64];
    // A byte that the line does not take would be lost: it waits in the terminal instead.
    if (usart->line.baud == 0U || USART_LINE_BYTES - usart->line.count < sizeof bytes) {
        return;
    }
    const ssize_t count = read(pty->board_end, bytes, sizeof bytes);
    if (count > 0) {
        (void)usart_send(usart, bytes, (uint32_t)count);
    }
}
