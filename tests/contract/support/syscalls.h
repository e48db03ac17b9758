/// System calls that fail to order, or at which the program is killed.
///
/// syscalls.c defines read, write, open and so on itself and hands them on to the C library, so the
/// drivers of hal/linux that are linked into the same test program call these, and so do libusb and
/// libgpiod below them. Calls of all threads count. Only programs that use this header get them.
#ifndef CONTRACT_SUPPORT_SYSCALLS_H
#define CONTRACT_SUPPORT_SYSCALLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum syscalls_fate {
    /// Fails with the errno, with no effect.
    SYSCALLS_FAIL,
    /// So do all that come after it.
    SYSCALLS_FAIL_ON,
    /// Gives 0 (the end of a file, nothing written).
    SYSCALLS_ZERO,
    /// Somebody else acts just before it (syscalls_intruder), then it does its work.
    SYSCALLS_INTRUDE,
    /// SIGKILL, before, in the middle of (a write: half of it) or after it.
    SYSCALLS_KILL_BEFORE,
    SYSCALLS_KILL_TORN,
    SYSCALLS_KILL_AFTER
};

/// The nth call from now (1: the next) meets its fate; nth 0: none does. Counts from 0 again.
void syscalls_at(uint32_t nth, enum syscalls_fate fate, int error_number);

/// Calls since syscalls_at.
uint32_t syscalls_count(void);

/// Whether the nth call has come.
bool syscalls_met(void);

/// What SYSCALLS_INTRUDE does; its own calls are not watched.
void syscalls_intruder(void (*act)(void));

/// The names of the calls since syscalls_at, each followed by a blank; cut if there are too many.
const char *syscalls_log(void);

/// The name of the nth call, once it has come; else "".
const char *syscalls_met_name(void);

/// For what stands for a library: a call of its function, counted like all others. True: it is to
/// fail with *error_number (a negative one can be the library's own code) and have no effect.
bool syscalls_fails(const char *name, int *error_number);

/// Calls of these names, each followed by a blank, are not counted and never fail, until the next
/// order; "": none.
void syscalls_spare(const char *names);

/// Serves the ioctls of a device that there is not; *result: what ioctl is to return, with errno.
/// False: it is somebody else's, and the kernel is asked. Called by whichever thread asks. null:
/// none.
void syscalls_serve_ioctl(bool (*serve)(int fd, unsigned long request, void *argument,
                                        int *result));

/// Every ioctl of that request succeeds and answers with these bytes, until the next order for
/// another; null: no request does. data stays the caller's.
void syscalls_answer_ioctl(unsigned long request, const void *data, size_t size_bytes);

/// false: calls go through uncounted, for what a test does on the far side. true at first.
void syscalls_watch(bool watch);

/// Descriptors that are open: the same before and after whatever should leave none behind. So with
/// what is mapped by mmap, and with threads.
uint32_t syscalls_open_files(void);
uint32_t syscalls_mappings(void);
uint32_t syscalls_threads(void);

#endif
