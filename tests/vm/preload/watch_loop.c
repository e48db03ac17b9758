/// Preloaded into `boresight run`: names whatever its loop does that may take long.
///
/// From the loop's first wait until what it waits on is closed, the program's first thread opens
/// nothing and waits for nothing but the next tick: each call of these functions by it, also from
/// within libusb and libgpiod, is a line `NAME WHAT` in the file that WATCH_LOOP names. That the
/// watch works shows its first line, `loop`.
#define _GNU_SOURCE // for the compiler's own headers, whatever the flags
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static int waits_on = -1; ///< not told by a timer: libusb makes and closes timers, too
static bool loops;

/// By system calls only: nothing here may come back to the functions below.
static void tell(const char *name, const char *what) {
    char line[512];
    const char *path = getenv("WATCH_LOOP");
    if (path == NULL || !loops || (pid_t)syscall(SYS_gettid) != getpid()) {
        return;
    }
    const int why = errno;
    const int size = snprintf(line, sizeof line, "%s %s\n", name, what);
    const long file =
        syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
    if (file >= 0) {
        (void)syscall(SYS_write, file, line, (size_t)size);
        (void)syscall(SYS_close, file);
    }
    errno = why;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

// ---------------------------------------------------------------- from when to when

int epoll_wait(int epoll, struct epoll_event *events, int most, int timeout_ms) {
    if (!loops && (pid_t)syscall(SYS_gettid) == getpid()) {
        loops = true;
        waits_on = epoll;
        tell("loop", "");
    }
    return REAL(epoll_wait)(epoll, events, most, timeout_ms);
}

int close(int fd) {
    loops = loops && fd != waits_on;
    return REAL(close)(fd);
}

// ---------------------------------------------------------------- what may take long

#define OPEN_MODE(flags, mode)                                                                     \
    mode_t mode = 0;                                                                               \
    if (((flags) & (O_CREAT | O_TMPFILE)) != 0) {                                                  \
        va_list more;                                                                              \
        va_start(more, flags);                                                                     \
        mode = va_arg(more, mode_t);                                                               \
        va_end(more);                                                                              \
    }

int open(const char *path, int flags, ...) {
    OPEN_MODE(flags, mode)
    tell("open", path);
    return REAL(open)(path, flags, mode);
}

int open64(const char *path, int flags, ...) {
    OPEN_MODE(flags, mode)
    tell("open", path);
    return REAL(open64)(path, flags, mode);
}

int openat(int folder, const char *path, int flags, ...) {
    OPEN_MODE(flags, mode)
    tell("openat", path);
    return REAL(openat)(folder, path, flags, mode);
}

int openat64(int folder, const char *path, int flags, ...) {
    OPEN_MODE(flags, mode)
    tell("openat", path);
    return REAL(openat64)(folder, path, flags, mode);
}

FILE *fopen(const char *path, const char *mode) {
    tell("fopen", path);
    return REAL(fopen)(path, mode);
}

FILE *fopen64(const char *path, const char *mode) {
    tell("fopen", path);
    return REAL(fopen64)(path, mode);
}

DIR *opendir(const char *path) {
    tell("opendir", path);
    return REAL(opendir)(path);
}

int socket(int family, int type, int protocol) {
    tell("socket", "");
    return REAL(socket)(family, type, protocol);
}

int fsync(int fd) {
    tell("fsync", "");
    return REAL(fsync)(fd);
}

int usleep(useconds_t time_us) {
    tell("usleep", "");
    return REAL(usleep)(time_us);
}

int nanosleep(const struct timespec *time, struct timespec *left) {
    tell("nanosleep", "");
    return REAL(nanosleep)(time, left);
}

int clock_nanosleep(clockid_t clock, int flags, const struct timespec *time,
                    struct timespec *left) {
    tell("clock_nanosleep", "");
    return REAL(clock_nanosleep)(clock, flags, time, left);
}

int poll(struct pollfd *fds, nfds_t count, int timeout_ms) {
    if (timeout_ms != 0) {
        tell("poll", "");
    }
    return REAL(poll)(fds, count, timeout_ms);
}
