#include "contract/support/syscalls.h"

#include <aio.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

static struct {
    uint32_t nth, count;
    enum syscalls_fate fate;
    int error_number;
    bool ignored;
    void (*intrude)(void);
    unsigned long request;
    const void *answer;
    size_t answer_bytes;
    char log[2000];
} plan;

void syscalls_at(uint32_t nth, enum syscalls_fate fate, int error_number) {
    plan.nth = nth;
    plan.count = 0;
    plan.fate = fate;
    plan.error_number = error_number;
    plan.log[0] = '\0';
}

void syscalls_intruder(void (*act)(void)) {
    plan.intrude = act;
}

void syscalls_answer_ioctl(unsigned long request, const void *data, size_t size_bytes) {
    plan.request = request;
    plan.answer = data;
    plan.answer_bytes = size_bytes;
}

const char *syscalls_log(void) {
    return plan.log;
}

uint32_t syscalls_count(void) {
    return plan.count;
}

bool syscalls_met(void) {
    return plan.nth != 0U && plan.count >= plan.nth;
}

void syscalls_watch(bool watch) {
    plan.ignored = !watch;
}

uint32_t syscalls_open_files(void) {
    uint32_t count = 0;
    for (int fd = 0; fd < 1024; fd++) {
        count += fcntl(fd, F_GETFD) >= 0 ? 1U : 0U;
    }
    return count;
}

static void die(void) {
    kill(getpid(), SIGKILL);
    pause();
}

/// Counts a call; whether it is the one.
static bool is_due(const char *name) {
    if (plan.ignored) {
        return false;
    }
    const size_t size = strlen(plan.log);
    snprintf(plan.log + size, sizeof plan.log - size, "%s ", name);
    plan.count++;
    const bool after = plan.fate == SYSCALLS_FAIL_ON && plan.nth != 0U && plan.count > plan.nth;
    if (plan.count != plan.nth && !after) {
        return false;
    }
    if (plan.fate == SYSCALLS_INTRUDE) {
        plan.ignored = true;
        plan.intrude();
        plan.ignored = false;
        return false;
    }
    if (plan.fate == SYSCALLS_KILL_BEFORE) {
        die();
    }
    return true;
}

/// What a call that is due gives instead of its work; false: it does its work and dies then.
static bool is_replaced(int *result) {
    if (plan.fate == SYSCALLS_FAIL || plan.fate == SYSCALLS_FAIL_ON) {
        errno = plan.error_number;
        *result = -1;
        return true;
    }
    *result = 0;
    return plan.fate == SYSCALLS_ZERO;
}

/// The C library's own function of that name.
static void find(void *function, const char *name) {
    void *const found = dlsym(RTLD_NEXT, name);
    if (found == NULL) {
        fprintf(stderr, "no %s in the C library\n", name);
        abort();
    }
    memcpy(function, &found, sizeof found); // ISO C has no cast from void * to a function
}

/// A call without a middle: declares the real function, counts, fails or dies.
#define PASS_ON(type, name, parameters, arguments)                                                 \
    type name parameters {                                                                         \
        type(*real) parameters;                                                                    \
        find(&real, #name);                                                                        \
        const bool due = is_due(#name);                                                            \
        int result;                                                                                \
        if (due && is_replaced(&result)) {                                                         \
            return (type)result;                                                                   \
        }                                                                                          \
        const type got = real arguments;                                                           \
        if (due) {                                                                                 \
            die();                                                                                 \
        }                                                                                          \
        return got;                                                                                \
    }

PASS_ON(ssize_t, read, (int fd, void *data, size_t size), (fd, data, size))
PASS_ON(ssize_t, write, (int fd, const void *data, size_t size), (fd, data, size))
PASS_ON(ssize_t, pread, (int fd, void *data, size_t size, off_t at), (fd, data, size, at))
PASS_ON(ssize_t, recv, (int fd, void *data, size_t size, int flags), (fd, data, size, flags))
PASS_ON(ssize_t, recvmsg, (int fd, struct msghdr *message, int flags), (fd, message, flags))
PASS_ON(int, setsockopt, (int fd, int level, int name, const void *value, socklen_t size),
        (fd, level, name, value, size))
PASS_ON(int, fsync, (int fd), (fd))
PASS_ON(int, fdatasync, (int fd), (fd))
PASS_ON(int, ftruncate, (int fd, off_t size), (fd, size))
PASS_ON(int, flock, (int fd, int operation), (fd, operation))
PASS_ON(int, fstat, (int fd, struct stat *about), (fd, about))
PASS_ON(int, rename, (const char *from, const char *to), (from, to))
PASS_ON(int, tcgetattr, (int fd, struct termios *settings), (fd, settings))
PASS_ON(int, tcsetattr, (int fd, int when, const struct termios *settings), (fd, when, settings))
PASS_ON(int, tcflush, (int fd, int queue), (fd, queue))
PASS_ON(int, aio_fsync, (int operation, struct aiocb *control), (operation, control))

/// On Linux even a close that fails closes.
int close(int fd) {
    int (*real)(int);
    find(&real, "close");
    const bool due = is_due("close");
    int result;
    const bool replaced = due && is_replaced(&result);
    const int got = real(fd);
    if (due && !replaced) {
        die();
    }
    return replaced ? result : got;
}

/// Its failure is what an operation in the background ended with.
int aio_error(const struct aiocb *control) {
    int (*real)(const struct aiocb *);
    find(&real, "aio_error");
    const int got = real(control);
    if (got == EINPROGRESS ||
        !is_due("aio_error")) { // how often it is in progress is chance: not counted
        return got;
    }
    int result;
    return is_replaced(&result) ? plan.error_number : (die(), 0);
}

ssize_t pwrite(int fd, const void *data, size_t size, off_t at) {
    ssize_t (*real)(int, const void *, size_t, off_t);
    find(&real, "pwrite");
    const bool due = is_due("pwrite");
    int result;
    if (due && is_replaced(&result)) {
        return result;
    }
    const size_t part = due && plan.fate == SYSCALLS_KILL_TORN ? size / 2U : size;
    const ssize_t got = real(fd, data, part, at);
    if (due) {
        die();
    }
    return got;
}

int open(const char *path, int flags, ...) {
    int (*real)(const char *, int, ...);
    find(&real, "open");
    mode_t mode = 0;
    if ((flags & O_CREAT) != 0) {
        va_list rest;
        va_start(rest, flags);
        mode = va_arg(rest, mode_t);
        va_end(rest);
    }
    const bool due = is_due("open");
    int result;
    if (due && is_replaced(&result)) {
        return result;
    }
    const int fd = real(path, flags, mode);
    if (due) {
        die();
    }
    return fd;
}

int ioctl(int fd, unsigned long request, ...) {
    int (*real)(int, unsigned long, ...);
    find(&real, "ioctl");
    va_list rest;
    va_start(rest, request);
    void *const argument = va_arg(rest, void *);
    va_end(rest);
    const bool due = is_due("ioctl");
    int result;
    if (due && is_replaced(&result)) {
        return result;
    }
    if (plan.answer != NULL && request == plan.request) {
        memcpy(argument, plan.answer, plan.answer_bytes);
        return 0;
    }
    const int got = real(fd, request, argument);
    if (due) {
        die();
    }
    return got;
}
