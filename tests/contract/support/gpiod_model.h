/// Stands for libgpiod below the GPIO drivers: lines whose edges are kept with their times, in
/// virtual time. A program that links it has no other GPIO.
#ifndef CONTRACT_SUPPORT_GPIOD_MODEL_H
#define CONTRACT_SUPPORT_GPIOD_MODEL_H

#include <stdbool.h>
#include <stdint.h>

enum { GPIOD_MODEL_LINES = 8, GPIOD_MODEL_EDGES = 65536 };

struct gpiod_model {
    uint64_t now_ns;
    uint64_t set_cost_ns; ///< that a call of the library takes
    uint32_t held_count;
    uint64_t calls, fail_at; ///< settings of lines so far; the one from which on all fail, 0: none
    bool busy[GPIOD_MODEL_LINES];
    bool high[GPIOD_MODEL_LINES];
    uint32_t edge_count;
    struct gpiod_model_edge {
        uint32_t line;
        bool high;
        uint64_t at_ns;
    } edge[GPIOD_MODEL_EDGES];
};
extern struct gpiod_model gpiod_model;

uint64_t gpiod_model_now_ns(void);
/// Lets work (linux_gpio_thread.h) run until a time, exactly when it wants to; then the time is
/// that.
void gpiod_model_run(uint64_t (*work)(void *ctx, uint64_t now_ns), void *ctx, uint64_t until_ns);

#endif
