#include "contract/support/syscalls.h"

#include <aio.h>
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/timerfd.h>
#include <termios.h>
#include <unistd.h>

static struct {
    uint32_t nth, count;
    enum syscalls_fate fate;
    int error_number;
    bool ignored;
    const char *spared;
    const char *met; ///< name of the nth call
    void (*intrude)(void);
    bool (*serve)(int fd, unsigned long request, void *argument, int *result);
    unsigned long request;
    const void *answer;
    size_t answer_bytes;
    char log[4000];
} plan;
static pthread_mutex_t plan_mutex = PTHREAD_MUTEX_INITIALIZER;
static _Atomic uint32_t mapping_count;

void syscalls_at(uint32_t nth, enum syscalls_fate fate, int error_number) {
    pthread_mutex_lock(&plan_mutex);
    plan.nth = nth;
    plan.count = 0;
    plan.fate = fate;
    plan.error_number = error_number;
    plan.met = "";
    plan.log[0] = '\0';
    pthread_mutex_unlock(&plan_mutex);
}

void syscalls_spare(const char *names) {
    plan.spared = names;
}

void syscalls_serve_ioctl(bool (*serve)(int fd, unsigned long request, void *argument,
                                        int *result)) {
    plan.serve = serve;
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

const char *syscalls_met_name(void) {
    return plan.met;
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

uint32_t syscalls_mappings(void) {
    return mapping_count;
}

static uint32_t count_entries(const char *path) {
    uint32_t count = 0;
    const bool ignored = plan.ignored;
    syscalls_watch(false);
    DIR *const folder = opendir(path);
    while (folder != NULL && readdir(folder) != NULL) {
        count++;
    }
    if (folder != NULL) {
        closedir(folder);
    }
    syscalls_watch(!ignored);
    return count;
}

uint32_t syscalls_open_files(void) {
    return count_entries("/proc/self/fd");
}

uint32_t syscalls_threads(void) {
    return count_entries("/proc/self/task");
}

static void die(void) {
    kill(getpid(), SIGKILL);
    pause();
}

static bool is_spared(const char *name) {
    const size_t size = strlen(name);
    for (const char *at = plan.spared; at != NULL && *at != '\0'; at += strcspn(at, " ") + 1U) {
        if (strncmp(at, name, size) == 0 && at[size] == ' ') {
            return true;
        }
    }
    return false;
}

/// Whether the call is the one, or one after it that fails, too.
static bool count_call(const char *name) {
    const size_t size = strlen(plan.log);
    snprintf(plan.log + size, sizeof plan.log - size, "%s ", name);
    plan.count++;
    plan.met = plan.count == plan.nth ? name : plan.met;
    const bool after = plan.fate == SYSCALLS_FAIL_ON && plan.nth != 0U && plan.count > plan.nth;
    return plan.count == plan.nth || after;
}

/// Counts a call; whether it is the one.
static bool is_due(const char *name) {
    if (plan.ignored || is_spared(name)) {
        return false;
    }
    pthread_mutex_lock(&plan_mutex);
    const bool due = count_call(name);
    pthread_mutex_unlock(&plan_mutex);
    if (!due) {
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

bool syscalls_fails(const char *name, int *error_number) {
    int result;
    if (!is_due(name) || !is_replaced(&result)) {
        return false;
    }
    *error_number = plan.error_number;
    return true;
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

/// The same for a call that answers with something else than a number; failing: what it gives then.
#define PASS_ON_OBJECT(type, failing, name, parameters, arguments)                                 \
    type name parameters {                                                                         \
        type(*real) parameters;                                                                    \
        find(&real, #name);                                                                        \
        int result;                                                                                \
        return is_due(#name) && is_replaced(&result) ? (failing) : real arguments;                 \
    }

PASS_ON(ssize_t, read, (int fd, void *data, size_t size), (fd, data, size))
PASS_ON(ssize_t, write, (int fd, const void *data, size_t size), (fd, data, size))
PASS_ON(ssize_t, pread, (int fd, void *data, size_t size, off_t at), (fd, data, size, at))
PASS_ON(ssize_t, send, (int fd, const void *data, size_t size, int flags), (fd, data, size, flags))
PASS_ON(ssize_t, recv, (int fd, void *data, size_t size, int flags), (fd, data, size, flags))
PASS_ON(ssize_t, recvmsg, (int fd, struct msghdr *message, int flags), (fd, message, flags))
PASS_ON(int, setsockopt, (int fd, int level, int name, const void *value, socklen_t size),
        (fd, level, name, value, size))
PASS_ON(int, getsockopt, (int fd, int level, int name, void *value, socklen_t *size),
        (fd, level, name, value, size))
PASS_ON(int, socket, (int domain, int type, int protocol), (domain, type, protocol))
PASS_ON(int, bind, (int fd, const struct sockaddr *address, socklen_t size), (fd, address, size))
PASS_ON(int, poll, (struct pollfd * ends, nfds_t count, int patience_ms),
        (ends, count, patience_ms))
PASS_ON(int, timerfd_create, (clockid_t clock, int flags), (clock, flags))
PASS_ON(int, timerfd_settime,
        (int fd, int flags, const struct itimerspec *wanted, struct itimerspec *before),
        (fd, flags, wanted, before))
PASS_ON(int, eventfd, (unsigned count, int flags), (count, flags))
PASS_ON(int, access, (const char *path, int mode), (path, mode))
PASS_ON(ssize_t, readlink, (const char *restrict path, char *restrict text, size_t size),
        (path, text, size))
PASS_ON_OBJECT(FILE *, NULL, fopen, (const char *restrict path, const char *restrict mode),
               (path, mode))
PASS_ON_OBJECT(DIR *, NULL, opendir, (const char *path), (path))
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

void *mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset) {
    void *(*real)(void *, size_t, int, int, int, off_t);
    find(&real, "mmap");
    int result;
    if (is_due("mmap") && is_replaced(&result)) {
        return MAP_FAILED;
    }
    void *const got = real(at, size, protection, flags, fd, offset);
    mapping_count += got != MAP_FAILED ? 1U : 0U;
    return got;
}

/// Nothing that a driver does can make it fail.
int munmap(void *at, size_t size) {
    int (*real)(void *, size_t);
    find(&real, "munmap");
    mapping_count--;
    return real(at, size);
}

#if defined __has_feature
#if __has_feature(address_sanitizer)
#define BELOW_SANITIZER 1
#endif
#endif
#ifdef BELOW_SANITIZER
/// The sanitizer's, which would be called if it were not for this file: it has to know all threads.
int __interceptor_pthread_create(pthread_t *thread, const pthread_attr_t *how, void *(*run)(void *),
                                 void *context);
#endif

/// Its error is its result.
int pthread_create(pthread_t *restrict thread, const pthread_attr_t *restrict how,
                   void *(*run)(void *), void *restrict context) {
    int (*real)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
#ifdef BELOW_SANITIZER
    real = __interceptor_pthread_create;
#else
    find(&real, "pthread_create");
#endif
    int result;
    return is_due("pthread_create") && is_replaced(&result) ? plan.error_number
                                                            : real(thread, how, run, context);
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
    if (plan.serve != NULL && plan.serve(fd, request, argument, &result)) {
        return result;
    }
    const int got = real(fd, request, argument);
    if (due) {
        die();
    }
    return got;
}
