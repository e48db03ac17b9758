#include "linux/linux_clock.h"

#include <stdlib.h>
#include <time.h>

static uint32_t monotonic_us(void) {
    struct timespec now;
    if (clock_gettime(CLOCK_MONOTONIC, &now) != 0) {
        abort(); // can't be: every Linux has it
    }
    return (uint32_t)((uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U);
}

static uint32_t linux_clock_now_us(void *ctx) {
    const struct linux_clock *clock = ctx;
    return monotonic_us() + clock->offset_us;
}

static const struct hal_clock_ops ops = {linux_clock_now_us};

void linux_clock_open(struct linux_clock *clock, uint32_t start_us) {
    clock->offset_us = start_us - monotonic_us();
    if (hal_clock_bind(&clock->hal, &ops, clock) != HAL_OK) {
        abort();
    }
}
