#include "devices/fake_clock.h"

#include "devices/fake_bind.h"

static uint32_t fake_clock_now_us(void *ctx) {
    struct fake_clock *clock = ctx;
    const uint32_t now_us = clock->now_us;
    clock->now_us += clock->step_us;
    return now_us;
}

static const struct hal_clock_ops ops = {fake_clock_now_us};

void fake_clock_init(struct fake_clock *clock, uint32_t now_us) {
    *clock = (struct fake_clock){.now_us = now_us};
    fake_bind_check(hal_clock_bind(&clock->hal, &ops, clock));
}

void fake_clock_set(struct fake_clock *clock, uint32_t now_us) {
    clock->now_us = now_us;
}

void fake_clock_advance(struct fake_clock *clock, uint32_t span_us) {
    clock->now_us += span_us;
}
