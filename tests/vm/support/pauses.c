#include "vm/support/pauses.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#define NAP_US 2000

static atomic_uint longest_us;
static uint32_t noted_us;

static int64_t now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static void *watch(void *processor) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET((size_t)(uintptr_t)processor, &set);
    (void)pthread_setaffinity_np(pthread_self(), sizeof set, &set);
    for (int64_t before_us = now_us();;) {
        const struct timespec nap = {0, NAP_US * 1000};
        nanosleep(&nap, NULL);
        const int64_t after_us = now_us();
        const unsigned late_us = (unsigned)(after_us - before_us - NAP_US);
        unsigned longest = atomic_load(&longest_us);
        while (late_us > longest && !atomic_compare_exchange_weak(&longest_us, &longest, late_us)) {
        }
        before_us = after_us;
    }
    return NULL;
}

void pauses_watch(uint32_t most_us) {
    noted_us = most_us;
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    for (long i = 0; i < processors; i++) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, watch, (void *)(uintptr_t)i) != 0) {
            perror("no thread to watch for pauses");
            exit(2);
        }
        pthread_detach(thread);
    }
}

const char *pauses_excuse(void) {
    static char text[64];
    const unsigned late_us = atomic_exchange(&longest_us, 0);
    if (late_us <= noted_us) {
        return NULL;
    }
    snprintf(text, sizeof text, "the machine paused for %u ms", late_us / 1000U);
    return text;
}
