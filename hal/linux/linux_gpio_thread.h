/// A thread that works at given times: what moves GPIO lines on time while the program does
/// something else. With real-time priority where that is allowed.
///
/// It sleeps until shortly before the time and then watches the clock, because a sleeping thread
/// wakes late. For linux_gpio_pulses.c and linux_gpio_steps.c only.
/// Shown: tests/contract/linux_gpio_edges.c, tests/vm/linux_gpio.c.
#ifndef HAL_LINUX_GPIO_THREAD_H
#define HAL_LINUX_GPIO_THREAD_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/// Does what is due at now_ns. Returns when it wants to be called again.
typedef uint64_t linux_gpio_work(void *ctx, uint64_t now_ns);

struct linux_gpio_thread {
    pthread_t thread;
    atomic_bool ending;
    bool runs;
    linux_gpio_work *work;
    void *ctx;
};

/// False: errno tells why.
bool linux_gpio_thread_start(struct linux_gpio_thread *thread, linux_gpio_work *work, void *ctx);
/// Waits until it has ended, which takes as long as one call of its work.
void linux_gpio_thread_stop(struct linux_gpio_thread *thread);

/// Nanoseconds of CLOCK_MONOTONIC.
uint64_t linux_gpio_thread_now_ns(void);
void linux_gpio_thread_sleep_until(uint64_t then_ns);

#endif
